// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::stiff_base {

namespace {

/// Damped enough that waves of the mesh do not grow.
const solid::Material pmma{.stiffness_damping_s = 0.25e-6};
constexpr double width_m = 0.2, height_m = 0.1, end_s = 60e-6;
constexpr double pressure_Pa = 5e6, t_Pa = 2.65e6, overstress_Pa = 1.1e6, patch_mm = 20;

interface::ContactModel contact() {
  return {interface::RateAndStateAging{}};
}

struct Slip {
  std::vector<double> x_mm, slip_um;
};

/// At the end, on a base so many times as stiff and as dense as the body; 0 for the rigid plane.
Slip slip(double stiffness, double h_m) {
  const auto mesh = layer(width_m, height_m, h_m);
  auto base = pmma;
  base.youngs_modulus_Pa *= stiffness;
  base.density_kg_per_m3 *= stiffness;
  const bool rigid = stiffness == 0;
  auto stepper = rigid ? motion::Stepper(mesh, pmma, contact(), plain_stepping())
                       : motion::Stepper(motion::BodySource{mesh, pmma}, motion::BodySource{mesh, base},
                                         contact(), plain_stepping());
  Slip slip;
  std::vector<double> t0_Pa;
  for (const auto n : mesh.interface_nodes) {
    slip.x_mm.push_back(1e3 * (mesh.x_m[n] - 0.5 * width_m));
    t0_Pa.push_back(t_Pa + overstress_Pa * std::exp(-std::pow(slip.x_mm.back() / patch_mm, 2)));
  }
  Start from{.contact = statics::Contact::slip,
             .t_Pa = t_Pa,
             .p_Pa = pressure_Pa,
             .loads = {t0_Pa, std::vector<double>(t0_Pa.size(), pressure_Pa)}};
  if (!rigid) from.below.mesh = &mesh;
  start(stepper, mesh, from);
  while (stepper.time_s() < end_s) advance(stepper);
  for (std::size_t i = 0; i < t0_Pa.size(); ++i) slip.slip_um.push_back(1e6 * stepper.slip_m(i));
  return slip;
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const double h_m = effort == Effort::full ? 1e-3 : 2e-3;
  const auto rigid = slip(0, h_m);
  Chart slips{.x_label = "x (mm)", .y_label = "slip (um)"};
  slips.curves.push_back({"rigid", Curve::Kind::theory, rigid.x_mm, rigid.slip_um});
  const std::vector<double> stiffnesses = {10, 100, 1e3, 1e4};
  std::vector<double> differences;
  for (const double stiffness : stiffnesses) {
    auto found = slip(stiffness, h_m);
    double difference = 0;
    for (std::size_t i = 0; i < found.slip_um.size(); ++i)
      difference = std::max(difference, std::abs(found.slip_um[i] - rigid.slip_um[i]));
    differences.push_back(difference / *std::ranges::max_element(rigid.slip_um));
    if (stiffness <= 100)
      slips.curves.push_back(
          {fmt::format("stiffness {}", stiffness), Curve::Kind::program, found.x_mm, found.slip_um});
  }
  for (std::size_t k = 0; k + 1 < stiffnesses.size(); ++k)
    outcome.check(
        fmt::format("difference of slip times the stiffness, at {:g}, over that at 1e4", stiffnesses[k]),
        stiffnesses[k] * differences[k] / (stiffnesses.back() * differences.back()), 1, 1 / stiffnesses[k],
        "the next order in 1/stiffness");
  Chart limit{.x_label = "stiffness of the base over that of the body",
              .y_label = "largest difference / largest slip",
              .log_x = true,
              .log_y = true};
  limit.curves = {order_line(-1, stiffnesses, differences.back()),
                  {"program", Curve::Kind::program, stiffnesses, differences}};
  outcome.charts = {std::move(slips), std::move(limit)};
  return outcome;
}

}  // namespace slipfront::verification::stiff_base
