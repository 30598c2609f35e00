// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// Cells of a mesh with consecutive numbers, and nodes with consecutive numbers, all of these cells among
/// them.
struct Slab {
  const Mesh& mesh;            ///< numbers its nodes and cells from 0
  std::size_t first_node = 0;  ///< their numbers in the whole
  std::size_t first_cell = 0;
  std::size_t n_own = 0;  ///< nodes; those after them are the first ones of the next slab
};

/// A mesh of which not all need be held at a time.
struct Slabs {
  std::size_t n_nodes = 0, n_cells = 0;
  /// Calls a function with each slab, in the order of the numbers.
  std::function<void(const std::function<void(const Slab&)>& visit)> for_each;
};

/// The whole in one slab.
Slabs in_one_slab(std::shared_ptr<const Mesh> whole);

}  // namespace slipfront::mesh
