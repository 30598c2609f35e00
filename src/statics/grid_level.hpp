// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "mesh/mesh.hpp"
#include "solid/operator.hpp"
#include "statics/elastic_body.hpp"

namespace slipfront::statics {

/// The plate's stiffness K on the logical grid or on a coarser one: one stencil for all nodes amid four equal
/// squares, block rows for the others. In the plane K of a square does not depend on its size, so the stencil
/// is that of every level.
///
/// Two bodies share one grid: the rows of the lower body from its far edge to its interface, the interface
/// row, the rows of the upper body above its interface. The unknowns of the interface row are the
/// displacement relative to what is below, the rigid plane or the lower body; the upper body's interface
/// moves with the sum of this row and the one before. So contact fixes or frees the same unknowns on either.
struct GridLevel {
  int columns = 0, rows = 0;
  int interface_row = 0;     ///< 0 on the rigid plane
  std::vector<double> x, y;  ///< logical coordinates of the columns and the rows of nodes
  solid::InteriorStencil stencil{};
  solid::InteriorStencil stencil_below{};  ///< of the lower body
  std::vector<solid::Span> span;           ///< nodes with the stencil
  std::vector<std::int32_t> first_span;    ///< [rows + 2] of each row of nodes
  solid::BlockRows block;                  ///< the other nodes of the plate, ascending
  std::vector<std::int32_t> first_block;   ///< [rows + 2] of each row of nodes
  /// Grid row and column of each neighbour in the block rows.
  std::vector<std::int32_t> neighbour_row, neighbour_column;
  /// Rows of nodes that K reaches up and down: 1, more around folded corners.
  int reach = 1;
  std::vector<mesh::Node> unused;  ///< grid numbers without a node of the plate
  /// Unused grid numbers on a face of a folded corner, with the node that took their place.
  std::map<mesh::Node, mesh::Node> glued;

  int stride() const { return columns + 1; }
  std::size_t n_nodes() const { return static_cast<std::size_t>(stride()) * (rows + 1); }
  mesh::Node node(int i, int j) const { return j * stride() + i; }
  const solid::InteriorStencil& stencil_of(int j) const {
    return j < interface_row ? stencil_below : stencil;
  }
  /// Rows of cells of the body that has fewer of them.
  int min_rows() const {
    return interface_row > 0 ? std::min(interface_row - 1, rows - interface_row) : rows;
  }
  bool has_stencil(int i, int j) const;
  /// Index of the node's block row, or -1.
  std::int32_t block_row(mesh::Node n) const;
};

/// Linear interpolation along one direction: value at k = (1 - weight) value(left) + weight value(left + 1).
/// Coarse nodes are every second one; where the number of cells is odd the last coarse cell takes three.
struct Transfer1D {
  std::vector<std::int32_t> left;   ///< [fine]
  std::vector<float> weight;        ///< [fine]
  std::vector<std::int32_t> place;  ///< [coarse] the fine node there
};

/// Interpolation from a coarse level to the next finer one: bilinear on the logical grid, with rows of their
/// own for nodes next to unused grid numbers, and for those of an upper body next to its interface.
struct Transfer {
  Transfer1D x, y;
  struct Entry {
    mesh::Node coarse;
    float weight;
  };
  std::map<mesh::Node, std::vector<Entry>> special;
};

/// The finest level of a plate on the rigid plane.
/// @pre the plate is not periodic.
GridLevel make_level(const ElasticBody& plate);
/// The finest level of two bodies with as many columns, each described with its interface at y = 0; the lower
/// one appears on the grid reflected, its u_y with the other sign.
/// @pre all nodes of the meshes' grids are used.
GridLevel make_level(const ElasticBody& upper, const ElasticBody& lower);

/// Calls f(neighbour, block) for the blocks of the node's row of K; none for unused grid numbers.
template <class F>
void for_each_block(const GridLevel& level, mesh::Node n, F&& f) {
  if (!level.has_stencil(n % level.stride(), n / level.stride())) {
    const auto r = level.block_row(n);
    if (r < 0) return;
    for (auto k = level.block.first[r]; k < level.block.first[r + 1]; ++k)
      f(level.block.neighbour[k], level.block.block[k]);
    return;
  }
  const auto& s = level.stencil_of(n / level.stride());
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di) {
      std::array<double, 4> b = {s.centre, 0, 0, s.centre};
      if (di != 0 && dj == 0) b = {s.along, 0, 0, s.across};
      if (di == 0 && dj != 0) b = {s.across, 0, 0, s.along};
      if (di != 0 && dj != 0) b = {s.corner, s.twist * di * dj, s.twist * di * dj, s.corner};
      f(n + dj * level.stride() + di, b);
    }
}

Transfer make_transfer(const GridLevel& fine);

/// The Galerkin product with the interpolation; where only squares are near, this is the stencil again.
GridLevel make_coarse_level(const GridLevel& fine, const Transfer& transfer);

/// Largest eigenvalue of D^-1 K of endless grids of the level's squares, D the diagonal.
double largest_smoothed_eigenvalue(const GridLevel& level);

}  // namespace slipfront::statics
