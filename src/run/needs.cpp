// SPDX-License-Identifier: BSD-3-Clause
#include "run/needs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include "base/error.hpp"
#include "interface/friction.hpp"
#include "mesh/plate.hpp"
#include "motion/event.hpp"
#include "results/snapshots.hpp"
#include "results/stream.hpp"
#include "run/choices.hpp"
#include "run/process_cost.hpp"
#include "run/snapshot_mesh.hpp"
#include "solid/operator.hpp"
#include "stability/verdict.hpp"
#include "statics/petsc_equations.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::run {

namespace {

constexpr double number = sizeof(double);

/// Columns of a mesh whose statics take a few hundredths of a second, and show the state of the interface.
constexpr double most_columns = 100, least_columns = 30;

/// A machine takes some 1e5 steps of the smallest plate in a second: these are four months.
constexpr double most_steps = 1e12;

std::int64_t countable(double steps, const Message& what, const Message& remedy) {
  if (!(steps <= most_steps)) throw UserError("{} takes {:g} steps; choose {}", what, steps, remedy);
  return static_cast<std::int64_t>(steps);
}

/// The plate in the smallest squares that make few columns, without coarsenings. A fillet, which may not fit,
/// becomes a right angle.
/// @throws UserError where the plate's sides are no multiples of such squares.
mesh::Plate coarse_plate(mesh::Plate plate) {
  const double columns = std::round(plate.width_m / plate.element_size_m);
  const double rows = std::round(plate.height_m / plate.element_size_m);
  double factor = std::max(1.0, std::ceil(columns / most_columns));
  const auto fits = [&] { return std::fmod(columns, factor) == 0 && std::fmod(rows, factor) == 0; };
  while (!fits() && columns / factor >= least_columns) ++factor;
  if (!fits()) throw UserError("no coarse mesh fits");
  plate.element_size_m *= factor;
  plate.coarsenings = 0;
  if (plate.corner == mesh::Corner::fillet) plate.corner = mesh::Corner::none;
  return plate;
}

/// Shear at which t/p inside reaches mu_s, from the statics of a coarse mesh.
double estimated_critical_shear_m(const input::Case& config) {
  const double mu_s = interface::static_coefficient(config.friction);
  // Of uniform compression and shear.
  const auto uniform_shear_m = [&] {
    double compliance_m_per_Pa = config.plate.height_m / solid::shear_modulus_Pa(config.material);
    if (input::has_base_body(config))
      compliance_m_per_Pa += config.base.plate.height_m / solid::shear_modulus_Pa(config.base.material);
    return mu_s * nominal_pressure_Pa(config) * compliance_m_per_Pa;
  };
  if (input::has_base_body(config)) return uniform_shear_m();
  try {
    const auto mesh = mesh::make_plate(coarse_plate(config.plate));
    return statics::Statics(mesh, config.material, config.loading, mu_s).shear_to(1).shear_m;
  } catch (const UserError&) {
    return uniform_shear_m();  // no coarse mesh fits, or its edges give way first
  }
}

double interface_bytes(const input::Case& config, const Size& size) {
  return size.n_interface * bytes_per_interface_node(config);
}

double rows_of(double end_s, double interval_s, double step_s) {
  return std::floor(end_s / std::max(interval_s, step_s)) + 1;
}

/// The existing folder in which `folder` is or will be made.
std::filesystem::path existing_parent(const std::filesystem::path& folder) {
  std::error_code ignored;
  auto path = std::filesystem::absolute(folder, ignored);
  while (!std::filesystem::exists(path, ignored) && path.has_relative_path()) path = path.parent_path();
  return path;
}

/// Of a node while several processes keep a checkpoint: what each keeps, and the message with it.
constexpr double kept_node_bytes = 2 * kept_bytes_per_node;

/// glibc keeps up to two freed arrays as long as the largest that it has taken from its heap, of 32 MB at
/// most: beyond that it gives memory back.
BudgetItem kept_by_allocator(double array_bytes) {
  return {"freed memory that the allocator keeps", 2 * std::min(array_bytes, double{32U << 20U}),
          larger_elements()};
}

BudgetItem energies_budget(double rows) {
  return {"the rows of energies", rows * sizeof(record::Energies),
          Message("a larger {}", Key("output.energy_interval_s"))};
}

double history_row_bytes(const Size& size) {
  return number * (1 + static_cast<double>(record::history_fields.size()) * size.n_interface);
}

double waiting_history_bytes(const Size& size, double history_rows) {
  return std::min(history_rows * history_row_bytes(size), double{results::ResultStream::most_bytes_waiting});
}

statics::StaticsBudget statics_budget(const input::Case& config, const Size& size) {
  return statics::statics_budget({wanted_solver(config), 2 * (size.n_nodes - size.n_base_nodes),
                                  size.n_interface, 2 * size.n_base_nodes,
                                  config.loading.top_during_tilt == statics::TopEdge::free,
                                  size.statics_share, size.keeps_displacements, size.leads_by_interface});
}

/// Bodies in motion. The process that leads several has the mesh and the state of all nodes as well while
/// they begin, unless it leads by the interface, or the state is kept by all.
double motion_bytes(const input::Case& config, const Size& size, double n_snapshots) {
  const auto of = [&](double share, bool with_snapshots) {
    return motion::event_bytes(share * size.n_nodes, share * size.n_cells, with_snapshots,
                               config.time.precision);
  };
  if (!size.parts_share) return of(1, n_snapshots > 0);
  const double of_all_nodes = leaders_bytes_per_node(size.leads_by_interface, size.keeps_displacements);
  return of(*size.parts_share, false) + of_all_nodes * size.n_nodes +
         (size.leads_by_interface ? corner_bytes(config) : 0);
}

/// The event while it is built and goes, with what is recorded of it and waits to be written.
Budget event_budget(const input::Case& config, const Size& size, double n_snapshots, double energy_rows) {
  return {{fmt::format("the motion of {:.4g} nodes", size.n_nodes), motion_bytes(config, size, n_snapshots),
           larger_elements()},
          {"the interface and the record of its slip", interface_bytes(config, size), larger_elements()},
          energies_budget(energy_rows)};
}

/// fields.vtkhdf is made of one raw field at a time, beside its mesh or some rows of it.
Budget snapshot_budget(const input::Case& config, const Size& size) {
  const double at_once = std::max(static_cast<double>(snapshot_nodes_at_once), 2 * size.n_interface);
  const double n_nodes = input::has_equal_elements(config) ? std::min(size.n_nodes, at_once) : size.n_nodes;
  const double field = 2 * number, same_motion = number;
  return {
      {"fields and their mesh", (field + same_motion + mesh_bytes_per_node) * n_nodes, larger_elements()}};
}

/// What every stage has besides. @param array_bytes  of the arrays that are freed in it
Budget with_program(const Budget& stage, double array_bytes) {
  return Budget{{"the program", program_bytes(), larger_elements()}, kept_by_allocator(array_bytes)} + stage;
}

std::vector<Budget> memory_stages(const input::Case& config, const Size& size, double n_snapshots,
                                  double history_rows, double energy_rows) {
  const double field = number * size.n_nodes;
  std::vector<Budget> stages;
  if (!is_prestressed(config)) {
    const auto statics = statics_budget(config, size);
    stages.push_back(with_program(statics.peak, field));
    if (config.loading.method == statics::LoadingMethod::ramp) {
      // The tilted plate that the ramp begins from, common and spontaneous state under way, and the last one.
      const Budget states = {{"states of the ramp", 4 * 4 * field, larger_elements()}};
      stages.push_back(with_program(statics.held + event_budget(config, size, 0, 0) + states, field));
    }
  }
  const double in_pieces =
      size.parts_share && n_snapshots > 0 ? 2.0 * results::ResultStream::most_bytes_waiting : 0;
  const Budget waiting = {{"rows of history that wait to be written",
                           waiting_history_bytes(size, history_rows), larger_elements()},
                          {"pieces of snapshots that wait to be written", in_pieces, larger_elements()}};
  stages.push_back(with_program(event_budget(config, size, n_snapshots, energy_rows) + waiting, field));
  if (n_snapshots > 0)
    stages.push_back(
        with_program(snapshot_budget(config, size) + Budget{energies_budget(energy_rows)}, field));
  return stages;
}

void require_disk(const Needs& needs, const std::filesystem::path& folder) {
  std::error_code error;
  const auto space = std::filesystem::space(existing_parent(folder), error);
  if (error) return;
  const auto available = static_cast<double>(space.available);
  require_room(needs.disk(), available, "the run", "on disk",
               fmt::format("{} has {:.3g} GB free", folder.string(), available * 1e-9), " or another folder");
}

/// All of a case's size but for the step.
Size estimated_mesh_size(const input::Case& config) {
  const auto unknowns = approximate_unknowns(config);
  Size size;
  size.n_base_nodes = 0.5 * unknowns.of_base;
  size.n_nodes = size.n_cells = 0.5 * unknowns.of_plate + size.n_base_nodes;
  size.n_interface = config.plate.width_m / config.plate.element_size_m + 1;
  return size;
}

/// Of the processes' parts, what this machine has.
double share_here(const Processes* processes) {
  if (processes == nullptr) return 1;
  return static_cast<double>(processes->on_this_machine()) / processes->size();
}

/// What this machine holds of the bodies.
Size held_here(const input::Case& config, Size size, const Processes* processes, bool may_keep) {
  if (processes == nullptr) return size;
  const int n_processes = processes->size();
  size.statics_share = share_here(processes);
  const double width = size.n_interface / n_processes;
  const double halo = 2.0 * (config.time.interface_substeps + 2);
  size.parts_share = share_here(processes) * (1 + std::max(0.1, halo / width));
  size.leads_by_interface = leads_by_interface(config, n_processes, may_keep);
  size.keeps_displacements = may_keep && keeps_displacements(config, n_processes);
  return size;
}

const char* instead_of(const Processes* processes) {
  return processes != nullptr ? ", or more machines" : "";
}

std::string work_of(const Size& size) {
  return fmt::format("the run with {:.4g} nodes", size.n_nodes);
}

}  // namespace

