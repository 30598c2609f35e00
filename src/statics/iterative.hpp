// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "statics/bodies_on_grid.hpp"
#include "statics/multigrid.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// Equilibria by conjugate gradients with one multigrid cycle as preconditioner. Coarser levels with enough
/// interface nodes give first guesses.
class IterativeSolver : public PlateSolver {
 public:
  IterativeSolver(const ElasticBody& plate, const std::optional<ElasticBody>& base,
                  int threads = threads::Team::processors());

  std::unique_ptr<LoadCase> load_case(TopConstraint constraint, const TopDisplacement& top, EdgeMotion motion,
                                      const DisplacementOfBodies* start, int level) override;
  std::int64_t n_unknowns() const override { return n_unknowns_; }
  double bytes() const override;
  bool iterates() const override { return true; }
  int n_cycles() const override { return multigrid_.n_cycles(); }
  int n_levels() const override { return n_levels_; }
  std::vector<std::size_t> interface_of(int level) const override;

  Multigrid& multigrid() { return multigrid_; }

 private:
  std::vector<double> gap_m_;  ///< [interface nodes]
  BodiesOnGrid bodies_;
  threads::Team team_;
  Multigrid multigrid_;
  std::int64_t n_unknowns_ = 0;
  int n_levels_ = 1;
};

}  // namespace slipfront::statics
