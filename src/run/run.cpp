// SPDX-License-Identifier: BSD-3-Clause
#include "run/run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/memory.hpp"
#include "base/per_node.hpp"
#include "motion/distributed_stepper.hpp"
#include "motion/stepper.hpp"
#include "motion/trigger_zone.hpp"
#include "problem/contact.hpp"
#include "run/begin.hpp"
#include "run/notes.hpp"
#include "run/outputs.hpp"
#include "run/snapshot_plan.hpp"

namespace slipfront::run {

namespace {

/// With which the event begins. @tparam Initial  InitialState
template <class Initial>
auto& event_state(const Problem& problem, Initial& initial) {
  return problem.start.kind == interface::EventKind::spontaneous ? initial.supercritical
                                                                 : initial.subcritical;
}

/// Nodes in contact that slip or are open at rest, said in one line; empty where all stick.
std::string contact_warning(const statics::Equilibrium& state) {
  const auto n_slip = std::ranges::count(state.contact, statics::Contact::slip);
  const auto n_open = std::ranges::count(state.contact, statics::Contact::open);
  if (n_slip + n_open == 0) return {};
  std::int64_t n_inside = 0;
  for (std::size_t k = 0; k < state.contact.size(); ++k) {
    const bool is_inside = state.is_inside(state.tractions.x_m[k]);
    n_inside += is_inside && state.contact[k] != statics::Contact::stick ? 1 : 0;
  }
  return fmt::format(
      "before the event {} interface nodes are open and {} slip at mu_s p, {} {:.4g} to {:.4g} m", n_open,
      n_slip, n_inside == 0 ? "all outside" : fmt::format("{} of them within", n_inside), state.inside_from_m,
      state.inside_to_m);
}

/// Empty where a ramp resolves the margin, or there is none.
std::string ramp_warning(const std::optional<motion::Ramp>& ramp) {
  if (!ramp || !ramp->passed_margin_in_a_step()) return {};
  return "the ramp brings t/p from below (1 - loading.critical_margin) mu_s to slip within a step: the state "
         "in which triggered events begin is the critical one; choose a lower loading.shear_speed_m_per_s";
}

}  // namespace

WaveSpeeds wave_speeds(const solid::Material& m) {
  return {solid::longitudinal_speed_m_per_s(m), solid::shear_speed_m_per_s(m),
          solid::rayleigh_speed_m_per_s(m)};
}

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
  const double edge = initial.prescribed ? 0 : problem.loading.edge_margin_m;
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

namespace {

/// The stepper of one process.
std::unique_ptr<motion::TimeStepper> whole_stepper(const Problem& problem, const InitialState& initial,
                                                   const motion::Execution& execution) {
  auto stepper = new_time_stepper(problem, initial, execution);
  stepper->set_probes(probes_of(problem, initial.mesh, initial.base));
  return stepper;
}

std::unique_ptr<motion::TimeStepper> stepper_of(const Problem& problem, InitialState& initial,
                                                const motion::Execution& execution, Processes& processes) {
  if (processes.size() == 1) return whole_stepper(problem, initial, execution);
  return new_distributed_stepper(problem, initial, processes, execution);
}

/// What only the stepper needed.
void release_nodes(InitialState& initial) {
  const auto release = [](mesh::Mesh& mesh) {
    mesh.x_m = std::vector<double>();
    mesh.y_m = std::vector<double>();
    mesh.cells = std::vector<mesh::Cell>();
  };
  release(initial.mesh);
  if (initial.base) release(*initial.base);
  return_freed_memory();
}

}  // namespace

motion::Loads loads_of_event(const Problem& problem, const InitialState& initial) {
  auto loads = starting_loads(problem, event_state(problem, initial), initial.mesh, initial.mu_s);
  loads.law_states = initial.law_states;
  return loads;
}

std::unique_ptr<motion::TimeStepper> start_event(const Problem& problem, InitialState& initial,
                                                 const motion::Execution& execution, Processes& processes) {
  auto& state = event_state(problem, initial);
  initial.release_displacements(&state);
  const auto loads = from_root(processes, [&] { return loads_of_event(problem, initial); });
  // The other ranks get the state without its displacements, and their columns of these.
  std::array<solid::Field, 4> u;
  for (std::size_t k = 0; k < u.size(); ++k) std::swap(u[k], *state.displacements()[k]);
  auto stepper = stepper_of(problem, initial, execution, processes);
  for (std::size_t k = 0; k < u.size(); ++k) std::swap(u[k], *state.displacements()[k]);
  stepper->start(state, shear_speed_in_event_m_per_s(problem), loads);
  initial.release_displacements();
  release_nodes(initial);
  return stepper;
}

std::unique_ptr<motion::TimeStepper> make_stepper(const Problem& problem, InitialState& initial,
                                                  const motion::Execution& execution, Processes& processes) {
  auto stepper = stepper_of(problem, initial, execution, processes);
  release_nodes(initial);
  return stepper;
}

motion::EventRun begin_event(const Problem& problem, const InitialState& initial,
                             motion::TimeStepper& stepper, const motion::Monitor& monitor,
                             const results::Sinks& sinks, motion::Observers more) {
  const auto& state = event_state(problem, initial);
  std::optional<motion::Interval> stop_window;
  if (problem.is_sequence()) stop_window = {state.inside_from_m, state.inside_to_m};
  const motion::EventSetup setup = {
      .state = state,
      .mu_s = ratios_at_rest(problem, initial.mu_s),
      .waves = {fastest_speed_m_per_s(problem),
                stability::radiation_damping_Pa_s_per_m(materials_of(problem))},
      .loads_settle_s = loads_settle_s(problem),
      .time = problem.time,
      .tip_slip_interval_s = problem.output.history_interval_s,
      .energy_interval_s = problem.output.energy_interval_s,
      .halo = motion::halo_for(initial.mesh, problem.fronts.l_star_m),
      .stop_window = stop_window,
      .slow_m_per_s = problem.is_slow() ? slow_slip_rate_m_per_s(problem) : infinity};
  auto list = results::observers_of(output_setup(problem, initial, stepper.step_s()), stepper, sinks);
  std::ranges::move(more, std::back_inserter(list));
  return {stepper, setup, monitor, std::move(list)};
}

Result run_from(const Problem& problem, const InitialState& initial, const motion::Monitor& monitor,
                const motion::Execution& execution, motion::Observers more) {
  const auto stepper = whole_stepper(problem, initial, execution);
  stepper->start(event_state(problem, initial), shear_speed_in_event_m_per_s(problem),
                 loads_of_event(problem, initial));
  return run_from(problem, initial, *stepper, monitor, std::move(more));
}

Result run_from(const Problem& problem, const InitialState& initial, motion::TimeStepper& stepper,
                const motion::Monitor& monitor, motion::Observers more) {
  const auto start = Clock::now();
  results::KeptOutputs rows;
  const auto sinks = [&](const results::Output& output) -> results::RowSink& { return rows[output.file]; };
  auto event = begin_event(problem, initial, stepper, monitor, sinks, std::move(more));
  auto result = collect(problem, stepper, event.run());
  result.rows = std::move(rows);
  result.stepping_wall_s = seconds_since(start);
  analyse(result, initial);
  return result;
}

Result collect(const Problem& problem, const motion::TimeStepper& stepper, motion::Event event) {
  Result result;
  result.problem = problem;
  result.speeds = wave_speeds(problem.above().material);
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

void analyse(Result& result, const InitialState& initial) {
  analyse(result, initial,
          rupture_outlook(result.problem, initial.subcritical, initial.tributary_m, initial.healed));
}

void analyse(Result& result, const InitialState& initial, const RuptureOutlook& outlook) {
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
  result.warnings = notes_of_case(problem, rupture, result.step_s);
  if (auto warning = contact_warning(initial.subcritical); !warning.empty())
    result.warnings.push_back(warning);
  if (auto warning = ramp_warning(initial.ramp); !warning.empty()) result.warnings.push_back(warning);
  const auto& before = result.event.energies.front();
  const auto& after = result.event.energies.back();
  if (!initial.prescribed && before.strain > 0 && after.trigger_work > 0.1 * before.strain)
    result.warnings.push_back(
        fmt::format("the trigger has done {:.4g} J/m of work, {:.0f} % of the energy stored before, "
                    "and drives the motion behind the front",
                    after.trigger_work, 100 * after.trigger_work / before.strain));
  if (problem.time.precision == motion::Precision::single_precision) {
    constexpr double most = 1e-3;
    double largest = 0, imbalance = 0;
    for (const auto& e : result.event.energies) {
      imbalance = std::max(imbalance, std::abs(record::imbalance_J_per_m(e, before)));
      for (const auto& term : record::energy_terms)
        largest = std::max(largest, std::abs(e.*term.member - before.*term.member));
    }
    if (imbalance > most * largest)
      result.warnings.push_back(fmt::format(
          "time.precision = single leaves {:.2g} of the largest change of energy open: the motion is "
          "small against what rounding takes from it; choose double",
          imbalance / largest));
  }
  const auto n_after = snapshots_after(problem, result.event.time_s).size();
  const auto n_running = std::ranges::count(result.fronts, fronts::End::record_end, &fronts::Front::end);
  const bool quiet = result.event.end == motion::EventEnd::quiet;
  const bool ended_early = result.event.end != motion::EventEnd::end_time;
  if (ended_early && n_after > 0)
    result.warnings.push_back(
        fmt::format("{} of {} output.snapshot_times_s are after the end of the event: {}", n_after,
                    problem.output.snapshot_times_s.size(), end_of_event(result)));
  if (const double wait_s = fronts::arrest_time_s(result.event.record, options);
      wait_s > options.arrest_time_s)
    result.warnings.push_back(
        fmt::format("slip spreads slowly: a tip has arrested after a wait of {:.3g} s, not of "
                    "fronts.arrest_time_s = {:g} s",
                    wait_s, options.arrest_time_s));
  const auto running = n_running == 1 ? std::string("1 front") : fmt::format("{} fronts", n_running);
  if (quiet && n_running > 0)
    result.warnings.push_back(
        fmt::format("{} may still have been under way when the event ended ({}); time.quiet_s = inf goes on "
                    "to time.end_s",
                    running, end_of_event(result)));
  if (result.event.end == motion::EventEnd::end_time && n_running > 0)
    result.warnings.push_back(
        fmt::format("{} may still be under way at time.end_s = {:g} s; choose a later end to see more",
                    running, problem.time.end_s));
  if (result.event.record.onsets.empty()) result.warnings.push_back("no node slipped");
}

}  // namespace slipfront::run
