// SPDX-License-Identifier: BSD-3-Clause
#include "statics/frontal_cholesky.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/interruption.hpp"
#include "statics/settings.hpp"

namespace slipfront::statics {

std::string algebra_library() {
  return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

FrontalCholesky::FrontalCholesky(std::vector<std::int32_t> block_ends, std::vector<CellUnknowns> cells)
    : cells_(std::move(cells)) {
  const std::int32_t n = block_ends.empty() ? 0 : block_ends.back();
  std::vector<std::int32_t> block_of(n);
  std::int32_t first = 0;
  for (const auto end : block_ends) {
    if (end == first) continue;
    std::fill(block_of.begin() + first, block_of.begin() + end, static_cast<std::int32_t>(blocks_.size()));
    blocks_.push_back({.first = first, .end = end});
    first = end;
  }
  distribute_cells(block_of);
  find_rows(block_of);
  measure_fronts();
}

template <class Work>
void FrontalCholesky::for_each_child(const Block& block, Work work) const {
  for (auto child = block.first_child; child >= 0; child = blocks_[child].next_sibling) work(child);
}

void FrontalCholesky::distribute_cells(const std::vector<std::int32_t>& block_of) {
  const auto block_of_cell = [&](const CellUnknowns& cell) {
    std::int32_t first = -1;
    for (const auto u : cell)
      if (u >= 0 && (first < 0 || u < first)) first = u;
    return first < 0 ? -1 : block_of[first];
  };
  first_cell_.assign(blocks_.size() + 1, 0);
  for (const auto& cell : cells_)
    if (const auto b = block_of_cell(cell); b >= 0) ++first_cell_[b + 1];
  std::partial_sum(first_cell_.begin(), first_cell_.end(), first_cell_.begin());
  cell_.resize(first_cell_.back());
  auto next = first_cell_;
  for (std::size_t k = 0; k < cells_.size(); ++k)
    if (const auto b = block_of_cell(cells_[k]); b >= 0) cell_[next[b]++] = static_cast<std::uint32_t>(k);
}

void FrontalCholesky::find_rows(const std::vector<std::int32_t>& block_of) {
  std::vector<std::int32_t> seen(block_of.size(), -1), rows;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    auto& block = blocks_[b];
    rows.clear();
    const auto see = [&](std::int32_t u) {
      if (u < block.end || seen[u] == static_cast<std::int32_t>(b)) return;
      seen[u] = static_cast<std::int32_t>(b);
      rows.push_back(u);
    };
    for (auto k = first_cell_[b]; k < first_cell_[b + 1]; ++k)
      for (const auto u : cells_[cell_[k]]) see(u);
    for_each_child(block, [&](std::int32_t child) {
      for (std::int32_t r = 0; r < blocks_[child].n_rows; ++r) see(rows_[blocks_[child].first_row + r]);
    });
    std::ranges::sort(rows);
    block.first_row = rows_.size();
    block.n_rows = static_cast<std::int32_t>(rows.size());
    block.first_value = n_values_;
    n_values_ += static_cast<std::size_t>(block.height()) * block.n_columns();
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    if (rows.empty()) continue;
    auto& parent = blocks_[block_of[rows.front()]];
    block.next_sibling = std::exchange(parent.first_child, static_cast<std::int32_t>(b));
  }
}

void FrontalCholesky::measure_fronts() {
  const auto rest = [](const Block& block) { return static_cast<double>(block.n_rows) * block.n_rows; };
  double waiting = 0, most = 0;
  for (const auto& block : blocks_) {
    waiting += rest(block);
    most = std::max(most, waiting);
    for_each_child(block, [&](std::int32_t child) { waiting -= rest(blocks_[child]); });
  }
  front_bytes_ = sizeof(double) * most;
}

/// Where in a block's front its unknowns stand.
void FrontalCholesky::place_unknowns(const Block& block, std::vector<std::int32_t>& place) const {
  for (std::int32_t u = block.first; u < block.end; ++u) place[u] = u - block.first;
  for (std::int32_t r = 0; r < block.n_rows; ++r) place[rows_[block.first_row + r]] = block.n_columns() + r;
}

void FrontalCholesky::add_cells(std::size_t b, const StiffnessOf& stiffness_of,
                                const std::vector<std::int32_t>& place, Columns& columns,
                                Eigen::MatrixXd& rest) const {
  const auto n = blocks_[b].n_columns();
  for (auto k = first_cell_[b]; k < first_cell_[b + 1]; ++k) {
    const auto& cell = cells_[cell_[k]];
    const auto& K = stiffness_of(cell_[k]);
    for (std::size_t j = 0; j < 8; ++j) {
      if (cell[j] < 0) continue;
      const auto column = place[cell[j]];
      for (std::size_t i = 0; i < 8; ++i) {
        if (cell[i] < 0 || place[cell[i]] < column) continue;
        const auto row = place[cell[i]];
        (column < n ? columns(row, column) : rest(row - n, column - n)) += K[8 * i + j];
      }
    }
  }
}

void FrontalCholesky::add_rest(const Block& child, const Eigen::MatrixXd& from, const Block& block,
                               const std::vector<std::int32_t>& place, Columns& columns,
                               Eigen::MatrixXd& rest) const {
  const auto n = block.n_columns();
  const std::int32_t* const rows = rows_.data() + child.first_row;
  for (std::int32_t j = 0; j < child.n_rows; ++j) {
    const auto column = place[rows[j]];
    double* const to = column < n ? &columns(0, column) : &rest(0, column - n) - n;
    const double* const values = &from(0, j);
    for (std::int32_t i = j; i < child.n_rows; ++i) to[place[rows[i]]] += values[i];
  }
}

namespace {

/// The factor's columns of the unknowns of a front's first columns, in their place, and what is left.
/// @return false where they are not definite
bool eliminate(Eigen::Map<Eigen::MatrixXd>& columns, Eigen::MatrixXd& rest) {
  Eigen::Ref<Eigen::MatrixXd> diagonal = columns.topRows(columns.cols());
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(diagonal);
  if (in_place.info() != Eigen::Success) return false;
  if (rest.size() == 0) return true;
  auto below = columns.bottomRows(rest.rows());
  diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
  rest.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  return true;
}

}  // namespace

std::optional<Eigen::MatrixXd> FrontalCholesky::factorise(const StiffnessOf& stiffness_of,
                                                          const Eigen::VectorXd& springs) {
  values_.assign(n_values_, 0.0);
  std::vector<std::int32_t> place(blocks_.back().end);
  std::vector<Eigen::MatrixXd> rests(blocks_.size());
  Eigen::MatrixXd last;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    require_no_interruption(interrupted_in_statics);
    const auto& block = blocks_[b];
    Columns columns(values_.data() + block.first_value, block.height(), block.n_columns());
    rests[b].setZero(block.n_rows, block.n_rows);
    place_unknowns(block, place);
    add_cells(b, stiffness_of, place, columns, rests[b]);
    for_each_child(block, [&](std::int32_t child) {
      add_rest(blocks_[child], rests[child], block, place, columns, rests[b]);
      rests[child].resize(0, 0);
    });
    if (b + 1 == blocks_.size()) {
      last = columns.selfadjointView<Eigen::Lower>();
      columns.diagonal() += springs;
    }
    if (!eliminate(columns, rests[b])) return std::nullopt;
  }
  return last;
}

