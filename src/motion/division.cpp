// SPDX-License-Identifier: BSD-3-Clause
#include "motion/division.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "motion/level.hpp"
#include "motion/stepper.hpp"

namespace slipfront::motion {

namespace {

/// Most steps between two exchanges: what several steps in one sweep through memory gain is gained with
/// these.
constexpr int most_steps_per_exchange = 16;
/// A halo on either side adds this part of a process's own work at most, if that allows a step.
constexpr double tolerated_halo = 0.1;

}  // namespace

mesh::Subset Division::all(int part) const {
  const auto columns = own(part);
  const int begin = columns.begin - halo_below(part), end = columns.end + halo_above(part);
  if (begin < 0) return mesh::Subset({{0, end}, {first.back() + begin, n_columns()}});
  if (end > first.back()) return mesh::Subset({{0, end - first.back()}, {begin, n_columns()}});
  return mesh::Subset({{begin, end}});
}

int columns_per_step(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                     const TimeStepping& time) {
  const double least_s = std::ranges::min(steps, {}, &BodySteps::stable_step_s).stable_step_s;
  std::vector<std::vector<LevelReach>> levels;
  int substeps = 1;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    auto of_body = time;
    of_body.interface_substeps *= steps_at_once(steps[b].stable_step_s, least_s);
    levels.push_back(reach_of_levels(bodies[b].mesh, of_body, steps[b].multiples));
    substeps = std::lcm(substeps, levels.back().front().period);
  }
  int columns = 0;
  for (int k = 0; k < substeps; ++k) {
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

Division divide_columns(const mesh::Mesh& mesh, int n_parts, int columns_per_step, int reach) {
  Division division;
  division.is_ring = mesh.period_m > 0;
  const int n_columns = mesh.grid.stride() - (division.is_ring ? 1 : 0);
  for (int k = 0; k <= n_parts; ++k)
    division.first.push_back(static_cast<int>(static_cast<std::int64_t>(n_columns) * k / n_parts));
  const int width = n_columns / n_parts;
  division.steps_per_exchange = std::clamp(static_cast<int>(0.5 * tolerated_halo * width / columns_per_step),
                                           1, most_steps_per_exchange);
  division.columns_per_step = columns_per_step;
  division.halo = division.steps_per_exchange * columns_per_step + reach;
  return division;
}

namespace {

/// Why parts do not know of the whole what they need; empty where they do.
/// @param widest_cell  columns over which it reaches: the halos of a part that go round a ring do not meet
/// @param corner       columns at either end among which no part begins or ends
std::string reason_against(const Division& division, int widest_cell, int corner) {
  const int n_parts = division.n_parts(), width = division.first.back() / n_parts;
  if (n_parts == 1) return {};
  int least_width = division.halo;
  if (division.is_ring && n_parts <= 3) {
    const int others = 2 * division.halo + widest_cell;
    least_width = std::max(least_width, (others + n_parts - 2) / (n_parts - 1));
  }
  if (width < least_width)
    return fmt::format("{} processes have {} columns of elements each, fewer than the {} that they need",
                       n_parts, width, least_width);
  const int last = division.n_columns() - 1;
  const auto is_at_corner = [&](int column) { return std::min(column, last - column) <= corner; };
  for (int part = 0; part < n_parts && corner > 0; ++part) {
    const auto own = division.own(part);
    const int begin = own.begin - division.halo_below(part), end = own.end - 1 + division.halo_above(part);
    if ((begin > 0 && is_at_corner(begin)) || (end < last && is_at_corner(end)))
      return fmt::format("of {} processes one would compute a part that ends at a rounded corner", n_parts);
  }
  return {};
}

constexpr std::int64_t most_nodes = std::numeric_limits<mesh::Node>::max();

/// Nodes of a column of the highest body of which no process has all; 0 where one has.
std::int64_t nodes_of_column_in_parts(std::span<const BodySource> bodies) {
  std::int64_t most = 0;
  for (const auto& body : bodies)
    if (body.mesh.is_interface()) most = std::max(most, std::int64_t{body.mesh.grid.rows} + 1);
  return most;
}

std::int64_t columns_of_widest(const Division& division) {
  int most = 0;
  for (int part = 0; part < division.n_parts(); ++part) most = std::max(most, division.all(part).count());
  return most;
}

}  // namespace

Division divide_bodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                       const TimeStepping& time, int n_parts) {
  SLIPFRONT_ASSERT(bodies.front().mesh.grid.columns > 0, "a mesh without a grid cannot be shared");
  // Probes look at all nodes of a cell, wherever its first one lies.
  int widest_cell = 1, corner = 0;
  for (const auto& body : bodies) {
    widest_cell = std::max(widest_cell, 1 << body.mesh.coarser.size());
    corner = std::max(
        {corner, mesh::columns_of_wrapped_cells(body.mesh), columns_of_rounded_layer(body.mesh, time)});
  }
  const int per_step = columns_per_step(bodies, steps, time);
  const auto divided = [&](int n) { return divide_columns(bodies.front().mesh, n, per_step, widest_cell); };
  const auto why_not = [&](int n) { return reason_against(divided(n), widest_cell, corner); };
  if (const auto reason = why_not(n_parts); !reason.empty()) {
    int most = n_parts - 1;
    while (!why_not(most).empty()) --most;
    throw UserError("{}; choose at most {}", reason, most);
  }
  auto division = divided(n_parts);
  const auto of_column = nodes_of_column_in_parts(bodies);
  const auto can_number = [&](const Division& d) { return of_column * columns_of_widest(d) <= most_nodes; };
  if (can_number(division)) return division;
  const auto is_possible = [&](int n) { return why_not(n).empty(); };
  const std::int64_t n_columns = division.n_columns();
  auto least =
      static_cast<int>(std::clamp(of_column * n_columns / most_nodes, std::int64_t{n_parts} + 1, n_columns));
  while (is_possible(least) && !can_number(divided(least))) ++least;
  throw UserError(
      "each of {} processes would have up to {:.3g} nodes of a body, more than the {} that it can "
      "number; use {}",
      n_parts, static_cast<double>(of_column * columns_of_widest(division)), most_nodes,
      is_possible(least) ? fmt::format("more processes, at least {}", least)
                         : "larger elements: more processes would have too few columns");
}

}  // namespace slipfront::motion
