// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

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
  std::vector<Dashpot> dashpots;
  Landing landing;
};

/// What the contact reads and writes of a body.
struct ContactBody {
  InterfaceSide* side;
  solid::Field *u_m, *v_m_per_s;
};

}  // namespace slipfront::motion
