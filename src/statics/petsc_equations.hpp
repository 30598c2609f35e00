// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "statics/plate_solver.hpp"
#include "statics/subdomains.hpp"

namespace slipfront::statics {

/// "3.18.5", or nothing where the program was built without PETSc.
std::string_view petsc_version();

/// A subdomain's share of the equations of all subdomains: rows of their matrices, entries of their vectors.
/// All processes have one and call the same functions at the same time. By PETSc: conjugate gradients,
/// BiCGStab where nodes slip, with smoothed aggregation as preconditioner.
class PetscEquations {
 public:
  explicit PetscEquations(const Subdomain& subdomain);
  ~PetscEquations();
  PetscEquations(const PetscEquations&) = delete;
  PetscEquations& operator=(const PetscEquations&) = delete;

  /// Begins a load case at these own unknowns, those without shear and their change with it, whose prescribed
  /// ones are right; none of the latter where there is no shear.
  void begin(TopConstraint constraint, std::span<const double> u0, std::span<const double> u1);

  /// At the own nodes of the interface, x and y of each.
  struct AtInterface {
    std::vector<double> u0, u1, f0, f1;
  };
  /// @param support  of all interface nodes
  /// @return nothing where it does not converge, on all processes alike
  std::optional<AtInterface> solve(const Support& support, double accuracy);

  std::vector<double> own_u0() const;
  std::vector<double> own_u1() const;
  int n_iterations() const;  ///< so far

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace slipfront::statics
