// SPDX-License-Identifier: BSD-3-Clause
#include "solid/cells_of_nodes.hpp"

#include <gtest/gtest.h>

#include "support/plate.hpp"

namespace slipfront::solid {
namespace {

TEST(CellsOfNodes, AreThoseThatHaveTheNodeWhateverTheBitsOfTheirPlaces) {
  auto plate = test::plate_of(0.02, 0.02, 1e-3);
  plate.coarsenings = 1;
  plate.fine_height_m = 4e-3;
  plate.sides = mesh::Sides::periodic;  // with orphans
  const auto mesh = mesh::make_plate(plate);
  const CellsOfNodes narrow(mesh), wide(mesh, 4 * mesh.cells.size() - 1);
  std::size_t n_orphans = 0;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    std::vector<std::int32_t> expected;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      for (const auto of_cell : mesh.cells[c])
        if (of_cell == n) expected.push_back(static_cast<std::int32_t>(c));
    for (const auto& cells : {narrow.of(n), wide.of(n)})
      EXPECT_EQ(std::vector(cells.begin(), cells.end()), expected);
    n_orphans += expected.empty() ? 1 : 0;
  }
  EXPECT_GT(n_orphans, 0);
}

}  // namespace
}  // namespace slipfront::solid
