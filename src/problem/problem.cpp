// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "input/prestress.hpp"
#include "interface/friction.hpp"
#include "problem/contact.hpp"
#include "problem/source.hpp"
#include "solid/operator.hpp"

namespace slipfront::problem {

std::vector<Body> bodies_of(const input::Case& config) {
  std::vector<Body> bodies = {{config.plate, config.material, config.machine}};
  if (has_base_body(config)) bodies.push_back({base_plate(config), base_material(config)});
  return bodies;
}

Problem make_problem(const input::Case& config) {
  Problem problem;
  problem.source = source_of(config);
  problem.bodies = bodies_of(config);
  problem.loading = config.loading;
  problem.shear_speed_m_per_s = config.loading.shear_speed_m_per_s;
  if (input::is_prestressed(config)) problem.prestress = config.prestress;
  problem.friction = {config.friction, config.friction_along_x, config.regularisation, config.contact,
                      config.tip_slip_rate_m_per_s};
  problem.start = start_of(config);
  problem.sequence = config.sequence;
  problem.time = config.time;
  problem.fronts = config.fronts;
  problem.output = config.output;
  const auto& [x_m, y_m, names, interval_s] = config.probes;
  for (std::size_t k = 0; k < x_m.size(); ++k)
    problem.probes.push_back({names.empty() ? std::to_string(k + 1) : names[k], x_m[k], y_m[k]});
  problem.probe_interval_s = interval_s;
  return problem;
}

stability::Bodies materials_of(const std::vector<Body>& bodies) {
  stability::Bodies both = bodies.front().material;
  if (bodies.size() > 1) both.below = bodies.back().material;
  return both;
}

double fastest_speed_m_per_s(const Problem& problem) {
  double fastest_m_per_s = 0;
  for (const auto& body : problem.bodies)
    fastest_m_per_s = std::max(fastest_m_per_s, solid::longitudinal_speed_m_per_s(body.material));
  return fastest_m_per_s;
}

double shear_speed_in_event_m_per_s(const Problem& problem) {
  return problem.above().machine.pusher.is_there() ? 0 : problem.shear_speed_m_per_s;
}

double nominal_pressure_Pa(const Problem& problem) {
  if (problem.prestress) {
    const auto& [x_m, t_Pa, p_Pa] = problem.prestress->table.rows;
    if (x_m.empty()) return problem.prestress->p_Pa;
    double force_N_per_m = 0;
    for (std::size_t k = 1; k < x_m.size(); ++k)
      force_N_per_m += 0.5 * (p_Pa[k - 1] + p_Pa[k]) * (x_m[k] - x_m[k - 1]);
    return x_m.size() == 1 ? p_Pa.front() : force_N_per_m / (x_m.back() - x_m.front());
  }
  const double width_m = problem.width_m();
  if (const auto force = statics::normal_force_N_per_m(problem.loading, width_m)) return *force / width_m;
  const double compression_m = 0.5 * (problem.loading.tilt_left_m + problem.loading.tilt_right_m);
  const auto per_compression = [](const Body& body) {
    return solid::uniaxial_modulus_Pa(body.material) / body.plate.height_m;
  };
  double stiffness = per_compression(problem.above());
  if (problem.has_below()) {
    const double of_base = per_compression(problem.below());
    stiffness *= of_base / (stiffness + of_base);
  }
  return compression_m * stiffness;
}

bool has_equal_elements(const Problem& problem) {
  return std::ranges::all_of(problem.bodies,
                             [](const Body& body) { return mesh::has_equal_elements(body.plate); });
}

bool can_be_held_in_parts(const Problem& problem) {
  return problem.is_prestressed() && has_equal_elements(problem);
}

bool root_has_interface_only(const Problem& problem, int n_processes) {
  const auto is_of_many_squares = [](const Body& body) {
    const auto& plate = body.plate;
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
  return n_processes > 1 && can_be_held_in_parts(problem) &&
         std::ranges::all_of(problem.bodies, is_of_many_squares);
}

record::StaticState prescribed_tractions(const Problem& problem, const std::vector<double>& x_m) {
  const auto& prestress = *problem.prestress;
  if (!prestress.file.empty()) return input::prestress_at(prestress, x_m);
  const double p_Pa = prestress.p_Pa;
  const double t_Pa = prestress.t_Pa ? *prestress.t_Pa : traction_before_Pa(problem.friction.law, p_Pa);
  record::StaticState state{x_m, std::vector(x_m.size(), t_Pa), std::vector(x_m.size(), p_Pa)};
  if (prestress.t_Pa) return state;
  const auto laws = friction_at(problem, x_m);
  for (std::size_t k = 0; k < laws.size(); ++k) state.t_s_Pa[k] = traction_before_Pa(laws[k], p_Pa);
  return state;
}

std::optional<solid::UniformStress> prescribed_stress(const Problem& problem) {
  const auto& prestress = problem.prestress;
  if (!prestress || !prestress->file.empty() || !prestress->t_Pa) return std::nullopt;
  return solid::UniformStress{-prestress->p_Pa, *prestress->t_Pa, -prestress->p_rate_Pa_per_s,
                              prestress->t_rate_Pa_per_s};
}

}  // namespace slipfront::problem
