// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/node_columns.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "base/error.hpp"

namespace slipfront::mesh {

Subset::Subset(std::vector<Span> ranges) : ranges_(std::move(ranges)) {
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
  return ranges_.empty() || std::ranges::any_of(ranges_, [&](const Span& range) {
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
  std::vector<Span> ranges;
  for (const auto& range : ranges_)
    if (range.begin < end) ranges.push_back({range.begin, std::min(range.end, end)});
  return Subset(std::move(ranges));
}

namespace {

/// Nodes of a row of the whole in columns below `column`. Of a transition every fourth column has none.
int n_below(int block, bool is_inner, int column) {
  const int size = 1 << block;
  const int n = (column + size - 1) / size;
  return is_inner ? n - (n + 3) / 4 : n;
}

int column_at(int block, bool is_inner, int place) {
  return (is_inner ? place + 1 + place / 3 : place) << block;
}

}  // namespace

NodeColumns::NodeColumns(const Mesh& whole)
    : NodeColumns(whole, Subset(), whole.grid.columns > 0 ? whole.grid.stride() : whole.n_nodes()) {}

NodeColumns::NodeColumns(const Mesh& part, const Subset& held, int n_columns) : n_columns_(n_columns) {
  add_rows(blocks(part), held);
  SLIPFRONT_ASSERT(part.is_interface() || n_nodes() == part.n_nodes(), "columns of this mesh");
}

NodeColumns::NodeColumns(std::span<const Grid> blocks) : n_columns_(blocks.front().stride()) {
  add_rows(blocks, Subset());
}

void NodeColumns::add_rows(std::span<const Grid> blocks, const Subset& held) {
  is_whole_ = held.ranges().empty();
  const Subset columns = is_whole_ ? Subset({{0, n_columns_}}) : held;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    for (int j = 0; j <= blocks[k].rows; ++j) add_row(static_cast<int>(k), false, columns);
    if (k + 1 < blocks.size()) add_row(static_cast<int>(k), true, columns);
  }
}

NodeColumns NodeColumns::of_subdomain(const Subset& held) const {
  NodeColumns part;
  part.n_columns_ = n_columns_;
  for (const auto& row : rows_) part.add_row(row.block, row.is_inner, held);
  return part;
}

void NodeColumns::add_row(int block, bool is_inner, const Subset& columns) {
  Row row{block, is_inner, 0, 0, {}};
  if (!rows_.empty()) {
    const auto& below = rows_.back();
    row.first = below.first + below.held.count();
    row.first_global = below.first_global + n_below(below.block, below.is_inner, n_columns_);
  }
  std::vector<Span> places;
  for (const auto& range : columns.ranges())
    places.push_back({n_below(block, is_inner, range.begin), n_below(block, is_inner, range.end)});
  row.held = Subset(std::move(places));
  rows_.push_back(std::move(row));
}

NodeColumns::Nodes NodeColumns::nodes(int row, Span columns) const {
  const auto& [block, is_inner, first, first_global, held] = rows_[row];
  const int begin = n_below(block, is_inner, columns.begin), end = n_below(block, is_inner, columns.end);
  return {first + held.place_of(begin), end - begin};
}

int NodeColumns::row_of(std::int64_t n) const {
  const auto above = std::ranges::upper_bound(rows_, n, {}, &Row::first);
  return static_cast<int>(above - rows_.begin()) - 1;
}

int NodeColumns::column_of(std::int64_t n) const {
  const auto& row = rows_[row_of(n)];
  return column_at(row.block, row.is_inner, row.held.number_at(static_cast<int>(n - row.first)));
}

std::int64_t NodeColumns::global_number(std::int64_t n) const {
  if (is_whole_) return n;
  const auto& row = rows_[row_of(n)];
  return row.first_global + row.held.number_at(static_cast<int>(n - row.first));
}

const NodeColumns::Row& NodeColumns::global_row_of(std::int64_t number) const {
  return *std::prev(std::ranges::upper_bound(rows_, number, {}, &Row::first_global));
}

Node NodeColumns::local_node(std::int64_t number) const {
  const auto& row = global_row_of(number);
  return static_cast<Node>(row.first + row.held.place_of(static_cast<int>(number - row.first_global)));
}

int NodeColumns::global_column_of(std::int64_t number) const {
  const auto& row = global_row_of(number);
  return column_at(row.block, row.is_inner, static_cast<int>(number - row.first_global));
}

int columns_of_cells(const Mesh& mesh, int block) {
  return 1 << std::min(block + 1, static_cast<int>(mesh.coarser.size()));
}

int columns_of_wrapped_cells(const Mesh& mesh) {
  const auto& grid = mesh.grid;
  if (std::ranges::all_of(mesh.interface_nodes, [&](Node n) { return n < grid.stride(); })) return 0;
  int columns = 0;
  for (const Cell& cell : mesh.cells) {
    if (std::ranges::max(cell) >= grid.n_nodes()) continue;
    std::array<int, 4> of_cell{};
    std::ranges::transform(cell, of_cell.begin(), [&](Node n) { return n % grid.stride(); });
    const auto [first, last] = std::ranges::minmax(of_cell);
    if (last - first > 1) columns = std::max(columns, std::min(last, grid.columns - first));
  }
  return columns;
}

}  // namespace slipfront::mesh
