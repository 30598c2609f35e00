// SPDX-License-Identifier: BSD-3-Clause
#include "verification/body.hpp"

namespace slipfront::verification {

namespace {

void set_motion(const motion::Body& body, const mesh::Mesh& mesh, const NodeMotion& u_x_m,
                const NodeMotion& u_y_m, solid::Field& u_m, solid::Field& v_m_per_s) {
  u_m = v_m_per_s = solid::Field(static_cast<std::size_t>(mesh.n_nodes()));
  const auto orphan = mesh::orphans(mesh);
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    if (orphan[n]) continue;
    const double dt = body.step_s(n);
    const auto set = [&](const auto& motion, std::vector<double>& u, std::vector<double>& v) {
      if (!motion) return;
      u[n] = motion(n, 0);
      v[n] = (motion(n, 0) - motion(n, -dt)) / dt;
    };
    set(u_x_m, u_m.x, v_m_per_s.x);
    set(u_y_m, u_m.y, v_m_per_s.y);
  }
}

class NoObserver final : public motion::StepObserver {
  void observe(double, const interface::Interface&, bool) override {}
};

}  // namespace

statics::Equilibrium start(motion::Stepper& stepper, const mesh::Mesh& mesh, const Start& start) {
  statics::Equilibrium state;
  // u_per_shear holds the velocities.
  set_motion(stepper.bodies().front(), mesh, start.u_x_m, start.u_y_m, state.u_m, state.u_per_shear);
  if (const auto& below = start.below; below.mesh)
    set_motion(stepper.bodies().back(), *below.mesh, below.u_x_m, below.u_y_m, state.below_u_m,
               state.below_u_per_shear);
  state.contact.assign(mesh.interface_nodes.size(), start.contact);
  for (const auto n : mesh.interface_nodes) state.tractions.x_m.push_back(mesh.x_m[n]);
  state.tractions.t_s_Pa.assign(mesh.interface_nodes.size(), start.t_Pa);
  state.tractions.p_s_Pa.assign(mesh.interface_nodes.size(), start.p_Pa);
  stepper.start(state, 1, start.loads);
  return state;
}

void advance(motion::Stepper& stepper) {
  NoObserver none;
  stepper.advance(none);
}

void reverse(motion::Stepper& stepper) {
  NoObserver none;
  stepper.reverse(none);
}

mesh::Mesh layer(double width_m, double height_m, double element_size_m, mesh::Top top) {
  return mesh::make_plate({.width_m = width_m,
                           .height_m = height_m,
                           .element_size_m = element_size_m,
                           .corner = mesh::Corner::none,
                           .sides = mesh::Sides::periodic,
                           .top = top});
}

}  // namespace slipfront::verification
