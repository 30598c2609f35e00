// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// Rounds both lower corners of a regular rectangular mesh by quarter circles, without slivers.
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
/// `mesh.lower` becomes the base with both arcs, from the left vertical edge to the right one. Grid numbers
/// that lose their cells stay as orphans, placed in the middle of the arc, k (k + 1) at each corner.
/// @param mesh      the regular mesh of a rectangle, all of whose nodes are at their grid positions
/// @param radius_m  of the quarter circles
/// @throws UserError for a radius too small for the cells or too large for the plate.
void round_corners(Mesh& mesh, double radius_m);

}  // namespace slipfront::mesh
