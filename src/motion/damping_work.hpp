// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/state_by_node.hpp"
#include "solid/kernels.hpp"

namespace slipfront::motion {

/// Sums over nodes that an impulse forms beside the kicks, for the damping's work. An impulse kicks nodes by
/// the force -K w of some cells, w = u + beta_R v, with u and v the displacements and velocities before it;
/// v' are the velocities after it.
struct ImpulseProducts {
  double u_K_w = 0, v_K_w = 0;  ///< without the nodes of `kicks`
  /// v' K w of the impulse before at the nodes that its `kicks` leave out, some of which got their v' only
  /// after it, from the contact or from a finer level.
  double next_velocity_K_w = 0;
  /// The same products in terms of the kick d = v' - v, K w = -m d/dt, at nodes that the stencils kick and
  /// move at once; as if all had the mass m of a node amid the smallest squares.
  solid::KickSums kicks;
  /// s K v and s K (2 u - s), s the shift that has put landing nodes onto the plane since the impulse before.
  double shift_K_v = 0, shift_K_u = 0;
};

/// Work of the stiffness damping on the cells of a level, without a product with K of its own.
///
/// The damping force of an impulse is -beta_R K v, and its work over the step dt
///
///     -dt/2 (v + v') beta_R K v = -dt/2 (beta_R v K v + v' K w - v' K u).
///
/// The impulses sum v' K w. The other two follow one impulse later: with u' = u + dt v' and w' = u' + beta_R
/// v' the next impulse has
///
///     u' K w' = u K u + (2 dt + beta_R) v' K u + dt (dt + beta_R) v' K v'
///     v' K w' = v' K u + (dt + beta_R) v' K v'
///
/// where u K u is known from the impulse before. This gives v' K u, which completes the work of the last
/// impulse, and v' K v' and u' K u', with which the next one begins.
class DampingWork {
 public:
  DampingWork() = default;
  DampingWork(double step_s, double damping_s, double interior_mass_kg)
      : step_s_(step_s), damping_s_(damping_s), interior_mass_kg_(interior_mass_kg) {}

  /// @param u_K_u  of the displacements one step before the start
  void begin(double u_K_u) {
    last_ = {};
    last_.u_K_u = u_K_u;
    begun_ = false;
  }

  /// @return the work at the impulse before, 0 at the first one
  double add(const ImpulseProducts& impulse);

  /// The work at the last impulse, without waiting for the next one.
  /// @param since_last  late product and landings since then
  /// @param u_K_u, v_K_u  of the present displacements and velocities
  double of_last_push(const ImpulseProducts& since_last, double u_K_u, double v_K_u) const;

  /// Adds all that changes.
  void add_to(StateView& state) {
    state.flags.push_back(&begun_);
    state.sums.insert(state.sums.end(), {&last_.u_K_u, &last_.v_K_v, &last_.after_K_w});
  }

 private:
  /// @param after_K_w, after_K_u  v' K w and v' K u of the last impulse
  double work(double after_K_w, double after_K_u) const;

  /// Products of the last impulse: u K u and v K v before it, and v' K w as far as it was known at once.
  struct Last {
    double u_K_u = 0, v_K_v = 0, after_K_w = 0;
  };
  double step_s_ = 0, damping_s_ = 0, interior_mass_kg_ = 0;
  bool begun_ = false;  ///< whether there is a last impulse
  Last last_;
};

}  // namespace slipfront::motion
