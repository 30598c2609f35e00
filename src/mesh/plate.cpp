// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "mesh/fillet.hpp"

namespace slipfront::mesh {
namespace {

constexpr double whole_tolerance = 1e-6;  // relative, for "a whole multiple of the element size"

void require_positive(double value, const char* key) {
  if (!(value > 0) || !std::isfinite(value))
    throw UserError("{} must be a positive length, not {:g}", Key(key), value);
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
  const Key width("plate.width_m"), height("plate.height_m");
  throw UserError("{} = {:.8g} does not divide the plate of {:.8g} m x {:.8g} m into whole elements; {}",
                  Key("plate.element_size_m"), plate.element_size_m, plate.width_m, plate.height_m,
                  sizes.empty() ? Message("no size near it fits both, change {} or {}", width, height)
                                : Message("the nearest that fit are " + sizes))
      .about(width, height);
}

Grid make_grid(const Plate& plate) {
  require_positive(plate.width_m, "plate.width_m");
  require_positive(plate.height_m, "plate.height_m");
  require_positive(plate.element_size_m, "plate.element_size_m");
  const double columns = plate.width_m / plate.element_size_m;
  const double rows = plate.height_m / plate.element_size_m;
  if ((columns + 1) * (rows + 1) > std::numeric_limits<Node>::max())
    throw UserError("{} = {:.8g} makes more than {} nodes; use a larger size", Key("plate.element_size_m"),
                    plate.element_size_m, std::numeric_limits<Node>::max());
  if (!is_whole(columns) || !is_whole(rows)) throw_no_fit(plate);
  Grid grid;
  grid.columns = static_cast<int>(std::lround(columns));
  grid.rows = static_cast<int>(std::lround(rows));
  grid.spacing_m = plate.width_m / grid.columns;
  return grid;
}

/// Column i of the transition's inner nodes stands i times the smaller spacing from the left; every fourth
/// column has none.
bool has_inner(int i) {
  return i % 4 != 0;
}
int n_inner(const Grid& below) {
  return below.columns - below.columns / 4;
}
Node inner_node(const Grid& below, int i) {
  return below.first + below.n_nodes() + i - 1 - i / 4;
}

/// Grids of the blocks of a plate whose rectangle has the grid `whole`, upwards.
std::vector<Grid> make_blocks(const Plate& plate, const Grid& whole, std::string_view table) {
  if (plate.coarsenings == 0) return {whole};
  const Key coarsenings(fmt::format("{}.coarsenings", table));
  if (plate.coarsenings < 0) throw UserError("{} = {} must not be negative", coarsenings, plate.coarsenings);
  require_positive(plate.fine_height_m, "plate.fine_height_m");
  const bool periodic = plate.sides == Sides::periodic;
  const int divisor = periodic ? 4 : 2;
  std::vector<Grid> grids;
  Grid block = whole;
  int rows_left = whole.rows;  // of the block's squares, up to the loaded edge
  double below_m = 0;
  for (int k = 0; k <= plate.coarsenings; ++k) {
    if (k == plate.coarsenings) {
      block.rows = rows_left;
    } else {
      if (block.columns % divisor != 0)
        throw UserError(
            "{} = {} needs a number of columns of elements that can be halved so often{}; {} columns can {} "
            "times: choose fewer, or another {}",
            coarsenings, plate.coarsenings, periodic ? " and stay even, the sides being periodic" : "",
            whole.columns, k, Key("plate.element_size_m"));
      const double least_m = k == 0 ? plate.fine_height_m : below_m;
      const double least = std::max(1.0, std::ceil(least_m / block.spacing_m - whole_tolerance));
      if (least + 4 > rows_left)
        throw UserError("{} = {} leaves no room for the largest elements; choose fewer, or a {} below {:g}",
                        coarsenings, plate.coarsenings, Key(fmt::format("{}.fine_height_m", table)),
                        plate.fine_height_m);
      block.rows = static_cast<int>(least);
      block.rows += (rows_left - block.rows) % 2;
    }
    grids.push_back(block);
    below_m += (block.rows + 2) * block.spacing_m;
    rows_left = (rows_left - block.rows) / 2 - 1;
    block.first += block.n_nodes() + n_inner(block);
    block.columns /= 2;
    block.spacing_m *= 2;
  }
  return grids;
}

/// Length of the transition's edges next to the blocks, at the left or the right side of the plate.
double transition_edge_m(const Grid& below, bool right) {
  return below.spacing_m * (right && has_inner(below.columns) ? 1 : 2);
}

void add_squares(Mesh& mesh, const Grid& grid) {
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      mesh.cells.push_back(
          {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1), grid.node(i, j + 1)});
}

void add_transition(Mesh& mesh, const Grid& below, const Grid& above) {
  const auto b = [&](int i) { return below.node(i, below.rows); };
  const auto m = [&](int i) { return inner_node(below, i); };
  for (int column = 0; column < above.columns; ++column) {
    const int i = 2 * column;
    const Node left = above.node(column, 0), right = above.node(column + 1, 0);
    if (column % 2 == 0) {
      mesh.cells.push_back({b(i), b(i + 1), m(i + 1), left});
      mesh.cells.push_back({b(i + 1), b(i + 2), m(i + 2), m(i + 1)});
      mesh.cells.push_back({left, m(i + 1), m(i + 2), right});
    } else {
      mesh.cells.push_back({b(i), b(i + 1), m(i + 1), m(i)});
      mesh.cells.push_back({b(i + 1), b(i + 2), right, m(i + 1)});
      mesh.cells.push_back({left, m(i), m(i + 1), right});
    }
  }
}

Mesh make_rectangle(const Plate& plate, std::string_view table) {
  const Grid whole = make_grid(plate);
  const auto grids = make_blocks(plate, whole, table);
  std::size_t n_nodes = 0;
  for (const Grid& grid : grids)
    n_nodes += static_cast<std::size_t>(grid.stride()) * (static_cast<std::size_t>(grid.rows) + 2);
  if (n_nodes > static_cast<std::size_t>(std::numeric_limits<Node>::max()))
    throw UserError("{} = {:g} makes {} nodes, more than can be numbered; choose a larger one",
                    Key("plate.element_size_m"), plate.element_size_m, n_nodes);
  Mesh mesh;
  mesh.grid = grids.front();
  mesh.coarser.assign(grids.begin() + 1, grids.end());
  mesh.x_m.reserve(n_nodes);
  mesh.y_m.reserve(n_nodes);
  mesh.cells.reserve(n_nodes);
  int level = 0;  // of the row, in rows of the smallest squares
  const auto y_of = [&](int at) { return at * plate.height_m / whole.rows; };
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const Grid& grid = grids[k];
    const int size = 1 << k;  // of the block's squares, in smallest ones
    for (int j = 0; j <= grid.rows; ++j)
      for (int i = 0; i <= grid.columns; ++i) {
        mesh.x_m.push_back(i * plate.width_m / grid.columns);
        mesh.y_m.push_back(y_of(level + j * size));
      }
    add_squares(mesh, grid);
    if (k + 1 == grids.size()) break;
    level += (grid.rows + 1) * size;
    for (int i = 0; i <= grid.columns; ++i) {
      if (!has_inner(i)) continue;
      mesh.x_m.push_back(i * plate.width_m / grid.columns);
      mesh.y_m.push_back(y_of(level));
    }
    add_transition(mesh, grid, grids[k + 1]);
    level += size;
  }
  const Grid& highest = grids.back();
  for (int i = 0; i <= mesh.grid.columns; ++i) mesh.lower.push_back(mesh.grid.node(i, 0));
  for (int i = 0; i <= highest.columns; ++i) mesh.top.push_back(highest.node(i, highest.rows));
  return mesh;
}

