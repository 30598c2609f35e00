// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// A numbering in which the nodes of a cell are near each other: reverse Cuthill-McKee, orphans last.
/// @return  [nodes] the new number of each node
std::vector<Node> near_numbers(const Mesh& mesh);

/// Gives the nodes new numbers. The mesh forgets its grids: no cell is taken for a square of a block any
/// more.
/// @param number  [nodes] a permutation
void renumber(Mesh& mesh, std::span<const Node> number);

}  // namespace slipfront::mesh
