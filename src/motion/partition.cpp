// SPDX-License-Identifier: BSD-3-Clause
#include "motion/partition.hpp"

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "motion/level.hpp"

namespace slipfront::motion {

namespace {

/// Most steps between two exchanges: what several steps in one sweep through memory gain is gained with
/// these.
constexpr int max_steps_per_exchange = 16;
/// A halo on either side adds this part of a rank's own work at most, if that allows a step.
constexpr double tolerated_halo = 0.1;

}  // namespace

mesh::Subset Partition::all(int subdomain) const {
  const auto columns = own(subdomain);
  const int begin = columns.begin - halo_below(subdomain), end = columns.end + halo_above(subdomain);
  if (begin < 0) return mesh::Subset({{0, end}, {first.back() + begin, n_columns()}});
  if (end > first.back()) return mesh::Subset({{0, end - first.back()}, {begin, n_columns()}});
  return mesh::Subset({{begin, end}});
}

int columns_per_step(std::span<const BodySource> bodies, const StepPlan& plan) {
  std::vector<std::vector<LevelReach>> levels;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    levels.push_back(reach_of_levels(bodies[b].mesh, plan.bodies[b].block_periods));
  int columns = 0;
  for (int k = 0; k < plan.period; ++k) {
    int farthest = 0;
    for (const auto& of_body : levels) {
      int together = 0;
      for (const auto& level : of_body)
        if (k % level.period == 0) together += level.columns;
      farthest = std::max(farthest, together);
    }
    columns += farthest;
  }
  return columns;
}

Partition partition_columns(const mesh::Mesh& mesh, int n_subdomains, int columns_per_step, int reach) {
  Partition partition;
  partition.is_ring = mesh.period_m > 0;
  const int n_columns = mesh.grid.stride() - (partition.is_ring ? 1 : 0);
  for (int k = 0; k <= n_subdomains; ++k)
    partition.first.push_back(static_cast<int>(static_cast<std::int64_t>(n_columns) * k / n_subdomains));
  const int width = n_columns / n_subdomains;
  partition.steps_per_exchange = std::clamp(static_cast<int>(0.5 * tolerated_halo * width / columns_per_step),
                                            1, max_steps_per_exchange);
  partition.columns_per_step = columns_per_step;
  partition.halo = partition.steps_per_exchange * columns_per_step + reach;
  return partition;
}

namespace {

/// Why subdomains do not know of the whole what they need; empty where they do.
/// @param widest_cell  columns over which it reaches: the halos of a subdomain that go round a ring do not
/// meet
/// @param corner       columns at either end among which no part begins or ends
std::string reason_against(const Partition& partition, int widest_cell, int corner) {
  const int n_subdomains = partition.n_subdomains(), width = partition.first.back() / n_subdomains;
  if (n_subdomains == 1) return {};
  int min_width = partition.halo;
  if (partition.is_ring && n_subdomains <= 3) {
    const int others = 2 * partition.halo + widest_cell;
    min_width = std::max(min_width, (others + n_subdomains - 2) / (n_subdomains - 1));
  }
  if (width < min_width)
    return fmt::format("{} ranks have {} columns of elements each, fewer than the {} that they need",
                       n_subdomains, width, min_width);
  const int last = partition.n_columns() - 1;
  const auto is_at_corner = [&](int column) { return std::min(column, last - column) <= corner; };
  for (int subdomain = 0; subdomain < n_subdomains && corner > 0; ++subdomain) {
    const auto own = partition.own(subdomain);
    const int begin = own.begin - partition.halo_below(subdomain),
              end = own.end - 1 + partition.halo_above(subdomain);
    if ((begin > 0 && is_at_corner(begin)) || (end < last && is_at_corner(end)))
      return fmt::format("of {} ranks one would compute a subdomain that ends at a rounded corner",
                         n_subdomains);
  }
  return {};
}

constexpr std::int64_t max_nodes = std::numeric_limits<mesh::Node>::max();

/// Nodes of a column of the highest body of which no rank has all; 0 where one has.
std::int64_t nodes_of_column_in_parts(std::span<const BodySource> bodies) {
  std::int64_t most = 0;
  for (const auto& body : bodies)
    if (body.mesh.is_interface()) most = std::max(most, std::int64_t{body.mesh.grid.rows} + 1);
  return most;
}

std::int64_t columns_of_widest(const Partition& partition) {
  int most = 0;
  for (int subdomain = 0; subdomain < partition.n_subdomains(); ++subdomain)
    most = std::max(most, partition.all(subdomain).count());
  return most;
}

}  // namespace

Partition partition_bodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                           const TimeStepping& time, int n_subdomains) {
  SLIPFRONT_ASSERT(bodies.front().mesh.grid.columns > 0, "a mesh without a grid cannot be shared");
  // Probes look at all nodes of a cell, wherever its first one lies.
  int widest_cell = 1, corner = 0;
  const auto plan = step_plan(steps, time);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& mesh = bodies[b].mesh;
    widest_cell = std::max(widest_cell, 1 << mesh.coarser.size());
    corner = std::max({corner, mesh::columns_of_wrapped_cells(mesh),
                       columns_of_rounded_layer(mesh, time, plan.bodies[b].block_periods)});
  }
  const int per_step = columns_per_step(bodies, plan);
  const auto divided = [&](int n) {
    return partition_columns(bodies.front().mesh, n, per_step, widest_cell);
  };
  const auto why_not = [&](int n) { return reason_against(divided(n), widest_cell, corner); };
  if (const auto reason = why_not(n_subdomains); !reason.empty()) {
    // A subdomain is at least as wide as its halo; without this bound a division into millions would be
    // tried.
    int most = std::clamp(divided(1).n_columns() / (per_step + widest_cell), 1, n_subdomains - 1);
    while (!why_not(most).empty()) --most;
    throw UserError("{}; choose at most {}", reason, most);
  }
  auto partition = divided(n_subdomains);
  const auto of_column = nodes_of_column_in_parts(bodies);
  const auto can_number = [&](const Partition& d) { return of_column * columns_of_widest(d) <= max_nodes; };
  if (can_number(partition)) return partition;
  const auto is_possible = [&](int n) { return why_not(n).empty(); };
  const std::int64_t n_columns = partition.n_columns();
  auto least = static_cast<int>(
      std::clamp(of_column * n_columns / max_nodes, std::int64_t{n_subdomains} + 1, n_columns));
  while (is_possible(least) && !can_number(divided(least))) ++least;
  throw UserError(
      "each of {} ranks would have up to {:.3g} nodes of a body, more than the {} that it can "
      "number; use {}",
      n_subdomains, static_cast<double>(of_column * columns_of_widest(partition)), max_nodes,
      is_possible(least) ? fmt::format("more ranks, at least {}", least)
                         : "larger elements: more ranks would have too few columns");
}

}  // namespace slipfront::motion