void check_relief(const Plate& plate, const Grid& grid) {
  const Key relief_length("plate.relief_length_m"), relief_height("plate.relief_height_m"),
      relief_depth("plate.relief_depth_m");
  require_positive(plate.relief_length_m, "plate.relief_length_m");
  require_positive(plate.relief_height_m, "plate.relief_height_m");
  require_positive(plate.relief_depth_m, "plate.relief_depth_m");
  if (plate.relief_length_m < (1 - whole_tolerance) * grid.spacing_m)
    throw UserError("{} = {:g} is shorter than an element; make it at least {:.8g}", relief_length,
                    plate.relief_length_m, grid.spacing_m)
        .about("plate.element_size_m");
  if (plate.relief_length_m >= 0.5 * plate.width_m)
    throw UserError("{} = {:g} leaves no flat base between the two reliefs; make it less than {:g}",
                    relief_length, plate.relief_length_m, 0.5 * plate.width_m)
        .about("plate.width_m");
  // The limits of one half keep every angle above 36 degrees and every cell at least half as high as it was.
  if (plate.relief_height_m > 0.5 * plate.relief_length_m)
    throw UserError("{} = {:g} is too steep; make it at most half of {} = {:g}", relief_height,
                    plate.relief_height_m, relief_length, plate.relief_length_m);
  if (plate.relief_depth_m > plate.height_m)
    throw UserError("{} = {:g} does not fit into the plate; make it at most {} = {:g}", relief_depth,
                    plate.relief_depth_m, Key("plate.height_m"), plate.height_m);
  if (plate.relief_height_m > 0.5 * plate.relief_depth_m)
    throw UserError("{} = {:g} is too small; make it at least twice {} = {:g}", relief_depth,
                    plate.relief_depth_m, relief_height, plate.relief_height_m);
}