namespace {

/// A time at which a snapshot is asked for, by the list or by the interval.
struct Asked {
  double time_s = 0;
  bool is_listed = true;
};

/// All of them, ascending.
std::vector<Asked> asked_snapshots(const input::Case& config, double step_s) {
  constexpr double most_snapshots = 1e7;
  std::vector<Asked> asked;
  for (const double time_s : config.output.snapshot_times_s) asked.push_back({time_s, true});
  const double interval_s = std::max(config.output.snapshot_interval_s, step_s);
  if (std::isinf(interval_s)) return asked;
  const double n = std::floor(config.time.end_s / interval_s * (1 + 1e-12));
  if (n > most_snapshots)
    throw UserError("{} = {:g} s gives {:.3g} snapshots until {} = {:g} s; choose a longer one",
                    Key("output.snapshot_interval_s"), config.output.snapshot_interval_s, n,
                    Key("time.end_s"), config.time.end_s);
  for (double k = 0; k <= n; ++k) asked.push_back({std::min(k * interval_s, config.time.end_s), false});
  std::ranges::stable_sort(asked, {}, &Asked::time_s);
  return asked;
}

}  // namespace

SnapshotPlan snapshot_plan(const input::Case& config, double step_s) {
  SnapshotPlan plan;
  const auto n_listed = config.output.snapshot_times_s.size();
  std::int64_t n_late = 0, n_near = 0;
  double last_step = -1;
  for (const auto& [time_s, is_listed] : asked_snapshots(config, step_s)) {
    const double step = std::ceil(time_s / step_s * (1 - 1e-12));
    if (time_s > config.time.end_s) {
      ++n_late;
    } else if (step == last_step) {
      n_near += is_listed ? 1 : 0;
    } else {
      plan.times_s.push_back(time_s);
      last_step = step;
    }
  }
  if (n_late > 0)
    plan.notes.push_back(
        fmt::format("{} of {} output.snapshot_times_s are left out: they are after time.end_s = {:g}", n_late,
                    n_listed, config.time.end_s));
  if (n_near > 0)
    plan.notes.push_back(
        fmt::format("{} of {} output.snapshot_times_s are left out: they fall into the step of {:.4g} s of "
                    "the time before",
                    n_near, n_listed, step_s));
  return plan;
}