void FrontalCholesky::solve(std::vector<double>& x) const {
  const auto columns_of = [&](const Block& block) {
    return Eigen::Map<const Eigen::MatrixXd>(values_.data() + block.first_value, block.height(),
                                             block.n_columns());
  };
  Eigen::VectorXd rest;
  for (const auto& block : blocks_) {
    const auto L = columns_of(block);
    Eigen::Map<Eigen::VectorXd> own(x.data() + block.first, block.n_columns());
    L.topRows(block.n_columns()).triangularView<Eigen::Lower>().solveInPlace(own);
    rest.noalias() = L.bottomRows(block.n_rows) * own;
    for (std::int32_t r = 0; r < block.n_rows; ++r) x[rows_[block.first_row + r]] -= rest(r);
  }
  for (auto block = blocks_.rbegin(); block != blocks_.rend(); ++block) {
    const auto L = columns_of(*block);
    Eigen::Map<Eigen::VectorXd> own(x.data() + block->first, block->n_columns());
    rest.resize(block->n_rows);
    for (std::int32_t r = 0; r < block->n_rows; ++r) rest(r) = x[rows_[block->first_row + r]];
    own.noalias() -= L.bottomRows(block->n_rows).transpose() * rest;
    L.topRows(block->n_columns()).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
}

}  // namespace slipfront::statics
