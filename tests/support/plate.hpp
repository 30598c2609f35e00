// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.hpp"
#include "mesh/plate.hpp"
#include "solid/operator.hpp"

namespace slipfront::test {

inline mesh::Plate plate_of(double width_m, double height_m, double element_m,
                            mesh::Corner corner = mesh::Corner::none) {
  mesh::Plate plate;
  plate.width_m = width_m;
  plate.height_m = height_m;
  plate.element_size_m = element_m;
  plate.corner = corner;
  plate.fine_height_m = plate.relief_depth_m = 10e-3;
  plate.relief_length_m = plate.fillet_radius_m = 5e-3;
  plate.relief_height_m = 0.5e-3;
  return plate;
}

inline mesh::Mesh make_plate(double width_m, double height_m, double element_m, mesh::Corner corner) {
  return mesh::make_plate(plate_of(width_m, height_m, element_m, corner));
}

/// 21 x 11 nodes, small enough for dense matrices.
inline mesh::Mesh tiny_plate(mesh::Corner corner) {
  auto plate = plate_of(0.02, 0.01, 1e-3, corner);
  plate.fillet_radius_m = 3e-3;
  return mesh::make_plate(plate);
}

inline std::string name_of(mesh::Corner corner) {
  return corner == mesh::Corner::none ? "none" : corner == mesh::Corner::relief ? "relief" : "fillet";
}

/// Largest component of u - v.
inline double max_difference(const solid::Field& u, const solid::Field& v) {
  double largest = 0;
  for (std::size_t n = 0; n < u.size(); ++n)
    largest = std::max({largest, std::abs(u.x[n] - v.x[n]), std::abs(u.y[n] - v.y[n])});
  return largest;
}

inline double max_abs(const solid::Field& u) {
  return max_difference(u, solid::Field(u.size()));
}

}  // namespace slipfront::test