std::vector<double> snapshots_after(const input::Case& config, double time_s) {
  std::vector<double> after_s;
  for (const double listed_s : config.output.snapshot_times_s)
    if (listed_s > time_s) after_s.push_back(listed_s);
  return after_s;
}

Size estimated_size(const input::Case& config) {
  Size size = estimated_mesh_size(config);
  const double h = config.plate.element_size_m;
  const auto stable_step_s = [&](const solid::Material& material) {
    // Corners and coarser blocks change it little, or lower it.
    return solid::stable_step_s(solid::frequency_of_squares_rad_per_s(h, material),
                                material.stiffness_damping_s);
  };
  size.step_s = config.time.step_factor * stable_step_s(config.material);
  if (input::has_base_body(config))
    size.step_s =
        std::min(size.step_s, config.time.step_factor * stable_step_s(input::base_material(config)));
  return size;
}

double program_bytes() {
  return statics::petsc_version().empty() ? 26e6 : 48e6;
}

double bytes_per_interface_node(const input::Case& config) {
  const double halo = std::ceil(config.fronts.l_star_m / config.plate.element_size_m) + 1;
  const double around = 2 * number * (2 * halo + 1);
  const double state = 30 * number + 2 * number + around;
  // A node's onsets and stops: the first ones, and those that other nodes' first onsets fell between.
  constexpr double changes = 6;
  const double record = changes * (2 * number + around + 2 * number);
  // The recorder with the copy of its record in the order of time.
  return state + 2 * record;
}

