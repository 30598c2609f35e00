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

/// A mesh of which not all need be held at a time. The numbers of a slab's nodes and cells follow those of
/// the slab before.
struct Slabs {
  std::size_t n_nodes = 0, n_cells = 0, n_slabs = 0;
  /// Calls a function with slab k.
  std::function<void(std::size_t k, const std::function<void(const Slab&)>& f)> visit;

  /// Calls a function with slabs [begin, end).
  template <class F>
  void for_some(std::size_t begin, std::size_t end, F&& f) const {
    for (std::size_t k = begin; k < end; ++k) visit(k, f);
  }
};

/// The whole in one slab.
inline Slabs in_one_slab(const std::shared_ptr<const Mesh>& whole) {
  const auto n_nodes = whole->x_m.size();
  return {n_nodes, whole->cells.size(), 1, [whole, n_nodes](std::size_t, const auto& f) {
            f(Slab{*whole, 0, 0, n_nodes});
          }};
}

}  // namespace slipfront::mesh
