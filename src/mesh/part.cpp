// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace slipfront::mesh {

Subset::Subset(std::vector<Range> ranges) : ranges_(std::move(ranges)) {
  for (std::size_t k = 0; k < ranges_.size(); ++k)
    SLIPFRONT_ASSERT(ranges_[k].begin < ranges_[k].end && (k == 0 || ranges_[k - 1].end <= ranges_[k].begin),
                     "ranges ascend");
}

int Subset::count() const {
  int n = 0;
  for (const auto& range : ranges_) n += range.end - range.begin;
  return n;
}

bool Subset::has(int number) const {
  return ranges_.empty() || std::ranges::any_of(ranges_, [&](const Range& range) {
           return number >= range.begin && number < range.end;
         });
}

int Subset::place_of(int number) const {
  int before = 0;
  for (const auto& range : ranges_) {
    if (number < range.end) return before + number - range.begin;
    before += range.end - range.begin;
  }
  return number;
}

int Subset::number_at(int place) const {
  int before = 0;
  for (const auto& range : ranges_) {
    if (place < before + range.end - range.begin) return place - before + range.begin;
    before += range.end - range.begin;
  }
  return place;
}

Subset Subset::below(int end) const {
  std::vector<Range> ranges;
  for (const auto& range : ranges_)
    if (range.begin < end) ranges.push_back({range.begin, std::min(range.end, end)});
  return Subset(std::move(ranges));
}

Mesh columns_of(const Mesh& whole, const Subset& columns) {
  const Grid& grid = whole.grid;
  SLIPFRONT_ASSERT(grid.columns > 0 && whole.coarser.empty(), "a plate of one block");
  Mesh mesh;
  mesh.grid = grid;
  mesh.grid.columns = columns.count() - 1;
  if (columns.ranges().size() > 1) mesh.period_m = whole.period_m;
  const auto column = [&](Node n) { return n % grid.stride(); };
  const auto has = [&](Node n) { return columns.has(column(n)); };
  const auto number = [&](Node n) { return mesh.grid.node(columns.place_of(column(n)), n / grid.stride()); };
  const auto n_nodes = static_cast<std::size_t>(mesh.grid.n_nodes());
  mesh.x_m.reserve(n_nodes);
  mesh.y_m.reserve(n_nodes);
  for (int j = 0; j <= grid.rows; ++j)
    for (const auto& range : columns.ranges())
      for (int i = range.begin; i < range.end; ++i) {
        mesh.x_m.push_back(whole.x_m[grid.node(i, j)]);
        mesh.y_m.push_back(whole.y_m[grid.node(i, j)]);
      }
  const auto at_cut = [&](Node n) {
    const int i = column(n);
    return (i > 0 && !columns.has(i - 1)) || (i < grid.columns && !columns.has(i + 1));
  };
  for (const Cell& cell : whole.cells) {
    if (std::ranges::all_of(cell, has)) {
      mesh.cells.push_back({number(cell[0]), number(cell[1]), number(cell[2]), number(cell[3])});
    } else if (std::ranges::any_of(cell, [&](Node n) { return has(n) && !at_cut(n); })) {
      throw UserError("a part of the plate would end within a rounded corner; choose fewer processes");
    }
  }
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
  return mesh;
}

}  // namespace slipfront::mesh
