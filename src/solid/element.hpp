// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "mesh/mesh.hpp"
#include "solid/material.hpp"

namespace slipfront::solid {

/// Node coordinates of one cell, counterclockwise: x0, y0, x1, y1, ... m.
using CellCoordinates = std::array<double, 8>;
/// Row-major 8 x 8 matrix over the degrees of freedom x0, y0, x1, y1, ... N/m per unit thickness.
using CellStiffness = std::array<double, 64>;

CellCoordinates cell_coordinates(const mesh::Mesh& mesh, const mesh::Cell& cell);

/// Stiffness of the bilinear four-node element with 2 x 2 Gauss points.
/// @pre the cell is convex and counterclockwise.
CellStiffness cell_stiffness(const CellCoordinates& coordinates, const Material& material);

/// Row-sum lumped mass of the element's nodes, kg per unit thickness.
std::array<double, 4> cell_mass(const CellCoordinates& coordinates, const Material& material);

/// Largest natural frequency (rad/s) of the free element; no mesh of such elements has a higher one.
double cell_frequency_rad_per_s(const CellCoordinates& coordinates, const Material& material);
/// The largest one of the cells marked.
double largest_cell_frequency_rad_per_s(const mesh::Mesh& mesh, const Material& material,
                                        const std::vector<bool>& in_part);

/// Lumped mass of every node, kg per unit thickness; 0 for orphans. [nodes]
std::vector<double> lumped_mass(const mesh::Mesh& mesh, const Material& material);

}  // namespace slipfront::solid
