// SPDX-License-Identifier: BSD-3-Clause
#include "motion/ramp.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "motion/observers/blow_up_monitor.hpp"
#include "motion/observers/onsets.hpp"

namespace slipfront::motion {

namespace {

constexpr std::int64_t renewal_interval = 1000;  // of the monitor as well

/// Twice as many as are expected.
std::int64_t max_steps(const Stepper& stepper, const RampSetup& setup) {
  const double steps = 2 * setup.expected_shear_m / (setup.top_speed_m_per_s * stepper.step_s());
  if (!(steps <= 2e12))
    throw UserError("the ramp with {} = {:g} m/s takes {:g} steps; choose a higher speed, or {} = direct",
                    Key("loading.shear_speed_m_per_s"), setup.top_speed_m_per_s, 0.5 * steps,
                    Key("loading.method"));
  return static_cast<std::int64_t>(steps);
}

}  // namespace

/// Finds the states of a ramp in which t/p inside reaches (1 - critical_margin) mu_s and mu_s, where it ends.
class RampStates final : public Observer {
 public:
  RampStates(const Stepper& stepper, const RampSetup& setup)
      : stepper_(stepper),
        setup_(setup),
        max_steps_(max_steps(stepper, setup)),
        from_m_(setup.tilted.inside_from_m),
        to_m_(setup.tilted.inside_to_m) {}

  std::int64_t expected_steps() const { return max_steps_ / 2; }
  statics::Equilibrium subcritical, supercritical;  ///< empty before

  bool after_step(const Now& /*now*/, const SlipRates& /*rates*/) override {
    reaches_common_ = reaches(1 - setup_.loading.critical_margin);
    reaches_handover_ = reaches_common_ && reaches(1 - ramp_handover);
    return !(has_subcritical_ ? reaches_handover_ : reaches_common_);
  }
  std::int64_t steps_to_pause(const Now& now) const override {
    return std::min(renewal_interval - now.step % renewal_interval, max_steps_ + 1 - now.step);
  }
  void at_pause(Pause& pause) override {
    if (!has_subcritical_ && reaches_common_) {
      subcritical = state_now();
      has_subcritical_ = true;
    }
    if (reaches_handover_) {
      supercritical = state_now();
    } else if (const auto step = pause.now().step; step > 0 && step % renewal_interval == 0) {
      const statics::Equilibrium e = state_now();
      from_m_ = e.inside_from_m;
      to_m_ = e.inside_to_m;
    }
  }
  std::optional<End> end(Pause& pause) override {
    if (reaches_handover_) return End{EventEnd::observer};
    if (pause.now().step > max_steps_)
      throw UserError(
          "the ramp does not bring t/p inside the interface to mu_s within a shear of {:.4g} m, twice the "
          "one found directly; choose another {}, or {} = direct",
          2 * setup_.expected_shear_m, Key("loading.shear_speed_m_per_s"), Key("loading.method"));
    return {};
  }

  const char* name() const override { return "ramp"; }
  void archive(StateArchive& archive) override { archive(subcritical, has_subcritical_, from_m_, to_m_); }
  void restored(Pause& pause) override {
    const auto& tilted = setup_.tilted;
    require_possible(pause.now().step >= 0 && pause.now().step <= max_steps_ + 1, "steps");
    require_possible(std::isfinite(from_m_) && std::isfinite(to_m_), "times of motion");
    require_possible(!has_subcritical_ || (statics::is_possible(subcritical, tilted.tractions.x_m,
                                                                tilted.u_m.size(), tilted.below_u_m.size()) &&
                                           subcritical.u_m.size() == tilted.u_m.size()),
                     "an equilibrium");
  }

