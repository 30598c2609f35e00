// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/slabs.hpp"

#include <utility>

namespace slipfront::mesh {

Slabs in_one_slab(std::shared_ptr<const Mesh> whole) {
  const auto n_nodes = whole->x_m.size(), n_cells = whole->cells.size();
  return {n_nodes, n_cells, 1, [whole = std::move(whole), n_nodes](std::size_t, const auto& f) {
            f(Slab{*whole, 0, 0, n_nodes});
          }};
}

}  // namespace slipfront::mesh
