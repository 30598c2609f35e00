// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/plate.hpp"

namespace slipfront::mesh {
namespace {

/// 48 columns of 1 mm, or 44: with half a unit at the right.
Plate plate(int coarsenings, Sides sides = Sides::free, int columns = 48) {
  Plate plate;
  plate.width_m = columns * 1e-3;
  plate.height_m = 0.03;
  plate.element_size_m = 1e-3;
  plate.corner = Corner::none;
  plate.coarsenings = coarsenings;
  plate.fine_height_m = 5e-3;
  plate.sides = sides;
  if (sides != Sides::free) plate.top = Top::absorbing;
  return plate;
}

using Place = std::pair<double, double>;
Place place(const Mesh& mesh, Node n) {
  return {mesh.x_m[n], mesh.y_m[n]};
}
/// Of no two nodes the same.
std::map<Place, Node> nodes_by_place(const Mesh& mesh) {
  std::map<Place, Node> nodes;
  for (Node n = 0; n < mesh.n_nodes(); ++n) nodes[place(mesh, n)] = n;
  return nodes;
}

TEST(NodeColumns, AreCountedInTheSmallestSquares) {
  for (const int columns : {48, 44}) {
    const auto mesh = make_plate(plate(2, Sides::free, columns));
    const NodeColumns of_nodes(mesh);
    EXPECT_EQ(of_nodes.n_columns(), columns + 1);
    EXPECT_EQ(of_nodes.n_nodes(), mesh.n_nodes());
    for (Node n = 0; n < mesh.n_nodes(); ++n) {
      EXPECT_EQ(of_nodes.column_of(n), std::lround(mesh.x_m[n] / 1e-3));
      EXPECT_EQ(of_nodes.number_in_whole(n), n);
      EXPECT_EQ(of_nodes.node_of_whole(n), n);
    }
    // A row's nodes in some columns are those that stand there.
    for (int r = 0; r < of_nodes.n_rows(); ++r) {
      const auto row = of_nodes.row(r), some = of_nodes.nodes(r, {7, 30});
      for (Node n = row.first; n < row.end(); ++n) {
        EXPECT_EQ(of_nodes.row_of(n), r);
        const int column = of_nodes.column_of(n);
        EXPECT_EQ(n >= some.first && n < some.end(), column >= 7 && column < 30);
      }
    }
  }
}

TEST(NodeColumns, OfAPartAreThoseOfTheWhole) {
  const auto whole = make_plate(plate(2, Sides::periodic));
  const NodeColumns of_whole(whole);
  for (const auto& held : {Subset({{5, 39}}), Subset({{0, 18}, {31, 49}})}) {
    const auto part = columns_of(whole, held);
    const auto nodes = nodes_by_place(whole);
    const NodeColumns of_nodes(part, held, 49), told = of_whole.of_part(held);
    ASSERT_EQ(told.n_nodes(), part.n_nodes());
    for (Node n = 0; n < part.n_nodes(); ++n) {
      const auto in_whole = nodes.at(place(part, n));
      EXPECT_EQ(of_nodes.number_in_whole(n), in_whole);
      EXPECT_EQ(of_nodes.column_of(n), of_whole.column_of(in_whole));
      EXPECT_EQ(of_nodes.column_of_whole(in_whole), of_whole.column_of(in_whole));
      EXPECT_EQ(told.node_of_whole(in_whole), n);
    }
  }
}

TEST(ColumnsOf, AreTheNodesThereAndTheCellsBetweenThem) {
  for (const int coarsenings : {0, 1, 2})
    for (const auto sides : {Sides::free, Sides::absorbing}) {
      const auto whole = make_plate(plate(coarsenings, sides));
      const NodeColumns of_whole(whole);
      const auto nodes = nodes_by_place(whole);
      // Cuts anywhere, within units of transitions, too.
      for (const auto& range : {Subset::Range{0, 25}, {9, 33}, {18, 49}, {15, 34}, {0, 49}}) {
        const Subset held({range});
        const auto part = columns_of(whole, held);
        EXPECT_EQ(part.coarser.size(), whole.coarser.size());
        EXPECT_EQ(part.grid.columns, range.end - range.begin - 1);
        const auto is_held = [&](Node n) { return held.has(of_whole.column_of(n)); };
        // Neighbouring numbers ascend as in the whole.
        Node last = -1;
        for (Node n = 0; n < part.n_nodes(); ++n) {
          const auto in_whole = nodes.at(place(part, n));
          EXPECT_TRUE(is_held(in_whole));
          EXPECT_GT(in_whole, last);
          last = in_whole;
        }
        EXPECT_EQ(part.n_nodes(),
                  std::ranges::count_if(nodes, [&](const auto& n) { return is_held(n.second); }));
        std::vector<Cell> cells;
        for (auto cell : part.cells) {
          for (auto& n : cell) n = nodes.at(place(part, n));
          cells.push_back(cell);
        }
        std::vector<Cell> expected;
        for (const auto& cell : whole.cells)
          if (std::ranges::all_of(cell, is_held)) expected.push_back(cell);
        EXPECT_EQ(cells, expected);
        for (const auto& grids = blocks(part); const auto& grid : grids)
          for (int j = 0; j <= grid.rows; ++j) {
            const auto row = grid.node(0, j);
            EXPECT_EQ(part.y_m[row], part.y_m[grid.node(grid.columns, j)]);
            EXPECT_EQ(of_whole.row_of(nodes.at(place(part, row))),
                      NodeColumns(part, held, whole.grid.stride()).row_of(row));
          }
        EXPECT_EQ(part.absorbing.size(), std::ranges::count_if(whole.absorbing, [&](const AbsorbingNode& a) {
                    return is_held(a.node);
                  }));
        EXPECT_EQ(part.top.size(), std::ranges::count_if(whole.top, is_held));
        EXPECT_EQ(part.lower.size(), std::ranges::count_if(whole.lower, is_held));
      }
    }
}

TEST(ColumnsOf, TwoRangesHoldTheCellsThatJoinTheSides) {
  const auto whole = make_plate(plate(2, Sides::periodic));
  const auto part = columns_of(whole, Subset({{0, 17}, {32, 49}}));
  EXPECT_EQ(part.period_m, whole.period_m);
  const auto joins = [](const Mesh& mesh) {
    return std::ranges::count_if(mesh.cells, [&](const Cell& cell) {
      return std::ranges::any_of(cell, [&](Node n) { return mesh.x_m[n] == 0; }) &&
             std::ranges::any_of(cell, [&](Node n) { return mesh.x_m[n] > 0.04; });
    });
  };
  EXPECT_GT(joins(whole), 10);
  EXPECT_EQ(joins(part), joins(whole));
  EXPECT_EQ(columns_of(whole, Subset({{0, 17}})).period_m, 0);
}

TEST(ColumnsOf, NoCutThroughARoundedCorner) {
  for (const int coarsenings : {0, 1}) {
    auto rounded = plate(coarsenings);
    rounded.corner = Corner::fillet;
    rounded.fillet_radius_m = 8e-3;
    rounded.fine_height_m = 12e-3;
    const auto whole = make_plate(rounded);
    const int corner = columns_of_wrapped_cells(whole), last = whole.grid.columns;
    EXPECT_GT(corner, 1);
    EXPECT_LT(corner, 17);
    for (int column = corner + 1; column < last - corner; ++column) {
      const auto left = columns_of(whole, Subset({{0, column + 1}}));
      const auto right = columns_of(whole, Subset({{column, last + 1}}));
      EXPECT_LE(left.cells.size() + right.cells.size(), whole.cells.size());
    }
    EXPECT_DEATH(columns_of(whole, Subset({{0, 2}})), "rounded corner");
  }
  EXPECT_EQ(columns_of_wrapped_cells(make_plate(plate(1))), 0);
}

}  // namespace
}  // namespace slipfront::mesh
