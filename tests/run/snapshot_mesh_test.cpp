// SPDX-License-Identifier: BSD-3-Clause
#include "run/snapshot_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "cases.hpp"
#include "mesh/plate.hpp"
#include "results/snapshots.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

/// A body on a base of another height, each of several slabs.
input::Case many_squares(mesh::Sides sides) {
  auto config = test::coarse_case(interface::EventKind::nucleation, 1e-3);
  config.plate.corner = mesh::Corner::none;
  config.plate.width_m = 0.7;
  config.plate.height_m = 0.5;
  config.plate.sides = sides;
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress.t_Pa = 0.45e6;
  config.base.kind = input::BaseKind::body;
  config.base.plate.height_m = 0.4;
  config.base.plate.sides = sides;
  return config;
}

class SnapshotMesh : public testing::TestWithParam<mesh::Sides> {};

TEST_P(SnapshotMesh, InRowsIsTheWholeToTheLastBit) {
  const auto config = many_squares(GetParam());
  const auto whole = snapshot_mesh(config, check(config));
  const auto rows = snapshot_mesh(config, check_interfaces(config));
  ASSERT_EQ(rows.n_nodes, whole.n_nodes);
  ASSERT_EQ(rows.n_cells, whole.n_cells);
  std::vector<double> x_m, y_m;
  std::vector<mesh::Cell> cells;
  int n_slabs = 0;
  rows.for_each([&](const mesh::Slab& slab) {
    ++n_slabs;
    ASSERT_EQ(slab.first_node, x_m.size());
    ASSERT_EQ(slab.first_cell, cells.size());
    ASSERT_LE(slab.n_own, slab.mesh.x_m.size());
    x_m.insert(x_m.end(), slab.mesh.x_m.begin(), slab.mesh.x_m.begin() + static_cast<int>(slab.n_own));
    y_m.insert(y_m.end(), slab.mesh.y_m.begin(), slab.mesh.y_m.begin() + static_cast<int>(slab.n_own));
    for (auto cell : slab.mesh.cells) {
      for (auto& n : cell) n += static_cast<mesh::Node>(slab.first_node);
      cells.push_back(cell);
    }
  });
  EXPECT_EQ(n_slabs, 4);
  whole.for_each([&](const mesh::Slab& slab) {
    EXPECT_EQ(x_m, slab.mesh.x_m);
    EXPECT_EQ(y_m, slab.mesh.y_m);
    EXPECT_EQ(cells, slab.mesh.cells);
  });
}

TEST_P(SnapshotMesh, InRowsMakesTheSameFile) {
  const auto config = many_squares(GetParam());
  const auto meshes = check_interfaces(config);
  const auto n_plate_cells = static_cast<std::size_t>(n_cells_of(meshes.plate));
  const auto rows = snapshot_mesh(config, meshes), whole = snapshot_mesh(config, check(config));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(-1e-6, 1e-6);
  motion::Snapshot snapshot{1e-6, solid::Field(rows.n_nodes), solid::Field(rows.n_nodes)};
  for (auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
    for (auto* component : {&field->x, &field->y})
      for (double& value : *component) value = some(random);
  const auto contents = snapshot_contents(config, n_plate_cells, rows.n_cells);
  const test::TemporaryFolder folder;
  results::write_snapshots(folder / "rows.vtkhdf", rows, std::vector{snapshot}, contents);
  results::write_snapshots(folder / "whole.vtkhdf", whole, std::vector{snapshot}, contents);
  const auto a = test::read_file(folder / "rows.vtkhdf"), b = test::read_file(folder / "whole.vtkhdf");
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a == b);
}

INSTANTIATE_TEST_SUITE_P(, SnapshotMesh, testing::Values(mesh::Sides::absorbing, mesh::Sides::periodic),
                         [](const auto& sides) {
                           return sides.param == mesh::Sides::periodic ? "periodic" : "absorbing";
                         });

}  // namespace
}  // namespace slipfront::run
