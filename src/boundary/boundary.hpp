// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "base/numbers.hpp"
#include "boundary/machine.hpp"
#include "mesh/mesh.hpp"
#include "solid/operator.hpp"

namespace slipfront::boundary {

/// A node that a dashpot damps, or that the machine holds along one direction or both.
struct EdgeNode {
  mesh::Node node = 0;
  double side_m = 0, top_m = 0;  ///< length of absorbing edge with the normal along x, and along y
  /// Stiffness, per unit thickness, of the spring between the machine and the node: infinite, it moves with
  /// the machine; 0, it bears a constant force; none, the machine has nothing to do with it.
  std::optional<double> spring_x_N_per_m = {}, spring_y_N_per_m = {};
  double machine_kg = 0;  ///< of the machine, per unit thickness, that moves along x with the node
};
inline bool is_spring(const std::optional<double>& spring_N_per_m) {
  return spring_N_per_m && *spring_N_per_m != infinity;
}

/// The conditions at a body's edges, contact apart. What no list names is free of traction; periodic sides
/// are joined by the mesh.
struct Boundary {
  std::vector<mesh::Node> driven;  ///< both displacements are prescribed, left to right
  std::vector<mesh::Node> pushed;  ///< under the pusher, upwards
  std::vector<EdgeNode> nodes;     ///< absorbing nodes, those under the pusher, and those of the far edge

  /// For the stiffness.
  solid::EdgeSets edge_sets() const;
};

Boundary make_boundary(const mesh::Mesh& mesh, const Machine& machine);

}  // namespace slipfront::boundary
