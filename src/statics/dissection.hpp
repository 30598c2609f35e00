// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::statics {

/// Orders the nodes for a sparse factorisation by nested dissection along the longer extent, with the nodes
/// of `last` at the end in their own order. Orphans are left out.
std::vector<mesh::Node> dissect(const mesh::Mesh& mesh, const std::vector<mesh::Node>& last);

}  // namespace slipfront::statics
