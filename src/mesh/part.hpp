// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// Some columns of a plate: a mesh of its own, whose nodes have the order of the whole one.
struct MeshPart {
  Mesh mesh;
  int first_column = 0;         ///< of the whole mesh, which is column 0 of the part
  std::size_t first_lower = 0;  ///< place in Mesh::lower of the whole mesh of the part's first one
};

/// The columns of nodes [first, end) of a mesh of one block, with the cells between them.
///
/// Right-angled, relieved and rounded corners keep their shape where the part holds them. The part's own
/// edges, where they are not the plate's, lack the cells beyond.
/// @pre the mesh has a grid of a single block and does not repeat
/// @throws UserError where a cut goes through the cells that are wrapped around a corner
MeshPart columns_of(const Mesh& whole, int first, int end);

}  // namespace slipfront::mesh
