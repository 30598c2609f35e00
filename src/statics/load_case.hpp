// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "solid/operator.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// Displacements of all nodes: of the plate, and of the base where there is one.
struct Displacement {
  solid::Field above, below;
};

/// The plate under its loaded edge, held by what it stands on: displacements of the interface, relative to
/// those of a base, and forces of the contact on the plate, affine in the shear, the length by which the edge
/// moves on along x, or down: u0 + shear u1, f0 + shear f1. Vectors over the interface hold x and y of each
/// of the level's interface nodes in turn. Forces are per unit thickness.
class LoadCase {
 public:
  virtual ~LoadCase() = default;
  /// Finds u0, u1, f0, f1 for given contact states. `accuracy`: error of the displacement in the energy norm
  /// over the norm of the displacement; a direct solution ignores it.
  virtual void solve(const Support& support, double accuracy) = 0;
  /// Displacement at a shear, after solve.
  virtual Displacement displacement(double shear) const = 0;
  /// Its change with the shear.
  virtual Displacement displacement_per_shear() const = 0;
  /// Takes the solution of the same case on the next coarser level as the guess from which solve begins.
  virtual void begin_from(const LoadCase& /*coarser*/) {}

  Eigen::VectorXd u0, u1, f0, f1;
};

}  // namespace slipfront::statics
