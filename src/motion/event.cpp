// SPDX-License-Identifier: BSD-3-Clause
#include "motion/event.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.hpp"
#include "base/interruption.hpp"
#include "base/state.hpp"
#include "motion/blow_up_monitor.hpp"

namespace slipfront::motion {

namespace {

constexpr std::int64_t monitor_interval = 50;

/// More rows of energies than that, 9 GB of them, are no more than asked for.
constexpr double max_rows_in_advance = 1e8;

/// Empties a history but for its places; the memory stays for the next rows.
void clear_rows(record::History& history) {
  history.time_s.clear();
  for (const auto& field : record::history_fields) (history.*field.member).clear();
}

/// Steps, at least one, until the stepper's time is at least time_s; a far time is beyond any run.
std::int64_t steps_until(const TimeStepper& stepper, double time_s) {
  constexpr double far_steps = 1e13;
  if (!(time_s < far_steps * stepper.step_s())) return static_cast<std::int64_t>(far_steps);
  auto step = static_cast<std::int64_t>(time_s / stepper.step_s()) - 1;
  while (static_cast<double>(step) * stepper.step_s() < time_s) ++step;
  return std::max<std::int64_t>(step - stepper.step(), 1);
}

/// The number of the next row, at least the one after n, of rows at multiples of an interval.
std::int64_t next_row(std::int64_t n, double time_s, double interval_s) {
  return std::max(n, static_cast<std::int64_t>(time_s / interval_s)) + 1;
}

/// Of a stepper about to begin: the velocity has been the present one.
ProbeRecorder probe_recorder(const TimeStepper& stepper, double interval_s) {
  const auto now_m = stepper.probed_u_m();
  auto before_m = now_m;
  const auto v_m_per_s = stepper.probed_v_m_per_s();
  for (std::size_t k = 0; k < before_m.size(); ++k) before_m[k] -= stepper.step_s() * v_m_per_s[k];
  return {stepper.probes(), stepper.step_s(), interval_s, before_m, now_m};
}

/// When a trigger's loads last change: the end of its ramp, or its removal.
double last_change_s(const interface::Trigger& trigger) {
  const double ramp_s = std::isfinite(trigger.ramp_s) ? trigger.ramp_s : 0;
  return std::isfinite(trigger.duration_s) ? std::max(ramp_s, trigger.duration_s) : ramp_s;
}

}  // namespace

std::vector<std::size_t> trigger_zone(const statics::Equilibrium& state, interface::EventKind kind,
                                      double zone_m) {
  const auto& x_m = state.tractions.x_m;
  std::vector<std::size_t> zone;
  if (kind != interface::EventKind::left && kind != interface::EventKind::right) return zone;
  const auto in_contact = [&](std::size_t k) { return state.contact[k] != statics::Contact::open; };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    if (!in_contact(k)) continue;
    first = std::min(first, x_m[k]);
    last = std::max(last, x_m[k]);
  }
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const double from_edge = kind == interface::EventKind::left ? x_m[k] - first : last - x_m[k];
    if (in_contact(k) && from_edge <= zone_m * (1 + 1e-9)) zone.push_back(k);
  }
  return zone;
}

double load_direction(const statics::Equilibrium& state, std::span<const double> tributary_m,
                      std::span<const std::size_t> zone) {
  double force = 0;
  for (const auto k : zone) force += state.tractions.t_s_Pa[k] * tributary_m[k];
  return force < 0 ? -1 : 1;
}

namespace {

/// What `added` and `raised` add to a traction.
double trigger_traction_Pa(const interface::Trigger& trigger, double t_s_Pa, double strength_Pa) {
  // A node that slips before the event is at its strength but for this share of its traction.
  constexpr double rounding = 1e-9;
  const double added_Pa = trigger.form == interface::TriggerForm::added
                              ? trigger.amount * (strength_Pa - t_s_Pa)
                              : trigger.amount * strength_Pa - t_s_Pa;
  return added_Pa < -rounding * t_s_Pa ? 0 : added_Pa;
}

}  // namespace

std::vector<double> trigger_forces(const statics::Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger,
                                   const PerNode& mu_s) {
  const auto& s = state.tractions;
  std::vector<double> force(s.x_m.size(), 0.0);
  if (trigger.form == interface::TriggerForm::weakened) return force;
  const auto zone = trigger_zone(state, kind, trigger.zone_m);
  const double direction = load_direction(state, tributary_m, zone);
  for (const auto k : zone)
    force[k] = direction * trigger_traction_Pa(trigger, direction * s.t_s_Pa[k], mu_s[k] * s.p_s_Pa[k]) *
               tributary_m[k];
  return force;
}

