// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "mesh/fillet.hpp"

namespace slipfront::mesh {
namespace {

constexpr double whole_tolerance = 1e-6;  // relative, for "a whole multiple of the element size"

void require_positive(double value, const char* key) {
  if (!(value > 0) || !std::isfinite(value))
    throw UserError("plate.{} must be a positive length, not {:g}", key, value);
}

bool is_whole(double count) {
  const double nearest = std::round(count);
  return nearest >= 1 && std::abs(count - nearest) <= whole_tolerance * nearest;
}

/// The element size closest to the requested one, in the direction of `step` (+1: more columns, smaller
/// elements), that divides both sides of the plate.
std::optional<double> size_that_fits(const Plate& plate, int step) {
  const double wanted = plate.width_m / plate.element_size_m;
  const double ratio = plate.height_m / plate.width_m;
  double columns = step > 0 ? std::ceil(wanted) : std::floor(wanted);
  for (int tries = 0; tries < 10000 && columns >= 1; ++tries, columns += step)
    if (is_whole(columns * ratio)) return plate.width_m / columns;
  return std::nullopt;
}

[[noreturn]] void throw_no_fit(const Plate& plate) {
  std::string sizes;
  for (const int step : {+1, -1})
    if (const auto size = size_that_fits(plate, step))
      sizes += fmt::format("{}{:.8g}", sizes.empty() ? "" : " and ", *size);
  const std::string advice = sizes.empty()
                                 ? "no size near it fits both, change plate.width_m or plate.height_m"
                                 : "the nearest that fit are " + sizes;
  throw UserError(
      "plate.element_size_m = {:.8g} does not divide the plate of {:.8g} m x {:.8g} m into whole elements; "
      "{}",
      plate.element_size_m, plate.width_m, plate.height_m, advice);
}

Grid make_grid(const Plate& plate) {
  require_positive(plate.width_m, "width_m");
  require_positive(plate.height_m, "height_m");
  require_positive(plate.element_size_m, "element_size_m");
  const double columns = plate.width_m / plate.element_size_m;
  const double rows = plate.height_m / plate.element_size_m;
  if ((columns + 1) * (rows + 1) > std::numeric_limits<Node>::max())
    throw UserError("plate.element_size_m = {:.8g} makes more than {} nodes; use a larger size",
                    plate.element_size_m, std::numeric_limits<Node>::max());
  if (!is_whole(columns) || !is_whole(rows)) throw_no_fit(plate);
  Grid grid;
  grid.columns = static_cast<int>(std::lround(columns));
  grid.rows = static_cast<int>(std::lround(rows));
  grid.spacing_m = plate.width_m / grid.columns;
  return grid;
}

/// Mesh, operator and motion of a plate, and what building them takes for a while.
constexpr double bytes_per_node = 180;

Mesh make_rectangle(const Plate& plate) {
  Mesh mesh;
  mesh.grid = make_grid(plate);
  const Grid& grid = mesh.grid;
  const auto n_nodes = static_cast<std::size_t>(grid.stride()) * (static_cast<std::size_t>(grid.rows) + 1);
  if (n_nodes > static_cast<std::size_t>(std::numeric_limits<Node>::max()))
    throw UserError(
        "plate.element_size_m = {:g} makes {} nodes, more than can be numbered; choose a larger one",
        plate.element_size_m, n_nodes);
  require_memory(bytes_per_node * static_cast<double>(n_nodes), fmt::format("a plate of {} nodes", n_nodes),
                 "choose a larger plate.element_size_m");
  mesh.x_m.reserve(n_nodes);
  mesh.y_m.reserve(n_nodes);
  for (int j = 0; j <= grid.rows; ++j) {
    const double y = j * plate.height_m / grid.rows;
    for (int i = 0; i <= grid.columns; ++i) {
      mesh.x_m.push_back(i * plate.width_m / grid.columns);
      mesh.y_m.push_back(y);
    }
  }
  mesh.cells.reserve(static_cast<std::size_t>(grid.columns) * grid.rows);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      mesh.cells.push_back(
          {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1), grid.node(i, j + 1)});
  for (int i = 0; i <= grid.columns; ++i) {
    mesh.lower.push_back(grid.node(i, 0));
    mesh.top.push_back(grid.node(i, grid.rows));
  }
  return mesh;
}

void check_relief(const Plate& plate, const Grid& grid) {
  require_positive(plate.relief_length_m, "relief_length_m");
  require_positive(plate.relief_height_m, "relief_height_m");
  require_positive(plate.relief_depth_m, "relief_depth_m");
  if (plate.relief_length_m < (1 - whole_tolerance) * grid.spacing_m)
    throw UserError("plate.relief_length_m = {:g} is shorter than an element; make it at least {:.8g}",
                    plate.relief_length_m, grid.spacing_m);
  if (plate.relief_length_m >= 0.5 * plate.width_m)
    throw UserError(
        "plate.relief_length_m = {:g} leaves no flat base between the two reliefs; make it less than {:g}",
        plate.relief_length_m, 0.5 * plate.width_m);
  // The limits of one half keep every angle above 36 degrees and every cell at least half as high as it was.
  if (plate.relief_height_m > 0.5 * plate.relief_length_m)
    throw UserError(
        "plate.relief_height_m = {:g} is too steep; make it at most half of plate.relief_length_m = {:g}",
        plate.relief_height_m, plate.relief_length_m);
  if (plate.relief_depth_m > plate.height_m)
    throw UserError(
        "plate.relief_depth_m = {:g} does not fit into the plate; make it at most plate.height_m = {:g}",
        plate.relief_depth_m, plate.height_m);
  if (plate.relief_height_m > 0.5 * plate.relief_depth_m)
    throw UserError(
        "plate.relief_depth_m = {:g} is too small; make it at least twice plate.relief_height_m = {:g}",
        plate.relief_depth_m, plate.relief_height_m);
}

/// Moves the nodes above the two arcs up, and by the same amount at both ends.
void lift_corners(Mesh& mesh, const Plate& plate) {
  const Grid& grid = mesh.grid;
  const double length = plate.relief_length_m;
  const double height = plate.relief_height_m;
  const double radius = (length * length + height * height) / (2 * height);
  for (int i = 0; 2 * i < grid.columns; ++i) {
    const double into = length - mesh.x_m[grid.node(i, 0)];
    if (into <= 0) break;
    // radius - sqrt(radius^2 - into^2), without the cancellation
    const double rise = into * into / (radius + std::sqrt(radius * radius - into * into));
    for (int j = 0; j <= grid.rows; ++j) {
      const double y = mesh.y_m[grid.node(i, j)];
      if (y >= plate.relief_depth_m) break;
      const double moved = y + rise * (1 - y / plate.relief_depth_m);
      mesh.y_m[grid.node(i, j)] = moved;
      mesh.y_m[grid.node(grid.columns - i, j)] = moved;
    }
  }
}

void join_sides(Mesh& mesh, const Plate& plate) {
  const Grid& grid = mesh.grid;
  if (grid.columns < 3)
    throw UserError("plate.sides = periodic needs three columns of elements or more, not {}", grid.columns);
  mesh.period_m = plate.width_m;
  for (int j = 0; j < grid.rows; ++j) {
    Cell& cell = mesh.cells[static_cast<std::size_t>(j) * grid.columns + grid.columns - 1];
    cell[1] = grid.node(0, j);
    cell[2] = grid.node(0, j + 1);
  }
  mesh.lower.pop_back();
  mesh.top.pop_back();
}

/// Every edge between two nodes gives half of its length to each.
void absorb(Mesh& mesh, const Plate& plate) {
  const Grid& grid = mesh.grid;
  const bool sides = plate.sides == Sides::absorbing, top = plate.top == Top::absorbing;
  const bool loaded = plate.top == Top::loaded;
  const bool periodic = mesh.period_m > 0;
  for (int j = 0; j <= grid.rows; ++j)
    for (int i = 0; i <= grid.columns - (periodic ? 1 : 0); ++i) {
      AbsorbingNode a{grid.node(i, j)};
      if (sides && (i == 0 || i == grid.columns) && (!loaded || j < grid.rows))
        a.side_m = grid.spacing_m * (j == 0 || j == grid.rows ? 0.5 : 1);
      if (top && j == grid.rows)
        a.top_m = grid.spacing_m * (!periodic && (i == 0 || i == grid.columns) ? 0.5 : 1);
      if (a.side_m > 0 || a.top_m > 0) mesh.absorbing.push_back(a);
    }
  if (!loaded) mesh.top.clear();
}

}  // namespace

Mesh make_plate(const Plate& plate) {
  Mesh mesh = make_rectangle(plate);
  if (plate.sides != Sides::free && plate.corner != Corner::none)
    throw UserError("plate.sides other than free needs right-angled corners; set plate.corner = \"none\"");
  if (plate.sides == Sides::periodic) join_sides(mesh, plate);
  absorb(mesh, plate);
  switch (plate.corner) {
    case Corner::none:
      break;
    case Corner::relief:
      check_relief(plate, mesh.grid);
      lift_corners(mesh, plate);
      break;
    case Corner::fillet:
      require_positive(plate.fillet_radius_m, "fillet_radius_m");
      round_corners(mesh, plate.fillet_radius_m);
      break;
  }
  return mesh;
}

}  // namespace slipfront::mesh
