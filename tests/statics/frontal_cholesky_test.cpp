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
  Eigen::MatrixXd dense(Eigen::Index n) const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t cell = 0; cell < unknowns.size(); ++cell)
      for (int k = 0; k < 64; ++k) {
        const auto i = unknowns[cell][k / 8], j = unknowns[cell][k % 8];
        if (i >= 0 && j >= 0) K(i, j) += stiffness[cell][k];
      }
    return K;
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
constexpr Eigen::Index n_some = 16, n_last = 4;

TEST(FrontalCholesky, SolvesAsADenseFactorDoesAndGivesTheSchurComplementWithoutTheSprings) {
  const auto cells = some_cells();
  FrontalCholesky factor(some_ends, cells.unknowns);
  const Eigen::VectorXd springs = Eigen::VectorXd::LinSpaced(n_last, 1, 4);
  const auto S = factor.factorise(cells.stiffness_of(), springs);
  ASSERT_TRUE(S);
  Eigen::MatrixXd K = cells.dense(n_some);
  const auto n = n_some - n_last;
  const Eigen::MatrixXd schur =
      K.bottomRightCorner(n_last, n_last) -
      K.bottomLeftCorner(n_last, n) * K.topLeftCorner(n, n).llt().solve(K.topRightCorner(n, n_last));
  EXPECT_LE(test::max_abs(*S - schur), 1e-13 * test::max_abs(schur));
  EXPECT_EQ(test::max_abs(*S - S->transpose()), 0);
  K.diagonal().tail(n_last) += springs;
  Random random(4);
  const Eigen::VectorXd f = Eigen::VectorXd::NullaryExpr(n_some, [&] { return random(); });
  std::vector<double> x(f.data(), f.data() + n_some);
  factor.solve(x);
  const Eigen::VectorXd expected = K.llt().solve(f);
  // Two direct solutions of a system whose condition number is of the order of 100.
  for (Eigen::Index k = 0; k < n_some; ++k)
    EXPECT_NEAR(x[k], expected(k), 1e-13 * expected.lpNorm<Eigen::Infinity>());
}

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