int halo_for(const mesh::Mesh& mesh, double l_star_m) {
  return static_cast<int>(std::ceil(l_star_m / mesh.grid.spacing_m - 0.01)) + 1;
}

EventRun::EventRun(TimeStepper& stepper, const statics::Equilibrium& state, const PerNode& mu_s,
                   const Waves& waves, const interface::Trigger& trigger, const TimeStepping& time,
                   const Sampling& sampling, int halo)
    : stepper_(stepper),
      waves_(waves),
      time_(time),
      snapshot_times_s_(sampling.snapshot_times_s),
      sample_interval_s_(std::max(sampling.history_interval_s, stepper.step_s())),
      energy_interval_s_(std::max(sampling.energy_interval_s, stepper.step_s())),
      recorder_(state, mu_s, halo, rest_slip_fraction * slip_rate_scale_m_per_s(state, mu_s, waves)),
      rest_criterion_(stepper, slip_rate_scale_m_per_s(state, mu_s, waves), last_change_s(trigger)),
      blow_up_monitor_(std::in_place, stepper, waves.c_L_m_per_s) {
  const double all_steps = std::ceil(time.end_s / stepper.step_s() * (1 - 1e-12));
  if (all_steps > 1e12)
    throw UserError("{} = {:g} takes {:g} steps of {:.4g} s; choose an earlier end", Key("time.end_s"),
                    time.end_s, all_steps, stepper.step_s());
  n_steps_ = static_cast<std::int64_t>(all_steps);
  event_.quiet_slip_rate_m_per_s = rest_slip_fraction * slip_rate_scale_m_per_s(state, mu_s, waves);
  event_.history.x_m = state.tractions.x_m;
  if (!stepper.probes().empty()) probes_.emplace(probe_recorder(stepper, sampling.probe_interval_s));
  // All that may come at once: while it grew, the rows would be there twice.
  event_.energies.reserve(
      static_cast<std::size_t>(std::min(time.end_s / energy_interval_s_ + 3, max_rows_in_advance)));
  event_.energies.push_back(blow_up_monitor_->start());
}

void EventRun::require_possible() {
  const auto step = stepper_.step(), checked_step = blow_up_monitor_->checked_step();
  slipfront::require_possible(step >= 0 && step <= n_steps_ && checked_step >= 0 && checked_step <= step,
                              "steps");
  const double now_s = stepper_.time_s();
  slipfront::require_possible(recorder_.is_possible_at(now_s) && rest_criterion_.is_possible_at(now_s),
                              "times of motion");
  // Of rows at multiples of an interval the next one is due within a step or later, not the one before it.
  const auto is_next = [&](double before_s, double next_s) {
    return before_s < now_s + 2 * stepper_.step_s() && next_s > now_s - 2 * stepper_.step_s();
  };
  const auto is_next_row = [&](std::int64_t n, double interval_s) {
    return n >= 0 && is_next(static_cast<double>(n - 1) * interval_s, static_cast<double>(n) * interval_s);
  };
  slipfront::require_possible(is_next_row(n_samples_, sample_interval_s_) &&
                                  is_next_row(n_energies_, energy_interval_s_) &&
                                  next_snapshot_ <= snapshot_times_s_.size(),
                              "counts of rows");
  constexpr double never_s = std::numeric_limits<double>::infinity();
  const auto& times_s = snapshot_times_s_;
  slipfront::require_possible(is_next(next_snapshot_ > 0 ? times_s[next_snapshot_ - 1] : 0,
                                      next_snapshot_ < times_s.size() ? times_s[next_snapshot_] : never_s),
                              "snapshots");
  const auto& rows = event_.energies;
  const auto are_ascending = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
  slipfront::require_possible(!rows.empty() && rows.front() == blow_up_monitor_->start() &&
                                  rows.back().time_s <= now_s &&
                                  std::ranges::adjacent_find(rows, std::not_fn(are_ascending)) == rows.end(),
                              "energies");
  slipfront::require_possible(blow_up_monitor_->is_possible(time_.precision), "a motion");
}

void EventRun::take_snapshots(EventObserver* observer) {
  while (next_snapshot_ < snapshot_times_s_.size() &&
         stepper_.time_s() >= snapshot_times_s_[next_snapshot_]) {
    if (observer != nullptr)
      observer->snapshot(stepper_);
    else
      event_.snapshots.push_back(stepper_.snapshot());
    ++next_snapshot_;
  }
}

void EventRun::take_probe_rows(EventObserver* observer) {
  if (!probes_) return;
  if (observer == nullptr) return probes_->take_rows(stepper_.step(), event_.probes);
  record::ProbeRecord rows;
  probes_->take_rows(stepper_.step(), rows);
  if (!rows.time_s.empty()) observer->probe(rows);
}

