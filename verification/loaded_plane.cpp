// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loaded_plane.hpp"

namespace slipfront::verification {

namespace {

/// The pressure that friction sees stays what it was.
constexpr interface::Regularisation constant_pressure { .relaxed = interface::Relaxed::pressure };

mesh::Mesh make_mesh(const LoadedPlane& plane) {
  return mesh::make_plate({.width_m = plane.width_m,
                           .height_m = plane.height_m,
                           .element_size_m = plane.h_m,
                           .corner = mesh::Corner::none,
                           .sides = mesh::Sides::absorbing,
                           .top = mesh::Top::absorbing});
}

/// Of the interface nodes from its middle.
std::vector<double> places_m(const mesh::Mesh& mesh, double width_m) {
  std::vector<double> x_m;
  for (const auto n : mesh.interface_nodes) x_m.push_back(mesh.x_m[n] - 0.5 * width_m);
  return x_m;
}

}  // namespace

LoadedBody::LoadedBody(const LoadedPlane& plane)
    : plane_(plane),
      mesh_(make_mesh(plane)),
      x_m_(places_m(mesh_, plane.width_m)),
      stepper_(mesh_, undamped, {plane.law, constant_pressure}, plain_stepping()) {
  const motion::Loads loads{.strength_fraction = plane.strength_fraction ? at(plane.strength_fraction)
                                                                         : std::vector<double>{}};
  auto state =
      start(stepper_, mesh_, {.contact = statics::Contact::stick, .p_Pa = plane.pressure_Pa, .loads = loads});
  if (!plane.t_at_V_i_Pa) return;
  state.tractions.t_s_Pa = at(plane.t_at_V_i_Pa);
  stepper_.start(state, 1, loads);
}

std::vector<double> LoadedBody::at(const std::function<double(double)>& f) const {
  std::vector<double> values;
  for (const double x : x_m_) values.push_back(f(x));
  return values;
}

void LoadedBody::load(const std::function<double(double)>& t0_Pa) {
  stepper_.set_prestress(at(t0_Pa), std::vector<double>(x_m_.size(), plane_.pressure_Pa));
}

double sliding_stiffness_Pa() {
  const double G = solid::shear_modulus_Pa(undamped);
  return 2 * G / (1 + G / solid::longitudinal_modulus_Pa(undamped));
}

}  // namespace slipfront::verification
