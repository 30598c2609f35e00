// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <memory>

#include "statics/factorisation.hpp"
#include "statics/load_case.hpp"
#include "statics/sliding_interface.hpp"

namespace slipfront::statics {

/// The interface of a factorised plate with what it stands on: the forces of the contact on the plate's
/// interface nodes are f = S u - g, with u their displacements relative to the rigid plane or a base.
///
/// With a base f = S_a u_a - g_a on the plate and D f = S_b u_b on the base, whose far edge is held. u_b is
/// upside down: D = diag(-1, 1) at each node, u = u_a + D u_b. Of these M u_a = P u + g_a, with P = D S_b D
/// and M = S_a + P, definite even where S_a is singular. So S = S_a M^-1 P and g = P M^-1 g_a: products
/// without a difference, which would lose the smaller of two unlike stiffnesses.
class CondensedInterface {
 public:
  /// @param base  factorised with both displacements of its far edge prescribed; null for the rigid plane
  CondensedInterface(std::shared_ptr<const Factorisation> plate, std::shared_ptr<const Factorisation> base);

  /// S, N/m.
  const Eigen::MatrixXd& stiffness() const { return base_ ? S_ : plate_->condensed_stiffness(); }
  Factorisation::Load load(const TopDisplacement& top) const { return plate_->load(top); }
  /// g, N.
  Eigen::VectorXd relative_load(const Factorisation::Load& load) const;
  /// Sliding of nodes in contact, beside open ones.
  /// @param load, unit_shear  of the loaded edge, and of its moving on by 1 m
  /// @param gap_m, tributary_m  [interface nodes]
  std::unique_ptr<SlidingInterface> sliding(const Factorisation::Load& load,
                                            const Factorisation::Load& unit_shear,
                                            const std::vector<double>& gap_m,
                                            const std::vector<double>& tributary_m,
                                            const std::vector<Contact>& contact) const;
  /// Displacement of all nodes under the load for given relative displacements of the interface.
  Displacement displacement(const Factorisation::Load& load, const Eigen::VectorXd& relative_u_m) const;

 private:
  std::shared_ptr<const Factorisation> plate_, base_;
  Eigen::LLT<Eigen::MatrixXd> M_;
  Eigen::MatrixXd S_;  ///< with a base
};

}  // namespace slipfront::statics
