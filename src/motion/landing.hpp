// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"
#include "motion/damping_work.hpp"
#include "motion/state_by_node.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// Shifts that put landing interface nodes onto the plane (predictor-corrector contact), and their work
/// against the body's forces.
class Landing {
 public:
  Landing() = default;
  /// @param own  of the nodes `interface_nodes`, those whose works count
  Landing(const mesh::Mesh& mesh, const solid::Material& material,
          const std::vector<mesh::Node>& interface_nodes, solid::Span own = solid::all_columns);

  /// Interface node i was put away from its place before the sub-step by shift_m, away from the interface.
  void add(std::size_t i, double shift_m);
  /// Work of the shifts, after the sub-step of length dt_s that began with them. @param u_m, v_m_per_s of now
  double work(const solid::Field& u_m, const solid::Field& v_m_per_s, double dt_s);
  /// The shifts since the last call of clear, for the damping's work at the next impulse of the last level.
  void add_to(ImpulseProducts& products) const {
    products.shift_K_v = K_v_;
    products.shift_K_u = K_u_;
  }
  void clear() { K_v_ = K_u_ = 0; }

  /// Adds all that changes.
  void add_to(StateView& state) { state.sums.insert(state.sums.end(), {&K_v_, &K_u_}); }

 private:
  std::vector<mesh::Node> interface_nodes_;
  solid::Span own_;
  solid::BlockRows rows_;           ///< K of the interface nodes, N/m
  std::vector<double> shift_m_;     ///< [nodes]; 0 but for nodes that land
  std::vector<std::size_t> nodes_;  ///< of this sub-step, interface nodes
  double K_v_ = 0, K_u_ = 0;        ///< see ImpulseProducts
};

}  // namespace slipfront::motion
