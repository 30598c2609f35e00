// SPDX-License-Identifier: BSD-3-Clause
#include "advice/needs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

#include "base/error.hpp"
#include "interface/friction.hpp"
#include "mesh/plate.hpp"
#include "motion/every.hpp"
#include "motion/step_plan.hpp"
#include "record/energies.hpp"
#include "record/sequence.hpp"
#include "setup/initial_state.hpp"
#include "setup/outputs.hpp"
#include "solid/operator.hpp"
#include "stability/rupture.hpp"
#include "statics/plate_solver.hpp"
#include "statics/statics.hpp"

namespace slipfront::advice {

namespace {

constexpr double number = sizeof(double);

// Bytes at the peak, measured over runs of 5e3 to 8e6 nodes; those of whole runs were within 20 %.

/// The program and its libraries.
constexpr double program_bytes = 18e6;
/// Bytes of a node of bodies whose motion is made: mesh, state before the event, mass and motion. In small
/// meshes four fields more, with which the largest frequency is found.
constexpr double in_motion = 135, in_motion_of_few = 180;
/// Bytes of a node by the plain scheme, and in its checkpoints: stiffnesses of cells, fields of two levels.
constexpr double in_plain_motion = 1000, in_plain_checkpoint = 210;
constexpr double state_before = 32;  ///< of these u before and its change with the shear
constexpr double in_ramp = 128;      ///< of a node under a ramp, besides: four states
/// Bytes of an unknown: what each solver takes, the equilibria included.
constexpr double by_multigrid = 112;
/// Bytes of an unknown: its place in the factor by nested dissection, times log2 of their number, and
/// indices.
constexpr double of_factor = 54, of_indices = 45;
/// Bytes of a pair of displacements of the interface: the dense end of the factor, fronts, equations of
/// contact.
constexpr double of_dense_pair = 56;
/// Bytes of an interface node: its state; of what is recorded of it five changes of contact, each with its
/// time and place, and two tractions at all nodes around it as far as l*; and slip behind the tip as it
/// passes.
constexpr double of_interface = 620, changes = 5, of_change = 32, of_node_around = 16, of_tip_slip = 620;
/// What rank 0 of several has beside its part, of each node of the bodies: the mesh.
constexpr double mesh_of_root = 32;
/// Bytes of a cell of a relief, for a rank 0 that has no more of the bodies than these and the interface.
constexpr double in_relief = 1600;

// Bytes on disk of a node.
constexpr double in_checkpoint = 33;  ///< u and what moves it, 32
constexpr double checkpoints = 3;     ///< two, and one that is written
constexpr double in_text = 20;        ///< of a number

// Seconds, of a processor of 2023 with two threads, measured over 2e4 to 5e7 unknowns.
constexpr double s_of_large_fronts = 1.6e-9;  ///< times n^1.5
constexpr double s_by_factor = 2.8e-6;        ///< times n
constexpr double s_by_multigrid = 1.1e-6,
                 s_by_multigrid_of_many = 2e-6;  ///< times n, in caches or beyond them
constexpr double many_for_caches = 3e6;

/// A machine takes some 1e5 steps of the smallest plate in a second: these are four months.
constexpr double max_steps = 1e12;

std::int64_t countable(double steps, const Message& what, const Message& remedy) {
  if (!(steps <= max_steps)) throw UserError("{} takes {:g} steps; choose {}", what, steps, remedy);
  return static_cast<std::int64_t>(steps);
}

/// The plate in the smallest squares that make at most 100 columns and fit, without coarsenings; a fillet,
/// which may not fit, becomes a right angle. Its statics take a few hundredths of a second.
/// @throws UserError where none fit
mesh::Mesh coarse_mesh(mesh::Plate plate) {
  const double columns = std::round(plate.width_m / plate.element_size_m);
  const double rows = std::round(plate.height_m / plate.element_size_m);
  double factor = std::max(1.0, std::ceil(columns / 100));
  const auto fits = [&] { return std::fmod(columns, factor) == 0 && std::fmod(rows, factor) == 0; };
  while (!fits() && columns / factor >= 30) ++factor;
  if (!fits()) throw UserError("no coarse mesh fits");
  plate.element_size_m *= factor;
  plate.coarsenings = 0;
  if (plate.corner == mesh::Corner::fillet) plate.corner = mesh::Corner::none;
  return mesh::make_plate(plate);
}

/// Shear at which t/p inside reaches mu_s: of the statics of a coarse mesh, or where there are none, or a
/// base, of uniform compression and shear, which is up to half too much.
double critical_shear_m(const Problem& problem) {
  const double mu_s = interface::static_coefficient(problem.friction.law);
  double compliance_m_per_Pa =
      problem.above().plate.height_m / solid::shear_modulus_Pa(problem.above().material);
  try {
    if (!problem.has_below())
      return statics::Statics(coarse_mesh(problem.above().plate), problem.above().material, problem.loading,
                              mu_s)
          .shear_to(1)
          .shear_m;
    compliance_m_per_Pa += problem.below().plate.height_m / solid::shear_modulus_Pa(problem.below().material);
  } catch (const UserError&) {  // nothing coarse fits, or its edges give way first
  }
  return mu_s * nominal_pressure_Pa(problem) * compliance_m_per_Pa;
}

double record_bytes(const Problem& problem, double n_interface) {
  const double halo = std::ceil(problem.fronts.l_star_m / problem.element_size_m()) + 1;
  return n_interface * (changes * (of_change + of_node_around * (2 * halo + 1)) + of_tip_slip);
}

/// What the ranks here know of the bodies that others move, and how many nodes those here move.
struct Shares {
  double of_all = 1;          ///< of the ranks
  double n_moving = 0;        ///< nodes, those of halos counted by each
  bool by_interface = false;  ///< see root_has_interface_only
  bool has_root = false;      ///< of several
};

Shares shares_of(const Problem& problem, const Size& size, const Holder& holder) {
  Shares s;
  s.n_moving = size.n_nodes;
  if (holder.n_processes == 1) return s;
  s.of_all = static_cast<double>(holder.n_here) / holder.n_processes;
  const double halo_columns = 2.0 * (problem.time.interface_substeps + 2);
  s.n_moving *= s.of_all + std::min(1.0, halo_columns / size.n_interface) * holder.n_here;
  s.by_interface = root_has_interface_only(problem, holder.n_processes);
  s.has_root = holder.has_root;
  return s;
}

double bytes_of_node(double of_all_nodes) {
  return of_all_nodes < solid::many_nodes ? in_motion_of_few : in_motion;
}

double motion_bytes_of(const Problem& problem, const Size& size, const Shares& s) {
  double bytes = s.n_moving * (problem.is_plain() ? in_plain_motion : bytes_of_node(size.n_nodes));
  if (s.by_interface) bytes -= state_before * s.n_moving;  // there is none
  if (s.has_root && !s.by_interface) bytes += size.n_nodes * (mesh_of_root + state_before);
  const auto& plate = problem.above().plate;
  if (s.has_root && s.by_interface && plate.corner == mesh::Corner::relief)
    bytes += 2 * in_relief * plate.relief_length_m * plate.relief_depth_m / std::pow(plate.element_size_m, 2);
  return bytes;
}

double statics_bytes_of(const Problem& problem, const Size& size, const Holder& holder) {
  if (problem.is_prestressed() || !holder.has_root) return 0;
  const double n = 2 * size.n_nodes, n_base = 2 * size.n_base_nodes;
  const auto solver = statics::choose_solver(setup::wanted_solver(problem), n);
  if (solver != statics::StaticSolver::direct) return statics_bytes(solver, n, size.n_interface);
  double bytes = statics_bytes(solver, n - n_base, size.n_interface);
  if (problem.loading.top_during_tilt == statics::TopEdge::free) bytes *= 2;  // with a separate factor
  return bytes + (n_base > 0 ? statics_bytes(solver, n_base, size.n_interface) : 0);
}

/// @param energy_rows  in memory until the end
Budget memory(const Problem& problem, const Size& size, const Holder& holder, double energy_rows) {
  const auto shares = shares_of(problem, size, holder);
  const bool is_direct = statics::choose_solver(setup::wanted_solver(problem), 2 * size.n_nodes) ==
                         statics::StaticSolver::direct;
  const BudgetItem statics = {"the statics", statics_bytes_of(problem, size, holder),
                              is_direct
                                  ? Message("{} = iterative or {}", Key("loading.solver"), larger_elements())
                                  : larger_elements()};
  const bool is_ramp = problem.loading.method == statics::LoadingMethod::ramp;
  const double copies = 2;  // of the record, one in the order of time
  // Each of several ranks observes the whole interface beside its own part.
  const double of_ranks = shares.of_all + (holder.n_processes > 1 ? holder.n_here : 0);
  const double interface =
      of_ranks * (of_interface * size.n_interface + copies * record_bytes(problem, size.n_interface));
  Budget event = {
      {fmt::format("the motion of {:.4g} nodes", size.n_nodes),
       motion_bytes_of(problem, size, shares) + (is_ramp ? in_ramp * size.n_nodes : 0), larger_elements()},
      {"the interface and the record of its slip", interface, larger_elements()},
      {"the rows of energies", holder.n_here * energy_rows * sizeof(record::Energies),
       Message("a larger {}", Key("output.energy_interval_s"))}};
  if (is_ramp) event.push_back(statics);
  Budget most = statics.bytes > total_bytes(event) ? Budget{statics} : event;
  most.push_back({"the program", holder.n_here * program_bytes, larger_elements()});
  return most;
}

/// Steps of slow slip: as long as the direct effect, a p/V, allows against the stiffness of the shortest
/// wave, so that they follow from the slip, and those in which rates and states change.
double slow_steps_of(const Problem& problem) {
  constexpr double of_pair = 2.5;     // the stable step of the orders 3 and 2, times the fastest decay
  constexpr double of_changes = 2e3;  // of an event
  const auto path = problem.path();
  double compliance_m_per_Pa =
      problem.above().plate.height_m / solid::shear_modulus_Pa(problem.above().material) +
      problem.width_m() / (problem.above().machine.shear_stiffness_Pa_per_m *
                           problem.above().machine.moved_length_m(problem.width_m()));
  if (problem.has_below())
    compliance_m_per_Pa += problem.below().plate.height_m / solid::shear_modulus_Pa(problem.below().material);
  const double p_Pa = nominal_pressure_Pa(problem);
  const double slip_m = std::isfinite(path.end_s()) ? path.shear_m(path.end_s())
                                                    : interface::static_coefficient(problem.friction.law) *
                                                          p_Pa * compliance_m_per_Pa;
  // Stiffness against waves of two elements.
  const double stiffness_Pa_per_m =
      0.5 * std::numbers::pi * stability::modulus_Pa(materials_of(problem)) / problem.element_size_m();
  return of_changes +
         slip_m * stiffness_Pa_per_m / (of_pair * interface::direct_effect(problem.friction.law) * p_Pa);
}

/// The existing folder in which `folder` is or will be made.
std::filesystem::path existing_parent(const std::filesystem::path& folder) {
  std::error_code ignored;
  auto path = std::filesystem::absolute(folder, ignored);
  while (!std::filesystem::exists(path, ignored) && path.has_relative_path()) path = path.parent_path();
  return path;
}

void require_disk(const Needs& needs, const std::filesystem::path& folder) {
  std::error_code error;
  const auto space = std::filesystem::space(existing_parent(folder), error);
  if (error) return;
  const auto available = static_cast<double>(space.available);
  require_room(needs.disk(), available, "the run", "on disk",
               fmt::format("{} has {:.3g} GB free", folder.string(), available * 1e-9), " or another folder");
}

/// Nodes of a body, from its measures alone.
double approximate_nodes(const mesh::Plate& plate) {
  double nodes = 0, h = plate.element_size_m, height_m = plate.fine_height_m, rest_m = plate.height_m;
  for (int k = 0; k <= std::max(0, plate.coarsenings) && rest_m > 0; ++k) {
    const double of_block_m = k == plate.coarsenings ? rest_m : std::min(height_m, rest_m);
    nodes += (plate.width_m / h + 1) * (of_block_m / h + 1);
    rest_m -= of_block_m;
    height_m = plate.height_m - rest_m;  // a block is as high as everything below it
    h *= 2;
  }
  return nodes;
}

/// The ranks of this machine, rank 0 among them.
Holder this_machine(const Processes& processes) {
  return {processes.size(), processes.on_this_machine(), true};
}

void require_memory_for(const Budget& memory, const Size& size, const Processes& processes) {
  require_memory(memory, fmt::format("the run with {:.4g} nodes", size.n_nodes),
                 processes.size() > 1 ? ", or more machines" : "");
}

/// Nodes of a body that is held as a whole are numbered by one process.
void require_numbers(const Problem& problem, int n_processes) {
  if (!can_be_held_in_parts(problem) || root_has_interface_only(problem, n_processes)) return;
  constexpr double max_nodes = std::numeric_limits<mesh::Node>::max();
  const double h = problem.element_size_m();
  const double height_m =
      std::max(problem.above().plate.height_m, problem.has_below() ? problem.below().plate.height_m : 0);
  const double n_nodes = (problem.width_m() / h + 1) * (height_m / h + 1);
  if (n_nodes > max_nodes)
    throw UserError("{} is {} m; that makes {:.3g} nodes, more than the {:.3g} that one rank can number{}",
                    Key("plate.element_size_m"), h, n_nodes, max_nodes,
                    root_has_interface_only(problem, 2) ? "; use more ranks, or choose a larger one"
                                                        : "; choose a larger one")
        .about("plate.width_m", "plate.height_m");
}

}  // namespace

Size mesh_size(const Problem& problem) {
  Size size;
  for (const auto& body : problem.bodies) size.n_nodes += approximate_nodes(body.plate);
  if (problem.has_below()) size.n_base_nodes = approximate_nodes(problem.below().plate);
  size.n_interface = problem.width_m() / problem.element_size_m() + 1;
  return size;
}

Size estimated_size(const Problem& problem) {
  Size size = mesh_size(problem);
  std::vector<motion::BodySteps> steps;  // corners and coarser blocks change them little, or shorten them
  for (const auto& [plate, material, machine] : problem.bodies)
    steps.push_back(
        {solid::stable_step_s(solid::frequency_of_squares_rad_per_s(plate.element_size_m, material),
                              material.stiffness_damping_s),
         {1}});
  size.step_s = motion::step_plan(steps, problem.time).lowest_step_s;
  return size;
}

double motion_bytes(double n_nodes) {
  return n_nodes * bytes_of_node(n_nodes);
}

double statics_bytes(statics::StaticSolver solver, double n, double n_interface) {
  if (solver == statics::StaticSolver::iterative) return n * by_multigrid;
  return n * (of_factor * std::log2(std::max(n, 2.0)) + of_indices) +
         of_dense_pair * std::pow(2 * n_interface, 2);
}

double statics_s(statics::StaticSolver solver, double n) {
  if (solver == statics::StaticSolver::direct) return s_of_large_fronts * std::pow(n, 1.5) + s_by_factor * n;
  return n * (n < many_for_caches ? s_by_multigrid : s_by_multigrid_of_many);
}

Needs needs(const Problem& problem, const Size& size, const Holder& holder) {
  const double end_s = problem.time.end_s;
  Needs n;
  n.steps = countable(motion::steps_to(end_s, size.step_s), Message("{} = {:g}", Key("time.end_s"), end_s),
                      "an earlier end");
  if (problem.loading.method == statics::LoadingMethod::ramp)
    n.ramp_steps =
        countable(std::ceil(critical_shear_m(problem) / (problem.shear_speed_m_per_s * size.step_s)),
                  Message("the ramp with {} = {:g} m/s", Key("loading.shear_speed_m_per_s"),
                          problem.loading.shear_speed_m_per_s),
                  Message("a higher speed, or {} = direct", Key("loading.method")));
  const auto setup = setup::output_setup(problem, size.step_s, size.n_interface, size.n_nodes);
  for (std::size_t k = 0; k < n.of_outputs.size(); ++k)
    n.of_outputs[k] = results::outputs[k]->forecast(setup);
  const double energy_rows = rows_at(setup, problem.output.energy_interval_s) + 1;

  n.memory = memory(problem, size, holder, energy_rows);
  n.statics_bytes = statics_bytes_of(problem, size, holder);

  if (problem.is_slow()) {
    n.slow_steps = slow_steps_of(problem);
    // With those in which rates and states change then.
    const double most_rows = 2.0 * record::all_slow_rows;
    const auto& history = n.of(results::history_output);
    n.slow_bytes =
        std::min(n.slow_steps / record::steps_per_slow_row, most_rows) * history.bytes / history.n_rows;
  }
  const double in_one = problem.is_plain() ? in_plain_checkpoint : in_checkpoint;
  n.checkpoint_bytes = checkpoints * (in_one * size.n_nodes + record_bytes(problem, size.n_interface));
  n.energy_bytes = energy_rows * in_text * sizeof(record::Energies) / number;
  return n;
}

const results::Forecast& Needs::of(const results::Output& output) const {
  return of_outputs[static_cast<std::size_t>(std::ranges::find(results::outputs, &output) -
                                             results::outputs.begin())];
}

Budget Needs::disk() const {
  Budget budget = {{"slow slip", slow_bytes, larger_elements()},
                   {"checkpoints", checkpoint_bytes, larger_elements()},
                   {"energy.csv", energy_bytes, Message("a larger {}", Key("output.energy_interval_s"))}};
  for (std::size_t k = 0; k < of_outputs.size(); ++k)
    budget.push_back({results::outputs[k]->name, of_outputs[k].bytes, results::outputs[k]->remedy()});
  return budget;
}

void require_memory_fits(const Problem& problem, const Processes& processes) {
  require_numbers(problem, processes.size());
  const auto size = mesh_size(problem);
  require_memory_for(memory(problem, size, this_machine(processes), 0), size, processes);
}

void require_fit(const Problem& problem, const std::filesystem::path& folder, const Processes& processes) {
  require_numbers(problem, processes.size());
  const auto size = estimated_size(problem);
  const Needs n = needs(problem, size, this_machine(processes));
  require_memory_for(n.memory, size, processes);
  require_disk(n, folder);
}

}  // namespace slipfront::advice
