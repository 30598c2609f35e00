// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <vector>

#include "base/error.hpp"
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
      for (auto n = row.first; n < row.end(); ++n) {
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
    const auto part = make_columns(plate(2, Sides::periodic), held);
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

TEST(NodeColumns, OfAWholeThatNoneHoldsHaveNumbersOf64Bits) {
  // 1e10 and 1e11 nodes, and a graded plate of 1e10.
  const std::vector<std::vector<Grid>> wholes = {{{.columns = 141421, .rows = 70710}},
                                                 {{.columns = 447213, .rows = 223606}},
                                                 {{.columns = 141424, .rows = 60000},
                                                  {.columns = 70712, .rows = 30000},
                                                  {.columns = 35356, .rows = 4000}}};
  for (const auto& grids : wholes) {
    const NodeColumns whole(grids);
    std::int64_t expected = 0;
    for (std::size_t k = 0; k < grids.size(); ++k) {
      expected += grids[k].n_nodes();
      // Three of four between two blocks.
      if (k + 1 < grids.size()) expected += grids[k].columns * 3 / 4;
    }
    EXPECT_GT(expected, std::int64_t{1} << 33);
    EXPECT_EQ(whole.n_nodes(), expected);
    const int last = whole.n_columns() - 1;
    EXPECT_EQ(whole.column_of(expected - 1), last);
    EXPECT_EQ(whole.row_of(expected - 1), whole.n_rows() - 1);
    for (const auto& held : {Subset({{last - 15, last + 1}}), Subset({{0, 9}, {last - 7, last + 1}})}) {
      const auto part = whole.of_part(held);
      ASSERT_LT(part.n_nodes(), std::int64_t{1} << 31);
      EXPECT_EQ(part.number_in_whole(part.n_nodes() - 1), expected - 1);
      for (int r = 0; r < whole.n_rows(); r += 997) {
        const auto row = part.row(r), of_whole = whole.row(r);
        const auto some = whole.nodes(r, {last - 7, last + 1});
        EXPECT_EQ(some.end(), of_whole.end());
        EXPECT_EQ(part.nodes(r, {last - 7, last + 1}).count, some.count);
        for (auto n = row.first; n < row.end(); ++n) {
          const auto number = part.number_in_whole(n);
          ASSERT_GE(number, of_whole.first);
          ASSERT_LT(number, of_whole.end());
          EXPECT_EQ(part.node_of_whole(number), n);
          EXPECT_EQ(whole.row_of(number), r);
          EXPECT_EQ(whole.column_of(number), part.column_of(n));
          EXPECT_EQ(whole.column_of_whole(number), part.column_of(n));
          EXPECT_TRUE(held.has(part.column_of(n)));
        }
      }
    }
  }
}

/// A part's nodes and cells, to the last bit and in the same order, are those of the whole.
void expect_columns(const Plate& plate, const Subset& held) {
  const auto whole = make_plate(plate);
  const auto part = make_columns(plate, held);
  const NodeColumns of_whole(whole), of_part(part, held, whole.grid.stride());
  const auto is_held = [&](Node n) { return held.has(of_whole.column_of(n)); };
  std::vector<Node> nodes;
  for (Node n = 0; n < whole.n_nodes(); ++n)
    if (is_held(n)) nodes.push_back(n);
  ASSERT_EQ(part.x_m.size(), nodes.size());
  ASSERT_EQ(part.y_m.size(), nodes.size());
  for (Node n = 0; n < part.n_nodes(); ++n) {
    const auto in_whole = nodes[static_cast<std::size_t>(n)];
    EXPECT_EQ(of_part.number_in_whole(n), in_whole);
    EXPECT_EQ(place(part, n), place(whole, in_whole));
  }
  const auto in_whole = [&](Node n) { return nodes[static_cast<std::size_t>(n)]; };
  std::vector<Cell> cells, expected_cells;
  for (auto cell : part.cells) {
    std::ranges::transform(cell, cell.begin(), in_whole);
    cells.push_back(cell);
  }
  for (const auto& cell : whole.cells)
    if (std::ranges::all_of(cell, is_held)) expected_cells.push_back(cell);
  EXPECT_EQ(cells, expected_cells);
  const auto expect_some = [&](const std::vector<Node>& some, const std::vector<Node>& all) {
    std::vector<Node> found, expected;
    std::ranges::transform(some, std::back_inserter(found), in_whole);
    std::ranges::copy_if(all, std::back_inserter(expected), is_held);
    EXPECT_EQ(found, expected);
  };
  expect_some(part.lower, whole.lower);
  expect_some(part.top, whole.top);
  std::vector<std::tuple<Node, double, double>> absorbing, expected_absorbing;
  for (const auto& a : part.absorbing) absorbing.emplace_back(in_whole(a.node), a.side_m, a.top_m);
  for (const auto& a : whole.absorbing)
    if (is_held(a.node)) expected_absorbing.emplace_back(a.node, a.side_m, a.top_m);
  EXPECT_EQ(absorbing, expected_absorbing);
  const auto grids = blocks(part), grids_of_whole = blocks(whole);
  ASSERT_EQ(grids.size(), grids_of_whole.size());
  for (std::size_t k = 0; k < grids.size(); ++k) {
    EXPECT_EQ(grids[k].rows, grids_of_whole[k].rows);
    EXPECT_EQ(grids[k].spacing_m, grids_of_whole[k].spacing_m);
    for (int j = 0; j <= grids[k].rows; ++j) {
      const auto row = of_part.row(of_part.row_of(grids[k].node(0, j)));
      EXPECT_EQ(row.first, grids[k].node(0, j));
      EXPECT_EQ(row.count, grids[k].stride());
    }
  }
}

TEST(MakeColumns, MakesTheNodesThereAndTheCellsBetweenThem) {
  for (const int coarsenings : {0, 1, 2})
    for (const int columns : {48, 44})
      for (const auto sides : {Sides::free, Sides::absorbing})
        for (const auto corner : {Corner::none, Corner::relief, Corner::fillet}) {
          auto some = plate(coarsenings, sides, columns);
          if (sides != Sides::free && corner != Corner::none) continue;
          some.corner = corner;
          some.fillet_radius_m = 4e-3;
          some.fine_height_m = 8e-3;
          if (coarsenings == 2) some.height_m = 0.06;
          // Cuts anywhere, within units of transitions, too.
          for (const auto& range :
               {Subset::Range{0, 25}, {9, 33}, {18, columns + 1}, {15, 34}, {0, columns + 1}}) {
            SCOPED_TRACE(testing::Message()
                         << coarsenings << " coarsenings, " << columns << " columns, corner "
                         << static_cast<int>(corner) << ", from " << range.begin);
            expect_columns(some, Subset({range}));
          }
        }
}

TEST(MakeColumns, MakesThoseOfAPlateThatRepeats) {
  for (const int coarsenings : {0, 1, 2})
    for (const auto& held : {Subset({{0, 17}, {32, 49}}), Subset({{3, 41}}), Subset({{0, 20}})})
      expect_columns(plate(coarsenings, Sides::periodic), held);
}

TEST(MakeInterface, MakesTheLowestRow) {
  for (const auto sides : {Sides::free, Sides::periodic})
    for (const int coarsenings : {0, 2}) {
      const auto whole = make_plate(plate(coarsenings, sides));
      const auto interface = make_interface(plate(coarsenings, sides));
      EXPECT_TRUE(interface.is_interface());
      EXPECT_FALSE(whole.is_interface());
      EXPECT_EQ(interface.lower, whole.lower);
      EXPECT_EQ(interface.period_m, whole.period_m);
      EXPECT_EQ(tributary_lengths_m(interface), tributary_lengths_m(whole));
      ASSERT_EQ(interface.n_nodes(), whole.grid.stride());
      for (Node n = 0; n < interface.n_nodes(); ++n) EXPECT_EQ(place(interface, n), place(whole, n));
      EXPECT_EQ(NodeColumns(blocks(interface)).n_nodes(), whole.n_nodes());
    }
}

TEST(MakeColumns, MakesThoseOfAPlateWithMoreNodesThanCanBeNumbered) {
  auto wide = plate(0);
  wide.width_m = 1000;
  wide.height_m = 30;
  EXPECT_THROW(make_plate(wide), UserError);
  const auto part = make_columns(wide, Subset({{500000, 500004}}));
  EXPECT_EQ(part.n_nodes(), 4 * 30001);
  EXPECT_EQ(part.x_m[1], 500001 * wide.width_m / 1000000);
}

/// 1e10 nodes.
Plate plate_of_1e10(Sides sides = Sides::free) {
  auto large = plate(0, sides);
  large.width_m = 141.421;
  large.height_m = 70.71;
  return large;
}

TEST(MakeColumns, MakesTheFarEndOfAPlateOf1e10Nodes) {
  const auto large = plate_of_1e10();
  const Subset held({{141417, 141422}});
  const auto part = make_columns(large, held);
  const NodeColumns of_part(part, held, 141422), whole(blocks(make_interface(large)));
  ASSERT_EQ(part.n_nodes(), 5 * 70711);
  ASSERT_EQ(part.cells.size(), 4U * 70710);
  EXPECT_EQ(part.top.size(), 5U);
  for (Node n = 0; n < part.n_nodes(); ++n) {
    const auto number = of_part.number_in_whole(n);
    const auto i = number % 141422, j = number / 141422;
    ASSERT_EQ(part.x_m[n], static_cast<double>(i) * large.width_m / 141421);
    ASSERT_EQ(part.y_m[n], static_cast<double>(j) * large.height_m / 70710);
    ASSERT_EQ(whole.column_of(number), i);
  }
  EXPECT_EQ(of_part.number_in_whole(part.n_nodes() - 1), whole.n_nodes() - 1);
  for (std::size_t k = 0; k < part.cells.size(); ++k) {
    const auto [a, b, c, d] = part.cells[k];
    const auto corner = static_cast<std::int64_t>(k / 4) * 141422 + 141417 + static_cast<std::int64_t>(k % 4);
    ASSERT_EQ(of_part.number_in_whole(a), corner);
    ASSERT_EQ(of_part.number_in_whole(b), corner + 1);
    ASSERT_EQ(of_part.number_in_whole(c), corner + 141422 + 1);
    ASSERT_EQ(of_part.number_in_whole(d), corner + 141422);
  }
}

TEST(MakeInterface, OfAPlateOf1e10NodesIsARow) {
  for (const auto sides : {Sides::free, Sides::periodic}) {
    const auto interface = make_interface(plate_of_1e10(sides));
    EXPECT_TRUE(interface.is_interface());
    EXPECT_EQ(interface.n_nodes(), 141422);
    EXPECT_EQ(interface.grid.n_nodes(), 10'000'091'042);
  }
  // Nodes of further blocks are numbered on from those below.
  auto graded = plate_of_1e10();
  graded.width_m = 141.424;
  graded.coarsenings = 1;
  graded.fine_height_m = 40;
  EXPECT_THROW(make_interface(graded), UserError);
}

TEST(MakeRows, MakesTheHighestOfAPlateOf1e10Nodes) {
  const auto large = plate_of_1e10();
  const auto rows = make_rows(large, 70709, 70710);
  ASSERT_EQ(rows.n_nodes(), 2 * 141422);
  ASSERT_EQ(rows.cells.size(), 141421U);
  EXPECT_EQ(rows.y_m.back(), large.height_m);
  EXPECT_EQ(rows.x_m.back(), large.width_m);
  EXPECT_EQ(rows.cells.back(), (Cell{141420, 141421, 2 * 141422 - 1, 2 * 141422 - 2}));
}

TEST(MakeColumns, RefusesMoreNodesThanAMeshCanNumber) {
  const auto large = plate_of_1e10();
  EXPECT_THROW(make_plate(large), UserError);
  EXPECT_THROW(make_columns(large, Subset({{0, 30371}})), UserError);  // 2^31 + 80,000
  auto wide = plate(0);
  wide.width_m = 2147483.647;  // a node more than a row may have
  EXPECT_THROW(make_interface(wide), UserError);
}

TEST(MakeColumns, TwoRangesHoldTheCellsThatJoinTheSides) {
  const auto whole = make_plate(plate(2, Sides::periodic));
  const auto part = make_columns(plate(2, Sides::periodic), Subset({{0, 17}, {32, 49}}));
  EXPECT_EQ(part.period_m, whole.period_m);
  const auto joins = [](const Mesh& mesh) {
    return std::ranges::count_if(mesh.cells, [&](const Cell& cell) {
      return std::ranges::any_of(cell, [&](Node n) { return mesh.x_m[n] == 0; }) &&
             std::ranges::any_of(cell, [&](Node n) { return mesh.x_m[n] > 0.04; });
    });
  };
  EXPECT_GT(joins(whole), 10);
  EXPECT_EQ(joins(part), joins(whole));
  EXPECT_EQ(make_columns(plate(2, Sides::periodic), Subset({{0, 17}})).period_m, 0);
}

TEST(MakeColumns, NoCutThroughARoundedCorner) {
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
      const auto left = make_columns(rounded, Subset({{0, column + 1}}));
      const auto right = make_columns(rounded, Subset({{column, last + 1}}));
      EXPECT_LE(left.cells.size() + right.cells.size(), whole.cells.size());
    }
    EXPECT_DEATH(make_columns(rounded, Subset({{0, 2}})), "rounded corner");
  }
  EXPECT_EQ(columns_of_wrapped_cells(make_plate(plate(1))), 0);
}

}  // namespace
}  // namespace slipfront::mesh
