// SPDX-License-Identifier: BSD-3-Clause
#include "advice/mesh_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/error.hpp"
#include "mesh/plate.hpp"
#include "motion/level.hpp"
#include "setup/meshes.hpp"
#include "stability/verdict.hpp"

namespace slipfront::advice {
namespace {

constexpr int most_coarsenings = 2;  // a third gains little: docs/mesh.md
constexpr double max_columns = 1e6;
constexpr int most_tries = 64;  // each makes an interface

/// Elements in a process zone of this length.
double needed_elements(const Problem& problem, const RuptureOutlook& rupture) {
  const auto bodies = materials_of(problem);
  double n = elements_for_peaks;
  if (may_pass_c_S(bodies, rupture.of_nodes.S.median)) n = elements_for_transition;
  // Damping of waves of the mesh, beta_R = a h/c_S, stays harmless to the zone Z, beta_R c_L <= b Z.
  const double h_m = problem.element_size_m();
  const double damping_s =
      stability::damping_of_grid_waves_s(bodies, problem.friction.law, problem.friction.regularisation, h_m);
  return std::max(n, damping_s * stability::slower_c_L_m_per_s(bodies) / (harmless_damping * h_m));
}

bool is_whole(double count) {
  return std::abs(count - std::round(count)) <= 1e-6 * count && count > 0.5;
}

/// Nodes of the plate and a base; none where the elements, or the rows that are sub-cycled, do not fit them.
std::optional<std::int64_t> n_nodes(const Problem& problem) {
  try {
    std::int64_t n = 0;
    for (const auto& body : problem.bodies) {
      const auto interface = mesh::make_interface(body.plate);
      motion::require_rows_fit(interface, problem.time);
      n += setup::n_nodes_of(interface);
    }
    return n;
  } catch (const UserError&) {
    return {};
  }
}

/// With plate.fine_height_m by default where it has not been asked for.
void coarsen(mesh::Plate& plate, int coarsenings) {
  const mesh::Plate standard;
  if (plate.coarsenings == 0)
    plate.fine_height_m = standard.fine_height_m / standard.height_m * plate.height_m;
  plate.coarsenings = coarsenings;
}

}  // namespace

std::optional<MeshChoice> cheapest_mesh(const Problem& problem, const RuptureOutlook& rupture) {
  if (!rupture.of_nodes.process_zone_m || problem.above().plate.corner == mesh::Corner::fillet) return {};
  const double zone_m = *rupture.of_nodes.process_zone_m, width_m = problem.width_m();
  const double least = needed_elements(problem, rupture) * width_m / zone_m;
  const int spare = problem.above().plate.sides == mesh::Sides::periodic ? 1 : 0;
  for (int coarsenings = most_coarsenings; coarsenings >= 0; --coarsenings) {
    const double multiple = coarsenings == 0 ? 1 : 1 << (coarsenings + spare);
    auto choice = problem;
    for (auto& body : choice.bodies) coarsen(body.plate, coarsenings);
    int tries = 0;
    for (double columns = multiple * std::ceil(least / multiple * (1 - 1e-9));
         columns <= std::min(max_columns, 2 * least + 100); columns += multiple) {
      const double h_m = width_m / columns;
      for (auto& body : choice.bodies) body.plate.element_size_m = h_m;
      if (!is_whole(problem.above().plate.height_m / h_m)) continue;
      if (++tries > most_tries) break;
      if (const auto n = n_nodes(choice)) return MeshChoice{h_m, coarsenings, zone_m / h_m, *n};
    }
  }
  return {};
}

}  // namespace slipfront::advice
