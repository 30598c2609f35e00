// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/reorder.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/error.hpp"

namespace slipfront::mesh {

namespace {

/// Nodes that share a cell with node n: neighbour[first[n]] ... neighbour[first[n + 1] - 1].
struct Neighbours {
  std::vector<std::size_t> first;
  std::vector<Node> neighbour;
  std::span<const Node> of(Node n) const {
    return std::span(neighbour).subspan(first[n], first[n + 1] - first[n]);
  }
};

Neighbours neighbours(const Mesh& mesh) {
  std::vector<std::vector<Node>> lists(mesh.x_m.size());
  for (const Cell& cell : mesh.cells)
    for (const Node a : cell)
      for (const Node b : cell)
        if (a != b && std::ranges::find(lists[a], b) == lists[a].end()) lists[a].push_back(b);
  Neighbours result;
  result.first.push_back(0);
  for (const auto& list : lists) {
    result.neighbour.insert(result.neighbour.end(), list.begin(), list.end());
    result.first.push_back(result.neighbour.size());
  }
  return result;
}

/// Appends the nodes reached from `start` in the order of Cuthill and McKee: by levels, those of each node
/// with the fewest neighbours first.
void append_levels(const Neighbours& graph, Node start, std::vector<bool>& seen, std::vector<Node>& order) {
  const auto degree = [&](Node n) { return graph.of(n).size(); };
  std::size_t next = order.size();
  order.push_back(start);
  seen[start] = true;
  for (; next < order.size(); ++next) {
    const std::size_t begin = order.size();
    for (const Node n : graph.of(order[next]))
      if (!seen[n]) {
        seen[n] = true;
        order.push_back(n);
      }
    std::ranges::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end(),
                      [&](Node a, Node b) { return degree(a) != degree(b) ? degree(a) < degree(b) : a < b; });
  }
}

}  // namespace

std::vector<Node> near_numbers(const Mesh& mesh) {
  const auto graph = neighbours(mesh);
  const auto n_nodes = static_cast<Node>(mesh.x_m.size());
  std::vector<bool> done(n_nodes, false);
  std::vector<Node> order;
  order.reserve(n_nodes);
  for (Node n = 0; n < n_nodes; ++n) {
    if (done[n] || graph.of(n).empty()) continue;
    // The last node of an order is far from its start: begun there, the levels are narrow.
    Node start = n;
    for (int search = 0; search < 3; ++search) {
      auto seen = done;
      std::vector<Node> trial;
      append_levels(graph, start, seen, trial);
      start = trial.back();
    }
    append_levels(graph, start, done, order);
  }
  std::ranges::reverse(order);
  for (Node n = 0; n < n_nodes; ++n)
    if (!done[n]) order.push_back(n);
  std::vector<Node> number(n_nodes);
  for (Node k = 0; k < n_nodes; ++k) number[order[k]] = k;
  return number;
}

void renumber(Mesh& mesh, std::span<const Node> number) {
  const Mesh old = mesh;
  for (std::size_t n = 0; n < number.size(); ++n) {
    mesh.x_m[number[n]] = old.x_m[n];
    mesh.y_m[number[n]] = old.y_m[n];
  }
  for (Cell& cell : mesh.cells)
    for (Node& n : cell) n = number[n];
  for (auto* nodes : {&mesh.lower, &mesh.top})
    for (Node& n : *nodes) n = number[n];
  for (auto& a : mesh.absorbing) a.node = number[a.node];
  mesh.grid = {.spacing_m = old.grid.spacing_m};
  mesh.coarser.clear();
  mesh.column_first.clear();
}

namespace {

/// A node, and how far to the right the cells around it reach.
struct Extent {
  double x_m = 0, right_m = 0;
};

void append_extents(const Mesh& mesh, std::vector<Extent>& to) {
  const auto first = to.size();
  for (const double x_m : mesh.x_m) to.push_back({x_m, x_m});
  const auto widen = [&](std::span<const Node> nodes) {
    double right_m = -std::numeric_limits<double>::infinity();
    for (const Node n : nodes) right_m = std::max(right_m, mesh.x_m[n]);
    for (const Node n : nodes) {
      auto& extent = to[first + static_cast<std::size_t>(n)];
      extent.right_m = std::max(extent.right_m, right_m);
    }
  };
  for (const Cell& cell : mesh.cells) widen(cell);
  for (std::size_t k = 0; k + 1 < mesh.lower.size(); ++k) widen(std::span(mesh.lower).subspan(k, 2));
}

}  // namespace

std::vector<double> column_ends_m(std::span<const Mesh* const> bodies) {
  std::vector<Extent> extents;
  for (const auto* body : bodies) append_extents(*body, extents);
  std::ranges::sort(extents, {}, &Extent::x_m);
  std::vector<double> ends_m;
  if (extents.empty()) return ends_m;
  // Nodes that face each other may differ by rounding; no cut comes between them.
  const double rounding_m = 1e-9 * (extents.back().x_m - extents.front().x_m);
  double reached_m = -std::numeric_limits<double>::infinity();
  for (auto next = extents.begin(); next != extents.end();) {
    ends_m.push_back(std::max(reached_m, next->x_m) + rounding_m);
    for (; next != extents.end() && next->x_m <= ends_m.back(); ++next)
      reached_m = std::max(reached_m, next->right_m);
  }
  return ends_m;
}

void number_by_columns(Mesh& mesh, std::span<const double> ends_m) {
  if (mesh.period_m > 0)
    throw UserError("a mesh without a grid that repeats along x cannot be divided into columns");
  SLIPFRONT_ASSERT(mesh.x_m.empty() || std::ranges::max(mesh.x_m) <= ends_m.back(), "columns of this mesh");
  const auto n_nodes = static_cast<std::size_t>(mesh.n_nodes());
  std::vector<std::size_t> column(n_nodes);
  std::vector<Node> order(n_nodes), number(n_nodes), first(ends_m.size() + 1, 0);
  for (std::size_t n = 0; n < n_nodes; ++n) {
    column[n] = static_cast<std::size_t>(std::ranges::lower_bound(ends_m, mesh.x_m[n]) - ends_m.begin());
    ++first[column[n] + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Node n) {
    return std::tuple(column[static_cast<std::size_t>(n)], mesh.y_m[n], mesh.x_m[n], n);
  });
  for (std::size_t k = 0; k < n_nodes; ++k) number[static_cast<std::size_t>(order[k])] = static_cast<Node>(k);
  renumber(mesh, number);
  mesh.column_first = std::move(first);
}

void number_by_columns(Mesh& mesh) {
  const Mesh* const bodies[] = {&mesh};
  number_by_columns(mesh, column_ends_m(bodies));
}

}  // namespace slipfront::mesh
