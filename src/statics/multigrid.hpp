// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "statics/grid_level.hpp"
#include "statics/grid_product.hpp"
#include "threads/team.hpp"

namespace slipfront::statics {

/// Conditions on the nodes of a level's block rows: displacements that are prescribed, and nodes that slip,
/// where instead of f_x = 0 the equation is f_x + factor f_y = 0. [block rows]
template <class T>
struct Conditions {
  std::vector<std::uint8_t> fixed;  ///< bit 0: x, bit 1: y
  std::vector<T> slip;              ///< factor, 0 where the node does not slip

  explicit Conditions(std::size_t n) : fixed(n, 0), slip(n, T(0)) {}
};

/// One geometric multigrid cycle for the stiffness of a plate, or of two bodies, with prescribed
/// displacements, in single precision: an approximation of the inverse, symmetric and positive definite where
/// no node slips.
///
/// V-cycles with Chebyshev polynomials of the diagonally scaled stiffness as smoother (Adams, Brezina, Hu,
/// Tuminaro, J. Comput. Phys. 188, 593-610, 2003) and a direct solution on the coarsest level. Each level's
/// data pass through memory twice in a cycle: smoothing, residual and restriction in one sweep of the rows,
/// prolongation and smoothing in the other, each step a few rows behind the last. Threads take bands of rows
/// and compute what they need beside them as well, so that the result is the same, bit for bit, for any
/// number of them.
class Multigrid {
 public:
  Multigrid(GridLevel finest, threads::Team& team);
  ~Multigrid();
  Multigrid(const Multigrid&) = delete;
  Multigrid& operator=(const Multigrid&) = delete;

  /// Prescribes what happens at a level's boundary, and begins cycles there from now on; a coarse node is
  /// fixed or slips where the finer node at its place does.
  void prescribe(const Conditions<double>& conditions, int level);

  /// z = B r on the level last prescribed; 0 at fixed displacements.
  /// @return r . z
  double apply(const Rows<const double>& r);
  double apply(const Rows<const float>& r);
  const GridField<float>& z() const;

  int n_levels() const { return static_cast<int>(levels_.size()); }
  const GridLevel& grid(int level) const;
  /// Blocks of a level's block rows in single precision, and factors of slip as they were last prescribed.
  const std::vector<std::array<float, 4>>& blocks(int level) const;
  const std::vector<float>& slip(int level) const;
  const Transfer& transfer(int finer_level) const;
  /// Parts into which the work on a level is cut: one, or one for each thread.
  int parts(int level) const;
  int n_cycles() const { return n_cycles_; }  ///< begun on the finest level so far

 private:
  struct Level;
  struct Workspace;
  template <class B>
  double cycle(std::size_t l, const Rows<const B>& b);
  template <class B>
  void smooth_and_restrict(std::size_t l, const Rows<const B>& b);
  template <class B>
  double prolong_and_smooth(std::size_t l, const Rows<const B>& b);
  void factorise_coarsest();
  template <class B>
  double solve_coarsest(const Rows<const B>& b);

  threads::Team& team_;
  std::vector<Workspace> workspace_;  ///< [threads]
  std::vector<std::unique_ptr<Level>> levels_;
  int top_level_ = 0;  ///< on which cycles begin
  int n_cycles_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
  std::vector<std::int32_t> coarsest_unknown_;  ///< [2 nodes] or -1
  Eigen::VectorXd coarsest_b_;
  std::vector<double> row_sum_;
};

}  // namespace slipfront::statics
