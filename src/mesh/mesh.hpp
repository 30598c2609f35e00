// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace slipfront::mesh {

/// A node's number among those that a mesh holds. In a whole that no mesh holds numbers may be larger, see
/// NodeColumns.
using Node = std::int32_t;

/// Four-node cells with their node numbers counterclockwise.
using Cell = std::array<Node, 4>;

/// Numbers [begin, end).
struct Span {
  int begin = 0, end = 0;
};

/// The logical grid under the node numbers of a block of squares: node (column i, row j) is
/// first + j * (columns + 1) + i.
///
/// A plate's nodes are numbered by such a grid, whatever is done to its corners; cells may be moved,
/// folded or taken away, and a grid number without a cell is an orphan (see orphans). The two lower corners
/// of a fillet are such, so take the plate's width from `far_edge_nodes`. A graded plate has one grid per
/// block.
struct Grid {
  int columns = 0;       ///< cells along x
  int rows = 0;          ///< cells along y
  double spacing_m = 0;  ///< side of the regular square cell
  Node first = 0;        ///< number of the lowest left node
  int stride() const { return columns + 1; }
  Node node(int i, int j) const { return first + j * stride() + i; }
  std::int64_t n_nodes() const { return std::int64_t{stride()} * (rows + 1); }
};

/// A node of an edge that lets waves out: length of that edge with the normal along x, and along y.
struct AbsorbingNode {
  Node node = 0;
  double side_m = 0, top_m = 0;
};

/// Nodes, four-node cells and the named node sets of a plate standing on the rigid plane y = 0.
///
/// A graded plate has blocks of squares above each other, each with squares twice as large as those of the
/// block below, joined by transition rows; see plate.hpp. Nodes are numbered upwards: a block, the inner
/// nodes of the transition, the next block. A mesh that knows no grid at all has a grid without columns.
struct Mesh {
  Grid grid;                  ///< of the lowest block, which holds the interface; of the whole plain plate
  std::vector<Grid> coarser;  ///< of the blocks above, upwards; none unless the plate is graded
  std::vector<double> x_m;    ///< [nodes] along the interface, from the left edge
  std::vector<double> y_m;    ///< [nodes] up from the rigid plane; the gap of an interface node
  std::vector<Cell> cells;
  std::vector<Node> interface_nodes;  ///< candidates for contact, x ascending, rounded corners included
  std::vector<Node> far_edge_nodes;   ///< the loaded edge, left to right; none where it is free or absorbs
  std::vector<double> far_edge_lengths_m;      ///< of the edge that belong to each of them
  std::vector<Node> left_nodes;                ///< of the left side, upwards; none where a part lacks it
  std::vector<AbsorbingNode> absorbing_nodes;  ///< upwards, left to right
  /// Length after which the plate repeats along x, or 0. Cells of the last column then use the nodes of
  /// column 0, and the nodes of the right edge are orphans.
  double period_m = 0;

  Node n_nodes() const { return static_cast<Node>(x_m.size()); }
  /// Whether only the lowest row is held, see make_interface.
  bool is_interface() const { return cells.empty() && !interface_nodes.empty(); }
};

/// The grids of all blocks, upwards.
std::vector<Grid> blocks(const Mesh& mesh);

/// For each node, whether it is among `nodes`.
std::vector<bool> marked(const Mesh& mesh, const std::vector<Node>& nodes);

/// For each node, whether no cell uses it. Orphans carry no mass and take no part in anything.
std::vector<bool> orphans(const Mesh& mesh);

/// Distance along x between two nodes of one cell, from the first to the second; the shorter way round where
/// the plate is periodic.
double distance_x_m(const Mesh& mesh, Node from, Node to);

/// Positions of the nodes of `mesh.interface_nodes`.
std::vector<double> interface_x_m(const Mesh& mesh);

/// Length of lower boundary that belongs to each node of `mesh.interface_nodes`: half of each adjoining
/// segment, measured along the arcs' chords. The first and the last node have one segment only, unless the
/// plate is periodic. [interface nodes], m.
std::vector<double> tributary_lengths_m(const Mesh& mesh);

/// Shortest side of all cells.
double min_side_m(const Mesh& mesh);

}  // namespace slipfront::mesh