double EventRun::moved_s() const {
  return std::max({rest_criterion_.since_s(), recorder_.last_motion_s(), recorder_.last_onset_s()});
}

bool EventRun::is_at_rest() const {
  return stepper_.time_s() - moved_s() > time_.quiet_s;
}

bool EventRun::is_at_rest_everywhere() {
  if (blow_up_monitor_->checked_step() == stepper_.step() && blow_up_monitor_->last())
    rest_criterion_.see_kinetic_energy(stepper_.time_s(), blow_up_monitor_->last()->kinetic);
  else if (is_at_rest())
    rest_criterion_.see_kinetic_energy(stepper_.time_s(), stepper_.kinetic_energy_J_per_m());
  return is_at_rest();
}

double EventRun::energy_time_s() const {
  return static_cast<double>(n_energies_) * energy_interval_s_;
}

StepCallbacks EventRun::callbacks(EventObserver* observer, record::History& row) {
  StepCallbacks callbacks;
  callbacks.sample = [this, observer, &row]() -> record::History* {
    if (stepper_.time_s() < static_cast<double>(n_samples_) * sample_interval_s_) return nullptr;
    n_samples_ = next_row(n_samples_, stepper_.time_s(), sample_interval_s_);
    return observer != nullptr ? &row : &event_.history;
  };
  if (probes_) callbacks.displacements = [this](std::int64_t step) { return probes_->room_for(step); };
  callbacks.may_continue = [this, observer, &row](const SlipRates& rates) {
    if (!row.time_s.empty()) {
      observer->sample(row);
      clear_rows(row);
    }
    const bool physical = blow_up_monitor_->check(rates);
    rest_criterion_.see_slip_rate(stepper_.time_s(), blow_up_monitor_->fastest_slip_m_per_s());
    return physical && !is_at_rest();
  };
  callbacks.interrupted = is_interruption_wanted;
  // A step less, since the sum may be rounded up.
  callbacks.guaranteed_steps = [this] {
    return std::max<std::int64_t>(steps_until(stepper_, moved_s() + time_.quiet_s) - 1, 1);
  };
  return callbacks;
}

std::int64_t EventRun::steps_to_next_check() const {
  const std::int64_t steps =
      std::min({n_steps_ - stepper_.step(), monitor_interval - stepper_.step() % monitor_interval,
                blow_up_monitor_->steps_to_check(), steps_until(stepper_, energy_time_s())});
  if (next_snapshot_ == snapshot_times_s_.size()) return steps;
  return std::min(steps, steps_until(stepper_, snapshot_times_s_[next_snapshot_]));
}

bool EventRun::check_motion() {
  const bool energies = stepper_.time_s() >= energy_time_s();
  if (energies) {
    n_energies_ = next_row(n_energies_, stepper_.time_s(), energy_interval_s_);
    event_.energies.push_back(stepper_.energies());
  }
  if (auto failure = blow_up_monitor_->failure(energies ? &event_.energies.back() : nullptr);
      !failure.empty()) {
    event_.end = EventEnd::blow_up;
    event_.blow_up = blow_up_message(stepper_, failure);
    return false;
  }
  if (!is_at_rest_everywhere()) return true;
  event_.end = EventEnd::quiet;
  return false;
}

Event EventRun::run(const Monitor& monitor, EventObserver* observer) {
  record::History row;
  const auto samples = callbacks(observer, row);
  while (stepper_.step() < n_steps_) {
    take_snapshots(observer);
    const auto max_steps = steps_to_next_check();
    if (probes_) probes_->expect(stepper_.step(), max_steps);
    stepper_.advance(recorder_, max_steps, samples);
    take_probe_rows(observer);
    if (!check_motion()) break;
    const bool is_asked = stepper_.step() % monitor_interval == 0 || is_interruption_wanted();
    if (is_asked && !monitor(stepper_.step(), n_steps_)) {
      event_.end = EventEnd::interrupted;
      break;
    }
  }
  take_snapshots(observer);
  event_.steps = stepper_.step();
  event_.time_s = stepper_.time_s();
  if (event_.energies.back().time_s < event_.time_s) event_.energies.push_back(stepper_.energies());
  event_.record = recorder_.record_until(event_.time_s);
  return std::move(event_);
}

Event run_event(TimeStepper& stepper, const statics::Equilibrium& state, const PerNode& mu_s,
                const Waves& waves, const interface::Trigger& trigger, const TimeStepping& time,
                const Sampling& sampling, int halo, const Monitor& monitor, EventObserver* observer) {
  return EventRun(stepper, state, mu_s, waves, trigger, time, sampling, halo).run(monitor, observer);
}