double corner_bytes(const input::Case& config) {
  const auto& plate = config.plate;
  if (plate.corner != mesh::Corner::relief) return 0;
  const auto cells = [&](double length_m) {
    return length_m / plate.element_size_m + solid::rings_around_others + 2;
  };
  // Mesh, block rows and iterations: measured, 1500.
  constexpr double bytes_per_node = 1600;
  return 2 * cells(plate.relief_length_m) * cells(plate.relief_depth_m) * bytes_per_node;
}

double statics_bytes(const input::Case& config, const Size& size) {
  return is_prestressed(config) ? 0 : total_bytes(statics_budget(config, size).peak);
}

Needs needs(const input::Case& config, const Size& size) {
  Needs n;
  n.steps = countable(std::ceil(config.time.end_s / size.step_s * (1 - 1e-12)),
                      Message("{} = {:g}", Key("time.end_s"), config.time.end_s), "an earlier end");
  if (config.loading.method == statics::LoadingMethod::ramp)
    n.ramp_steps =
        countable(std::ceil(estimated_critical_shear_m(config) / (top_speed_m_per_s(config) * size.step_s)),
                  Message("the ramp with {} = {:g}", Key("loading.shear_speed_over_c_L"),
                          config.loading.shear_speed_over_c_L),
                  Message("a higher speed, or {} = direct", Key("loading.method")));

  n.history_rows = rows_of(config.time.end_s, config.output.history_interval_s, size.step_s);
  n.energy_rows = rows_of(config.time.end_s, config.output.energy_interval_s, size.step_s) + 1;
  n.snapshots = static_cast<double>(snapshot_plan(config, size.step_s).times_s.size());

  n.statics_bytes = statics_bytes(config, size);
  n.recorded_bytes = energies_budget(n.energy_rows).bytes + waiting_history_bytes(size, n.history_rows);
  n.memory = memory_stages(config, size, n.snapshots, n.history_rows, n.energy_rows);

  constexpr double bytes_per_number_in_text = 20;
  const double history = n.history_rows * history_row_bytes(size);
  const double field = 2 * number * size.n_nodes;
  const double mesh_of_fields = 3 * number * size.n_nodes + (5 * number + 1) * size.n_cells;
  const double snapshot_raw = 2 * field, snapshot_written = 6 * number * size.n_nodes;
  n.history_bytes = 2 * history;
  const double tensors =
      config.output.snapshot_stress ? results::tensor_values_per_cell * number * size.n_cells : 0;
  if (n.snapshots > 0)
    n.snapshot_bytes = mesh_of_fields + n.snapshots * (snapshot_raw + snapshot_written + tensors);
  if (const auto n_probes = config.probes.x_m.size(); n_probes > 0)
    n.probe_bytes = 2 * rows_of(config.time.end_s, config.probes.interval_s, size.step_s) * number *
                    static_cast<double>(record::probe_row_values(n_probes));
  n.checkpoint_bytes = 3 * (2 * field + interface_bytes(config, size));  // two, and one that is written
  n.energy_bytes = n.energy_rows * bytes_per_number_in_text * sizeof(record::Energies) / number;
  return n;
}

