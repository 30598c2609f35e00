// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/dashpot.hpp"

#include <cmath>

#include "base/numbers.hpp"

namespace slipfront::boundary {

Dashpot make_dashpot(const EdgeNode& edge, const solid::Material& material, double mass_kg, double step_s) {
  const double c_L = solid::longitudinal_speed_m_per_s(material), c_S = solid::shear_speed_m_per_s(material);
  const auto& [node, side_m, top_m, spring_x, spring_y, machine_kg] = edge;
  const double factor = 0.5 * step_s * material.density_kg_per_m3 / mass_kg;
  return {0, node, spring_x == infinity ? infinity : factor * (c_L * side_m + c_S * top_m),
          spring_y == infinity ? infinity : factor * (c_S * side_m + c_L * top_m)};
}

double dashpot_work(double d_x, double d_y, double mass_kg, double mean_x_m_per_s, double mean_y_m_per_s) {
  return -2 * mass_kg * (d_x * mean_x_m_per_s * mean_x_m_per_s + d_y * mean_y_m_per_s * mean_y_m_per_s);
}

namespace {

/// Without what a machine pulls.
/// @param share  of the node's mass in what moves along x
solid::Pair damp(const Dashpot& dashpot, double mass_kg, double share, solid::Pair before, solid::Pair trial,
                 record::Energies& works) {
  const bool holds_x = std::isinf(dashpot.d_x), holds_y = std::isinf(dashpot.d_y);
  const double d_x = holds_x ? 0 : dashpot.d_x, d_y = holds_y ? 0 : dashpot.d_y;
  const double mean_x = 0.5 * (before.x + trial.x) / (1 + share * d_x);
  const double mean_y = 0.5 * (before.y + trial.y) / (1 + d_y);
  works.boundary_work += dashpot_work(d_x, d_y, mass_kg, mean_x, mean_y);
  if (holds_x) works.far_edge_work += mass_kg * (before.x - trial.x) * before.x;
  if (holds_y) works.far_edge_work += mass_kg * (before.y - trial.y) * before.y;
  return {holds_x ? before.x : trial.x - 2 * share * d_x * mean_x,
          holds_y ? before.y : trial.y - 2 * d_y * mean_y};
}

}  // namespace

solid::Pair damp(const Dashpot& dashpot, MachineSprings& springs, double step_s, double mass_kg,
                 solid::Pair u_m, solid::Pair before, solid::Pair trial, record::Energies& works) {
  if (dashpot.spring == MachineSprings::none) return damp(dashpot, mass_kg, 1, before, trial, works);
  const auto force_N = springs.force(dashpot.spring, u_m);
  // Along x the forces move the machine's mass, too.
  const double machine_kg = springs.mass_kg(dashpot.spring), share = mass_kg / (mass_kg + machine_kg);
  const double s_per_kg = step_s / mass_kg;
  const double x = trial.x - (1 - share) * (trial.x - before.x) + share * s_per_kg * force_N.x;
  const auto after = damp(dashpot, mass_kg, share, before, {x, trial.y + s_per_kg * force_N.y}, works);
  springs.move(dashpot.spring, step_s, force_N, before, after, works);
  return after;
}

}  // namespace slipfront::boundary
