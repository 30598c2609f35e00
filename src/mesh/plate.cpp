// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

constexpr auto max_nodes = std::numeric_limits<Node>::max();

/// @param holds_all  whether a mesh holds all of its nodes
Grid make_grid(const Plate& plate, bool holds_all) {
  require_positive(plate.width_m, "plate.width_m");
  require_positive(plate.height_m, "plate.height_m");
  require_positive(plate.element_size_m, "plate.element_size_m");
  const double columns = plate.width_m / plate.element_size_m;
  const double rows = plate.height_m / plate.element_size_m;
  const double in_row = std::round(columns) + 1, in_column = std::round(rows) + 1;
  if ((holds_all ? in_row * in_column : std::max(in_row, in_column)) > max_nodes)
    throw UserError("{} = {:.8g} makes more than {} nodes{}; use a larger size", Key("plate.element_size_m"),
                    plate.element_size_m, max_nodes, holds_all ? "" : " in a row or a column");
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
/// Grids of the blocks of a plate whose rectangle has the grid `whole`, upwards.
std::vector<Grid> make_blocks(const Plate& plate, const Grid& whole, std::string_view table) {
  if (plate.coarsenings == 0) return {whole};
  const Key coarsenings(fmt::format("{}.coarsenings", table));
  if (plate.coarsenings < 0) throw UserError("{} = {} must not be negative", coarsenings, plate.coarsenings);
  require_positive(plate.fine_height_m, "plate.fine_height_m");
  const int divisor = plate.sides == Sides::periodic ? 4 : 2;  // columns stay even where they are periodic
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
            "{} = {} needs a multiple of {:g} columns of elements, not {}; choose fewer, or another {}",
            coarsenings, plate.coarsenings, divisor * std::exp2(plate.coarsenings - 1), whole.columns,
            Key("plate.element_size_m"));
      const double min_m = k == 0 ? plate.fine_height_m : below_m;
      const double least = std::max(1.0, std::ceil(min_m / block.spacing_m - whole_tolerance));
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
    block.columns /= 2;
    block.spacing_m *= 2;
  }
  return grids;
}

/// Length of the transition's edges next to the blocks, at the left or the right side of the plate.
double transition_edge_m(const Grid& below, bool right) {
  return below.spacing_m * (right && has_inner(below.columns) ? 1 : 2);
}

/// The nodes of a block's grid rows, and of the transition above it, that a mesh holds; columns and rows are
/// those of the whole plate.
class Block {
 public:
  /// @param columns  of the smallest squares' nodes, of which the mesh holds some
  Block(const Grid& whole, int level, const Subset& columns, Node first)
      : grid(whole), size(1 << level), place_(static_cast<std::size_t>(whole.stride()), -1) {
    inner_place_ = place_;
    part_ = {0, whole.rows, whole.spacing_m, first};
    for (int i = 0; i <= whole.columns; ++i) {
      if (!columns.has(i * size)) continue;
      place_[static_cast<std::size_t>(i)] = static_cast<int>(held.size());
      held.push_back(i);
      if (has_inner(i)) inner_place_[static_cast<std::size_t>(i)] = n_inner_++;
    }
    part_.columns = static_cast<int>(held.size()) - 1;
  }

  Grid grid;              ///< of the whole; without `first`
  int size;               ///< of its squares, in smallest ones
  std::vector<int> held;  ///< columns

  const Grid& part() const { return part_; }
  bool has(int i) const { return place_[static_cast<std::size_t>(i)] >= 0; }
  /// @pre the mesh has it
  Node node(int i, int j) const {
    return part_.first + j * part_.stride() + place_[static_cast<std::size_t>(i)];
  }
  Node inner_node(int i) const { return first_inner() + inner_place_[static_cast<std::size_t>(i)]; }
  Node first_above() const { return first_inner() + n_inner_; }

 private:
  Node first_inner() const { return part_.first + static_cast<Node>(part_.n_nodes()); }

  Grid part_;
  std::vector<int> place_, inner_place_;
  int n_inner_ = 0;
};

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

/// Two arcs over which nodes are moved up.
class Relief {
 public:
  explicit Relief(const Plate& plate)
      : length_m_(plate.relief_length_m),
        depth_m_(plate.relief_depth_m),
        radius_m_((length_m_ * length_m_ + plate.relief_height_m * plate.relief_height_m) /
                  (2 * plate.relief_height_m)) {}

