// SPDX-License-Identifier: BSD-3-Clause
#include "motion/damping_work.hpp"

namespace slipfront::motion {

double DampingWork::add(const ImpulseProducts& impulse) {
  const double dt = step_s_, beta = damping_s_, m_over_dt = interior_mass_kg_ / dt;
  const auto& kicks = impulse.kicks;
  // In the head's notation `impulse` is the next impulse: its u, v and w are u', v' and w'. A landing has
  // shifted u' since the last impulse; u_K_w is u' K w' without that shift.
  const double u_K_w_now = impulse.u_K_w - m_over_dt * (kicks.w_d - beta * kicks.v_d);
  const double v_K_w = impulse.v_K_w - m_over_dt * kicks.v_d - impulse.shift_K_v;
  const double u_K_w = u_K_w_now - impulse.shift_K_u - beta * impulse.shift_K_v;
  const double after_K_u = (u_K_w - last_.u_K_u - dt * v_K_w) / (dt + beta);
  const double done = begun_ ? work(last_.after_K_w + impulse.next_velocity_K_w, after_K_u) : 0;
  begun_ = true;
  last_.v_K_v = (v_K_w - after_K_u) / (dt + beta);
  last_.u_K_u = u_K_w_now - beta * (after_K_u + dt * last_.v_K_v + impulse.shift_K_v);
  last_.after_K_w = -m_over_dt * (kicks.v_d + kicks.d_d);
  return done;
}

double DampingWork::of_last_push(const ImpulseProducts& since_last, double u_K_u, double v_K_u) const {
  if (!begun_) return 0;
  // u' K u' = u K u + dt v' K (u + u'), v' the velocity after the last impulse.
  const double after_K_u =
      (u_K_u - since_last.shift_K_u - last_.u_K_u) / step_s_ - (v_K_u - since_last.shift_K_v);
  return work(last_.after_K_w + since_last.next_velocity_K_w, after_K_u);
}

double DampingWork::work(double after_K_w, double after_K_u) const {
  // dt f v' with the damping force f = -beta K v and the mean velocity; beta v' K v = v' K w - v' K u.
  return -0.5 * step_s_ * (damping_s_ * last_.v_K_v + after_K_w - after_K_u);
}

}  // namespace slipfront::motion
