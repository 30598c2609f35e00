// SPDX-License-Identifier: BSD-3-Clause
#include "solve/event.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "solve/watch.hpp"

namespace slipfront::solve {

namespace {

constexpr std::int64_t monitor_interval = 50;

/// Nodes at the edges creep along with the loading; slip that is no faster than this multiple of the top's
/// speed does not keep an event going.
constexpr double creep_over_top_speed = 10;

/// Empties a history but for its places; the memory stays for the next rows.
void clear_rows(fronts::History& history) {
  for (auto* column :
       {&history.time_s, &history.slip_m, &history.slip_rate_m_per_s, &history.t_Pa, &history.p_Pa})
    column->clear();
}

/// Steps, at least one, until the stepper's time is at least time_s; a far time is beyond any run.
std::int64_t steps_until(const Stepper& stepper, double time_s) {
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

}  // namespace

std::vector<double> trigger_forces(const Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger,
                                   double mu_s) {
  const auto& s = state.tractions;
  std::vector<double> force(s.x_m.size(), 0.0);
  if (kind != interface::EventKind::left && kind != interface::EventKind::right) return force;
  const auto in_contact = [&](std::size_t k) { return state.contact[k] != Contact::open; };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (!in_contact(k)) continue;
    first = std::min(first, s.x_m[k]);
    last = std::max(last, s.x_m[k]);
  }
  for (std::size_t k = 0; k < force.size(); ++k) {
    const double from_edge = kind == interface::EventKind::left ? s.x_m[k] - first : last - s.x_m[k];
    if (in_contact(k) && from_edge <= trigger.zone_m * (1 + 1e-9))
      force[k] = trigger.amount * (mu_s * s.p_s_Pa[k] - s.t_s_Pa[k]) * tributary_m[k];
  }
  return force;
}

int halo_for(const mesh::Mesh& mesh, double l_star_m) {
  return static_cast<int>(std::ceil(l_star_m / mesh.grid.spacing_m - 0.01)) + 1;
}

double event_bytes(double n_nodes, double n_cells, bool with_snapshots, Precision precision) {
  constexpr double number = sizeof(double), field = 2 * number;
  const double mesh = field * n_nodes + sizeof(mesh::Cell) * n_cells;
  const double state = 2 * field * n_nodes;  // u_m, u_per_shear
  const double single = precision == Precision::single_precision ? field * n_nodes : 0;
  const double motion = (number + 2 * field) * n_nodes + single;  // mass, u, v
  // The largest frequency by iterations, or the cells around each node.
  const double building = (n_nodes < solid::many_nodes ? number + 4 * field : 28) * n_nodes;
  const double stepping = 2 * n_nodes;  // of the stepper besides: levels, orphans
  const double snapshot = with_snapshots ? 2 * field * n_nodes : 0;
  return motion + std::max(mesh + state + building, stepping + snapshot);
}

Snapshot take_snapshot(const Stepper& stepper) {
  return {stepper.time_s(), stepper.u_m(), stepper.mean_velocity_m_per_s()};
}

Event run_event(Stepper& stepper, const Equilibrium& state, double mu_s, double c_L,
                const interface::Trigger& trigger, const TimeStepping& time, const Sampling& sampling,
                int halo, const Monitor& monitor, Sink* sink) {
  Event event;
  const auto& top = stepper.plate().top.node;
  const double top_speed = top.empty() ? 0 : stepper.v_m_per_s().x[top.front()];
  Recorder recorder(state, mu_s, halo, creep_over_top_speed * top_speed);
  Watch watch(stepper, c_L);
  event.history.x_m = state.tractions.x_m;

  const double quiet_from = std::isfinite(trigger.ramp_s) ? trigger.ramp_s : 0;
  const double all_steps = std::ceil(time.end_s / stepper.step_s() * (1 - 1e-12));
  if (all_steps > 1e12)
    throw UserError("time.end_s = {:g} takes {:g} steps of {:.4g} s; choose an earlier end", time.end_s,
                    all_steps, stepper.step_s());
  const auto n_steps = static_cast<std::int64_t>(all_steps);
  const double sample_interval = std::max(sampling.history_interval_s, stepper.step_s());
  const double energy_interval = std::max(sampling.energy_interval_s, stepper.step_s());
  event.energies.push_back(watch.start());
  std::int64_t n_samples = 0, n_energies = 1;
  fronts::History row;
  auto& history = sink != nullptr ? row : event.history;
  std::size_t next_snapshot = 0;
  const auto take_snapshots = [&] {
    while (next_snapshot < sampling.snapshot_times_s.size() &&
           stepper.time_s() >= sampling.snapshot_times_s[next_snapshot]) {
      if (sink != nullptr)
        sink->snapshot(stepper);
      else
        event.snapshots.push_back(take_snapshot(stepper));
      ++next_snapshot;
    }
  };
  const auto is_quiet = [&] {
    return stepper.time_s() - std::max(recorder.last_motion_s(), quiet_from) > time.quiet_s;
  };
  bool sampled = false;
  Between between;
  between.sample = [&]() -> fronts::History* {
    if (stepper.time_s() < static_cast<double>(n_samples) * sample_interval) return nullptr;
    n_samples = next_row(n_samples, stepper.time_s(), sample_interval);
    sampled = true;
    return &history;
  };
  between.go_on = [&] {
    if (sampled && sink != nullptr) {
      sink->sample(row);
      clear_rows(row);
    }
    sampled = false;
    return watch.look() && !is_quiet();
  };
  while (stepper.step() < n_steps) {
    take_snapshots();
    const double energy_time_s = static_cast<double>(n_energies) * energy_interval;
    std::int64_t steps =
        std::min({n_steps - stepper.step(), monitor_interval - stepper.step() % monitor_interval,
                  watch.steps_to_check(), steps_until(stepper, energy_time_s)});
    if (next_snapshot < sampling.snapshot_times_s.size())
      steps = std::min(steps, steps_until(stepper, sampling.snapshot_times_s[next_snapshot]));
    stepper.advance(recorder, steps, between);
    const bool energies = stepper.time_s() >= energy_time_s;
    if (energies) {
      n_energies = next_row(n_energies, stepper.time_s(), energy_interval);
      event.energies.push_back(stepper.energies());
    }
    if (auto trouble = watch.trouble(energies ? &event.energies.back() : nullptr); !trouble.empty()) {
      event.end = EventEnd::blow_up;
      event.blow_up = blow_up_message(stepper, trouble);
      break;
    }
    if (is_quiet()) {
      event.end = EventEnd::quiet;
      break;
    }
    if (stepper.step() % monitor_interval == 0 && !monitor(stepper.step(), n_steps)) {
      event.end = EventEnd::interrupted;
      break;
    }
  }
  take_snapshots();
  event.steps = stepper.step();
  event.time_s = stepper.time_s();
  if (event.energies.back().time_s < event.time_s) event.energies.push_back(stepper.energies());
  event.record = recorder.take(event.time_s);
  return event;
}

Ramp run_ramp(Stepper& stepper, const Equilibrium& tilted, const Loading& loading, double mu_s,
              double top_speed, double c_L, double expected_shear_m, const Monitor& monitor) {
  Ramp ramp;
  stepper.start(tilted, top_speed);
  Recorder recorder(tilted, mu_s, 0);
  Watch watch(stepper, c_L);
  const auto most = static_cast<std::int64_t>(2 * expected_shear_m / (top_speed * stepper.step_s()));

  // The motion where t/p inside passes a given ratio, in the form of an equilibrium under way.
  const auto state_now = [&] {
    Equilibrium e = tilted;
    const auto& s = stepper.interface_state();
    e.u_m = stepper.u_m();
    for (std::size_t n = 0; n < e.u_per_shear.size(); ++n) {
      e.u_per_shear.x[n] = stepper.v_m_per_s().x[n] / top_speed;
      e.u_per_shear.y[n] = stepper.v_m_per_s().y[n] / top_speed;
    }
    e.shear_m = top_speed * stepper.time_s();
    e.tractions.t_s_Pa = s.t_Pa;
    e.tractions.p_s_Pa = s.p_Pa;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (std::size_t k = 0; k < s.size(); ++k) {
      e.contact[k] = s.p_Pa[k] > 0 ? (s.slipping[k] != 0 ? Contact::slip : Contact::stick) : Contact::open;
      if (e.contact[k] == Contact::open) continue;
      first = std::min(first, e.tractions.x_m[k]);
      last = std::max(last, e.tractions.x_m[k]);
    }
    e.inside_from_m = first + loading.edge_margin_m;
    e.inside_to_m = last - loading.edge_margin_m;
    e.peak_ratio = 0;
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double x = e.tractions.x_m[k];
      if (x < e.inside_from_m || x > e.inside_to_m || s.p_Pa[k] <= 0 || s.t_Pa[k] / s.p_Pa[k] <= e.peak_ratio)
        continue;
      e.peak_ratio = s.t_Pa[k] / s.p_Pa[k];
      e.peak_x_m = x;
    }
    return e;
  };
  // The contact's extent changes slowly; the peak is looked for between bounds that are renewed at the
  // checks.
  double from = tilted.inside_from_m, to = tilted.inside_to_m;
  const auto peak_now = [&] {
    const auto& s = stepper.interface_state();
    double peak = 0;
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double x = tilted.tractions.x_m[k];
      if (x >= from && x <= to && s.p_Pa[k] > 0) peak = std::max(peak, s.t_Pa[k] / s.p_Pa[k]);
    }
    return peak;
  };

  constexpr std::int64_t renewal_interval = 1000;
  bool have_common = false;
  double peak = 0;
  Between between;
  between.go_on = [&] {
    peak = peak_now();
    return watch.look() && peak < mu_s * (1 - (have_common ? ramp_handover : loading.critical_margin));
  };
  for (;;) {
    stepper.advance(recorder,
                    std::min({renewal_interval - stepper.step() % renewal_interval, watch.steps_to_check(),
                              most + 1 - stepper.step()}),
                    between);
    if (auto trouble = watch.trouble(nullptr); !trouble.empty())
      throw BlowUp(blow_up_message(stepper, trouble));
    if (!have_common && peak >= mu_s * (1 - loading.critical_margin)) {
      ramp.common = state_now();
      have_common = true;
    }
    if (peak >= mu_s * (1 - ramp_handover)) {
      ramp.spontaneous = state_now();
      break;
    }
    if (stepper.step() % renewal_interval == 0) {
      const Equilibrium e = state_now();
      from = e.inside_from_m;
      to = e.inside_to_m;
      if (!monitor(stepper.step(), most / 2)) {
        ramp.interrupted = true;
        break;
      }
    }
    if (stepper.step() > most)
      throw UserError("the ramp does not bring t/p inside the interface to mu_s within a shear of {:.4g} m",
                      2 * expected_shear_m);
  }
  ramp.steps = stepper.step();
  ramp.record = recorder.take(stepper.time_s());
  return ramp;
}

}  // namespace slipfront::solve
