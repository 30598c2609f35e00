// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/ramp_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace slipfront::motion {

namespace {

constexpr std::int64_t renewal_interval = 1000;

/// Of a ramp that is expected to end at a shear: twice as many as to that.
std::int64_t max_steps(const Stepper& stepper, double shear_m, double top_speed_m_per_s, double c_L_m_per_s) {
  const double steps = 2 * shear_m / (top_speed_m_per_s * stepper.step_s());
  if (!(steps <= 2e12))
    throw UserError("the ramp with {} = {:g} takes {:g} steps; choose a higher speed, or {} = direct",
                    Key("loading.shear_speed_over_c_L"), top_speed_m_per_s / c_L_m_per_s, 0.5 * steps,
                    Key("loading.method"));
  return static_cast<std::int64_t>(steps);
}

}  // namespace

RampStates::RampStates(const Stepper& stepper, const statics::Equilibrium& tilted,
                       const statics::Loading& loading, const PerNode& mu_s, double top_speed_m_per_s,
                       double c_L_m_per_s, double expected_shear_m)
    : stepper_(stepper),
      tilted_(tilted),
      loading_(loading),
      mu_s_(mu_s),
      top_speed_m_per_s_(top_speed_m_per_s),
      expected_shear_m_(expected_shear_m),
      max_steps_(max_steps(stepper, expected_shear_m, top_speed_m_per_s, c_L_m_per_s)),
      from_m_(tilted.inside_from_m),
      to_m_(tilted.inside_to_m) {}

bool RampStates::after_step(const Now& /*now*/, const SlipRates& /*rates*/) {
  reaches_common_ = reaches(1 - loading_.critical_margin);
  reaches_handover_ = reaches_common_ && reaches(1 - ramp_handover);
  return !(has_common_ ? reaches_handover_ : reaches_common_);
}

std::int64_t RampStates::steps_to_pause(const Now& now) const {
  return std::min(renewal_interval - now.step % renewal_interval, max_steps_ + 1 - now.step);
}

void RampStates::at_pause(Pause& pause) {
  if (!has_common_ && reaches_common_) {
    found_.common = state_now();
    has_common_ = true;
  }
  if (reaches_handover_) {
    found_.spontaneous = state_now();
  } else if (const auto step = pause.now().step; step > 0 && step % renewal_interval == 0) {
    const statics::Equilibrium e = state_now();
    from_m_ = e.inside_from_m;
    to_m_ = e.inside_to_m;
  }
}

std::optional<End> RampStates::end(Pause& pause) {
  if (reaches_handover_) return End{EventEnd::observer};
  if (pause.now().step > max_steps_)
    throw UserError(
        "the ramp does not bring t/p inside the interface to mu_s within a shear of {:.4g} m, twice the "
        "one found directly; choose another {}, or {} = direct",
        2 * expected_shear_m_, Key("loading.shear_speed_over_c_L"), Key("loading.method"));
  return {};
}

void RampStates::restored(Pause& pause) {
  require_possible(pause.now().step >= 0 && pause.now().step <= max_steps_ + 1, "steps");
  require_possible(std::isfinite(from_m_) && std::isfinite(to_m_), "times of motion");
  const auto& common = found_.common;
  require_possible(!has_common_ || (statics::is_possible(common, tilted_.tractions.x_m, tilted_.u_m.size(),
                                                         tilted_.below_u_m.size()) &&
                                    common.u_m.size() == tilted_.u_m.size()),
                   "an equilibrium");
  require_possible(stepper_.has_loads({}), "loads");
}

/// The motion where t/p inside passes a given ratio, in the form of an equilibrium under way.
statics::Equilibrium RampStates::state_now() const {
  statics::Equilibrium e = tilted_;
  const auto& s = stepper_.interface_state();
  const auto take = [&](const Body& body, solid::Field& u_m, solid::Field& u_per_shear) {
    u_m = body.u_m();
    for (std::size_t n = 0; n < u_per_shear.size(); ++n) {
      u_per_shear.x[n] = body.v_m_per_s().x[n] / top_speed_m_per_s_;
      u_per_shear.y[n] = body.v_m_per_s().y[n] / top_speed_m_per_s_;
    }
  };
  take(stepper_.bodies().front(), e.u_m, e.u_per_shear);
  if (stepper_.bodies().size() > 1) take(stepper_.bodies().back(), e.below_u_m, e.below_u_per_shear);
  e.shear_m = top_speed_m_per_s_ * stepper_.time_s();
  e.tractions.t_s_Pa = s.t_Pa;
  e.tractions.p_s_Pa = s.p_Pa;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t k = 0; k < s.size(); ++k) {
    e.contact[k] = s.p_Pa[k] > 0 ? (s.slipping[k] != 0 ? statics::Contact::slip : statics::Contact::stick)
                                 : statics::Contact::open;
    if (e.contact[k] == statics::Contact::open) continue;
    first = std::min(first, e.tractions.x_m[k]);
    last = std::max(last, e.tractions.x_m[k]);
  }
  e.inside_from_m = first + loading_.edge_margin_m;
  e.inside_to_m = last - loading_.edge_margin_m;
  e.peak_ratio = 0;
  double mu_s_at_peak = mu_s_[0];
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double x = e.tractions.x_m[k];
    if (!e.is_inside(x) || s.p_Pa[k] <= 0) continue;
    const double ratio = s.t_Pa[k] / s.p_Pa[k];
    if (!statics::is_nearer_to_slip(ratio, mu_s_[k], e.peak_ratio, mu_s_at_peak)) continue;
    e.peak_ratio = ratio;
    e.peak_x_m = x;
    mu_s_at_peak = mu_s_[k];
  }
  return e;
}

bool RampStates::reaches(double share) const {
  const auto& s = stepper_.interface_state();
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double x = tilted_.tractions.x_m[k];
    if (x < from_m_ || x > to_m_ || s.p_Pa[k] <= 0) continue;
    // A node that began to slip within the step has weakened since.
    if (s.slipping[k] != 0 || s.t_Pa[k] / s.p_Pa[k] >= mu_s_[k] * share) return true;
  }
  return false;
}

}  // namespace slipfront::motion
