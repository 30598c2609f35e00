// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// How the logical corner is cut and what is re-shaped; cells are counted from the corner.
struct Fold {
  double radius_m = 0;
  double spacing_m = 0;
  int cut = 0;       ///< k: cells taken away along each side of the corner
  int side = 0;      ///< cells along each side of the re-shaped patch
  int half_arc = 0;  ///< cells along one half of the arc
  int n_nodes() const { return (side + 1) * (side + 1); }
  /// Number within the patch of logical node (i, j); glued nodes have the same number.
  int node(int i, int j) const { return j == cut && i < cut ? i * (side + 1) + cut : j * (side + 1) + i; }
  bool has_node(int i, int j) const { return i >= cut || j > cut; }
  bool has_cell(int i, int j) const { return i >= cut || j >= cut; }
};

/// Both lower corners of a regular rectangular grid rounded by quarter circles, without slivers.
///
/// Pushing the nodes of a regular grid onto a rounded corner makes a cell with a nearly straight angle. So
/// the grid is folded instead: at each corner the k x k outermost cells are taken away and the two faces of
/// the cut are glued to each other, node (k, j) to node (j, k), j <= k, counted from the corner:
///
///      |   |   |   |
///      D---E---G---+--
///      |   |   |   |       k = 1: A and A' become one node, in the middle of the arc; at B, now inside the
///      A---B---F---+--     plate, only the three cells ABED, A'CFB and BFGE meet.
///          |   |   |
///          A'--C---+--
///
/// The k lowest rows of cells thus turn upwards and follow the arc, and the k lowest columns are their
/// continuation. With k near (2 - pi/2)/2 radius/spacing the smooth side keeps its length per cell. The cells
/// within about 1.25 radii of the corner are then re-shaped so that the smallest of them allows as large a
/// time step as possible. There are nodes at both ends and in the middle of each arc. Both corners are mirror
/// images.
///
/// The interface becomes the base with both arcs, from the left vertical edge to the right one. Grid numbers
/// that lose their cells stay as orphans, placed in the middle of the arc, k (k + 1) at each corner.
class RoundedCorners {
 public:
  /// A node of the grid, by its column and row.
  struct Place {
    int i = 0, j = 0;
  };
  struct Point {
    double x = 0, y = 0;
  };

  /// @param grid      of the rectangle's lowest squares
  /// @param is_graded  whether larger squares lie above it
  /// @param radius_m  of the quarter circles
  /// @throws UserError for a radius too small for the cells or too large for the plate.
  RoundedCorners(const Grid& grid, bool is_graded, double radius_m);

  /// Columns at either end in which nodes are moved.
  int side() const { return fold_.side; }
  /// Columns at either end that cells wrapped around the corner reach.
  int cut() const { return fold_.cut; }
  /// Whether the cell between nodes (i, j) and (i + 1, j + 1) is taken away.
  bool is_cut(int i, int j) const;
  /// The node that a cell has instead of this one.
  Place glued(Place node) const;
  /// Where the nodes of the left corner are, row by row, side() columns and rows; those of the right corner
  /// are their mirror images.
  std::vector<Point> places() const;
  /// The nodes that may touch the base, x ascending.
  std::vector<Place> lower() const;

 private:
  int columns_ = 0;
  Fold fold_;
};

}  // namespace slipfront::mesh
