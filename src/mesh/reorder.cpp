// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/reorder.hpp"

#include <algorithm>

namespace slipfront::mesh {

namespace {

/// Nodes that share a cell with each node.
using Neighbours = std::vector<std::vector<Node>>;

Neighbours neighbours(const Mesh& mesh) {
  Neighbours all(mesh.x_m.size());
  for (const Cell& cell : mesh.cells)
    for (const Node a : cell)
      for (const Node b : cell)
        if (a != b && std::ranges::find(all[a], b) == all[a].end()) all[a].push_back(b);
  return all;
}

/// Appends the nodes reached from `start` in the order of Cuthill and McKee: by levels, those of each node
/// with the fewest neighbours first.
void append_levels(const Neighbours& graph, Node start, std::vector<bool>& seen, std::vector<Node>& order) {
  const auto degree = [&](Node n) { return graph[n].size(); };
  std::size_t next = order.size();
  order.push_back(start);
  seen[start] = true;
  for (; next < order.size(); ++next) {
    const std::size_t begin = order.size();
    for (const Node n : graph[order[next]])
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
    if (done[n] || graph[n].empty()) continue;
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
  for (auto* nodes : {&mesh.interface_nodes, &mesh.far_edge_nodes, &mesh.left_nodes})
    for (Node& n : *nodes) n = number[n];
  for (auto& a : mesh.absorbing_nodes) a.node = number[a.node];
  mesh.grid = {.spacing_m = old.grid.spacing_m};
  mesh.coarser.clear();
}

}  // namespace slipfront::mesh
