// SPDX-License-Identifier: BSD-3-Clause
#include "run/snapshot_mesh.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "input/schema.hpp"
#include "mesh/plate.hpp"

namespace slipfront::run {

namespace {

/// Of a body that is described upside down.
void turn_over(mesh::Mesh& mesh) {
  for (double& y : mesh.y_m) y = -y;
  for (auto& [a, b, c, d] : mesh.cells) {  // counterclockwise again
    std::swap(a, d);
    std::swap(b, c);
  }
}

mesh::Mesh joined(Meshes meshes) {
  auto mesh = std::move(meshes.plate);
  if (!meshes.base) return mesh;
  auto& base = *meshes.base;
  turn_over(base);
  const auto first = mesh.n_nodes();
  for (auto grid : mesh::blocks(base)) {
    grid.first += first;
    mesh.coarser.push_back(grid);
  }
  mesh.x_m.insert(mesh.x_m.end(), base.x_m.begin(), base.x_m.end());
  mesh.y_m.insert(mesh.y_m.end(), base.y_m.begin(), base.y_m.end());
  for (const auto& [a, b, c, d] : base.cells)
    mesh.cells.push_back({first + a, first + b, first + c, first + d});
  return mesh;
}

/// Rows of squares of a body of many.
struct RowsOfBody {
  mesh::Plate plate;
  int rows = 0;
  std::size_t nodes_per_row = 0, cells_per_row = 0;
  bool is_below = false;

  std::size_t n_nodes() const { return nodes_per_row * (static_cast<std::size_t>(rows) + 1); }
  std::size_t n_cells() const { return cells_per_row * static_cast<std::size_t>(rows); }
};

RowsOfBody rows_of(const mesh::Plate& plate, const mesh::Grid& grid, bool is_below) {
  return {plate, grid.rows, static_cast<std::size_t>(grid.stride()), static_cast<std::size_t>(grid.columns),
          is_below};
}

void for_slabs(const RowsOfBody& body, std::size_t first_node, std::size_t first_cell,
               const std::function<void(const mesh::Slab&)>& visit) {
  const auto rows_at_once =
      static_cast<int>(std::max<std::size_t>(1, snapshot_nodes_at_once / body.nodes_per_row));
  for (int row = 0; row < body.rows; row += rows_at_once) {
    const int end = std::min(row + rows_at_once, body.rows);
    auto mesh = mesh::make_rows(body.plate, row, end);
    if (body.is_below) turn_over(mesh);
    const auto before = static_cast<std::size_t>(row);
    const std::size_t own_rows = static_cast<std::size_t>(end - row) + (end == body.rows ? 1 : 0);
    visit({mesh, first_node + before * body.nodes_per_row, first_cell + before * body.cells_per_row,
           own_rows * body.nodes_per_row});
  }
}

mesh::Slabs in_rows(std::vector<RowsOfBody> bodies) {
  mesh::Slabs slabs;
  for (const auto& body : bodies) {
    slabs.n_nodes += body.n_nodes();
    slabs.n_cells += body.n_cells();
  }
  slabs.for_each = [bodies = std::move(bodies)](const auto& visit) {
    std::size_t first_node = 0, first_cell = 0;
    for (const auto& body : bodies) {
      for_slabs(body, first_node, first_cell, visit);
      first_node += body.n_nodes();
      first_cell += body.n_cells();
    }
  };
  return slabs;
}

}  // namespace

mesh::Slabs snapshot_mesh(const input::Case& config, Meshes meshes) {
  if (!meshes.plate.is_interface())
    return mesh::in_one_slab(std::make_shared<const mesh::Mesh>(joined(std::move(meshes))));
  std::vector<RowsOfBody> bodies = {rows_of(config.plate, meshes.plate.grid, false)};
  if (meshes.base) bodies.push_back(rows_of(input::base_plate(config), meshes.base->grid, true));
  return in_rows(std::move(bodies));
}

}  // namespace slipfront::run
