// SPDX-License-Identifier: BSD-3-Clause
#include "run/needs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "interface/friction/registry.hpp"
#include "mesh/plate.hpp"
#include "motion/event.hpp"
#include "run/choices.hpp"
#include "solid/operator.hpp"
#include "stability/verdict.hpp"
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

/// The interface's state, and the recorder with the copy of its record in the order of time.
double interface_bytes(const input::Case& config, const Size& size) {
  const double halo = std::ceil(config.fronts.l_star_m / config.plate.element_size_m) + 1;
  const double around = 2 * number * (2 * halo + 1);
  const double state = 30 * number + 2 * number + around;
  // A node's onsets and stops: the first ones, and those that other nodes' first onsets fell between.
  constexpr double changes = 6;
  const double record = changes * (2 * number + around + 2 * number);
  return size.n_interface * (state + 2 * record);
}

/// Largest frequency of many squares of side h; corners and coarser blocks change it little, or lower it.
double frequency_of_squares_rad_per_s(double h, const solid::Material& material) {
  constexpr int side = 32;
  mesh::Plate squares;
  squares.width_m = squares.height_m = side * h;
  squares.element_size_m = h;
  squares.corner = mesh::Corner::none;
  squares.top = mesh::Top::free;
  return solid::frequency_bound_rad_per_s(mesh::make_plate(squares), material);
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

void require_disk(const Needs& needs, const std::filesystem::path& folder) {
  std::error_code error;
  const auto space = std::filesystem::space(existing_parent(folder), error);
  if (error || needs.disk_bytes() <= static_cast<double>(space.available)) return;
  struct Part {
    double bytes;
    const char* what;
    Message remedy;
  };
  const std::array<Part, 4> parts = {{
      {needs.history_bytes, "the history", Message("a larger {}", Key("output.history_interval_s"))},
      {needs.snapshot_bytes, "snapshots", Message("fewer {}", Key("output.snapshot_times_s"))},
      {needs.checkpoint_bytes, "checkpoints", Message("a larger {}", Key("plate.element_size_m"))},
      {needs.energy_bytes, "energy.csv", Message("a larger {}", Key("output.energy_interval_s"))},
  }};
  const auto& largest = *std::ranges::max_element(parts, {}, &Part::bytes);
  throw UserError(
      "the run needs about {:.3g} GB on disk, {:.3g} GB of it for {}, and {} has {:.3g} GB free; choose {} "
      "or another folder",
      needs.disk_bytes() * 1e-9, largest.bytes * 1e-9, largest.what, folder.string(),
      static_cast<double>(space.available) * 1e-9, largest.remedy);
}

}  // namespace

SnapshotPlan snapshot_plan(const input::Case& config, double step_s) {
  SnapshotPlan plan;
  const auto& asked_s = config.output.snapshot_times_s;
  std::int64_t n_late = 0, n_near = 0;
  double last_step = -1;
  for (const double time_s : asked_s) {
    const double step = std::ceil(time_s / step_s * (1 - 1e-12));
    if (time_s > config.time.end_s) {
      ++n_late;
    } else if (step == last_step) {
      ++n_near;
    } else {
      plan.times_s.push_back(time_s);
      last_step = step;
    }
  }
  if (n_late > 0)
    plan.notes.push_back(
        fmt::format("{} of {} output.snapshot_times_s are left out: they are after time.end_s = {:g}", n_late,
                    asked_s.size(), config.time.end_s));
  if (n_near > 0)
    plan.notes.push_back(
        fmt::format("{} of {} output.snapshot_times_s are left out: they fall into the step of {:.4g} s of "
                    "the time before",
                    n_near, asked_s.size(), step_s));
  return plan;
}

Size estimated_size(const input::Case& config) {
  Size size;
  size.n_nodes = size.n_cells = 0.5 * approximate_unknowns(config);
  const double h = config.plate.element_size_m;
  size.n_interface = config.plate.width_m / h + 1;
  const auto stable_step_s = [&](const solid::Material& material) {
    return solid::stable_step_s(frequency_of_squares_rad_per_s(h, material), material.stiffness_damping_s);
  };
  size.step_s = config.time.step_factor * stable_step_s(config.material);
  if (input::has_base_body(config))
    size.step_s =
        std::min(size.step_s, config.time.step_factor * stable_step_s(input::base_material(config)));
  return size;
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

  const double n_unknowns = 2 * size.n_nodes;
  if (!is_prestressed(config))
    n.statics_bytes =
        statics::statics_bytes(statics::choose_solver(wanted_solver(config), n_unknowns), n_unknowns);
  n.event_bytes = motion::event_bytes(size.n_nodes, size.n_cells, n.snapshots > 0, config.time.precision) +
                  interface_bytes(config, size) + n.energy_rows * sizeof(record::Energies);

  constexpr double bytes_per_number_in_text = 20;
  const double history = number * n.history_rows * (1 + record::history_fields.size() * size.n_interface);
  const double field = 2 * number * size.n_nodes;
  const double mesh_of_fields = 3 * number * size.n_nodes + (5 * number + 1) * size.n_cells;
  const double snapshot_raw = 2 * field, snapshot_written = 6 * number * size.n_nodes;
  n.history_bytes = 2 * history;
  if (n.snapshots > 0) n.snapshot_bytes = mesh_of_fields + n.snapshots * (snapshot_raw + snapshot_written);
  n.checkpoint_bytes = 2 * (2 * field + interface_bytes(config, size));
  n.energy_bytes = n.energy_rows * bytes_per_number_in_text * sizeof(record::Energies) / number;
  return n;
}

void require_fit(const input::Case& config, const std::filesystem::path& folder) {
  require_plate_fits(config);
  if (!is_prestressed(config)) require_statics_fit(config);
  const Size size = estimated_size(config);
  const Needs n = needs(config, size);
  const bool energies = n.energy_rows * sizeof(record::Energies) > 0.5 * n.memory_bytes();
  require_memory(
      n.memory_bytes(), fmt::format("the run on a plate of {:.4g} nodes", size.n_nodes),
      Message("choose a larger {}", Key(energies ? "output.energy_interval_s" : "plate.element_size_m")));
  require_disk(n, folder);
}

}  // namespace slipfront::run
