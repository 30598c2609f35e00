// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

inline constexpr double eps = std::numeric_limits<double>::epsilon();

/// Sum of the cells' areas, m2.
double area_m2(const Mesh& mesh);

/// The nodes of the boundary in the order of its counterclockwise walk, from mesh.interface_nodes's first
/// node. Empty, with a test failure, unless every edge has one cell or two that run through it in opposite
/// directions, and the edges with one cell form a single closed loop.
std::vector<Node> boundary_loop(const Mesh& mesh);

/// Fails unless the mesh is one conforming piece of convex cells without two nodes at a place, whose boundary
/// runs along the interface nodes from left to right and back along the far edge.
void expect_one_piece(const Mesh& mesh);

/// Number of cells at each node.
std::vector<int> valences(const Mesh& mesh);

/// Fails unless the mesh equals its mirror image about the plate's middle: coordinates to rounding, cells
/// exactly.
void expect_mirror_symmetry(const Mesh& mesh);

/// The regular square's frequency over the largest one of a cell: a lower bound of the stable time step
/// relative to the regular mesh's.
double relative_stable_step(const Mesh& mesh);

}  // namespace slipfront::mesh
