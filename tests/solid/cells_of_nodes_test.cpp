// SPDX-License-Identifier: BSD-3-Clause
#include "solid/cells_of_nodes.hpp"

#include <gtest/gtest.h>

#include "mesh/plate.hpp"

namespace slipfront::solid {
namespace {

TEST(CellsOfNodes, AreThoseThatHaveTheNodeWhateverTheBitsOfTheirPlaces) {
  for (const auto sides : {mesh::Sides::free, mesh::Sides::periodic}) {  // with orphans
    const auto mesh = mesh::make_plate({.width_m = 0.02,
                                        .height_m = 0.02,
                                        .element_size_m = 1e-3,
                                        .coarsenings = 1,
                                        .fine_height_m = 4e-3,
                                        .corner = mesh::Corner::none,
                                        .sides = sides});
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
    EXPECT_EQ(n_orphans > 0, sides == mesh::Sides::periodic);
  }
}

}  // namespace
}  // namespace slipfront::solid
