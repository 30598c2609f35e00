// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>

#include "mesh/mesh.hpp"
#include "solid/material.hpp"

namespace slipfront::solid {

/// Node coordinates of one cell, counterclockwise: x0, y0, x1, y1, ... m.
using CellCoordinates = std::array<double, 8>;
/// Row-major 8 x 8 matrix over the degrees of freedom x0, y0, x1, y1, ... N/m per unit thickness.
using CellStiffness = std::array<double, 64>;

CellCoordinates cell_coordinates(const mesh::Mesh& mesh, const mesh::Cell& cell);

/// By which part of its side a cell may be no square, and still count as one.
inline constexpr double square_tolerance = 1e-9;

/// Whether it is a square with this side along x, its lower left node first.
bool is_square(const CellCoordinates& coordinates, double side_m);
/// Whether it is a square of the grid's spacing between grid neighbours, its lower left node first.
bool is_square_of_grid(const mesh::Mesh& mesh, const mesh::Grid& grid, const mesh::Cell& cell);

/// Shape functions of a cell at a place in it, and their gradients, 1/m.
struct CellShape {
  std::array<double, 4> value{}, d_dx{}, d_dy{};
  double jacobian = 0;  ///< m2: of (x, y) by the local coordinates (xi, eta), each -1 to 1
};
/// @pre the cell is convex and counterclockwise.
CellShape cell_shape(const CellCoordinates& coordinates, double xi, double eta);

/// The shape functions at a place, by Newton's method on the bilinear map; none where it lies outside the
/// cell by more than 1e-9 of its sides.
std::optional<CellShape> cell_shape_at(const CellCoordinates& coordinates, double x_m, double y_m);

/// A symmetric tensor of the plane with its component across the plane; xy is the tensor's, half the
/// engineering shear strain.
struct PlaneTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0;
};

/// Small strain of the displacements of a cell's nodes, x0, y0, x1, y1, ...; zz is -nu/(1 - nu) (xx + yy) in
/// plane stress and 0 in plane strain.
PlaneTensor strain(const CellShape& shape, const std::array<double, 8>& u_m, const Material& material);

/// Elastic stress of a strain, Pa, positive in tension; zz is 0 in plane stress.
PlaneTensor stress_Pa(const PlaneTensor& strain, const Material& material);
/// The strain whose stress it is. The stress across the plane follows from the others.
PlaneTensor strain_of(const PlaneTensor& stress_Pa, const Material& material);

/// A uniform stress that displacements leave out, and that grows. Along x it is 0.
struct UniformStress {
  double yy_Pa = 0, xy_Pa = 0;  ///< at time 0
  double yy_Pa_per_s = 0, xy_Pa_per_s = 0;
};

struct StrainAndStress {
  PlaneTensor strain, stress_Pa;
};

/// Strain and stress of a cell by the displacements of its nodes, and by a uniform stress where there is one.
StrainAndStress strain_and_stress(const CellShape& shape, const std::array<double, 8>& u_m,
                                  const Material& material, const std::optional<UniformStress>& further,
                                  double time_s);

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
