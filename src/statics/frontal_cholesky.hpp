// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "solid/element.hpp"

namespace slipfront::statics {

/// Unknowns of a cell, -1 where a displacement is prescribed.
using CellUnknowns = std::array<std::int32_t, 8>;

/// Cholesky factor of a symmetric definite matrix that is a sum over cells, by the multifrontal method (Duff
/// and Reid 1983; Liu 1992). The unknowns are eliminated block by block in the order of their numbers, as
/// nested dissection gives it. A block has a dense front: its own unknowns and those of later blocks that it
/// is coupled with. The front is the sum of the block's cells and of what is left of earlier fronts; its
/// columns become the factor's, and what is left of it goes to the block of the first of its other unknowns.
/// Nothing is left over to be added to the last front: it is the Schur complement of the last block.
///
/// Several threads may make and use different ones at once.
class FrontalCholesky {
 public:
  /// Finds the fronts' sizes; nothing is computed yet.
  /// @param block_ends  the number behind the last unknown of each block, increasing
  FrontalCholesky(std::vector<std::int32_t> block_ends, std::vector<CellUnknowns> cells);

  /// Size of the factor, of the fronts that are there at once while it is made, and of the numbers that
  /// describe both.
  double factor_bytes() const { return sizeof(double) * static_cast<double>(n_values_); }
  double front_bytes() const { return front_bytes_; }

  /// Stiffness of a cell, by its place in `cells`; asked for each cell once.
  using StiffnessOf = std::function<const solid::CellStiffness&(std::size_t cell)>;
  /// @param springs  added to the diagonal of the last block once its Schur complement is taken
  /// @return the Schur complement of the last block; none where the matrix is not definite
  /// @throws std::bad_alloc
  std::optional<Eigen::MatrixXd> factorise(const StiffnessOf& stiffness_of, const Eigen::VectorXd& springs);

  /// x = K^-1 x, springs included. After factorise.
  void solve(std::vector<double>& x) const;

 private:
  struct Block {
    std::int32_t first, end;         ///< its unknowns
    std::int32_t n_rows = 0;         ///< later unknowns that it is coupled with
    std::size_t first_row = 0;       ///< of these in rows_
    std::size_t first_value = 0;     ///< in values_
    std::int32_t first_child = -1;   ///< blocks whose fronts leave something to this one
    std::int32_t next_sibling = -1;  ///< the next child of the same block
    std::int32_t n_columns() const { return end - first; }
    std::int32_t height() const { return n_columns() + n_rows; }
  };
  using Columns = Eigen::Map<Eigen::MatrixXd>;

  void distribute_cells(const std::vector<std::int32_t>& block_of);
  void find_rows(const std::vector<std::int32_t>& block_of);
  void measure_fronts();
  template <class Work>
  void for_each_child(const Block& block, Work work) const;
  void place_unknowns(const Block& block, std::vector<std::int32_t>& place) const;
  void add_cells(std::size_t b, const StiffnessOf& stiffness_of, const std::vector<std::int32_t>& place,
                 Columns& columns, Eigen::MatrixXd& rest) const;
  void add_rest(const Block& child, const Eigen::MatrixXd& from, const Block& block,
                const std::vector<std::int32_t>& place, Columns& columns, Eigen::MatrixXd& rest) const;

  std::vector<CellUnknowns> cells_;
  std::vector<std::uint32_t> cell_;      ///< places in cells_, by the block of their first unknown
  std::vector<std::size_t> first_cell_;  ///< [blocks + 1] in cell_
  std::vector<Block> blocks_;
  std::vector<std::int32_t> rows_;
  std::size_t n_values_ = 0;
  std::vector<double> values_;  ///< the factor: of each block its columns, one after the other
  double front_bytes_ = 0;
};

}  // namespace slipfront::statics
