// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "boundary/dashpot.hpp"
#include "mesh/mesh.hpp"
#include "motion/landing.hpp"
#include "motion/level.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// Interface nodes of a body, which the contact moves. Arrays: [interface nodes].
struct InterfaceSide {
  std::vector<mesh::Node> nodes;
  std::vector<NodeRun> runs;
  solid::Span own;  ///< owned nodes, which enter works; see BodyMotion
  std::vector<double> tributary_m, mass_kg, y_m;
  std::vector<boundary::Dashpot> dashpots;
  Landing landing;
};

/// The side of a body with these masses of its nodes; without dashpots and landing.
/// @param motion  of a part of a body says which nodes are owned, for the runs alone
inline InterfaceSide make_interface_side(const mesh::Mesh& mesh, const std::vector<double>& mass_kg,
                                         const BodyMotion& motion) {
  InterfaceSide side;
  side.nodes = mesh.interface_nodes;
  side.runs = runs_of(side.nodes, motion);
  side.own = {0, static_cast<int>(side.nodes.size())};
  side.tributary_m = mesh::tributary_lengths_m(mesh);
  for (const auto n : side.nodes) {
    side.mass_kg.push_back(mass_kg[n]);
    side.y_m.push_back(mesh.y_m[n]);
  }
  return side;
}

/// What the contact reads and writes of a body.
struct ContactBody {
  InterfaceSide* side;
  solid::Field *u, *v;  ///< m, m/s
  /// Of an interface node.
  solid::Pair u_m(std::size_t i) const { return {u->x[side->nodes[i]], u->y[side->nodes[i]]}; }
};

template <class Body>
std::vector<ContactBody> contacts_of(std::vector<Body>& bodies) {
  std::vector<ContactBody> contacts;
  for (auto& body : bodies) contacts.push_back(body.contact());
  return contacts;
}

}  // namespace slipfront::motion
