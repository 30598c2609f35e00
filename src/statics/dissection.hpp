// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::statics {

/// Nodes in the order in which a sparse factorisation eliminates them, and the number of nodes up to the end
/// of each block of them: a leaf of the dissection, or what separates two halves.
struct NodeOrder {
  std::vector<mesh::Node> nodes;
  std::vector<std::size_t> block_ends;
};

/// Orders the nodes for a sparse factorisation by nested dissection along the longer extent, with the nodes
/// of `last` at the end in their own order, as the last block. Orphans are left out.
NodeOrder dissect(const mesh::Mesh& mesh, const std::vector<mesh::Node>& last);

}  // namespace slipfront::statics
