// SPDX-License-Identifier: BSD-3-Clause
#include "motion/event.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "motion/observers/blow_up_monitor.hpp"
#include "motion/observers/end_time.hpp"

namespace slipfront::motion {

namespace {

constexpr std::int64_t monitor_interval = 50;

std::int64_t steps_of(const TimeStepping& time, double step_s) {
  const double all_steps = steps_to(time.end_s, step_s);
  if (all_steps > 1e12)
    throw UserError("{} = {:g} takes {:g} steps of {:.4g} s; choose an earlier end", Key("time.end_s"),
                    time.end_s, all_steps, step_s);
  return static_cast<std::int64_t>(all_steps);
}

}  // namespace

EventRun::EventRun(TimeStepper& stepper, const EventSetup& setup, const Monitor& monitor, Observers more)
    : stepper_(stepper),
      quiet_slip_rate_m_per_s_(rest_slip_fraction *
                               slip_rate_scale_m_per_s(setup.state, setup.mu_s, setup.waves)),
      run_(stepper, {setup.state, setup.mu_s, setup.halo, quiet_slip_rate_m_per_s_},
           setup.state.tractions.x_m, observers(setup, monitor, std::move(more))) {}

Observers EventRun::observers(const EventSetup& setup, const Monitor& monitor, Observers more) {
  const auto& [state, mu_s, waves, loads_settle_s, time, tip_slip_interval_s, energy_interval_s, halo,
               stop_window, slow_m_per_s] = setup;
  const double step_s = stepper_.step_s();
  const auto n_steps = steps_of(time, step_s);
  const auto start = stepper_.energies();
  Observers list;
  list.push_back(std::make_unique<Onsets>(state.tractions.x_m, halo));
  list.push_back(std::make_unique<TipSlips>(state, tip_slip_interval_s));
  list.push_back(std::make_unique<EnergyRows>(start, energy_interval_s, step_s, time.end_s));
  list.push_back(std::make_unique<BlowUpMonitor>(stepper_, waves.c_L_m_per_s, time.precision, start));
  if (stop_window)
    list.push_back(std::make_unique<StickCriterion>(
        state, *stop_window, time.quiet_s, stuck_slip_fraction * slip_rate_scale_m_per_s(state, mu_s, waves),
        slow_m_per_s));
  else
    list.push_back(std::make_unique<RestCriterion>(stepper_, slip_rate_scale_m_per_s(state, mu_s, waves),
                                                   loads_settle_s, time.quiet_s));
  for (auto& observer : more) list.push_back(std::move(observer));
  list.push_back(std::make_unique<Progress>(stepper_, monitor_interval, n_steps, monitor));
  list.push_back(std::make_unique<EndTime>(n_steps));
  return list;
}

void EventRun::require_restored() {
  run_.require_restored();
  const auto& monitor = run_.get<BlowUpMonitor>();
  require_possible(std::ranges::all_of(energies(), [&](const auto& row) { return monitor.balances(row); }),
                   "energies");
}

Event EventRun::run() {
  const End end = run_.run();
  Event event;
  event.end = end.why;
  event.reason = end.reason;
  event.steps = stepper_.step();
  event.time_s = stepper_.time_s();
  event.quiet_slip_rate_m_per_s = quiet_slip_rate_m_per_s_;
  event.record = record();
  event.breakdown = stepper_.breakdown();
  event.tip_slip = tip_slip();
  event.interface_at_end = stepper_.interface_row();
  event.energies = run_.get<EnergyRows>().take_rows();
  return event;
}

}  // namespace slipfront::motion