namespace {

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

RampRun::RampRun(Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
                 const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m)
    : stepper_(stepper),
      tilted_(tilted),
      loading_(loading),
      mu_s_(mu_s),
      top_speed_m_per_s_(top_speed_m_per_s),
      c_L_m_per_s_(c_L_m_per_s),
      expected_shear_m_(expected_shear_m),
      max_steps_(max_steps(stepper, expected_shear_m, top_speed_m_per_s, c_L_m_per_s)),
      recorder_(tilted, mu_s, 0),
      blow_up_monitor_(std::in_place, stepper, c_L_m_per_s),
      from_m_(tilted.inside_from_m),
      to_m_(tilted.inside_to_m) {}

void RampRun::require_possible() {
  const auto step = stepper_.step(), checked_step = blow_up_monitor_->checked_step();
  slipfront::require_possible(
      step >= 0 && step <= max_steps_ + 1 && checked_step >= 0 && checked_step <= step, "steps");
  slipfront::require_possible(
      recorder_.is_possible_at(stepper_.time_s()) && std::isfinite(from_m_) && std::isfinite(to_m_),
      "times of motion");
  const auto& common = ramp_.common;
  slipfront::require_possible(
      !has_common_ || (statics::is_possible(common, tilted_.tractions.x_m, tilted_.u_m.size(),
                                            tilted_.below_u_m.size()) &&
                       common.u_m.size() == tilted_.u_m.size()),
      "an equilibrium");
  const bool is_single =
      std::ranges::any_of(stepper_.bodies(), [](const Body& body) { return body.has_single_precision(); });
  slipfront::require_possible(
      blow_up_monitor_->is_possible(is_single ? Precision::single_precision : Precision::double_precision),
      "a motion");
}

/// The motion where t/p inside passes a given ratio, in the form of an equilibrium under way.
statics::Equilibrium RampRun::state_now() const {
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

std::uint64_t Ramp::n_onsets_inside() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(record.onsets, [&](const record::Onset& onset) {
    return spontaneous.is_inside(record.x_m[onset.node]);
  }));
}

bool RampRun::reaches(double share) const {
  const auto& s = stepper_.interface_state();
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double x = tilted_.tractions.x_m[k];
    if (x < from_m_ || x > to_m_ || s.p_Pa[k] <= 0) continue;
    // A node that began to slip within the step has weakened since.
    if (s.slipping[k] != 0 || s.t_Pa[k] / s.p_Pa[k] >= mu_s_[k] * share) return true;
  }
  return false;
}

Ramp RampRun::run(const Monitor& monitor) {
  constexpr std::int64_t renewal_interval = 1000;
  bool reaches_common = false, reaches_handover = false;
  StepCallbacks callbacks;
  callbacks.may_continue = [&](const SlipRates& rates) {
    reaches_common = reaches(1 - loading_.critical_margin);
    reaches_handover = reaches_common && reaches(1 - ramp_handover);
    return blow_up_monitor_->check(rates) && !(has_common_ ? reaches_handover : reaches_common);
  };
  callbacks.interrupted = is_interruption_wanted;
  for (;;) {
    if (stepper_.step() > max_steps_)
      throw UserError(
          "the ramp does not bring t/p inside the interface to mu_s within a shear of {:.4g} m, twice the "
          "one found directly; choose another {}, or {} = direct",
          2 * expected_shear_m_, Key("loading.shear_speed_over_c_L"), Key("loading.method"));
    stepper_.advance(recorder_,
                     std::min({renewal_interval - stepper_.step() % renewal_interval,
                               blow_up_monitor_->steps_to_check(), max_steps_ + 1 - stepper_.step()}),
                     callbacks);
    if (auto failure = blow_up_monitor_->failure(nullptr); !failure.empty())
      throw BlowUp(blow_up_message(stepper_, failure));
    if (!has_common_ && reaches_common) {
      ramp_.common = state_now();
      has_common_ = true;
    }
    if (reaches_handover) {
      ramp_.spontaneous = state_now();
      break;
    }
    const bool is_renewed = stepper_.step() % renewal_interval == 0;
    if (is_renewed) {
      const statics::Equilibrium e = state_now();
      from_m_ = e.inside_from_m;
      to_m_ = e.inside_to_m;
    }
    if ((is_renewed || is_interruption_wanted()) && !monitor(stepper_.step(), expected_steps())) {
      ramp_.interrupted = true;
      break;
    }
  }
  ramp_.steps = stepper_.step();
  ramp_.record = recorder_.record_until(stepper_.time_s());
  return std::move(ramp_);
}

Ramp run_ramp(Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
              const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m,
              const Monitor& monitor) {
  stepper.start(tilted, top_speed_m_per_s);
  return RampRun(stepper, tilted, loading, mu_s, top_speed_m_per_s, c_L_m_per_s, expected_shear_m)
      .run(monitor);
}

}  // namespace slipfront::motion
