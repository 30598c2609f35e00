// SPDX-License-Identifier: BSD-3-Clause
#include "run/run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "advice/notes.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/per_node.hpp"
#include "problem/contact.hpp"
#include "setup/event.hpp"
#include "setup/event_loads.hpp"
#include "setup/snapshot_plan.hpp"

namespace slipfront::run {

namespace {

/// A number of the law of each node, or of the one of all.
template <class Of>
PerNode at_nodes(Of of, const interface::FrictionLaw& of_all,
                 const std::vector<interface::FrictionLaw>& laws) {
  std::vector<double> of_each;
  for (const auto& law : laws) of_each.push_back(std::invoke(of, law));
  return of_each.empty() ? PerNode(std::invoke(of, of_all)) : PerNode(std::move(of_each));
}

}  // namespace

fronts::FrontOptions front_options(const Problem& problem, const InitialState& initial) {
  fronts::FrontOptions o;
  o.l_star_m = problem.fronts.l_star_m;
  o.speed_interval = problem.fronts.speed_interval;
  o.arrest_time_s = problem.fronts.arrest_time_s;
  o.arrest_time_by_event = true;
  o.min_length_m = problem.fronts.min_length_m;
  o.crack_share = problem.fronts.crack_share;
  o.pulse_share = problem.fronts.pulse_share;
  const auto laws = friction_at(problem, initial.subcritical.tractions.x_m, initial.healed);
  o.mu_s = at_nodes(interface::static_coefficient, problem.friction.law, laws);
  o.cohesion_Pa = at_nodes(&interface::FrictionLaw::cohesion_Pa, problem.friction.law, laws);
  o.elasticity = {problem.above().material.youngs_modulus_Pa, problem.above().material.poissons_ratio,
                  problem.above().material.plane == solid::Plane::strain};
  const double margin = problem.start.trigger.zone_m + problem.fronts.trigger_margin_m;
  const double edge = problem.is_prestressed() ? 0 : problem.loading.edge_margin_m;
  const double contact_from = initial.subcritical.inside_from_m - edge;
  const double contact_to = initial.subcritical.inside_to_m + edge;
  if (problem.start.kind == interface::EventKind::left) {
    o.exclude_left_m = contact_from + margin;
    o.driven = {{contact_from, contact_from + problem.start.trigger.zone_m}};
  }
  if (problem.start.kind == interface::EventKind::right) {
    o.exclude_right_m = contact_to - margin;
    o.driven = {{contact_to - problem.start.trigger.zone_m, contact_to}};
  }
  if (problem.start.kind == interface::EventKind::nucleation) {
    const auto& n = problem.start.nucleation;
    const double patch_reach = n.reach_m();
    const double reach = patch_reach + problem.fronts.trigger_margin_m;
    o.exclude_from_m = n.x_m - reach;
    o.exclude_to_m = n.x_m + reach;
    // A patch that passes an edge of a periodic plate goes on at the other one.
    const double period = initial.mesh.period_m;
    for (const double shift : {0.0, -period, period})
      o.driven.push_back({n.x_m - patch_reach + shift, n.x_m + patch_reach + shift});
    if (period > 0 && o.exclude_from_m < 0) o.exclude_right_m = o.exclude_from_m + period;
    if (period > 0 && o.exclude_to_m > period) o.exclude_left_m = o.exclude_to_m - period;
  }
  return o;
}

Result run_from(const Problem& problem, const InitialState& initial, const motion::Monitor& monitor,
                const motion::Execution& execution, motion::Observers more) {
  const auto stepper = setup::whole_stepper(problem, initial, execution);
  stepper->start(initial.before(problem.start.kind), shear_speed_in_event_m_per_s(problem),
                 setup::event_loads(problem, initial));
  return run_from(problem, initial, *stepper, monitor, std::move(more));
}

Result run_from(const Problem& problem, const InitialState& initial, motion::TimeStepper& stepper,
                const motion::Monitor& monitor, motion::Observers more) {
  const auto start = Clock::now();
  results::KeptOutputs rows;
  const auto sinks = [&](const results::Output& output) -> results::RowSink& { return rows[output.file]; };
  auto event = setup::begin_event(problem, initial, stepper, monitor, sinks, std::move(more));
  auto result = collect(problem, stepper, event.run());
  result.rows = std::move(rows);
  result.stepping_wall_s = seconds_since(start);
  analyse(result, initial);
  return result;
}

Result collect(const Problem& problem, const motion::TimeStepper& stepper, motion::Event event) {
  Result result;
  result.problem = problem;
  result.speeds = solid::wave_speeds(problem.above().material);
  result.stable_step_s = stepper.stable_step_s();
  result.step_s = stepper.step_s();
  result.substep_s = stepper.substep_s();
  result.node_updates_per_step = stepper.node_updates_per_step();
  if (const auto* parted = dynamic_cast<const motion::DistributedStepper*>(&stepper); parted != nullptr)
    result.shared = SharedCost{parted->partition(), parted->costs()};
  result.event = std::move(event);
  return result;
}

std::string end_of_event(const Result& result) {
  const auto& problem = result.problem;
  switch (result.event.end) {
    case motion::EventEnd::end_time:
      return fmt::format("time.end_s = {:g} s was reached", problem.time.end_s);
    case motion::EventEnd::interrupted:
      return fmt::format("interrupted at t = {:.4g} s", result.event.time_s);
    case motion::EventEnd::blow_up:
      return result.event.reason;
    case motion::EventEnd::observer:
      return fmt::format("an observer ended it at t = {:.4g} s: {}", result.event.time_s,
                         result.event.reason);
    case motion::EventEnd::quiet:
      break;
  }
  if (problem.is_sequence())
    return fmt::format("at t = {:.4g} s all nodes inside had stuck for time.quiet_s = {:g} s",
                       result.event.time_s, problem.time.quiet_s);
  return fmt::format(
      "at t = {:.4g} s nothing had moved for time.quiet_s = {:g} s: no slip began, none grew or was faster "
      "than {:.3g} m/s, and no waves were left",
      result.event.time_s, problem.time.quiet_s, result.event.quiet_slip_rate_m_per_s);
}

namespace {

/// Nodes in contact that slip or are open at rest.
void add_contact(const statics::Equilibrium& state, Diagnostics& notes) {
  const auto n_slip = std::ranges::count(state.contact, statics::Contact::slip);
  const auto n_open = std::ranges::count(state.contact, statics::Contact::open);
  if (n_slip + n_open == 0) return;
  std::int64_t n_inside = 0;
  for (std::size_t k = 0; k < state.contact.size(); ++k) {
    const bool is_inside = state.is_inside(state.tractions.x_m[k]);
    n_inside += is_inside && state.contact[k] != statics::Contact::stick ? 1 : 0;
  }
  notes.add(Diagnostic::physics,
            "before the event {} interface nodes are open and {} slip at mu_s p, {} {:.4g} to {:.4g} m",
            n_open, n_slip, n_inside == 0 ? "all outside" : fmt::format("{} of them within", n_inside),
            state.inside_from_m, state.inside_to_m);
}

/// Energy that single precision leaves open.
void add_imbalance(const Result& result, Diagnostics& notes) {
  if (result.problem.time.precision != motion::Precision::single_precision) return;
  constexpr double most = 1e-3;
  const auto& before = result.event.energies.front();
  double largest = 0, imbalance = 0;
  for (const auto& e : result.event.energies) {
    imbalance = std::max(imbalance, std::abs(record::imbalance_J_per_m(e, before)));
    for (const auto& term : record::energy_terms)
      largest = std::max(largest, std::abs(e.*term.member - before.*term.member));
  }
  if (imbalance > most * largest)
    notes.add(
        Diagnostic::resolution,
        "time.precision = single leaves {:.2g} of the largest change of energy open: the motion is small "
        "against what rounding takes from it; choose double",
        imbalance / largest);
}

void add_notes_of_event(Result& result, const InitialState& initial, const fronts::FrontOptions& options) {
  const auto& problem = result.problem;
  const auto& event = result.event;
  auto& notes = result.notes;
  add_contact(initial.subcritical, notes);
  if (initial.ramp && initial.ramp->passed_margin_in_a_step())
    notes.add(Diagnostic::resolution,
              "the ramp brings t/p from below (1 - loading.critical_margin) mu_s to slip within a step: the "
              "state in which triggered events begin is the critical one; choose a lower "
              "loading.shear_speed_m_per_s");
  const double stored = event.energies.front().strain, trigger_work = event.energies.back().trigger_work;
  if (!problem.is_prestressed() && stored > 0 && trigger_work > 0.1 * stored)
    notes.add(Diagnostic::physics,
              "the trigger has done {:.4g} J/m of work, {:.0f} % of the energy stored before, and drives the "
              "motion behind the front",
              trigger_work, 100 * trigger_work / stored);
  add_imbalance(result, notes);
  const auto n_after = setup::snapshots_after(problem, event.time_s).size();
  if (event.end != motion::EventEnd::end_time && n_after > 0)
    notes.add(Diagnostic::output, "{} of {} output.snapshot_times_s are after the end of the event: {}",
              n_after, problem.output.snapshot_times_s.size(), end_of_event(result));
  if (const double wait_s = fronts::arrest_time_s(event.record, options); wait_s > options.arrest_time_s)
    notes.add(
        Diagnostic::output,
        "slip spreads slowly: a tip has arrested after a wait of {:.3g} s, not of fronts.arrest_time_s = "
        "{:g} s",
        wait_s, options.arrest_time_s);
  const auto n_running = std::ranges::count(result.fronts, fronts::End::record_end, &fronts::Front::end);
  const auto running = n_running == 1 ? std::string("1 front") : fmt::format("{} fronts", n_running);
  if (event.end == motion::EventEnd::quiet && n_running > 0)
    notes.add(Diagnostic::output,
              "{} may still have been under way when the event ended ({}); time.quiet_s = inf goes on to "
              "time.end_s",
              running, end_of_event(result));
  if (event.end == motion::EventEnd::end_time && n_running > 0)
    notes.add(Diagnostic::output,
              "{} may still be under way at time.end_s = {:g} s; choose a later end to see more", running,
              problem.time.end_s);
  if (event.record.onsets.empty()) notes.add(Diagnostic::physics, "no node slipped");
}

}  // namespace

void analyse(Result& result, const InitialState& initial) {
  analyse(result, initial,
          advice::rupture_outlook(result.problem, initial.subcritical, initial.tributary_m, initial.healed));
}

void analyse(Result& result, const InitialState& initial, const advice::RuptureOutlook& outlook) {
  const auto& problem = result.problem;
  const auto options = front_options(problem, initial);
  result.fronts = fronts::find_fronts(result.event.record, initial.subcritical.tractions, options);
  result.passages.clear();
  const fracture::Recorded recorded{result.event.record.x_m, result.event.breakdown, result.event.tip_slip};
  for (const auto& front : result.fronts)
    result.passages.push_back(fracture::passages(front, recorded, materials_of(problem)));
  result.rupture = outlook;
  auto rupture = outlook;
  if (result.fronts.empty())
    for (auto& doubt : rupture.doubts) doubt = "no rupture: " + doubt;
  result.notes = advice::notes_of_case(problem, rupture, result.step_s);
  add_notes_of_event(result, initial, options);
}

Diagnostics notes_of_sequence(const Problem& problem, std::span<const record::SequenceEvent> events) {
  // Events that begin as soon as one place passes mu_s by little may be of that place alone.
  constexpr double small_m = 1e-7, usual_margin = 0.01;
  Diagnostics notes;
  const auto n_small = std::ranges::count_if(events, [](const auto& e) { return e.max_slip_m < small_m; });
  if (!problem.is_slow() && n_small > 0 && problem.loading.critical_margin < usual_margin)
    notes.add(Diagnostic::physics,
              "{} of {} events slip by nanometres, less than 0.1 um: they begin where t/p passes mu_s by "
              "loading.critical_margin = {:g}; a larger one, 0.01 to 0.03, leaves larger events alone",
              n_small, events.size(), problem.loading.critical_margin);
  return notes;
}

}  // namespace slipfront::run
