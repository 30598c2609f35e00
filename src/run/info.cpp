// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "base/clock.hpp"
#include "fronts/fit.hpp"
#include "input/friction_along_x.hpp"
#include "mesh/part.hpp"
#include "motion/stepper.hpp"
#include "run/choices.hpp"
#include "run/parts.hpp"
#include "run/run.hpp"
#include "statics/plate_solver.hpp"
#include "statics/prestress.hpp"

namespace slipfront::run {

namespace {

double mean_pressure_Pa(const input::Case& config, const mesh::Mesh& mesh) {
  if (!is_prestressed(config)) return nominal_pressure_Pa(config);
  const auto p = prescribed_tractions(config.prestress, mesh).p_s_Pa;
  return std::accumulate(p.begin(), p.end(), 0.0) / static_cast<double>(p.size());
}

/// Nodes where one of the three numbers by which friction enters the growth of waves is least or largest.
std::set<std::size_t> extreme_nodes(const std::vector<interface::FrictionLaw>& laws, double pressure_Pa,
                                    const interface::Regularisation& regularisation) {
  std::vector<stability::Sliding> sliding;
  for (const auto& law : laws)
    sliding.push_back(stability::uniform_sliding(law, 0, pressure_Pa, regularisation));
  std::set<std::size_t> nodes;
  for (const auto member :
       {&stability::Sliding::mu, &stability::Sliding::slope_s_per_m, &stability::Sliding::slip_slope_per_m}) {
    for (const auto at :
         {std::ranges::min_element(sliding, {}, member), std::ranges::max_element(sliding, {}, member)})
      nodes.insert(static_cast<std::size_t>(at - sliding.begin()));
  }
  return nodes;
}

/// Of two verdicts the one with faster growth; where neither has a bound, by how far weakening is beyond it.
bool is_worse(const stability::WellPosedness& a, const stability::WellPosedness& b) {
  return std::pair(a.fastest_growth_per_s, a.weakening_over_radiation) >
         std::pair(b.fastest_growth_per_s, b.weakening_over_radiation);
}

void add_well_posedness(const input::Case& config, const mesh::Mesh& mesh, Info& info) {
  const double pressure_Pa = mean_pressure_Pa(config, mesh);
  const auto of = [&](const interface::FrictionLaw& law) {
    return stability::well_posedness(bodies_of(config), law, pressure_Pa, config.plate.element_size_m,
                                     config.plate.width_m, config.regularisation);
  };
  const auto x_m = interface_x_m(mesh);
  const auto laws = input::friction_at(config, x_m);
  if (laws.empty()) {
    info.well_posedness = of(config.friction);
    return;
  }
  for (const auto node : extreme_nodes(laws, pressure_Pa, config.regularisation)) {
    const auto here = of(laws[node]);
    if (!std::isnan(info.well_posedness_x_m) && !is_worse(here, info.well_posedness)) continue;
    info.well_posedness = here;
    info.well_posedness_x_m = x_m[node];
  }
}

/// Bodies whose steps are timed: the whole ones, or some columns of them.
struct Timed {
  std::unique_ptr<motion::Stepper> stepper;
  const mesh::Mesh* plate = nullptr;
  const mesh::Mesh* base = nullptr;
  int first_column = 0;
  double share = 1;  ///< of the whole
};

void add_sizes(const input::Case& config, const Meshes& meshes, Info& info) {
  info.n_nodes = n_nodes_of(meshes.plate);
  info.n_cells = n_cells_of(meshes.plate);
  info.n_interface = std::ssize(meshes.plate.lower);
  if (!meshes.base) return;
  info.base_speeds = wave_speeds(input::base_material(config));
  info.generalised_rayleigh_speed_m_per_s =
      stability::generalised_rayleigh_speed_m_per_s(config.material, input::base_material(config));
  info.n_nodes += n_nodes_of(*meshes.base);
  info.n_cells += n_cells_of(*meshes.base);
}

void add_steps(const Timed& timed, Info& info) {
  const auto& stepper = *timed.stepper;
  if (timed.share == 1) info.n_irregular = 0;
  for (const auto& body : stepper.bodies()) {
    if (info.n_irregular)
      *info.n_irregular +=
          static_cast<std::int64_t>(body.op().whole.irregular.size() + body.op().whole.general.size());
    info.substeps_of_bodies.push_back(body.period());
  }
  info.stable_step_s = stepper.stable_step_s();
  info.step_s = stepper.step_s();
  info.substep_s = stepper.substep_s();
}

double n_unknowns_of(const Info& info) {
  return 2.0 * static_cast<double>(info.n_nodes);
}

Size size_of(const Meshes& meshes, const Info& info) {
  return {static_cast<double>(info.n_nodes), static_cast<double>(info.n_cells),
          static_cast<double>(info.n_interface), info.step_s,
          meshes.base ? static_cast<double>(n_nodes_of(*meshes.base)) : 0};
}

void add_needs(const input::Case& config, const Meshes& meshes, double node_updates_per_step, Info& info) {
  info.needs = needs(config, size_of(meshes, info));
  info.n_steps = info.needs.steps;
  info.node_updates = static_cast<double>(info.n_steps) * node_updates_per_step +
                      static_cast<double>(info.needs.ramp_steps) * static_cast<double>(info.n_nodes);
  info.memory_bytes = info.needs.memory_bytes();
  info.solver_bytes = info.needs.statics_bytes;
  if (!is_prestressed(config))
    info.solver = statics::choose_solver(wanted_solver(config), n_unknowns_of(info));
}

constexpr double steps_per_look = 50, steps_per_check = 100;  // of motion::EventRun, motion::Watch

/// Times at which an event is looked at: every so many steps, and for energies and snapshots.
double commands_of(const Needs& needs) {
  const auto steps = static_cast<double>(needs.steps);
  return std::min(steps, steps / steps_per_look + needs.energy_rows + needs.snapshots);
}

/// Steps between two of them, at least 1.
int steps_of_command(const Needs& needs) {
  return std::max(1, static_cast<int>(static_cast<double>(needs.steps) / commands_of(needs)));
}

struct MeasuredSteps {
  double step_s = 0;
  /// Of the time of a step, what goes with the interface, before other rows.
  double interface_share = 0;
};

/// A few steps give this machine's rate: under the mean pressure, with half of the interface sliding, which
/// takes longer than to stick.
/// @param n_steps  of a command
/// @param at_once  that no exchange interrupts
MeasuredSteps measure_steps(const input::Case& config, const Timed& timed, std::int64_t n_steps,
                            std::int64_t at_once) {
  constexpr double least_s = 20e-3, most_s = 0.5;
  const double mu_s = interface::static_coefficient(config.friction);
  auto& stepper = *timed.stepper;
  const auto& plate = *timed.plate;
  const auto n = plate.lower.size();
  record::StaticState tractions;
  tractions.x_m = interface_x_m(plate);
  tractions.p_s_Pa.assign(n, mean_pressure_Pa(config, plate));
  tractions.t_s_Pa.assign(n, 0.0);
  for (std::size_t k = 0; k < n / 2; ++k) tractions.t_s_Pa[k] = 1.1 * mu_s * tractions.p_s_Pa[k];
  const auto state = statics::prestressed(plate, tractions, timed.base);
  stepper.start(state, 0, {tractions.t_s_Pa, tractions.p_s_Pa});
  motion::Recorder recorder(state, mu_s, 0);
  std::vector<double> times_s, shares;
  const auto start = Clock::now();
  double spent_s = 0;
  do {
    const auto begin = Clock::now();
    for (std::int64_t done = 0; done < n_steps; done += at_once)
      stepper.advance(recorder, std::min(at_once, n_steps - done), {});
    times_s.push_back(seconds_since(begin) / static_cast<double>(n_steps));
    double with_interface_s = 0;
    const auto one = Clock::now();
    motion::AtBands at_bands;
    at_bands.after_last = [&](int band) {
      if (band == 0) with_interface_s = seconds_since(one);
    };
    stepper.advance(recorder, 1, {}, at_bands);
    shares.push_back(with_interface_s / seconds_since(one));
    spent_s = seconds_since(start);
  } while (spent_s < least_s || (times_s.size() < 3 && spent_s < most_s));
  return {fronts::median(times_s), fronts::median(shares)};
}

/// Of the factorisation n^1.5 operations are those of large fronts, the rest of its assembly and small ones;
/// rates measured with two threads over 2e4 to 8e5 unknowns. By PETSc of one process.
double expected_statics_s(const Info& info) {
  const double n = n_unknowns_of(info);
  if (info.solver == statics::StaticSolver::direct) return 1.6e-9 * std::pow(n, 1.5) + 2.8e-6 * n;
  if (info.solver == statics::StaticSolver::petsc) return 3e-5 * n;
  return info.solver == statics::StaticSolver::iterative ? 1e-6 * n : 0;
}

Timed whole_to_time(const input::Case& config, const Meshes& meshes) {
  Timed timed;
  timed.stepper = new_stepper(config, meshes.plate, meshes.base);
  timed.plate = &meshes.plate;
  timed.base = meshes.base ? &*meshes.base : nullptr;
  return timed;
}

/// The columns of a part, no more than show the rate.
Timed part_to_time(const input::Case& config, const Meshes& interfaces, int n_processes, LonePart& part) {
  constexpr double most_nodes = 4e6;
  constexpr int least_columns = 64;
  const WholeBodies whole(config, interfaces.plate, interfaces.base);
  const auto steps = whole.steps();
  const auto division = whole.divided(n_processes, steps);
  const auto own = division.own(n_processes / 2);
  double per_column = 0;
  for (const auto& body : whole.bodies()) per_column += body.mesh.grid.rows + 1;
  const int most = std::max(least_columns, static_cast<int>(most_nodes / per_column));
  const int width = std::min(own.end - own.begin, most);
  part = make_lone_part(config, interfaces.plate, steps, {own.begin, own.begin + width});
  Timed timed;
  timed.stepper = std::move(part.stepper);
  timed.plate = &part.plate;
  timed.base = part.base ? &*part.base : nullptr;
  timed.first_column = own.begin;
  timed.share = static_cast<double>(width) / division.first.back();
  return timed;
}

Info::Shared shared_by(const input::Case& config, const Meshes& meshes, const Timed& timed,
                       const Sharing& sharing, const Info& info) {
  auto& stepper = *timed.stepper;
  const WholeBodies whole(config, meshes.plate, meshes.base);
  const auto bodies = whole.bodies();
  std::vector<motion::BodySteps> steps;
  for (const auto& body : stepper.bodies()) steps.push_back(body.steps());
  const int n_columns = meshes.plate.grid.stride();
  Info::Shared shared;
  shared.division = whole.divided(sharing.n_processes, steps);
  SharedWork work;
  work.n_nodes = static_cast<double>(info.n_nodes);
  work.n_cells = static_cast<double>(info.n_cells);
  work.n_columns = n_columns;
  work.node_updates_per_step = stepper.node_updates_per_step() / timed.share;
  const int n_steps = steps_of_command(info.needs);
  const int at_once = sharing.n_processes > 1 ? shared.division.steps_per_exchange : n_steps;
  const auto measured = measure_steps(config, timed, n_steps, at_once);
  work.node_updates_per_s = stepper.node_updates_per_step() / measured.step_s;
  work.interface_share = measured.interface_share;
  // Coarser blocks have nodes in some columns only, in the same ones of so many.
  int period = 1;
  for (const auto& body : bodies)
    if (const auto n = body.mesh.coarser.size(); n > 0) period = std::max(period, 2 << n);
  const int first = timed.share < 1 ? timed.first_column : n_columns / 2 / period * period;
  std::vector<solid::Span> with_interface;
  for (std::size_t b = 0; b < stepper.bodies().size(); ++b)
    with_interface.push_back({0, stepper.rows_moved(b, 0)});
  const solid::Span columns = {first, first + period};
  const auto add_to = [period](double& bytes_per_column) {
    return [&bytes_per_column, period](const auto* values, std::size_t n) {
      bytes_per_column += static_cast<double>(n * sizeof(*values)) / period;
    };
  };
  stepper.visit_columns(columns, add_to(work.bytes_per_column));
  stepper.visit_columns(columns, with_interface, true, add_to(work.interface_bytes_per_column));
  work.steps = static_cast<double>(info.n_steps);
  work.advances = commands_of(info.needs);
  work.energies = std::max(info.needs.energy_rows, work.steps / steps_per_check);
  work.history_rows = info.needs.history_rows;
  work.values_per_row = static_cast<double>(record::history_fields.size()) * n_columns;
  work.snapshots = info.needs.snapshots;
  work.leads_by_interface = leads_by_interface(config, sharing.n_processes);
  work.corner_bytes = corner_bytes(config);
  work.keeps_displacements = keeps_displacements(config, sharing.n_processes);
  work.statics_s = expected_statics_s(info);
  work.statics_bytes = info.solver_bytes;
  if (info.solver == statics::StaticSolver::petsc) {
    work.statics_s /= std::min(sharing.n_processes, sharing.n_processors);
    auto size = size_of(meshes, info);
    size.statics_share = 1.0 / sharing.n_processes;
    size.keeps_displacements = work.keeps_displacements;
    size.leads_by_interface = work.leads_by_interface;
    work.statics_bytes = statics_bytes(config, size);
    work.shared_statics_bytes = info.solver_bytes / sharing.n_processes;
  }
  work.precision = config.time.precision;
  work.bytes_per_interface_node = bytes_per_interface_node(config);
  work.program_bytes = program_bytes();
  work.recorded_bytes = info.needs.recorded_bytes;
  shared.cost = process_cost(work, shared.division, sharing.n_processors, sharing.network);
  return shared;
}

}  // namespace

Info info(const input::Case& config, const std::optional<Sharing>& sharing) {
  Info info;
  info.speeds = wave_speeds(config.material);
  const bool is_by_interface = sharing && leads_by_interface(config, sharing->n_processes);
  const auto meshes = is_by_interface ? check_interfaces(config) : check(config);
  add_sizes(config, meshes, info);
  info.rupture = rupture_outlook(config, meshes);

  // About as long as making the stepper.
  auto sliding = std::async(std::launch::async | std::launch::deferred,
                            [&] { add_well_posedness(config, meshes.plate, info); });
  LonePart part;
  const auto timed = is_by_interface ? part_to_time(config, meshes, sharing->n_processes, part)
                                     : whole_to_time(config, meshes);
  sliding.get();
  add_steps(timed, info);
  const double node_updates_per_step = timed.stepper->node_updates_per_step();
  add_needs(config, meshes, node_updates_per_step / timed.share, info);
  const int n_steps = steps_of_command(info.needs);
  info.node_updates_per_s = node_updates_per_step / measure_steps(config, timed, n_steps, n_steps).step_s;
  info.expected_s = info.node_updates / info.node_updates_per_s + expected_statics_s(info);
  if (sharing) info.shared = shared_by(config, meshes, timed, *sharing, info);
  if (sharing && sharing->n_processes > 1) info.needs.checkpoint_bytes *= shared_checkpoint_bytes;
  return info;
}

}  // namespace slipfront::run
