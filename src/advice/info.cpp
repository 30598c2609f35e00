// SPDX-License-Identifier: BSD-3-Clause
#include "advice/info.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "advice/notes.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "mesh/node_columns.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/stepper.hpp"
#include "problem/contact.hpp"
#include "setup/event.hpp"
#include "setup/initial_state.hpp"
#include "setup/subdomains.hpp"
#include "statics/plate_solver.hpp"
#include "statics/prestress.hpp"

namespace slipfront::advice {

namespace {

/// Tractions before the event; under a tilt those of the nominal pressure when the weakest node slips.
record::StaticState expected_tractions(const Problem& problem, const mesh::Mesh& mesh,
                                       const std::vector<interface::FrictionLaw>& laws) {
  if (problem.is_prestressed()) return prescribed_tractions(problem, mesh::interface_x_m(mesh));
  const double p_Pa = nominal_pressure_Pa(problem);
  double least_Pa = infinity;
  for (const auto& law : laws) least_Pa = std::min(least_Pa, interface::static_strength_Pa(law, p_Pa));
  return {mesh::interface_x_m(mesh), std::vector(laws.size(), least_Pa), std::vector(laws.size(), p_Pa)};
}

/// Nodes that a front can break: t is short of the strength by at most so many times the largest stress drop
/// as a barrier is; all where t drops nowhere, or under a law that never sticks.
std::vector<std::size_t> nodes_that_can_slip(const Problem& problem, const mesh::Mesh& mesh,
                                             const std::vector<interface::FrictionLaw>& laws) {
  const auto s = expected_tractions(problem, mesh, laws);
  double largest_drop_Pa = 0;
  for (std::size_t k = 0; k < laws.size(); ++k)
    largest_drop_Pa = std::max(largest_drop_Pa, std::abs(s.t_s_Pa[k]) - laws[k].cohesion_Pa() -
                                                    interface::kinetic_coefficient(laws[k]) * s.p_s_Pa[k]);
  std::vector<std::size_t> nodes;
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const double short_Pa = interface::static_strength_Pa(laws[k], s.p_s_Pa[k]) - std::abs(s.t_s_Pa[k]);
    if (laws[k].never_sticks() || largest_drop_Pa <= 0 || short_Pa <= stability::barrier_S * largest_drop_Pa)
      nodes.push_back(k);
  }
  return nodes;
}

/// Those of some nodes where one of the three numbers by which friction enters the growth of waves is least
/// or largest; all under laws with a state, of which more numbers count, and whose growth is a closed form.
std::set<std::size_t> extreme_nodes(const std::vector<std::size_t>& among,
                                    const std::vector<interface::FrictionLaw>& laws, double pressure_Pa,
                                    const interface::Regularisation& regularisation) {
  if (laws.front().never_sticks()) return {among.begin(), among.end()};
  std::vector<stability::Sliding> sliding;
  for (const auto node : among)
    sliding.push_back(stability::uniform_sliding(laws[node], 0, pressure_Pa, regularisation));
  std::set<std::size_t> nodes;
  for (const auto member :
       {&stability::Sliding::mu, &stability::Sliding::slope_s_per_m, &stability::Sliding::slip_slope_per_m}) {
    for (const auto at :
         {std::ranges::min_element(sliding, {}, member), std::ranges::max_element(sliding, {}, member)})
      nodes.insert(among[static_cast<std::size_t>(at - sliding.begin())]);
  }
  return nodes;
}

/// The verdict with faster growth is the worse one; where neither has a bound or grows, by how far weakening
/// is beyond it. None is worse by rounding alone, and no verdict comes last.
bool is_worse(const stability::WellPosedness& a, const stability::WellPosedness& b) {
  constexpr double rounding = 1e-9;
  const double of_a = a.fastest_growth_per_s, of_b = b.fastest_growth_per_s;
  if (!a.has_verdict() || !b.has_verdict()) return a.has_verdict();
  if (of_a > (1 + rounding) * of_b || of_b > (1 + rounding) * of_a) return of_a > of_b;
  return a.weakening_over_radiation - b.weakening_over_radiation >
         rounding * std::abs(b.weakening_over_radiation);
}

/// @return notes: of which friction nothing can be said
Diagnostics add_well_posedness(const Problem& problem, const mesh::Mesh& mesh, Info& info) {
  const double pressure_Pa = nominal_pressure_Pa(problem);
  Diagnostics notes;
  auto& worst = info.well_posedness;
  const auto consider = [&](const interface::FrictionLaw& law, double x_m) {
    const auto here =
        stability::well_posedness(materials_of(problem), law, pressure_Pa, problem.element_size_m(),
                                  problem.width_m(), problem.friction.regularisation);
    if (!here.has_verdict())
      notes.add(Diagnostic::physics, "uniform sliding{}: {}",
                std::isnan(x_m) ? "" : fmt::format(" with the friction at x = {:.4g} m", x_m),
                here.statement);
    if (!worst.statement.empty() && !is_worse(here, worst)) return;
    worst = here;
    info.well_posedness_x_m = x_m;
  };
  const auto x_m = mesh::interface_x_m(mesh);
  const auto laws = friction_at(problem, x_m);
  if (laws.empty()) {
    consider(problem.friction.law, nan);
    return notes;
  }
  const auto can_slip = nodes_that_can_slip(problem, mesh, laws);
  if (can_slip.empty()) {
    worst.fastest_growth_per_s = nan;
    worst.statement = "no verdict: t is too far below the strength for any node to slip";
    notes.add(Diagnostic::physics, "uniform sliding: {}", worst.statement);
    return notes;
  }
  for (const auto node : extreme_nodes(can_slip, laws, pressure_Pa, problem.friction.regularisation))
    consider(laws[node], x_m[node]);
  return notes;
}

/// Bodies whose steps are timed: the whole ones, or some columns of them.
struct Timed {
  std::unique_ptr<motion::Stepper> stepper;
  const mesh::Mesh* plate = nullptr;
  const mesh::Mesh* base = nullptr;
  double share = 1;  ///< of the whole
};

void add_sizes(const Problem& problem, const setup::Meshes& meshes, Info& info) {
  info.n_nodes = setup::n_nodes_of(meshes.plate);
  info.n_cells = setup::n_cells_of(meshes.plate);
  info.n_interface = std::ssize(meshes.plate.interface_nodes);
  if (!meshes.base) return;
  info.base_speeds = solid::wave_speeds(problem.below().material);
  info.generalised_rayleigh_speed_m_per_s =
      stability::generalised_rayleigh_speed_m_per_s(problem.above().material, problem.below().material);
  info.n_nodes += setup::n_nodes_of(*meshes.base);
  info.n_cells += setup::n_cells_of(*meshes.base);
}

void add_steps(const Timed& timed, Info& info) {
  const auto& stepper = *timed.stepper;
  if (timed.share == 1) info.n_irregular = 0;
  for (const auto& body : stepper.bodies()) {
    if (info.n_irregular)
      *info.n_irregular +=
          static_cast<std::int64_t>(body.op().whole.own.size() + body.op().whole.general.size());
    info.substeps_of_bodies.push_back(body.period());
  }
  info.stable_step_s = stepper.stable_step_s();
  info.step_s = stepper.step_s();
  info.substep_s = stepper.substep_s();
}

Size size_of(const setup::Meshes& meshes, const Info& info) {
  return {static_cast<double>(info.n_nodes),
          meshes.base ? static_cast<double>(setup::n_nodes_of(*meshes.base)) : 0,
          static_cast<double>(info.n_interface), info.step_s};
}

void add_needs(const Problem& problem, const setup::Meshes& meshes, double node_updates_per_step,
               Info& info) {
  info.needs = needs(problem, size_of(meshes, info));
  info.n_steps = info.needs.steps;
  info.node_updates = static_cast<double>(info.n_steps) * node_updates_per_step +
                      static_cast<double>(info.needs.ramp_steps) * static_cast<double>(info.n_nodes);
  info.memory_bytes = info.needs.memory_bytes();
  info.solver_bytes = info.needs.statics_bytes;
  if (!problem.is_prestressed())
    info.solver =
        statics::choose_solver(setup::wanted_solver(problem), 2.0 * static_cast<double>(info.n_nodes));
}

/// Most steps that are taken without a look at the event.
constexpr double steps_per_look = 50;

/// Times at which the event is looked at: every so many steps, and for energies and snapshots.
double looks_of(const Problem& problem, const Needs& needs) {
  const auto steps = static_cast<double>(needs.steps);
  return std::min(steps, steps / steps_per_look + problem.time.end_s / problem.output.energy_interval_s +
                             needs.of(results::snapshot_output).n_rows + 1);
}

/// Node updates/s of this machine, from a few steps: under the mean pressure, with half of the interface
/// sliding, which takes longer than to stick; beside the programs that run now.
/// @param n_steps  at once
double measured_rate_per_s(const Problem& problem, const Timed& timed, motion::TimeStepper& stepper,
                           std::int64_t n_steps) {
  constexpr double min_s = 20e-3, max_s = 0.5;
  const double mu_s = interface::static_coefficient(problem.friction.law);
  const auto& plate = *timed.plate;
  const auto n = plate.interface_nodes.size();
  record::StaticState tractions;
  tractions.x_m = mesh::interface_x_m(plate);
  tractions.p_s_Pa.assign(n, nominal_pressure_Pa(problem));
  tractions.t_s_Pa.assign(n, 0.0);
  for (std::size_t k = 0; k < n / 2; ++k) tractions.t_s_Pa[k] = 1.1 * mu_s * tractions.p_s_Pa[k];
  const auto state = statics::prestressed(plate, tractions, timed.base);
  stepper.start(state, 0, motion::prescribed_loads(state));
  motion::Recorder recorder(state, mu_s, 0);
  stepper.advance(recorder, 1);  // makes its pages and fills the caches
  const auto start = Clock::now();
  double times = 0, spent_s = 0;
  do {
    stepper.advance(recorder, n_steps);
    ++times;
    spent_s = seconds_since(start);
  } while (spent_s < min_s || (times < 3 && spent_s < max_s));
  return times * static_cast<double>(n_steps) * stepper.node_updates_per_step() / spent_s;
}

/// Time of the meshes, of the state that the event begins from and of the files, mostly sums and writing of
/// fields.
double expected_rest_s(const Info& info) {
  constexpr double s_per_node = 0.25e-6, s_per_byte = 2.4e-9;
  return s_per_node * static_cast<double>(info.n_nodes) +
         s_per_byte *
             (info.needs.of(results::history_output).bytes + info.needs.of(results::snapshot_output).bytes);
}

double expected_statics_s(const Info& info) {
  if (info.solver == statics::StaticSolver::automatic) return 0;  // prescribed tractions
  return statics_s(info.solver, 2.0 * static_cast<double>(info.n_nodes));
}

Timed whole_to_time(const Problem& problem, const setup::Meshes& meshes) {
  Timed timed;
  timed.stepper = setup::new_stepper(problem, meshes.plate, meshes.base);
  timed.plate = &meshes.plate;
  timed.base = meshes.base ? &*meshes.base : nullptr;
  return timed;
}

/// Time of three evaluations a step, each with two dense products and friction at all nodes.
double expected_slow_s(const Info& info) {
  constexpr double s_per_pair = 3 * 2 * 0.4e-9, s_per_node = 3 * 100e-9;
  const auto n = static_cast<double>(info.n_interface);
  return info.needs.slow_steps * n * (s_per_pair * n + s_per_node);
}

/// The columns of a part, no more than show the rate.
Timed part_to_time(const Problem& problem, const setup::Meshes& interfaces, int n_processes,
                   setup::IsolatedSubdomain& part) {
  constexpr double max_nodes = 4e6;
  constexpr int min_columns = 64;
  const setup::GlobalBodies whole(problem, interfaces.plate, interfaces.base);
  const auto steps = whole.steps();
  const auto partition = whole.divided(n_processes, steps);
  const auto own = partition.own(n_processes / 2);
  double per_column = 0;
  for (const auto& body : whole.bodies()) per_column += body.mesh.grid.rows + 1;
  const int most = std::max(min_columns, static_cast<int>(max_nodes / per_column));
  const int width = std::min(own.end - own.begin, most);
  part = setup::make_isolated_subdomain(problem, interfaces.plate, steps, {own.begin, own.begin + width});
  Timed timed;
  timed.stepper = std::move(part.stepper);
  timed.plate = &part.plate;
  timed.base = part.base ? &*part.base : nullptr;
  timed.share = static_cast<double>(width) / partition.first.back();
  return timed;
}

/// Time of the steps of own and ghost columns, at the measured rate, of what passes through rank 0: samples,
/// snapshots and initial motion, and of its statics.
Info::Shared shared_by(const Problem& problem, const setup::Meshes& meshes, const Timed& timed,
                       int n_processes, const Info& info) {
  /// Bytes of a node: u and v, as they are sent. Packed, passed on and joined by rank 0, of each byte.
  constexpr double sent_bytes_per_node = 32, s_per_byte = 1 / 0.8e9;
  const setup::GlobalBodies whole(problem, meshes.plate, meshes.base);
  std::vector<motion::BodySteps> body_steps;
  for (const auto& body : timed.stepper->bodies()) body_steps.push_back(body.steps());
  Info::Shared shared;
  shared.partition = whole.divided(n_processes, body_steps);

  const auto& partition = shared.partition;
  const int middle = n_processes / 2;  // with a neighbour on each side, where any subdomain has
  const double own_columns = partition.own(middle).end - partition.own(middle).begin;
  const double halo_columns = partition.halo_below(middle) + partition.halo_above(middle);
  const auto n_nodes = static_cast<double>(info.n_nodes);
  const double column_s = info.node_updates / partition.n_columns() / info.node_updates_per_s;
  shared.bytes_per_step =
      halo_columns * n_nodes / partition.n_columns() * sent_bytes_per_node / partition.steps_per_exchange;
  const double passed_bytes = 0.5 * info.needs.of(results::history_output).bytes +
                              (info.needs.of(results::snapshot_output).n_rows + (n_processes > 1 ? 1 : 0)) *
                                  sent_bytes_per_node * n_nodes;
  const double own_s = own_columns * column_s;
  const double event_s = own_s + halo_columns * column_s + passed_bytes * s_per_byte;
  shared.efficiency = own_s / event_s;
  shared.expected_s = event_s + expected_rest_s(info) + expected_statics_s(info);

  const auto size = size_of(meshes, info);
  shared.root_memory_bytes = needs(problem, size, {n_processes, 1, true}).memory_bytes();
  shared.memory_bytes = needs(problem, size, {n_processes, 1, false}).memory_bytes();
  return shared;
}

}  // namespace

