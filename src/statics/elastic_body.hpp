// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "boundary/machine.hpp"
#include "mesh/mesh.hpp"
#include "solid/material.hpp"

namespace slipfront::statics {

/// A plate, or a base below one. A base is described upside down: y points away from the interface into it,
/// mesh.interface_nodes are its interface nodes at the places of the plate's along x, and mesh.far_edge_nodes
/// is its far edge, which is held still.
struct ElasticBody {
  const mesh::Mesh& mesh;
  const solid::Material& material;
  boundary::Machine machine = {};  ///< that loads it
};

}  // namespace slipfront::statics
