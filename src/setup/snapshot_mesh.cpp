// SPDX-License-Identifier: BSD-3-Clause
#include "setup/snapshot_mesh.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/plate.hpp"

namespace slipfront::setup {

namespace {

/// Turns a body that is described upside down.
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

/// Rows of equal squares.
struct RowsOfBody {
  mesh::Plate plate;
  int rows = 0, at_once = 1;
  std::size_t nodes_per_row = 0, cells_per_row = 0;
  bool is_below = false;

  std::size_t n_nodes() const { return nodes_per_row * (static_cast<std::size_t>(rows) + 1); }
  std::size_t n_cells() const { return cells_per_row * static_cast<std::size_t>(rows); }
  std::size_t n_slabs() const { return static_cast<std::size_t>((rows + at_once - 1) / at_once); }
};

RowsOfBody rows_of(const mesh::Plate& plate, bool is_below, int n_writers) {
  const auto grid = mesh::make_interface(plate).grid;
  const auto nodes_per_row = static_cast<std::size_t>(grid.stride());
  const auto few = static_cast<int>(snapshot_nodes_at_once / nodes_per_row);
  const int at_once = std::max(1, std::min(few, (grid.rows + n_writers - 1) / n_writers));
  return {plate, grid.rows, at_once, nodes_per_row, static_cast<std::size_t>(grid.columns), is_below};
}

/// @param first_node, first_cell  numbers of the body's first ones
void visit_slab(const RowsOfBody& body, std::size_t slab, std::size_t first_node, std::size_t first_cell,
                const std::function<void(const mesh::Slab&)>& f) {
  const int row = static_cast<int>(slab) * body.at_once;
  const int end = std::min(row + body.at_once, body.rows);
  auto mesh = mesh::make_rows(body.plate, row, end);
  if (body.is_below) turn_over(mesh);
  const auto before = static_cast<std::size_t>(row);
  const std::size_t own_rows = static_cast<std::size_t>(end - row) + (end == body.rows ? 1 : 0);
  f({mesh, first_node + before * body.nodes_per_row, first_cell + before * body.cells_per_row,
     own_rows * body.nodes_per_row});
}

mesh::Slabs in_rows(std::vector<RowsOfBody> bodies) {
  mesh::Slabs slabs;
  for (const auto& body : bodies) {
    slabs.n_nodes += body.n_nodes();
    slabs.n_cells += body.n_cells();
    slabs.n_slabs += body.n_slabs();
  }
  slabs.visit = [bodies = std::move(bodies)](std::size_t k, const auto& f) {
    std::size_t first_node = 0, first_cell = 0;
    for (const auto& body : bodies) {
      if (k < body.n_slabs()) return visit_slab(body, k, first_node, first_cell, f);
      k -= body.n_slabs();
      first_node += body.n_nodes();
      first_cell += body.n_cells();
    }
  };
  return slabs;
}

}  // namespace

SnapshotMesh snapshot_mesh_in_rows(const Problem& problem, int n_writers) {
  std::vector<RowsOfBody> bodies = {rows_of(problem.above().plate, false, n_writers)};
  if (problem.has_below()) bodies.push_back(rows_of(problem.below().plate, true, n_writers));
  const auto n_plate_cells = bodies.front().n_cells();
  return {in_rows(std::move(bodies)), n_plate_cells};
}

SnapshotMesh whole_snapshot_mesh(Meshes meshes) {
  const auto n_plate_cells = meshes.plate.cells.size();
  return {mesh::in_one_slab(std::make_shared<const mesh::Mesh>(joined(std::move(meshes)))), n_plate_cells};
}

}  // namespace slipfront::setup
