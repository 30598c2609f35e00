// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::solid {

/// The cells around each node of a mesh, ascending.
class CellsOfNodes {
 public:
  /// @param max_narrow  places in the list of all up to which 32 bits are taken for each
  explicit CellsOfNodes(const mesh::Mesh& mesh,
                        std::size_t max_narrow = std::numeric_limits<std::uint32_t>::max()) {
    cell_.resize(4 * mesh.cells.size());
    if (cell_.size() <= max_narrow)
      put_cells(mesh, narrow_);
    else
      put_cells(mesh, wide_);
  }

  std::span<const std::int32_t> of(mesh::Node n) const {
    return wide_.empty() ? between(narrow_, n) : between(wide_, n);
  }

 private:
  template <class Place>
  std::span<const std::int32_t> between(const std::vector<Place>& first, mesh::Node n) const {
    const auto begin = first.begin() + n;
    return {cell_.begin() + static_cast<std::ptrdiff_t>(begin[0]),
            cell_.begin() + static_cast<std::ptrdiff_t>(begin[1])};
  }

  template <class Place>
  void put_cells(const mesh::Mesh& mesh, std::vector<Place>& first) {
    first.assign(mesh.x_m.size() + 1, 0);
    for (const auto& cell : mesh.cells)
      for (const auto n : cell) ++first[n];
    // Where the cells of each node end; where they begin, when they have been put there from the last one on.
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (std::size_t k = mesh.cells.size(); k-- > 0;)
      for (const auto n : mesh.cells[k]) cell_[--first[n]] = static_cast<std::int32_t>(k);
  }

  std::vector<std::uint32_t> narrow_;  ///< [nodes + 1] where the cells of each begin; or the other one
  std::vector<std::uint64_t> wide_;
  std::vector<std::int32_t> cell_;
};

}  // namespace slipfront::solid