Info info(const Problem& problem, const std::optional<int>& n_processes) {
  Info info;
  info.speeds = solid::wave_speeds(problem.above().material);
  const bool is_by_interface = n_processes && root_has_interface_only(problem, *n_processes);
  if (!is_by_interface) require_memory_fits(problem);
  const auto meshes = is_by_interface ? setup::check_interfaces(problem) : setup::check(problem);
  add_sizes(problem, meshes, info);
  std::optional<setup::LoadedState> loaded;
  std::string not_loaded;
  try {
    loaded = setup::loaded_state(problem, meshes);
  } catch (const UserError& error) {
    if (!problem.is_slow()) throw;
    not_loaded = no_static_state(error);
  }
  if (loaded) {
    info.loads = loaded->loads;
    info.rupture = rupture_outlook(problem, loaded->subcritical, mesh::tributary_lengths_m(meshes.plate));
  } else {
    info.rupture = rupture_outlook(problem, meshes);
  }
  info.cheapest_mesh = cheapest_mesh(problem, info.rupture);

  // About as long as making the stepper.
  auto sliding = std::async(std::launch::async | std::launch::deferred,
                            [&] { return add_well_posedness(problem, meshes.plate, info); });
  setup::IsolatedSubdomain part;
  const auto timed =
      is_by_interface ? part_to_time(problem, meshes, *n_processes, part) : whole_to_time(problem, meshes);
  const auto notes_on_sliding = sliding.get();
  add_steps(timed, info);
  const double node_updates_per_step = timed.stepper->node_updates_per_step();
  add_needs(problem, meshes, node_updates_per_step / timed.share, info);
  // As many at once as between two looks.
  const double steps = static_cast<double>(info.n_steps) / looks_of(problem, info.needs);
  if (problem.is_plain()) {
    const auto plain = setup::new_plain_stepper(problem, meshes.plate, meshes.base);
    info.node_updates_per_s = measured_rate_per_s(problem, timed, *plain, 1);
  } else {
    info.node_updates_per_s =
        measured_rate_per_s(problem, timed, *timed.stepper, std::max(1, static_cast<int>(steps)));
  }
  info.expected_s = info.node_updates / info.node_updates_per_s + expected_statics_s(info) +
                    expected_rest_s(info) + expected_slow_s(info);
  info.notes = notes_of_case(problem, info.rupture, info.step_s);
  if (!not_loaded.empty()) info.notes.add(Diagnostic::physics, "{}", not_loaded);
  info.notes.add(notes_on_sliding);
  if (n_processes) info.shared = shared_by(problem, meshes, timed, *n_processes, info);
  return info;
}

}  // namespace slipfront::advice
