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

/// Stepping of a body whose steps are taken together with those of a faster one.
TimeStepping stepping_of(std::span<const BodySteps> steps, std::size_t body, const TimeStepping& time) {
  const double least_s = std::ranges::min(steps, {}, &BodySteps::stable_step_s).stable_step_s;
  auto of_body = time;
  of_body.interface_substeps *= steps_at_once(steps[body].stable_step_s, least_s);
  return of_body;
}

}  // namespace

mesh::Subset Division::all(int part) const {
  const auto columns = own(part);
  int begin = columns.begin - halo_below(part), end = columns.end + halo_above(part);
  if (rim > 0) {
    begin = std::max(0, begin - rim);
    end = std::min(end + rim, n_columns());
  }
  if (begin < 0) return mesh::Subset({{0, end}, {first.back() + begin, n_columns()}});
  if (end > first.back()) return mesh::Subset({{0, end - first.back()}, {begin, n_columns()}});
  return mesh::Subset({{begin, end}});
}

int Division::narrowest() const {
  int least = n_columns();
  for (int part = 0; part < n_parts(); ++part) least = std::min(least, own(part).end - own(part).begin);
  return least;
}

int columns_per_step(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                     const TimeStepping& time) {
  std::vector<std::vector<LevelReach>> levels;
  int substeps = 1;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    levels.push_back(reach_of_levels(bodies[b].mesh, stepping_of(steps, b, time), steps[b].multiples));
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

namespace {

/// Gives parts that are divided already steps between two exchanges, and a halo.
void set_halo(Division& division, int columns_per_step, int reach) {
  division.steps_per_exchange =
      std::clamp(static_cast<int>(0.5 * tolerated_halo * division.narrowest() / columns_per_step), 1,
                 most_steps_per_exchange);
  division.columns_per_step = columns_per_step;
  division.halo = division.steps_per_exchange * columns_per_step + reach;
}

/// Of meshes without a grid, which have the same columns. Each part begins at the column nearest to its share
/// of the nodes.
/// @param before  [columns + 1] nodes in columns below this one
std::vector<int> first_of_equal_nodes(std::span<const std::int64_t> before, int n_parts) {
  std::vector<int> first;
  for (int k = 0; k <= n_parts; ++k) {
    const auto wanted = before.back() * k / n_parts;
    const auto above = std::ranges::lower_bound(before, wanted);
    const bool takes_below = above != before.begin() && wanted - above[-1] < *above - wanted;
    first.push_back(static_cast<int>(above - before.begin()) - (takes_below ? 1 : 0));
  }
  return first;
}

bool is_without_grid(const mesh::Mesh& mesh) {
  return mesh.grid.columns == 0;
}

/// Of bodies without a grid the nodes of all in columns below each one.
std::vector<std::int64_t> nodes_before_columns(std::span<const BodySource> bodies) {
  const auto n = bodies.front().mesh.column_first.size();
  std::vector<std::int64_t> before(n, 0);
  for (const auto& body : bodies) {
    const auto& of_body = body.mesh.column_first;
    if (is_without_grid(body.mesh) && of_body.empty())
      throw UserError(
          "processes can share a mesh without a grid only where its nodes are numbered by columns");
    if (!is_without_grid(body.mesh) || of_body.size() != n)
      throw UserError("processes can share two bodies only where both have the same columns of nodes");
    for (std::size_t k = 0; k < n; ++k) before[k] += of_body[k];
  }
  return before;
}

}  // namespace

Division divide_columns(const mesh::Mesh& mesh, int n_parts, int columns_per_step, int reach) {
  Division division;
  division.is_ring = mesh.period_m > 0;
  const int n_columns = mesh.grid.stride() - (division.is_ring ? 1 : 0);
  for (int k = 0; k <= n_parts; ++k)
    division.first.push_back(static_cast<int>(static_cast<std::int64_t>(n_columns) * k / n_parts));
  set_halo(division, columns_per_step, reach);
  return division;
}

namespace {

/// Why parts do not know of the whole what they need; empty where they do.
/// @param widest_cell  columns over which it reaches: the halos of a part that go round a ring do not meet
/// @param corner       columns at either end among which no part begins or ends
std::string reason_against(const Division& division, int widest_cell, int corner) {
  const int n_parts = division.n_parts(), width = division.narrowest();
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

/// Bodies without a grid.
class GeneralBodies {
 public:
  GeneralBodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                const TimeStepping& time)
      : nodes_before_(nodes_before_columns(bodies)), lower_(columns_of_lower(bodies.front().mesh)) {
    if (columns_of_lower(bodies.back().mesh) != lower_)
      throw UserError(
          "processes can share two bodies only where nodes that face each other have the same column");
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (stepping_of(steps, b, time).interface_substeps > 1) rim_ = time.interface_rows;
    per_step_ = columns_per_step(bodies, steps, time);
  }

  Division divided(int n_parts) const {
    Division division;
    division.first = first_of_equal_nodes(nodes_before_, n_parts);
    division.rim = rim_;
    set_halo(division, per_step_, 1);
    return division;
  }

  std::string reason_against(const Division& division) const {
    auto reason = motion::reason_against(division, 1, 0);
    for (int part = 0; part < division.n_parts() && reason.empty(); ++part) {
      const auto own = division.own(part);
      const auto first = std::ranges::lower_bound(lower_, own.begin);
      if (first == lower_.end() || *first >= own.end)
        reason = fmt::format("of {} processes one would have no interface", division.n_parts());
    }
    return reason;
  }

 private:
  static std::vector<int> columns_of_lower(const mesh::Mesh& mesh) {
    const mesh::NodeColumns columns(mesh);
    std::vector<int> of_lower;
    for (const auto n : mesh.lower) of_lower.push_back(columns.column_of(n));
    SLIPFRONT_ASSERT(std::ranges::is_sorted(of_lower), "interface nodes in the order of columns");
    return of_lower;
  }

  std::vector<std::int64_t> nodes_before_;
  std::vector<int> lower_;  ///< columns of the interface nodes
  int rim_ = 0, per_step_ = 1;
};

/// @param divided(n)   into so many parts
/// @param why_not(d)   see reason_against
template <class Divided, class WhyNot>
Division divide(int n_parts, Divided&& divided, WhyNot&& why_not) {
  auto division = divided(n_parts);
  const std::string reason = why_not(division);
  if (reason.empty()) return division;
  int most = n_parts - 1;
  while (!why_not(divided(most)).empty()) --most;
  throw UserError("{}; choose at most {}", reason, most);
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
  if (std::ranges::any_of(bodies, [](const BodySource& body) { return is_without_grid(body.mesh); })) {
    const GeneralBodies general(bodies, steps, time);
    return divide(
        n_parts, [&](int n) { return general.divided(n); },
        [&](const Division& division) { return general.reason_against(division); });
  }
  // Probes look at all nodes of a cell, wherever its first one lies.
  int widest_cell = 1, corner = 0;
  for (const auto& body : bodies) {
    widest_cell = std::max(widest_cell, 1 << body.mesh.coarser.size());
    corner = std::max(
        {corner, mesh::columns_of_wrapped_cells(body.mesh), columns_of_rounded_layer(body.mesh, time)});
  }
  const int per_step = columns_per_step(bodies, steps, time);
  const auto divided = [&](int n) { return divide_columns(bodies.front().mesh, n, per_step, widest_cell); };
  const auto why_not = [&](const Division& d) { return reason_against(d, widest_cell, corner); };
  auto division = divide(n_parts, divided, why_not);
  const auto of_column = nodes_of_column_in_parts(bodies);
  const auto can_number = [&](const Division& d) { return of_column * columns_of_widest(d) <= most_nodes; };
  if (can_number(division)) return division;
  const auto is_possible = [&](int n) { return why_not(divided(n)).empty(); };
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