  /// The new height of a node. @param x  from the nearer side of the plate
  double lifted_m(double x, double y) const {
    const double into = length_m_ - x;
    if (into <= 0 || y >= depth_m_) return y;
    // radius - sqrt(radius^2 - into^2), without the cancellation
    const double rise = into * into / (radius_m_ + std::sqrt(radius2_ - into * into));
    return y + rise * (1 - y / depth_m_);
  }

 private:
  double length_m_, depth_m_, radius_m_;
  double radius2_ = radius_m_ * radius_m_;
};

/// Which rows of nodes a mesh holds.
enum class Rows { all, some };

/// A plate, of whose nodes and cells a mesh holds some columns, or some rows.
class Maker {
 public:
  Maker(const Plate& plate, const Subset& columns, Rows rows, std::string_view table)
      : plate_(plate),
        whole_(make_grid(plate, columns.ranges().empty() && rows == Rows::all)),
        is_periodic_(plate.sides == Sides::periodic) {
    const auto grids = make_blocks(plate, whole_, table);
    double n_nodes = 0;
    Node first = 0;
    for (std::size_t k = 0; k < grids.size(); ++k) {
      const auto& block = blocks_.emplace_back(grids[k], static_cast<int>(k), columns, first);
      const bool is_highest = k + 1 == grids.size();
      n_nodes += static_cast<double>(block.held.size()) * (block.grid.rows + (is_highest ? 1.0 : 2.0));
      if (n_nodes > max_nodes && (rows == Rows::all || !is_highest))
        throw UserError("{} = {:g} makes more than {} nodes; choose a larger one",
                        Key("plate.element_size_m"), plate.element_size_m, max_nodes);
      if (!is_highest) first = block.first_above();
    }
    if (plate.sides != Sides::free && plate.corner != Corner::none)
      throw UserError("{} other than free needs right-angled corners; set {} = \"none\"", Key("plate.sides"),
                      Key("plate.corner"));
    if (is_periodic_ && lowest().columns < 3)
      throw UserError("{} = periodic needs three columns of elements or more, not {}", Key("plate.sides"),
                      lowest().columns);
    if (plate.corner == Corner::relief) {
      check_relief(plate, lowest());
      relief_.emplace(plate);
    }
    if (plate.corner == Corner::fillet) {
      require_positive(plate.fillet_radius_m, "plate.fillet_radius_m");
      rounded_.emplace(lowest(), blocks_.size() > 1, plate.fillet_radius_m);
      for (const auto& [begin, end] : columns.ranges())
        SLIPFRONT_ASSERT(
            (begin == 0 || (begin > rounded_->cut() && begin <= lowest().columns - rounded_->cut())) &&
                (end == lowest().stride() ||
                 (end > rounded_->cut() && end <= lowest().columns - rounded_->cut())),
            "no part ends at a rounded corner");
    }
    if (is_periodic_ && columns.ranges().size() != 1) mesh_.period_m = plate.width_m;
    mesh_.grid = blocks_.front().part();
    for (std::size_t k = 1; k < blocks_.size(); ++k) mesh_.coarser.push_back(blocks_[k].part());
  }

  Mesh make_lowest_row() && {
    SLIPFRONT_ASSERT(plate_.corner != Corner::fillet, "the interface is a row");
    const auto& block = blocks_.front();
    for (const int i : block.held) add_grid_node(block, i, 0);
    name_interface_nodes();
    return std::move(mesh_);
  }

  Mesh make_rows(int begin, int end) && {
    SLIPFRONT_ASSERT(blocks_.size() == 1 && !rounded_, "rows of one grid");
    const auto& block = blocks_.front();
    mesh_.grid.rows = end - begin;
    SLIPFRONT_ASSERT(mesh_.grid.n_nodes() <= max_nodes, "rows of no more nodes than can be numbered");
    for (int j = begin; j <= end; ++j)
      for (const int i : block.held) add_grid_node(block, i, j);
    for (int j = 0; j < mesh_.grid.rows; ++j) add_row_of_squares(block, j);
    return std::move(mesh_);
  }

