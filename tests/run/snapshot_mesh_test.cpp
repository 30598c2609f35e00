// SPDX-License-Identifier: BSD-3-Clause
#include "run/snapshot_mesh.hpp"

#include <gtest/gtest.h>

#include <random>

#include "cases.hpp"
#include "mesh/plate.hpp"
#include "results/snapshots.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

struct Edges {
  const char* name;
  mesh::Sides sides;
  mesh::Corner corner;
};

/// A body on a base of another height, each of several slabs.
input::Case many_elements(const Edges& edges) {
  auto config = test::coarse_case(interface::EventKind::nucleation, 1e-3);
  config.plate.corner = edges.corner;
  config.plate.width_m = 0.7;
  config.plate.height_m = 0.5;
  config.plate.sides = edges.sides;
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress.t_Pa = 0.45e6;
  config.base.kind = input::BaseKind::body;
  config.base.plate.height_m = 0.4;
  config.base.plate.sides = edges.sides;
  return config;
}

SnapshotMesh in_rows(const input::Case& config) {
  const auto meshes = check(config);
  return snapshot_mesh_in_rows(config, meshes.plate.grid, meshes.base->grid);
}

class SnapshotMeshes : public testing::TestWithParam<Edges> {};

TEST_P(SnapshotMeshes, InRowsIsTheWholeToTheLastBit) {
  const auto config = many_elements(GetParam());
  ASSERT_TRUE(has_equal_elements(config));
  const auto whole_mesh = whole_snapshot_mesh(check(config)), mesh_in_rows = in_rows(config);
  ASSERT_EQ(mesh_in_rows.n_plate_cells, whole_mesh.n_plate_cells);
  const auto &whole = whole_mesh.slabs, &rows = mesh_in_rows.slabs;
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

TEST_P(SnapshotMeshes, InRowsMakesTheSameFile) {
  const auto config = many_elements(GetParam());
  const auto rows = in_rows(config), whole = whole_snapshot_mesh(check(config));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(-1e-6, 1e-6);
  motion::Snapshot snapshot{1e-6, solid::Field(rows.slabs.n_nodes), solid::Field(rows.slabs.n_nodes)};
  for (auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
    for (auto* component : {&field->x, &field->y})
      for (double& value : *component) value = some(random);
  const test::TemporaryFolder folder;
  const auto write = [&](const char* name, const SnapshotMesh& mesh) {
    results::write_snapshots(folder / name, mesh.slabs, results::series_of(std::span(&snapshot, 1)),
                             snapshot_contents(config, mesh));
  };
  write("rows.vtkhdf", rows);
  write("whole.vtkhdf", whole);
  const auto a = test::read_file(folder / "rows.vtkhdf"), b = test::read_file(folder / "whole.vtkhdf");
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a == b);
}

INSTANTIATE_TEST_SUITE_P(, SnapshotMeshes,
                         testing::Values(Edges{"periodic", mesh::Sides::periodic, mesh::Corner::none},
                                         Edges{"relief", mesh::Sides::free, mesh::Corner::relief}),
                         [](const auto& edges) { return std::string(edges.param.name); });

}  // namespace
}  // namespace slipfront::run
