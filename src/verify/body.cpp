// SPDX-License-Identifier: BSD-3-Clause
#include "verify/body.hpp"

namespace slipfront::verify {

statics::Equilibrium start(motion::Stepper& stepper, const mesh::Mesh& mesh, const Start& start) {
  statics::Equilibrium state;
  state.u_m = state.u_per_shear = solid::Field(static_cast<std::size_t>(mesh.n_nodes()));
  const auto orphan = mesh::orphans(mesh);
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    if (orphan[n]) continue;
    const double dt = stepper.step_s(n);
    const auto set = [&](const auto& motion, std::vector<double>& u, std::vector<double>& v) {
      if (!motion) return;
      u[n] = motion(n, 0);
      v[n] = (motion(n, 0) - motion(n, -dt)) / dt;
    };
    set(start.u_x_m, state.u_m.x, state.u_per_shear.x);
    set(start.u_y_m, state.u_m.y, state.u_per_shear.y);
  }
  state.contact.assign(mesh.lower.size(), start.contact);
  for (const auto n : mesh.lower) state.tractions.x_m.push_back(mesh.x_m[n]);
  state.tractions.t_s_Pa.assign(mesh.lower.size(), start.t_Pa);
  state.tractions.p_s_Pa.assign(mesh.lower.size(), start.p_Pa);
  stepper.start(state, 1);  // u_per_shear holds the velocities
  return state;
}

}  // namespace slipfront::verify
