// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "solid/kernels.hpp"

namespace slipfront::motion {

/// Products with the stiffness K of some cells at one push, w = u + beta_R v: of the place u and the velocity
/// v before it, of the velocity after it as far as the push knows it, and of the velocity after the push
/// before, where that one did not.
struct PushProducts {
  double u_K_w = 0, v_K_w = 0, after_K_w = 0;
  double late_K_w = 0;
  solid::KickSums kicks;  ///< over nodes amid four squares, all of one mass
  /// Of the shift s of landing nodes since the push before: s K v, and s K (u' + u' - s) with u' the place
  /// after it.
  double shift_K_v = 0, shift_K_u = 0;
};

/// The stiffness damping's work on cells that are pushed with one step. It is known at the next push, from
/// products that the pushes form anyway.
class DampingWork {
 public:
  DampingWork() = default;
  DampingWork(double step_s, double damping_s, double interior_mass_kg)
      : step_s_(step_s), damping_s_(damping_s), interior_mass_kg_(interior_mass_kg) {}

  /// @param u_K_u  of the place one step before the start
  void begin(double u_K_u) {
    last_ = {};
    last_.u_K_u = u_K_u;
    begun_ = false;
  }

  /// @return the work at the push before, 0 at the first one
  double add(const PushProducts& push);

  /// The work at the last push.
  /// @param since_last  late product and landings since then
  /// @param u_K_u, v_K_u  of the present place and velocity
  double of_last_push(const PushProducts& since_last, double u_K_u, double v_K_u) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begun_, last_.u_K_u, last_.v_K_v, last_.after_K_w);
  }

 private:
  /// @param after_K_u  the velocity after the last push times K u at it
  double work(double after_K_w, double after_K_u) const;

  /// What the next push needs of the last one's.
  struct Last {
    double u_K_u = 0, v_K_v = 0, after_K_w = 0;
  };
  double step_s_ = 0, damping_s_ = 0, interior_mass_kg_ = 0;
  bool begun_ = false;  ///< whether there is a last push
  Last last_;
};

}  // namespace slipfront::motion
