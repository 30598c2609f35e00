// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "boundary/boundary.hpp"
#include "mesh/mesh.hpp"
#include "record/energies.hpp"
#include "solid/operator.hpp"

namespace slipfront::boundary {

/// What a loading machine pulls of a body's boundary by springs: at each node the force force_N - k u. It is
/// that of the equilibrium at the start, and force_N grows as the machine moves on along x; where k is 0 it
/// stays. Between spring and node a mass of the machine moves along x with the node.
class MachineSprings {
 public:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  MachineSprings() = default;
  MachineSprings(const mesh::Mesh& mesh, const solid::Material& material, const Boundary& boundary);

  bool empty() const { return node_.empty(); }
  /// none where no spring pulls the node.
  std::size_t place(mesh::Node n) const;

  /// At a place of equilibrium, with the machine's speed.
  void start(const solid::Field& u_m, double speed_m_per_s);
  /// In N per unit thickness.
  solid::Pair force(std::size_t k, solid::Pair u_m) const {
    return {force_N_.x[k] - stiffness_.x[k] * u_m.x, force_N_.y[k] - stiffness_.y[k] * u_m.y};
  }
  /// Per unit thickness.
  double mass_kg(std::size_t k) const { return mass_kg_[k]; }
  /// The machine moves on by a step of the node, which has gone from one velocity to the other under a force.
  void move(std::size_t k, double dt_s, solid::Pair force_N, solid::Pair before, solid::Pair after,
            record::Energies& works);
  void reverse();

  const std::vector<mesh::Node>& nodes() const { return node_; }
  /// Arrays over the nodes: what changes, and what follows from the start.
  std::vector<std::vector<double>*> arrays() { return {&force_N_.x, &force_N_.y, &speed_x_m_per_s_}; }

 private:
  std::vector<mesh::Node> node_;  ///< ascending
  solid::BlockRows rows_;         ///< of K
  solid::Field has_spring_;       ///< 1 or 0
  solid::Field stiffness_;        ///< N/m per unit thickness
  std::vector<double> mass_kg_;
  solid::Field force_N_;  ///< where u is 0
  std::vector<double> speed_x_m_per_s_;
};

/// Largest frequency of a spring and its node's mass.
/// @param of_node  nodes that count; empty: all
double largest_spring_frequency_rad_per_s(const mesh::Mesh& mesh, const solid::Material& material,
                                          const Boundary& boundary, const std::vector<bool>& of_node = {});

}  // namespace slipfront::boundary
