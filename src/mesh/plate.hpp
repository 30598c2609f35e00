// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "mesh/mesh.hpp"
#include "mesh/node_columns.hpp"

namespace slipfront::mesh {

/// How the two lower corners of the plate are rounded.
enum class Corner {
  none,    ///< right angles
  relief,  ///< a shallow arc, tangent to the base, that rises by relief_height_m over relief_length_m
  fillet,  ///< a quarter circle of fillet_radius_m
};

/// The two vertical edges.
enum class Sides {
  free,       ///< no traction
  periodic,   ///< the right edge is the left one
  absorbing,  ///< waves leave through dashpots
};

/// The upper edge.
enum class Top {
  loaded,     ///< its displacements are prescribed
  free,       ///< no traction
  absorbing,  ///< it moves freely, waves leave through dashpots
};

/// A rectangle on the rigid plane y = 0 with its lower left corner at the origin.
struct Plate {
  double width_m = 0.1;
  double height_m = 0.05;
  double element_size_m = 1e-3 / 3;  ///< width and height must be whole multiples of it, to 1e-6
  int coarsenings = 0;               ///< how often the element size doubles on the way up
  double fine_height_m = 5e-3;       ///< least height of the elements of element_size_m, if coarsened
  Corner corner = Corner::none;
  double relief_length_m = 2.5e-3;
  double relief_height_m = 0.25e-3;
  double relief_depth_m = 5e-3;  ///< height over which the relief's shift of the nodes fades out
  double fillet_radius_m = 2.5e-3;
  Sides sides = Sides::free;  ///< others only with right-angled corners
  Top top = Top::loaded;
};

/// Whether elements are neither coarser anywhere nor wrapped around a corner.
inline bool has_equal_elements(const Plate& plate) {
  return plate.coarsenings == 0 && plate.corner != Corner::fillet;
}

/// Meshes the plate with four-node cells that are squares away from the corners, exact to rounding when the
/// sides are exact multiples.
///
/// - none: cell j * columns + i lies between grid nodes (i, j) and (i + 1, j + 1).
/// - relief: the same cells. A circle of radius (length^2 + height^2)/(2 height) touches the base at
///   relief_length_m from the edge; nodes above it move up by its rise times (1 - y/relief_depth_m). The
///   height may be at most half of the length and half of the depth, so that no angle gets below 36 degrees
///   and no cell less high than half an element.
/// - fillet: a few rows of cells are wrapped around each corner, see fillet.hpp.
///
/// Periodic sides need three columns or more.
///
/// With `coarsenings`, blocks of squares of element_size_m, twice, four times it ... lie above each other.
/// The lowest block has the fewest rows that reach fine_height_m, each one above it the fewest that make it
/// at least as high as everything below it, one row more where the rest of the plate would not divide; the
/// last one takes the rest. A transition row of quadrilaterals, as high as two of the smaller squares (side
/// h) and conforming, joins two blocks; a unit of it is 4 h wide:
///
///      t0-------t1-------t2
///      | \      |      / |
///      |  m1----m2---m3  |     inner nodes h above b1, b2, b3; angles of 45 to 135 degrees; no cell has a
///      |  |     |    |   |     higher frequency than the square of side h
///      b0-b1----b2---b3--b4
///
/// A block whose columns are not a multiple of 4 ends with the left half of a unit.
///
/// @param table  of the case file that holds coarsenings and fine_height_m, for messages
/// @throws UserError for an impossible geometry, naming the quantity to change.
Mesh make_plate(const Plate& plate, std::string_view table = "plate");

/// The nodes of the lowest row alone of a plate without fillets, in the grids of the whole plate and without
/// cells: what is known of a plate whose columns are held elsewhere. The whole plate may have more nodes than
/// can be numbered.
Mesh make_interface(const Plate& plate, std::string_view table = "plate");

/// The cells of make_plate that are no squares since a relief moves their nodes, and so many more cells on
/// their inner sides, with the places and the order that they have there: a separate mesh, without edges.
/// @pre elements are equal, the corners reliefs
Mesh make_corners(const Plate& plate, int around);

/// The nodes of make_plate in grid rows [begin, end], numbered from 0, with the cells between them: a mesh of
/// its own for those who write a plate row after row. It has no edges. The whole plate may have more nodes
/// than can be numbered.
/// @pre elements are equal, corners not wrapped
Mesh make_rows(const Plate& plate, int begin, int end, std::string_view table = "plate");

/// The nodes of make_plate in some columns, with the cells between them: a separate mesh, whose nodes and
/// cells have the order and the places of the whole plate's, to the last bit. The whole plate may have more
/// nodes than can be numbered.
///
/// The part's own edges, where they are not the plate's, lack the cells that reach beyond. A part of a plate
/// that repeats has either a single range of columns, or two: then it holds the cells that join the plate's
/// sides, and the last column, which has no cells, with them.
/// @param columns  as NodeColumns counts them
/// @pre no part ends among the columns of cells that are wrapped around a corner
Mesh make_columns(const Plate& plate, const Subset& columns, std::string_view table = "plate");

}  // namespace slipfront::mesh
