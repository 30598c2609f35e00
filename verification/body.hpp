// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "statics/statics.hpp"

namespace slipfront::verification {

/// PMMA without damping: the body of most problems.
inline constexpr solid::Material undamped{.stiffness_damping_s = 0};

using NodeMotion = std::function<double(mesh::Node, double time_s)>;  ///< empty for none

/// Starts a stepper from a motion u(node, time) that is known: displacements at time 0, velocities of the
/// step before it. Every interface node is in the contact state given, with tractions t, p of the plane on
/// it.
struct Start {
  NodeMotion u_x_m = {}, u_y_m = {};
  statics::Contact contact = statics::Contact::open;
  double t_Pa = 0, p_Pa = 0;
  /// A body below, upside down.
  struct Below {
    const mesh::Mesh* mesh = nullptr;
    NodeMotion u_x_m, u_y_m;
  } below = {};
  motion::Loads loads = {};
};

/// @return the state from which the stepper was started
statics::Equilibrium start(motion::Stepper& stepper, const mesh::Mesh& mesh, const Start& start);

/// The whole plate with one step.
inline motion::TimeStepping plain_stepping(double step_factor = 0.9) {
  motion::TimeStepping time;
  time.step_factor = step_factor;
  time.interface_substeps = 1;
  return time;
}

/// One step, which no one observes.
void advance(motion::Stepper& stepper);
/// Turns the motion round, see motion::Stepper.
void reverse(motion::Stepper& stepper);

/// A plate that repeats along x, of right angles: waves along y stay plane.
mesh::Mesh layer(double width_m, double height_m, double element_size_m, mesh::Top top = mesh::Top::loaded);

}  // namespace slipfront::verification
