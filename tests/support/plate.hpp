// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "mesh/plate.hpp"
#include "solid/operator.hpp"

namespace slipfront::test {

inline mesh::Mesh make_plate(double width_m, double height_m, double element_m, mesh::Corner corner) {
  mesh::Plate plate;
  plate.width_m = width_m;
  plate.height_m = height_m;
  plate.element_size_m = element_m;
  plate.corner = corner;
  return mesh::make_plate(plate);
}

/// 21 x 11 nodes, small enough for dense matrices.
inline mesh::Mesh tiny_plate(mesh::Corner corner) {
  mesh::Plate plate;
  plate.width_m = 0.02;
  plate.height_m = 0.01;
  plate.element_size_m = 1e-3;
  plate.corner = corner;
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

/// Reproducible numbers in [-1, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace slipfront::test
