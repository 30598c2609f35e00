// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// A numbering in which the nodes of a cell are near each other: reverse Cuthill-McKee, orphans last.
/// @return  [nodes] the new number of each node
std::vector<Node> near_numbers(const Mesh& mesh);

/// Gives the nodes new numbers. The mesh forgets its grids and columns: no cell is taken for a square of a
/// block any more.
/// @param number  [nodes] a permutation
void renumber(Mesh& mesh, std::span<const Node> number);

/// Where bodies on each other are cut into columns of nodes: the places x up to which each column reaches. A
/// column reaches as far as any cell that has a node in the column before it, so that each cell has nodes in
/// one column or in two neighbouring ones. A segment of the interface counts as a cell, for nodes that are
/// neighbours there need not belong to one.
///
/// Columns are cut at places x, and not by distances over cells: each has a single stretch of the interface
/// then, in the order of columns, and the bodies on both sides of it have the same ones.
std::vector<double> column_ends_m(std::span<const Mesh* const> bodies);

/// Numbers the nodes column by column, from the interface upwards, which the mesh remembers. It forgets its
/// grids, see renumber.
/// @param ends_m  see column_ends_m
/// @throws UserError for a mesh that repeats along x
void number_by_columns(Mesh& mesh, std::span<const double> ends_m);
/// The same of a single body.
void number_by_columns(Mesh& mesh);

}  // namespace slipfront::mesh