 private:
  /// The motion where t/p inside passes a given ratio, in the form of an equilibrium under way.
  statics::Equilibrium state_now() const {
    statics::Equilibrium e = setup_.tilted;
    const auto& s = stepper_.interface_state();
    const auto take = [&](const Body& body, solid::Field& u_m, solid::Field& u_per_shear) {
      u_m = body.u_m();
      for (std::size_t n = 0; n < u_per_shear.size(); ++n) {
        u_per_shear.x[n] = body.v_m_per_s().x[n] / setup_.top_speed_m_per_s;
        u_per_shear.y[n] = body.v_m_per_s().y[n] / setup_.top_speed_m_per_s;
      }
    };
    take(stepper_.bodies().front(), e.u_m, e.u_per_shear);
    if (stepper_.bodies().size() > 1) take(stepper_.bodies().back(), e.below_u_m, e.below_u_per_shear);
    e.shear_m = setup_.top_speed_m_per_s * stepper_.time_s();
    e.tractions.t_s_Pa = s.t_Pa;
    e.tractions.p_s_Pa = s.p_Pa;
    double first = infinity, last = -first;
    for (std::size_t k = 0; k < s.size(); ++k) {
      e.contact[k] = s.p_Pa[k] > 0 ? (s.slipping[k] != 0 ? statics::Contact::slip : statics::Contact::stick)
                                   : statics::Contact::open;
      if (e.contact[k] == statics::Contact::open) continue;
      first = std::min(first, e.tractions.x_m[k]);
      last = std::max(last, e.tractions.x_m[k]);
    }
    e.inside_from_m = first + setup_.loading.edge_margin_m;
    e.inside_to_m = last - setup_.loading.edge_margin_m;
    e.peak_ratio = 0;
    double mu_s_at_peak = setup_.mu_s[0];
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double x = e.tractions.x_m[k];
      if (!e.is_inside(x) || s.p_Pa[k] <= 0) continue;
      const double ratio = s.t_Pa[k] / s.p_Pa[k];
      if (!statics::is_nearer_to_slip(ratio, setup_.mu_s[k], e.peak_ratio, mu_s_at_peak)) continue;
      e.peak_ratio = ratio;
      e.peak_x_m = x;
      mu_s_at_peak = setup_.mu_s[k];
    }
    return e;
  }
  /// Whether t/p is so large a share of mu_s anywhere inside, or a node there slips.
  bool reaches(double share) const {
    const auto& s = stepper_.interface_state();
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double x = setup_.tilted.tractions.x_m[k];
      if (x < from_m_ || x > to_m_ || s.p_Pa[k] <= 0) continue;
      // A node that began to slip within the step has weakened since.
      if (s.slipping[k] != 0 || s.t_Pa[k] / s.p_Pa[k] >= setup_.mu_s[k] * share) return true;
    }
    return false;
  }

  const Stepper& stepper_;
  const RampSetup setup_;
  std::int64_t max_steps_;
  bool has_subcritical_ = false, reaches_common_ = false, reaches_handover_ = false;
  /// The contact's extent changes slowly; the peak is looked for between bounds that are renewed at times.
  double from_m_, to_m_;
};

static Observers ramp_observers(Stepper& stepper, const RampSetup& setup, const Monitor& monitor) {
  const bool is_single =
      std::ranges::any_of(stepper.bodies(), [](const Body& body) { return body.has_single_precision(); });
  auto states = std::make_unique<RampStates>(stepper, setup);
  const auto expected_steps = states->expected_steps();
  Observers list;
  list.push_back(std::make_unique<Onsets>(setup.tilted.tractions.x_m, 0));
  list.push_back(std::make_unique<BlowUpMonitor>(
      stepper, setup.c_L_m_per_s, is_single ? Precision::single_precision : Precision::double_precision,
      stepper.energies()));
  list.push_back(std::move(states));
  list.push_back(std::make_unique<Progress>(stepper, renewal_interval, expected_steps, monitor));
  return list;
}

RampRun::RampRun(Stepper& stepper, const RampSetup& setup, const Monitor& monitor)
    : stepper_(stepper),
      run_(stepper, {setup.tilted, setup.mu_s, 0, 0}, setup.tilted.tractions.x_m,
           ramp_observers(stepper, setup, monitor)) {}

std::uint64_t Ramp::n_onsets_inside() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(record.onsets, [&](const record::Onset& onset) {
    return supercritical.is_inside(record.x_m[onset.node]);
  }));
}

Ramp RampRun::run() {
  const End end = run_.run();
  if (end.why == EventEnd::blow_up) throw BlowUp(end.reason);
  auto& states = run_.get<RampStates>();
  return {std::move(states.subcritical), std::move(states.supercritical),
          run_.get<Onsets>().record_until(stepper_.time_s()), stepper_.step(),
          end.why == EventEnd::interrupted};
}

}  // namespace slipfront::motion
