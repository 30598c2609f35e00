// SPDX-License-Identifier: BSD-3-Clause
#include "setup/snapshot_mesh.hpp"

#include <gtest/gtest.h>

#include <random>

#include "cases.hpp"
#include "mesh/plate.hpp"
#include "support/files.hpp"
#include "support/results.hpp"

namespace slipfront::run {
namespace {

using problem::make_problem;
struct Edges {
  const char* name;
  mesh::Sides sides;
  mesh::Corner corner;
};

class SnapshotMeshes : public testing::TestWithParam<Edges> {};

TEST_P(SnapshotMeshes, InRowsMakesTheSameFile) {
  // A body on a base of another height, each of two slabs.
  auto config = test::prestressed_case(1e-3);
  config.plate.width_m = 0.7;
  config.plate.height_m = 0.5;
  config.plate.sides = GetParam().sides;
  config.plate.corner = GetParam().corner;
  config.prestress.t_Pa = 0.45e6;
  config.prestress.p_Pa = 1e6;
  config.base.kind = input::BaseKind::body;
  config.base.plate.height_m = 0.4;
  config.base.plate.sides = GetParam().sides;
  ASSERT_TRUE(has_equal_elements(make_problem(config)));
  const auto meshes = setup::check(make_problem(config));
  const auto whole = setup::whole_snapshot_mesh(meshes);
  const auto rows = setup::snapshot_mesh_in_rows(make_problem(config));
  int n_slabs = 0;
  rows.slabs.for_some(0, rows.slabs.n_slabs, [&](const mesh::Slab&) { ++n_slabs; });
  EXPECT_EQ(n_slabs, 4);

  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(-1e-6, 1e-6);
  motion::Snapshot snapshot{1e-6, solid::Field(rows.slabs.n_nodes), solid::Field(rows.slabs.n_nodes)};
  for (auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
    for (auto* component : {&field->x, &field->y})
      for (double& value : *component) value = some(random);
  const auto written = [&](const setup::SnapshotMesh& mesh) {
    const test::TemporaryFolder folder;
    test::write_snapshots(folder.path(), mesh.slabs, std::span(&snapshot, 1),
                          snapshot_contents(make_problem(config), mesh));
    return test::read_file(folder / results::snapshot_output.file);
  };
  EXPECT_TRUE(written(rows) == written(whole));
}

INSTANTIATE_TEST_SUITE_P(, SnapshotMeshes,
                         testing::Values(Edges{"periodic", mesh::Sides::periodic, mesh::Corner::none},
                                         Edges{"relief", mesh::Sides::free, mesh::Corner::relief}),
                         [](const auto& edges) { return std::string(edges.param.name); });

}  // namespace
}  // namespace slipfront::run
