// SPDX-License-Identifier: BSD-3-Clause
#include "statics/frontal_cholesky.hpp"

#include <gtest/gtest.h>

#include "support/matrices.hpp"

namespace slipfront::statics {
namespace {

/// Cells with random definite matrices on unknowns of a chain of blocks; -1 is prescribed.
struct Cells {
  std::vector<CellUnknowns> unknowns;
  std::vector<solid::CellStiffness> stiffness;

  void add(const CellUnknowns& cell, Random& random) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(8, 8, [&] { return random(); });
    const Eigen::MatrixXd K = A * A.transpose() + Eigen::MatrixXd::Identity(8, 8);
    unknowns.push_back(cell);
    stiffness.emplace_back();
    for (int k = 0; k < 64; ++k) stiffness.back()[k] = K(k / 8, k % 8);
  }
  FrontalCholesky::StiffnessOf stiffness_of() const {
    return [this](std::size_t cell) -> const solid::CellStiffness& { return stiffness[cell]; };
  }
};

/// Two halves that do not touch, one of them in two blocks, a separator and a last block; unknown 11 touches
/// the last block alone, one cell is prescribed throughout.
Cells some_cells() {
  Random random(3);
  Cells cells;
  cells.add({0, 1, 2, 3, 4, 5, 10, -1}, random);
  cells.add({6, 7, 8, 9, 10, -1, 12, 13}, random);
  cells.add({4, 5, 10, 12, 13, 14, -1, 3}, random);
  cells.add({11, 12, 14, 15, -1, -1, -1, 13}, random);
  cells.add({-1, -1, -1, -1, -1, -1, -1, -1}, random);
  return cells;
}
const std::vector<std::int32_t> some_ends{3, 6, 6, 10, 11, 12, 16};
constexpr Eigen::Index n_last = 4;

TEST(FrontalCholesky, TellsAMatrixThatIsNotDefinite) {
  auto cells = some_cells();
  cells.stiffness[1][9 * 2] = -100;  // of unknown 8, which no other cell has
  FrontalCholesky factor(some_ends, cells.unknowns);
  EXPECT_FALSE(factor.factorise(cells.stiffness_of(), Eigen::VectorXd::Zero(n_last)));
}

TEST(FrontalCholesky, KnowsItsSizesBeforeItComputes) {
  const FrontalCholesky factor(some_ends, some_cells().unknowns);
  // Columns of each block times its unknowns and the later ones that it is coupled with: 3 of {0..5, 10},
  // 3 of {3, 4, 5, 10, 12, 13, 14}, 4 of {6..10, 12, 13}, 1 of {10, 12, 13, 14}, 1 of {11..15}, 4 of 4.
  EXPECT_EQ(factor.factor_bytes(), 8 * (3 * 7 + 3 * 7 + 4 * 7 + 4 + 5 + 16));
}

}  // namespace
}  // namespace slipfront::statics
