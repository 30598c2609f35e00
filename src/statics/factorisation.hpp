// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "boundary/boundary.hpp"
#include "mesh/mesh.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "statics/elastic_body.hpp"
#include "statics/frontal_cholesky.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::statics {

/// The plate's stiffness factorised once, with the interface condensed.
///
/// The unknowns are all displacements that are not prescribed on the loaded edge, springs of a machine count
/// as stiffness of its nodes; the interface is free. They are numbered by nested dissection with the
/// interface last: what the elimination of all others leaves of its block is its condensed stiffness S. The
/// forces of the plane on the interface nodes are then f = S u_i - g, with u_i their displacements and g the
/// load that the loaded edge sends to the interface. Contact states change on this small dense system without
/// another factorisation.
///
/// Vectors over the interface hold x and y of each node of mesh.interface_nodes in turn. Forces are per unit
/// thickness.
class Factorisation {
 public:
  /// @throws UserError where the factor does not fit into the memory at hand, with the figures.
  Factorisation(const ElasticBody& body, TopConstraint top);
  Factorisation(const Factorisation&) = delete;
  Factorisation& operator=(const Factorisation&) = delete;

  /// S, N/m.
  const Eigen::MatrixXd& condensed_stiffness() const { return condensed_; }
  /// The loaded edge's displacements with the load g they send to the interface, N.
  struct Load {
    TopDisplacement top;
    Eigen::VectorXd g_N;
  };
  Load load(const TopDisplacement& top) const;
  /// Displacement of all nodes under the load for given displacements of the interface.
  solid::Field displacement(const Load& load, const Eigen::VectorXd& interface_u_m) const;
  /// Displacement under given forces on the interface, with the loaded edge held where it is. Both its
  /// displacements have to be prescribed.
  solid::Field displacement(const Eigen::VectorXd& interface_force_N) const;

  std::int64_t n_unknowns() const { return n_unknowns_; }
  double factor_bytes() const { return factor_->factor_bytes(); }

 private:
  /// In the order of dissection, the interface last. @return the number behind the last unknown of each block
  std::vector<std::int32_t> number_unknowns();
  void set_springs();
  /// Whether a displacement along x, or y, is prescribed anywhere.
  bool is_held_along(std::size_t component) const;
  void factorise(const solid::Material& material);
  solid::Field solve(const TopDisplacement& top, const Eigen::VectorXd& interface_force) const;
  Eigen::VectorXd at_interface(const solid::Field& u) const;

  const mesh::Mesh& mesh_;
  boundary::Boundary boundary_;
  TopConstraint top_;
  /// Stiffness of what holds the loaded edge and what is pushed; infinite: prescribed. [2 nodes], N/m
  std::vector<double> spring_N_per_m_;
  /// Springs along x and y under the interface nodes, N/m, that keep the factorised matrix definite where
  /// nothing rigid holds the plate. S is without them.
  std::array<double, 2> spring_ = {0, 0};
  solid::BlockRows near_top_;          ///< K rows of the loaded edge's nodes and their neighbours
  std::vector<std::int32_t> unknown_;  ///< [2 nodes] index of the unknown, -1 where prescribed or an orphan
  Eigen::MatrixXd condensed_;
  std::int32_t n_unknowns_ = 0;
  std::optional<FrontalCholesky> factor_;
};

}  // namespace slipfront::statics