/// Moves the nodes above the two arcs up, and by the same amount at both ends.
void lift_corners(Mesh& mesh, const Plate& plate) {
  const double length = plate.relief_length_m;
  const double height = plate.relief_height_m;
  const double radius = (length * length + height * height) / (2 * height);
  const auto lifted = [&](double x, double y) {
    const double into = length - x;
    if (into <= 0 || y >= plate.relief_depth_m) return y;
    // radius - sqrt(radius^2 - into^2), without the cancellation
    const double rise = into * into / (radius + std::sqrt(radius * radius - into * into));
    return y + rise * (1 - y / plate.relief_depth_m);
  };
  for (const Grid& grid : blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j)
      for (int i = 0; 2 * i < grid.columns; ++i) {
        const double y = mesh.y_m[grid.node(i, j)];
        const double moved = lifted(mesh.x_m[grid.node(i, j)], y);
        if (moved == y) break;
        mesh.y_m[grid.node(i, j)] = moved;
        mesh.y_m[grid.node(grid.columns - i, j)] = moved;
      }
  const auto grids = blocks(mesh);
  for (std::size_t k = 0; k + 1 < grids.size(); ++k)
    for (int i = 1; i <= grids[k].columns; ++i) {
      if (!has_inner(i)) continue;
      const Node n = inner_node(grids[k], i);
      const double x = mesh.x_m[n];
      mesh.y_m[n] = lifted(std::min(x, plate.width_m - x), mesh.y_m[n]);
    }
}

void join_sides(Mesh& mesh, const Plate& plate) {
  if (mesh.grid.columns < 3)
    throw UserError("{} = periodic needs three columns of elements or more, not {}", Key("plate.sides"),
                    mesh.grid.columns);
  mesh.period_m = plate.width_m;
  std::vector<Node> joined(mesh.x_m.size());
  std::iota(joined.begin(), joined.end(), 0);
  for (const Grid& grid : blocks(mesh))
    for (int j = 0; j <= grid.rows; ++j) joined[grid.node(grid.columns, j)] = grid.node(0, j);
  for (Cell& cell : mesh.cells)
    for (Node& n : cell) n = joined[n];
  mesh.lower.pop_back();
  mesh.top.pop_back();
}

/// Every edge between two nodes gives half of its length to each.
void absorb(Mesh& mesh, const Plate& plate) {
  const bool sides = plate.sides == Sides::absorbing, top = plate.top == Top::absorbing;
  const bool loaded = plate.top == Top::loaded;
  const bool periodic = mesh.period_m > 0;
  const auto grids = blocks(mesh);
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const Grid& grid = grids[k];
    const bool first = k == 0, last = k + 1 == grids.size();
    for (int j = 0; j <= grid.rows; ++j)
      for (int i = 0; i <= grid.columns - (periodic ? 1 : 0); ++i) {
        AbsorbingNode a{grid.node(i, j)};
        const bool at_top = last && j == grid.rows;
        if (sides && (i == 0 || i == grid.columns) && (!loaded || !at_top)) {
          const bool at_end = (first && j == 0) || at_top;
          a.side_m = grid.spacing_m * (at_end ? 0.5 : 1);
          // The transition's edges: 2 h, or h and h where an inner node stands on the edge.
          const Grid* below = j == 0 && !first ? &grids[k - 1] : nullptr;
          if (below != nullptr) a.side_m = 0.5 * (grid.spacing_m + transition_edge_m(*below, i > 0));
          if (j == grid.rows && !last) a.side_m = 0.5 * (grid.spacing_m + transition_edge_m(grid, i > 0));
        }
        if (at_top && top) a.top_m = grid.spacing_m * (!periodic && (i == 0 || i == grid.columns) ? 0.5 : 1);
        if (a.side_m > 0 || a.top_m > 0) mesh.absorbing.push_back(a);
      }
    if (sides && !last && has_inner(grid.columns))
      mesh.absorbing.push_back({inner_node(grid, grid.columns), grid.spacing_m, 0});
  }
  if (!loaded) mesh.top.clear();
}

}  // namespace

Mesh make_plate(const Plate& plate, std::string_view table) {
  Mesh mesh = make_rectangle(plate, table);
  if (plate.sides != Sides::free && plate.corner != Corner::none)
    throw UserError("{} other than free needs right-angled corners; set {} = \"none\"", Key("plate.sides"),
                    Key("plate.corner"));
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
      require_positive(plate.fillet_radius_m, "plate.fillet_radius_m");
      round_corners(mesh, plate.fillet_radius_m);
      break;
  }
  return mesh;
}

}  // namespace slipfront::mesh