  Mesh make() && {
    const auto& highest = blocks_.back().part();
    const auto n_nodes = static_cast<std::size_t>(highest.first + highest.n_nodes());
    mesh_.x_m.reserve(n_nodes);
    mesh_.y_m.reserve(n_nodes);
    mesh_.cells.reserve(n_nodes);
    int level = 0;  // of the row, in rows of the smallest squares
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const auto& block = blocks_[k];
      for (int j = 0; j <= block.grid.rows; ++j)
        for (const int i : block.held) add_grid_node(block, i, level + j * block.size);
      add_squares(block);
      if (k + 1 == blocks_.size()) break;
      level += (block.grid.rows + 1) * block.size;
      for (const int i : block.held)
        if (has_inner(i)) add_inner_node(block, i, level);
      add_transition(block, blocks_[k + 1]);
      level += block.size;
    }
    if (rounded_) move_to_arcs();
    name_interface_nodes();
    name_top();
    name_left();
    absorb();
    return std::move(mesh_);
  }

 private:
  const Grid& lowest() const { return blocks_.front().grid; }
  double x_of(const Block& block, int i) const { return i * plate_.width_m / block.grid.columns; }

  /// @param from_edge_m  from the nearer side of the plate
  void add_node(double x_m, double from_edge_m, int level) {
    const double y = level * plate_.height_m / whole_.rows;
    mesh_.x_m.push_back(x_m);
    mesh_.y_m.push_back(relief_ ? relief_->lifted_m(from_edge_m, y) : y);
  }
  /// Both ends of a grid row are mirror images.
  void add_grid_node(const Block& block, int i, int level) {
    add_node(x_of(block, i), x_of(block, std::min(i, block.grid.columns - i)), level);
  }
  void add_inner_node(const Block& block, int i, int level) {
    const double x_m = x_of(block, i);
    add_node(x_m, std::min(x_m, plate_.width_m - x_m), level);
  }

  /// -1 where the mesh does not hold it.
  Node node(const Block& block, int i, int j) const {
    if (is_periodic_ && i == block.grid.columns) i = 0;
    return block.has(i) ? block.node(i, j) : -1;
  }
  Node inner_node(const Block& block, int i) const { return block.has(i) ? block.inner_node(i) : -1; }

  /// Where the mesh holds all of its nodes.
  void add_cell(const Cell& cell) {
    if (std::ranges::none_of(cell, [](Node n) { return n < 0; })) mesh_.cells.push_back(cell);
  }

  void add_squares(const Block& block) {
    for (int j = 0; j < block.grid.rows; ++j) add_row_of_squares(block, j);
  }

  void add_row_of_squares(const Block& block, int j) {
    const bool is_folded = rounded_ && &block == blocks_.data() && j <= rounded_->cut();
    for (const int i : block.held) {
      if (i == block.grid.columns) continue;
      if (is_folded)
        add_folded(block, i, j);
      else
        add_cell(
            {node(block, i, j), node(block, i + 1, j), node(block, i + 1, j + 1), node(block, i, j + 1)});
    }
  }

  void add_folded(const Block& block, int i, int j) {
    if (rounded_->is_cut(i, j)) return;
    const auto at = [&](int column, int row) {
      const auto place = rounded_->glued({column, row});
      return node(block, place.i, place.j);
    };
    add_cell({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }

  void add_transition(const Block& below, const Block& above) {
    const auto b = [&](int i) { return node(below, i, below.grid.rows); };
    const auto m = [&](int i) { return inner_node(below, i); };
    for (int column = 0; column < above.grid.columns; ++column) {
      const int i = 2 * column;
      const Node left = node(above, column, 0), right = node(above, column + 1, 0);
      if (column % 2 == 0) {
        add_cell({b(i), b(i + 1), m(i + 1), left});
        add_cell({b(i + 1), b(i + 2), m(i + 2), m(i + 1)});
        add_cell({left, m(i + 1), m(i + 2), right});
      } else {
        add_cell({b(i), b(i + 1), m(i + 1), m(i)});
        add_cell({b(i + 1), b(i + 2), right, m(i + 1)});
        add_cell({left, m(i), m(i + 1), right});
      }
    }
  }

  void move_to_arcs() {
    const auto& block = blocks_.front();
    const int columns = lowest().columns, side = rounded_->side();
    const auto is_moved = [&](int i) { return std::min(i, columns - i) < side; };
    if (std::ranges::none_of(block.held, is_moved)) return;
    const auto places = rounded_->places();
    const double width_m = x_of(block, columns);
    for (int j = 0; j < side; ++j)
      for (const int i : block.held) {
        if (!is_moved(i)) continue;
        const auto [x, y] = places[static_cast<std::size_t>(j * side + std::min(i, columns - i))];
        const Node n = block.node(i, j);
        mesh_.x_m[n] = i < side ? x : width_m - x;
        mesh_.y_m[n] = y;
      }
  }

  bool is_orphan(const Block& block, int i) const { return is_periodic_ && i == block.grid.columns; }

  void name_interface_nodes() {
    const auto& block = blocks_.front();
    if (rounded_) {
      for (const auto [i, j] : rounded_->lower())
        if (block.has(i)) mesh_.interface_nodes.push_back(block.node(i, j));
    } else {
      for (const int i : block.held)
        if (!is_orphan(block, i)) mesh_.interface_nodes.push_back(block.node(i, 0));
    }
  }

  void name_top() {
    if (plate_.top != Top::loaded) return;
    const auto& highest = blocks_.back();
    const double spacing_m = highest.grid.spacing_m;
    for (const int i : highest.held) {
      if (is_orphan(highest, i)) continue;
      const bool is_end = !is_periodic_ && (i == 0 || i == highest.grid.columns);
      mesh_.far_edge_nodes.push_back(highest.node(i, highest.grid.rows));
      mesh_.far_edge_lengths_m.push_back(is_end ? 0.5 * spacing_m : spacing_m);
    }
  }

  void name_left() {
    for (const auto& block : blocks_)
      for (int j = 0; block.has(0) && j <= block.grid.rows; ++j) mesh_.left_nodes.push_back(block.node(0, j));
  }

  /// Every edge between two nodes gives half of its length to each.
  void absorb() {
    const bool sides = plate_.sides == Sides::absorbing, top = plate_.top == Top::absorbing;
    const bool loaded = plate_.top == Top::loaded;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const auto& block = blocks_[k];
      const Grid& grid = block.grid;
      const bool first = k == 0, last = k + 1 == blocks_.size();
      for (int j = 0; j <= grid.rows; ++j)
        for (const int i : block.held) {
          if (is_orphan(block, i)) continue;
          AbsorbingNode a{block.node(i, j)};
          const bool at_top = last && j == grid.rows;
          if (sides && (i == 0 || i == grid.columns) && (!loaded || !at_top)) {
            const bool at_end = (first && j == 0) || at_top;
            a.side_m = grid.spacing_m * (at_end ? 0.5 : 1);
            // The transition's edges: 2 h, or h and h where an inner node stands on the edge.
            const Grid* below = j == 0 && !first ? &blocks_[k - 1].grid : nullptr;
            if (below != nullptr) a.side_m = 0.5 * (grid.spacing_m + transition_edge_m(*below, i > 0));
            if (j == grid.rows && !last) a.side_m = 0.5 * (grid.spacing_m + transition_edge_m(grid, i > 0));
          }
          if (at_top && top)
            a.top_m = grid.spacing_m * (!is_periodic_ && (i == 0 || i == grid.columns) ? 0.5 : 1);
          if (a.side_m > 0 || a.top_m > 0) mesh_.absorbing_nodes.push_back(a);
        }
      if (sides && !last && has_inner(grid.columns) && block.has(grid.columns))
        mesh_.absorbing_nodes.push_back({block.inner_node(grid.columns), grid.spacing_m, 0});
    }
  }

  const Plate& plate_;
  Grid whole_;
  bool is_periodic_ = false;
  std::vector<Block> blocks_;
  std::optional<Relief> relief_;
  std::optional<RoundedCorners> rounded_;
  Mesh mesh_;
};

}  // namespace

