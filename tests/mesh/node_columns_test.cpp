// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/node_columns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "mesh/plate.hpp"
#include "mesh/reorder.hpp"

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

TEST(NodeColumns, AreCountedInTheSmallestSquares) {
  for (const int columns : {48, 44}) {
    const auto mesh = make_plate(plate(2, Sides::free, columns));
    const NodeColumns of_nodes(mesh);
    EXPECT_EQ(of_nodes.n_columns(), columns + 1);
    EXPECT_EQ(of_nodes.n_nodes(), mesh.n_nodes());
    for (Node n = 0; n < mesh.n_nodes(); ++n) {
      EXPECT_EQ(of_nodes.column_of(n), std::lround(mesh.x_m[n] / 1e-3));
      EXPECT_EQ(of_nodes.global_number(n), n);
      EXPECT_EQ(of_nodes.local_node(n), n);
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

TEST(NodeColumns, OfAMeshWithoutAGridHaveANodeEach) {
  auto mesh = make_plate(plate(0));
  renumber(mesh, near_numbers(mesh));
  const NodeColumns columns(mesh);
  EXPECT_EQ(columns.n_rows(), 1);
  EXPECT_EQ(columns.n_columns(), mesh.n_nodes());
  for (Node n = 0; n < mesh.n_nodes(); ++n) EXPECT_EQ(columns.column_of(n), n);
}

TEST(NodeColumns, OfAWholeThatNoneHoldsHaveNumbersOf64Bits) {
  // 1e11 nodes, and a graded plate of 1e10.
  const std::vector<std::vector<Grid>> wholes = {{{.columns = 447213, .rows = 223606}},
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
      const auto part = whole.of_subdomain(held);
      ASSERT_LT(part.n_nodes(), std::int64_t{1} << 31);
      EXPECT_EQ(part.global_number(part.n_nodes() - 1), expected - 1);
      for (int r = 0; r < whole.n_rows(); r += 997) {
        const auto row = part.row(r), of_whole = whole.row(r);
        const auto some = whole.nodes(r, {last - 7, last + 1});
        EXPECT_EQ(some.end(), of_whole.end());
        EXPECT_EQ(part.nodes(r, {last - 7, last + 1}).count, some.count);
        for (auto n = row.first; n < row.end(); ++n) {
          const auto number = part.global_number(n);
          ASSERT_GE(number, of_whole.first);
          ASSERT_LT(number, of_whole.end());
          EXPECT_EQ(part.local_node(number), n);
          EXPECT_EQ(whole.row_of(number), r);
          EXPECT_EQ(whole.column_of(number), part.column_of(n));
          EXPECT_EQ(whole.global_column_of(number), part.column_of(n));
          EXPECT_TRUE(held.has(part.column_of(n)));
        }
      }
    }
  }
}

/// A part's nodes and cells, to the last bit and in the same order, are those of the whole; so are the
/// columns of its nodes.
void expect_columns(const Plate& plate, const Subset& held) {
  SCOPED_TRACE(testing::Message() << plate.coarsenings << " coarsenings, width " << plate.width_m
                                  << " m, corner " << static_cast<int>(plate.corner) << ", from column "
                                  << held.ranges().front().begin);
  const auto whole = make_plate(plate), part = make_columns(plate, held);
  const NodeColumns of_whole(whole), of_subdomain(part, held, of_whole.n_columns()),
      told = of_whole.of_subdomain(held);
  const auto is_held = [&](Node n) { return held.has(of_whole.column_of(n)); };
  std::vector<Node> nodes;
  for (Node n = 0; n < whole.n_nodes(); ++n)
    if (is_held(n)) nodes.push_back(n);
  ASSERT_EQ(part.x_m.size(), nodes.size());
  ASSERT_EQ(part.y_m.size(), nodes.size());
  ASSERT_EQ(told.n_nodes(), part.n_nodes());
  const auto in_whole = [&](Node n) { return nodes[static_cast<std::size_t>(n)]; };
  for (Node n = 0; n < part.n_nodes(); ++n) {
    EXPECT_EQ(place(part, n), place(whole, in_whole(n)));
    EXPECT_EQ(of_subdomain.global_number(n), in_whole(n));
    EXPECT_EQ(told.local_node(in_whole(n)), n);
    EXPECT_EQ(of_subdomain.column_of(n), of_whole.column_of(in_whole(n)));
    EXPECT_EQ(of_subdomain.global_column_of(in_whole(n)), of_subdomain.column_of(n));
  }
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
  expect_some(part.interface_nodes, whole.interface_nodes);
  expect_some(part.far_edge_nodes, whole.far_edge_nodes);
  expect_some(part.left_nodes, whole.left_nodes);
  std::vector<double> lengths_m;
  for (std::size_t k = 0; k < whole.far_edge_nodes.size(); ++k)
    if (is_held(whole.far_edge_nodes[k])) lengths_m.push_back(whole.far_edge_lengths_m[k]);
  EXPECT_EQ(part.far_edge_lengths_m, lengths_m);
  std::vector<std::tuple<Node, double, double>> absorbing, expected_absorbing;
  for (const auto& [n, side_m, top_m] : part.absorbing_nodes)
    absorbing.emplace_back(in_whole(n), side_m, top_m);
  for (const auto& [n, side_m, top_m] : whole.absorbing_nodes)
    if (is_held(n)) expected_absorbing.emplace_back(n, side_m, top_m);
  EXPECT_EQ(absorbing, expected_absorbing);
  const bool has_both_sides = held.has(0) && held.has(of_whole.n_columns() - 1);
  EXPECT_EQ(part.period_m, has_both_sides ? whole.period_m : 0);
  const auto grids = blocks(part), grids_of_whole = blocks(whole);
  ASSERT_EQ(grids.size(), grids_of_whole.size());
  for (std::size_t k = 0; k < grids.size(); ++k) {
    EXPECT_EQ(grids[k].rows, grids_of_whole[k].rows);
    EXPECT_EQ(grids[k].spacing_m, grids_of_whole[k].spacing_m);
    for (int j = 0; j <= grids[k].rows; ++j) {
      const auto row = of_subdomain.row(of_subdomain.row_of(grids[k].node(0, j)));
      EXPECT_EQ(row.first, grids[k].node(0, j));
      EXPECT_EQ(row.count, grids[k].stride());
    }
  }
}

TEST(MakeColumns, MakesTheNodesThereAndTheCellsBetweenThem) {
  struct Form {
    int coarsenings, columns;
    Sides sides;
    Corner corner;
  };
  for (const auto& form :
       {Form{0, 48, Sides::free, Corner::fillet}, Form{0, 44, Sides::absorbing, Corner::none},
        Form{1, 44, Sides::free, Corner::relief}, Form{1, 48, Sides::free, Corner::fillet},
        Form{2, 44, Sides::absorbing, Corner::none}, Form{2, 48, Sides::free, Corner::relief},
        Form{0, 48, Sides::periodic, Corner::none}, Form{2, 48, Sides::periodic, Corner::none}}) {
    auto some = plate(form.coarsenings, form.sides, form.columns);
    some.corner = form.corner;
    some.fillet_radius_m = 4e-3;
    some.fine_height_m = 8e-3;
    if (form.coarsenings == 2) some.height_m = 0.06;
    // Cuts anywhere, within units of transitions, too.
    for (const auto& range : {Span{0, 25}, {9, 33}, {18, form.columns + 1}, {15, 34}})
      expect_columns(some, Subset({range}));
    if (form.sides == Sides::periodic) {
      expect_columns(some, Subset({{0, 17}, {32, 49}}));
      expect_columns(some, Subset({{0, 18}, {31, 49}}));
    }
  }
}

TEST(MakeInterface, MakesTheLowestRow) {
  auto relieved = plate(0);
  relieved.corner = Corner::relief;
  for (const auto& of :
       {plate(0), plate(2), plate(0, Sides::periodic), plate(2, Sides::periodic), relieved}) {
    const auto whole = make_plate(of), interface = make_interface(of);
    EXPECT_TRUE(interface.is_interface());
    EXPECT_FALSE(whole.is_interface());
    EXPECT_EQ(interface.interface_nodes, whole.interface_nodes);
    EXPECT_EQ(interface.period_m, whole.period_m);
    EXPECT_EQ(tributary_lengths_m(interface), tributary_lengths_m(whole));
    ASSERT_EQ(interface.n_nodes(), whole.grid.stride());
    for (Node n = 0; n < interface.n_nodes(); ++n) EXPECT_EQ(place(interface, n), place(whole, n));
    EXPECT_EQ(NodeColumns(blocks(interface)).n_nodes(), whole.n_nodes());
    EXPECT_EQ(interface.y_m.front() > 0, of.corner == Corner::relief);
  }
}

TEST(MakeCorners, HaveAllCellsThatAreNoSquaresAndSomeAroundThem) {
  constexpr int around = 3;
  const Plate relieved{.width_m = 0.06,
                       .height_m = 0.03,
                       .element_size_m = 1e-3,
                       .corner = Corner::relief,
                       .relief_length_m = 4.5e-3,
                       .relief_height_m = 0.5e-3,
                       .relief_depth_m = 6.2e-3};
  const auto whole = make_plate(relieved), corners = make_corners(relieved, around);
  EXPECT_LT(corners.n_nodes(), whole.n_nodes() / 3);
  EXPECT_FALSE(corners.is_interface());
  using Places = std::array<std::pair<double, double>, 4>;
  const auto places_of = [](const Mesh& mesh, const Cell& cell) {
    Places places;
    std::ranges::transform(cell, places.begin(), [&](Node n) { return std::pair(mesh.x_m[n], mesh.y_m[n]); });
    return places;
  };
  // Cells of the whole near the corners, in its order.
  std::vector<Places> expected, found;
  const double from_side_m = 1e-3 * (5 + around), from_base_m = 1e-3 * (7 + around);
  for (const auto& cell : whole.cells) {
    const auto places = places_of(whole, cell);
    const double x_m = 0.5 * (places[0].first + places[1].first),
                 y_m = 0.5 * (places[0].second + places[3].second);
    if (std::min(x_m, relieved.width_m - x_m) < from_side_m && y_m < from_base_m) expected.push_back(places);
  }
  for (const auto& cell : corners.cells) found.push_back(places_of(corners, cell));
  std::size_t k = 0;
  for (const auto& places : found)
    if (k < expected.size() && places == expected[k]) ++k;
  EXPECT_EQ(k, expected.size());
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
  const NodeColumns of_subdomain(part, held, 141422), whole(blocks(make_interface(large)));
  ASSERT_EQ(part.n_nodes(), 5 * 70711);
  ASSERT_EQ(part.cells.size(), 4U * 70710);
  EXPECT_EQ(part.far_edge_nodes.size(), 5U);
  for (Node n = 0; n < part.n_nodes(); ++n) {
    const auto number = of_subdomain.global_number(n);
    const auto i = number % 141422, j = number / 141422;
    ASSERT_EQ(part.x_m[n], static_cast<double>(i) * large.width_m / 141421);
    ASSERT_EQ(part.y_m[n], static_cast<double>(j) * large.height_m / 70710);
    ASSERT_EQ(whole.column_of(number), i);
  }
  EXPECT_EQ(of_subdomain.global_number(part.n_nodes() - 1), whole.n_nodes() - 1);
  for (std::size_t k = 0; k < part.cells.size(); ++k) {
    const auto [a, b, c, d] = part.cells[k];
    const auto corner = static_cast<std::int64_t>(k / 4) * 141422 + 141417 + static_cast<std::int64_t>(k % 4);
    ASSERT_EQ(of_subdomain.global_number(a), corner);
    ASSERT_EQ(of_subdomain.global_number(b), corner + 1);
    ASSERT_EQ(of_subdomain.global_number(c), corner + 141422 + 1);
    ASSERT_EQ(of_subdomain.global_number(d), corner + 141422);
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