Budget Needs::disk() const {
  return {{"the history", history_bytes, Message("a larger {}", Key("output.history_interval_s"))},
          {"snapshots", snapshot_bytes,
           Message("fewer {}, a longer {:leaf}, {:leaf} = false", Key("output.snapshot_times_s"),
                   Key("output.snapshot_interval_s"), Key("output.snapshot_stress"))},
          {"checkpoints", checkpoint_bytes, larger_elements()},
          {"probes", probe_bytes,
           Message("fewer {}, or a larger {:leaf}", Key("probes.x_m"), Key("probes.interval_s"))},
          {"energy.csv", energy_bytes, Message("a larger {}", Key("output.energy_interval_s"))}};
}

namespace {

/// Nodes of a body that is held as a whole are numbered by one process.
void require_numbers(const input::Case& config, int n_processes) {
  if (!input::can_be_held_in_parts(config) || leads_by_interface(config, n_processes)) return;
  constexpr double most_nodes = std::numeric_limits<mesh::Node>::max();
  const double h = config.plate.element_size_m;
  const double height_m =
      std::max(config.plate.height_m, input::has_base_body(config) ? config.base.plate.height_m : 0);
  const double n_nodes = (config.plate.width_m / h + 1) * (height_m / h + 1);
  if (n_nodes > most_nodes)
    throw UserError("{} is {} m; that makes {:.3g} nodes, more than the {:.3g} that one process can number{}",
                    Key("plate.element_size_m"), h, n_nodes, most_nodes,
                    leads_by_interface(config, 2) ? "; use more processes, or choose a larger one"
                                                  : "; choose a larger one")
        .about("plate.width_m", "plate.height_m");
}

}  // namespace

void require_numbers_of_petsc(const input::Case& config) {
  if (is_prestressed(config) || config.loading.solver != statics::StaticSolver::petsc) return;
  const auto unknowns = approximate_unknowns(config);
  const double n_nodes = 0.5 * (unknowns.of_plate + unknowns.of_base);
  if (n_nodes > statics::most_petsc_nodes)
    throw UserError(
        "{} is {} m; that makes {:.3g} nodes, more than the {:.3g} whose unknowns PETSc can "
        "number; choose a larger one, or {} = prestress, which needs no statics",
        Key("plate.element_size_m"), config.plate.element_size_m, n_nodes,
        static_cast<double>(statics::most_petsc_nodes), Key("loading.method"))
        .about("loading.solver");
}

void require_memory_fits(const input::Case& config, const Processes* processes, bool may_keep) {
  require_numbers(config, processes != nullptr ? processes->size() : 1);
  const auto whole = estimated_mesh_size(config);
  const auto size = held_here(config, whole, processes, may_keep);
  const double n_snapshots = has_snapshots(config) ? 1 : 0;
  require_memory(largest_of(memory_stages(config, size, n_snapshots, 0, 0)), work_of(whole),
                 instead_of(processes));
}

void require_fit(const input::Case& config, const std::filesystem::path& folder, const Processes* processes,
                 bool may_keep) {
  require_memory_fits(config, processes, may_keep);  // before the coarse statics that count a ramp's steps
  const auto whole = estimated_size(config);
  Needs n = needs(config, whole);
  const auto size = held_here(config, whole, processes, may_keep);
  Budget memory = largest_of(memory_stages(config, size, n.snapshots, n.history_rows, n.energy_rows));
  if (processes != nullptr) {
    const double kept = share_here(processes) + 1.0 / processes->size();  // those here, and one that has come
    memory.push_back(
        {"a checkpoint of the processes", kept * kept_node_bytes * whole.n_nodes, larger_elements()});
    n.checkpoint_bytes *= shared_checkpoint_bytes;
  }
  require_memory(memory, work_of(whole), instead_of(processes));
  require_disk(n, folder);
}

}  // namespace slipfront::run
