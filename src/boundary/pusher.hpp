// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::boundary {

/// Holds the left side along x, from one height to another one.
struct Pusher {
  double from_m = 0, to_m = 0;
  bool is_there() const { return to_m > 0; }
};

/// The nodes under a pusher, upwards; none of a part of a body without the left side.
std::vector<mesh::Node> pushed_nodes(const mesh::Mesh& mesh, const Pusher& pusher);

/// The share of the pusher's length that belongs to each of its nodes.
std::vector<double> shares_of_pushed(const mesh::Mesh& mesh, const std::vector<mesh::Node>& pushed);

}  // namespace slipfront::boundary