Mesh make_plate(const Plate& plate, std::string_view table) {
  return make_columns(plate, Subset(), table);
}

Mesh make_interface(const Plate& plate, std::string_view table) {
  return Maker(plate, Subset(), Rows::some, table).make_lowest_row();
}

Mesh make_corners(const Plate& plate, int around) {
  SLIPFRONT_ASSERT(plate.corner == Corner::relief && plate.coarsenings == 0, "corners of moved squares");
  const Grid whole = make_grid(plate, false);
  const auto cells = [&](double length_m) {
    return static_cast<int>(std::ceil(length_m / whole.spacing_m)) + around + 1;
  };
  const int n = whole.stride(), columns = cells(plate.relief_length_m) + 1;
  std::vector<Span> sides = {{0, n}};
  if (2 * columns < n) sides = {{0, columns}, {n - columns, n}};
  return Maker(plate, Subset(sides), Rows::some, "plate")
      .make_rows(0, std::min(whole.rows, cells(plate.relief_depth_m)));
}

Mesh make_rows(const Plate& plate, int begin, int end, std::string_view table) {
  return Maker(plate, Subset(), Rows::some, table).make_rows(begin, end);
}

Mesh make_columns(const Plate& plate, const Subset& columns, std::string_view table) {
  return Maker(plate, columns, Rows::all, table).make();
}

}  // namespace slipfront::mesh
