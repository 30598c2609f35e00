// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "solve/grid_level.hpp"
#include "solve/grid_product.hpp"

namespace slipfront::solve {

/// Displacements that are prescribed, as lists of nodes on the boundary.
struct FixedNodes {
  std::vector<mesh::Node> x, y;
};

/// One geometric multigrid cycle for the plate's stiffness with prescribed displacements, in single
/// precision: a symmetric, positive definite approximation of the inverse.
///
/// V-cycles with Chebyshev polynomials of the diagonally scaled stiffness as smoother (Adams, Brezina, Hu,
/// Tuminaro, J. Comput. Phys. 188, 593-610, 2003) and a direct solution on the coarsest level.
class Multigrid {
 public:
  Multigrid(const mesh::Mesh& mesh, const solid::Material& material);
  ~Multigrid();
  Multigrid(const Multigrid&) = delete;
  Multigrid& operator=(const Multigrid&) = delete;

  /// Prescribes displacements of a level's nodes, on which the cycles then begin; a coarse node is fixed
  /// where the finer node at its place is.
  void fix(const FixedNodes& fixed, int level = 0);

  /// z = B r on the level last fixed; 0 at fixed displacements.
  void apply(const solid::Field& r);
  const GridField<float>& z() const;

  int n_levels() const { return static_cast<int>(levels_.size()); }
  const GridLevel& grid(int level) const;
  const Transfer& transfer(int finer_level) const;
  int n_cycles() const { return n_cycles_; }  ///< begun on the finest level so far

 private:
  struct Level;
  void cycle(std::size_t l);
  void smooth(Level& level, bool from_zero);
  void restrict_residual(Level& fine, Level& coarse);
  void prolong(const Level& coarse, Level& fine);
  void damp_block_rows(Level& level);
  void estimate_largest_eigenvalue(Level& level);
  void factorise_coarsest();
  void solve_coarsest();

  std::vector<std::unique_ptr<Level>> levels_;
  int top_level_ = 0;  ///< on which cycles begin
  int n_cycles_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
  std::vector<std::int32_t> coarsest_unknown_;  ///< [2 nodes] or -1
  Eigen::VectorXd coarsest_b_;
};

}  // namespace slipfront::solve
