// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "statics/prestress.hpp"

/// When each interface node first slips.
class FirstSlips final : public slipfront::motion::StepObserver {
 public:
  explicit FirstSlips(std::size_t n) : first_s(n, std::numeric_limits<double>::infinity()) {}
  void observe(double time_s, const slipfront::interface::Interface& state, bool changed) override {
    for (std::size_t i = 0; changed && i < first_s.size(); ++i)
      if (state.slipping[i] != 0) first_s[i] = std::min(first_s[i], time_s);
  }
  std::vector<double> first_s;
};

/// Times of first slip in a rupture of 60 us from a patch whose friction is gone.
/// @param materials  of the body on the rigid plane, or of the bodies above and below
/// @param load_s     a loading of one's own: the shear is taken away then
inline std::vector<double> rupture(const slipfront::interface::FrictionLaw& law,
                                   std::span<const slipfront::solid::Material> materials,
                                   double load_s = 60e-6) {
  using namespace slipfront;
  const mesh::Mesh mesh = mesh::make_plate({.width_m = 0.2,
                                            .height_m = 0.05,
                                            .element_size_m = 1e-3,
                                            .corner = mesh::Corner::none,
                                            .sides = mesh::Sides::absorbing,
                                            .top = mesh::Top::absorbing});
  std::vector<motion::BodySource> bodies;  // a body below is the same mesh upside down
  for (const auto& material : materials) bodies.push_back({mesh, material});
  record::StaticState before;
  std::vector<double> strength_fraction;
  for (const auto node : mesh.interface_nodes) {
    before.x_m.push_back(mesh.x_m[node]);
    strength_fraction.push_back(std::abs(mesh.x_m[node] - 0.1) <= 12.5e-3 ? 0 : 1);
  }
  before.t_s_Pa = std::vector(before.x_m.size(), 1.2e6);
  before.p_s_Pa = std::vector(before.x_m.size(), 2e6);

  motion::Stepper stepper(bodies, {.law = law}, motion::TimeStepping{}, motion::Execution{});
  const auto state = statics::prestressed(mesh, before, bodies.size() > 1 ? &mesh : nullptr);
  auto loads = motion::prescribed_loads(state);
  loads.strength_fraction = strength_fraction;
  stepper.start(state, 0, loads);
  FirstSlips slips(before.x_m.size());
  while (stepper.time_s() < load_s) stepper.advance(slips);
  stepper.set_prestress(std::vector(before.x_m.size(), 0.0), loads.prestress_p_Pa);
  while (stepper.time_s() < 60e-6) stepper.advance(slips);
  return slips.first_s;
}
