// SPDX-License-Identifier: BSD-3-Clause
#include "run/choices.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <thread>

#include "input/friction_along_x.hpp"
#include "input/prestress.hpp"
#include "solid/operator.hpp"
#include "stability/verdict.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::run {

namespace {

double approximate_unknowns_of(const mesh::Plate& plate) {
  double unknowns = 0, h = plate.element_size_m, height_m = plate.fine_height_m, rest_m = plate.height_m;
  for (int k = 0; k <= std::max(0, plate.coarsenings) && rest_m > 0; ++k) {
    const double of_block_m = k == plate.coarsenings ? rest_m : std::min(height_m, rest_m);
    unknowns += 2 * (plate.width_m / h + 1) * (of_block_m / h + 1);
    rest_m -= of_block_m;
    height_m = plate.height_m - rest_m;  // a block is as high as everything below it
    h *= 2;
  }
  return unknowns;
}

}  // namespace

Unknowns approximate_unknowns(const input::Case& config) {
  return {approximate_unknowns_of(config.plate),
          input::has_base_body(config) ? approximate_unknowns_of(input::base_plate(config)) : 0};
}

int suitable_threads(const input::Case& config) {
  constexpr double nodes_per_thread = 20'000;
  constexpr unsigned max_threads = 4;
  const auto unknowns = approximate_unknowns(config);
  const double useful = 0.5 * (unknowns.of_plate + unknowns.of_base) / nodes_per_thread;
  const double most = std::clamp(std::thread::hardware_concurrency(), 1U, max_threads);
  return static_cast<int>(std::clamp(useful, 1.0, most));
}

double top_speed_m_per_s(const input::Case& config) {
  return config.loading.shear_speed_m_per_s;
}

double top_speed_in_event_m_per_s(const input::Case& config) {
  return config.machine.pusher.is_there() ? 0 : top_speed_m_per_s(config);
}

stability::Bodies bodies_of(const input::Case& config) {
  stability::Bodies both = config.material;
  if (input::has_base_body(config)) both.below = input::base_material(config);
  return both;
}

double advised_damping_s(const input::Case& config) {
  const double least_s = stability::damping_of_grid_waves_s(
      bodies_of(config), config.friction, config.regularisation, config.plate.element_size_m);
  if (least_s == 0) return 0;
  const double digit_s = std::pow(10, std::floor(std::log10(least_s)) - 2);
  return digit_s * std::ceil((1 - 1e-9) * least_s / digit_s);
}

statics::StaticSolver wanted_solver(const input::Case& config) {
  if (config.machine.pusher.is_there() || !config.machine.is_rigid() || input::is_slow(config))
    return statics::StaticSolver::direct;
  const auto shape = [](const mesh::Plate& plate) {
    return statics::Shape{std::round(plate.width_m / plate.element_size_m),
                          std::round(plate.height_m / plate.element_size_m), plate.coarsenings > 0};
  };
  std::optional<statics::Shape> base;
  if (input::has_base_body(config)) base = shape(input::base_plate(config));
  return statics::solver_for_shapes(config.loading.solver, shape(config.plate), base);
}

bool is_plain(const input::Case& config) {
  return config.time.stepper == motion::StepperKind::plain;
}

bool has_snapshots(const input::Case& config) {
  return !config.output.snapshot_times_s.empty() || std::isfinite(config.output.snapshot_interval_s);
}

bool root_has_interface_only(const input::Case& config, int n_processes) {
  const auto is_of_many_squares = [](const mesh::Plate& plate) {
    const double columns = std::round(plate.width_m / plate.element_size_m);
    const double rows = std::round(plate.height_m / plate.element_size_m);
    constexpr double most = std::numeric_limits<int>::max();
    if (!(columns > 0 && columns < most && rows > 0 && rows < most)) return false;  // refused elsewhere
    // Both as the whole mesh finds it: that all are squares, to 1e-9 of a side and what rounding adds, and
    // that above a relief there are some in all columns.
    const double stretch = plate.width_m / columns / (plate.height_m / rows);
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::max(columns, rows);
    if (!(std::abs(stretch - 1) + rounding <= 0.9 * solid::square_tolerance)) return false;
    if (plate.corner == mesh::Corner::relief &&
        plate.relief_depth_m > plate.height_m - 2 * plate.element_size_m)
      return false;
    const mesh::Grid grid{.columns = static_cast<int>(columns), .rows = static_cast<int>(rows)};
    const auto n_nodes = static_cast<std::int64_t>((columns + 1) * (rows + 1));
    return solid::takes_frequency_bound(n_nodes, std::span(&grid, 1));
  };
  return n_processes > 1 && input::can_be_held_in_parts(config) && is_of_many_squares(config.plate) &&
         (!input::has_base_body(config) || is_of_many_squares(input::base_plate(config)));
}

record::StaticState prescribed_tractions(const input::Case& config, const mesh::Mesh& mesh) {
  const input::Prestress& prestress = config.prestress;
  record::StaticState state;
  state.x_m = interface_x_m(mesh);
  if (!prestress.file.empty()) return input::prestress_at(prestress, state.x_m);
  state.p_s_Pa.assign(state.x_m.size(), prestress.p_Pa);
  state.t_s_Pa.assign(state.x_m.size(),
                      prestress.t_Pa ? *prestress.t_Pa : traction_before_Pa(config.friction, prestress.p_Pa));
  if (prestress.t_Pa) return state;
  const auto laws = input::friction_at(config, state.x_m);
  for (std::size_t k = 0; k < laws.size(); ++k) state.t_s_Pa[k] = traction_before_Pa(laws[k], prestress.p_Pa);
  return state;
}

std::optional<solid::UniformStress> prescribed_stress(const input::Case& config) {
  const input::Prestress& prestress = config.prestress;
  if (!is_prestressed(config) || !prestress.file.empty() || !prestress.t_Pa) return std::nullopt;
  return solid::UniformStress{-prestress.p_Pa, *prestress.t_Pa, -prestress.p_rate_Pa_per_s,
                              prestress.t_rate_Pa_per_s};
}

std::vector<double> interface_x_m(const mesh::Mesh& mesh) {
  std::vector<double> x_m;
  for (const auto n : mesh.interface_nodes) x_m.push_back(mesh.x_m[n]);
  return x_m;
}

double fastest_speed_m_per_s(const input::Case& config) {
  const double of_plate = solid::longitudinal_speed_m_per_s(config.material);
  if (!input::has_base_body(config)) return of_plate;
  return std::max(of_plate, solid::longitudinal_speed_m_per_s(input::base_material(config)));
}

}  // namespace slipfront::run
