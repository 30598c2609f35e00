// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace slipfront::mesh {

MeshPart columns_of(const Mesh& whole, int first, int end) {
  const Grid& grid = whole.grid;
  SLIPFRONT_ASSERT(grid.columns > 0 && whole.coarser.empty() && whole.period_m == 0, "a plate of one block");
  SLIPFRONT_ASSERT(first >= 0 && end - first > 1 && end <= grid.stride(), "columns of the plate");
  MeshPart part;
  part.first_column = first;
  Mesh& mesh = part.mesh;
  mesh.grid = grid;
  mesh.grid.columns = end - first - 1;
  const auto column = [&](Node n) { return n % grid.stride(); };
  const auto has = [&](Node n) { return column(n) >= first && column(n) < end; };
  const auto number = [&](Node n) { return mesh.grid.node(column(n) - first, n / grid.stride()); };
  const auto n_nodes = static_cast<std::size_t>(mesh.grid.n_nodes());
  mesh.x_m.reserve(n_nodes);
  mesh.y_m.reserve(n_nodes);
  for (int j = 0; j <= grid.rows; ++j)
    for (int i = first; i < end; ++i) {
      mesh.x_m.push_back(whole.x_m[grid.node(i, j)]);
      mesh.y_m.push_back(whole.y_m[grid.node(i, j)]);
    }
  const auto at_cut = [&](Node n) {
    return (column(n) == first && first > 0) || (column(n) == end - 1 && end < grid.stride());
  };
  for (const Cell& cell : whole.cells) {
    if (std::ranges::all_of(cell, has)) {
      mesh.cells.push_back({number(cell[0]), number(cell[1]), number(cell[2]), number(cell[3])});
    } else if (std::ranges::any_of(cell, [&](Node n) { return has(n) && !at_cut(n); })) {
      throw UserError("a part of the plate would end within a rounded corner; choose fewer processes");
    }
  }
  part.first_lower = static_cast<std::size_t>(std::ranges::find_if(whole.lower, has) - whole.lower.begin());
  const auto take = [&](const std::vector<Node>& from, std::vector<Node>& to) {
    for (const Node n : from)
      if (has(n)) to.push_back(number(n));
  };
  take(whole.lower, mesh.lower);
  take(whole.top, mesh.top);
  for (AbsorbingNode absorbing : whole.absorbing) {
    if (!has(absorbing.node)) continue;
    absorbing.node = number(absorbing.node);
    mesh.absorbing.push_back(absorbing);
  }
  return part;
}

}  // namespace slipfront::mesh
