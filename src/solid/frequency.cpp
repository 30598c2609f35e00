// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"
#include "mesh/plate.hpp"
#include "solid/element.hpp"
#include "solid/operator.hpp"

namespace slipfront::solid {

namespace {

/// Cells on the side of a block of squares that stands for all of them. One square alone has a frequency some
/// 17 % higher, by a mode in which its neighbours hinder it.
constexpr int block_side = 32;

bool is_square(const mesh::Mesh& mesh, const mesh::Cell& cell) {
  const auto c = cell_coordinates(mesh, cell);
  return solid::is_square(c, c[2] - c[0]);
}

/// The cells marked and their nodes, on no grid. Nothing of it is held.
mesh::Mesh part_of(const mesh::Mesh& mesh, const std::vector<bool>& in_part) {
  mesh::Mesh part;
  std::vector<mesh::Node> number(mesh.n_nodes(), -1);
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_part[k]) continue;
    auto& cell = part.cells.emplace_back(mesh.cells[k]);
    for (auto& n : cell) {
      if (number[n] < 0) {
        number[n] = part.n_nodes();
        part.x_m.push_back(mesh.x_m[n]);
        part.y_m.push_back(mesh.y_m[n]);
      }
      n = number[n];
    }
  }
  part.period_m = mesh.period_m;
  return part;
}

/// Smallest side of the squares of a mesh.
double smallest_side_m(const mesh::Mesh& mesh) {
  double smallest_m = infinity;
  for (const auto& cell : mesh.cells) {
    if (!is_square(mesh, cell)) continue;
    const auto c = cell_coordinates(mesh, cell);
    smallest_m = std::min(smallest_m, std::abs(c[2] - c[0]));
  }
  return smallest_m;
}

/// Smallest side of the squares on a row of nodes, as cell_coordinates has it.
double smallest_side_of_interface_m(const mesh::Mesh& interface) {
  double smallest_m = infinity;
  const auto look_at = [&](mesh::Node n, mesh::Node next) {
    const double x_m = interface.x_m[n];
    smallest_m = std::min(smallest_m, x_m + mesh::distance_x_m(interface, n, next) - x_m);
  };
  const auto& lower = interface.interface_nodes;
  for (std::size_t k = 0; k + 1 < lower.size(); ++k) look_at(lower[k], lower[k + 1]);
  if (interface.period_m > 0) look_at(lower.back(), lower.front());
  return smallest_m;
}

/// Largest frequency of the cells that are no squares with those around them; 0 where all are squares.
double frequency_of_others_rad_per_s(const mesh::Mesh& mesh, const Material& material) {
  std::vector<bool> near(mesh.cells.size(), false), of_near(mesh.n_nodes(), false);
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    near[k] = !is_square(mesh, mesh.cells[k]);
    if (!near[k]) continue;
    for (const auto n : mesh.cells[k]) of_near[n] = true;
  }
  if (std::ranges::find(near, true) == near.end()) return 0;
  for (int ring = 0; ring < rings_around_others; ++ring) {
    const auto reached = of_near;
    for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
      if (near[k] || std::ranges::none_of(mesh.cells[k], [&](mesh::Node n) { return reached[n]; })) continue;
      near[k] = true;
      for (const auto n : mesh.cells[k]) of_near[n] = true;
    }
  }
  return largest_frequency_rad_per_s(make_operator(part_of(mesh, near), material));
}

}  // namespace

double frequency_bound_rad_per_s(const mesh::Mesh& mesh, const Material& material,
                                 const mesh::Mesh* corners) {
  const bool is_interface = mesh.is_interface();
  const double side_m = is_interface ? smallest_side_of_interface_m(mesh) : smallest_side_m(mesh);
  const double of_squares = std::isfinite(side_m) ? frequency_of_squares_rad_per_s(side_m, material) : 0;
  if (is_interface && corners == nullptr) return of_squares;
  return std::max(of_squares, frequency_of_others_rad_per_s(is_interface ? *corners : mesh, material));
}

double frequency_of_squares_rad_per_s(double side_m, const Material& material) {
  const auto block = mesh::make_plate({.width_m = block_side * side_m,
                                       .height_m = block_side * side_m,
                                       .element_size_m = side_m,
                                       .corner = mesh::Corner::none,
                                       .top = mesh::Top::free});
  return largest_frequency_rad_per_s(make_operator(block, material));
}

bool takes_frequency_bound(std::int64_t n_nodes, std::span<const mesh::Grid> blocks) {
  return n_nodes >= many_nodes && std::ranges::all_of(blocks, [](const mesh::Grid& grid) {
           return std::min(grid.rows, grid.columns) >= block_side;
         });
}

double largest_frequency_rad_per_s(const mesh::Mesh& mesh, const Material& material, const Operator& op) {
  return takes_frequency_bound(mesh.n_nodes(), mesh::blocks(mesh)) ? frequency_bound_rad_per_s(mesh, material)
                                                                   : largest_frequency_rad_per_s(op);
}

}  // namespace slipfront::solid
