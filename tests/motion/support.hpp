// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "interface/friction/velocity_weakening.hpp"
#include "motion/event.hpp"
#include "motion/stepper.hpp"
#include "support/plate.hpp"

namespace slipfront::motion::support {

using namespace slipfront::test;

/// A state of motion that is no equilibrium: displacement u, velocity v at a top speed of 1, no contact.
inline statics::Equilibrium in_flight(const mesh::Mesh& mesh, solid::Field u, solid::Field v) {
  statics::Equilibrium e;
  e.u_m = std::move(u);
  e.u_per_shear = std::move(v);
  const std::size_t n = mesh.interface_nodes.size();
  e.contact.assign(n, statics::Contact::open);
  for (const auto node : mesh.interface_nodes) e.tractions.x_m.push_back(mesh.x_m[node]);
  e.tractions.t_s_Pa.assign(n, 0);
  e.tractions.p_s_Pa.assign(n, 0);
  return e;
}

/// Plain scheme: the interface layer in step with the rest.
inline TimeStepping one_substep(double step_factor = 0.9) {
  TimeStepping time;
  time.step_factor = step_factor;
  time.interface_rows = 1;
  time.interface_substeps = 1;
  return time;
}

inline interface::ContactModel with_algorithm(interface::ContactModel model,
                                              interface::ContactAlgorithm algorithm) {
  model.algorithm = algorithm;
  return model;
}

inline const interface::ContactModel paper_law {
  interface::VelocityWeakening {
    .mu_s = 1.3, .mu_k = 0.6, .alpha_m2_per_s2 = 0.1
  }
};

/// Weakens with the slip rate, but so slowly that rounding is not amplified: the paper's law lets differences
/// between two runs grow tenfold a step.
inline const interface::ContactModel gentle_law {
  interface::VelocityWeakening {
    .mu_s = 1.3, .mu_k = 1.0, .alpha_m2_per_s2 = 100
  }
};

/// A trigger at the left edge of the state.
inline Loads left_trigger(const statics::Equilibrium& state, const mesh::Mesh& mesh, double mu_s) {
  const interface::Trigger trigger { .zone_m = 3e-3, .ramp_s = 1e-6 };
  return {.trigger_force_N_per_m = trigger_forces(state, mesh::tributary_lengths_m(mesh),
                                                  interface::EventKind::left, trigger, mu_s),
          .trigger = trigger};
}

}  // namespace slipfront::motion::support
