// SPDX-License-Identifier: BSD-3-Clause
// Plates of more nodes than one process can number.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "advice/info.hpp"
#include "advice/notes.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "mesh/plate.hpp"
#include "motion/state_by_node.hpp"
#include "problem/problem.hpp"
#include "setup/cases.hpp"
#include "setup/snapshot_mesh.hpp"
#include "setup/subdomains.hpp"

namespace slipfront::advice {
namespace {

using problem::make_problem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Columns of nodes, and nodes of a column: 1e10 in all.
constexpr std::int64_t n_columns = 141422, of_column = 70711;

/// With a base as high.
input::Case two_bodies() {
  auto config = test::coarse_case(interface::EventKind::nucleation, 1e-3);
  config.plate.corner = mesh::Corner::none;
  config.plate.width_m = 141.421;
  config.plate.height_m = 70.71;
  config.loading.method = statics::LoadingMethod::prestress;
  config.prestress.t_Pa = 2.1e6;
  config.prestress.p_Pa = 5e6;
  config.nucleation.x_m = 70;
  config.base.kind = input::BaseKind::body;
  config.base.plate.height_m = config.plate.height_m;
  config.base.material = config.material;
  config.time.interface_substeps = 1;
  config.time.interface_rows = 1;
  config.time.end_s = 1e-4;
  return config;
}

input::Case one_body() {
  auto config = two_bodies();
  config.base.kind = input::BaseKind::rigid;
  return config;
}

std::string check_error(const input::Case& config) {
  return test::error_of([&] { notes_of_case(make_problem(config)); });
}

TEST(LargePlate, NeedsSeveralProcesses) {
  const auto config = one_body();
  EXPECT_TRUE(can_be_held_in_parts(make_problem(config)));
  const auto one = AllOf(HasSubstr("plate.element_size_m is 0.001 m"), HasSubstr("1e+10 nodes"),
                         HasSubstr("one rank can number; use more ranks"));
  const auto info_error = [&](const auto&... sharing) {
    return test::error_of([&] { info(make_problem(config), sharing...); });
  };
  EXPECT_THAT(check_error(config), one);
  EXPECT_THAT(info_error(), one);
  EXPECT_THAT(info_error(1), one);
  EXPECT_THAT(info_error(2), HasSubstr("at least 5"));
  // A low plate beside a base that is too large.
  auto on_base = two_bodies();
  on_base.plate.height_m = 0.1;
  EXPECT_THAT(check_error(on_base), one);
  // Of others a process has all nodes.
  auto graded = config, rounded = config, tilted = config;
  graded.plate.coarsenings = 1;
  rounded.plate.corner = mesh::Corner::fillet;
  tilted.loading.method = statics::LoadingMethod::direct;
  for (const auto& other : {graded, rounded, tilted}) EXPECT_FALSE(can_be_held_in_parts(make_problem(other)));
}

TEST(LargePlate, InfoCountsItsNodes) {
  const auto info = advice::info(make_problem(two_bodies()), 10000);
  EXPECT_EQ(info.n_nodes, 2 * n_columns * of_column);
  EXPECT_EQ(info.n_cells, 2 * (n_columns - 1) * (of_column - 1));
  EXPECT_EQ(info.n_interface, n_columns);
  ASSERT_TRUE(info.shared);
  EXPECT_EQ(info.shared->partition.n_columns(), n_columns);
  // In a step each node moves once but for those of the two loaded edges.
  const double moved = 2.0 * n_columns * (of_column - 1);
  EXPECT_NEAR(info.node_updates / static_cast<double>(info.n_steps), moved, 1e-3 * moved);
  // Displacements and velocities of all nodes at least, and three checkpoints of them.
  EXPECT_GT(info.memory_bytes, 96.0 * 2 * n_columns * of_column);
  EXPECT_GT(info.needs.checkpoint_bytes, 3 * 32.0 * 2 * n_columns * of_column);
}

TEST(LargePlate, APartAtTheFarEndIsThatOfTheWhole) {
  const auto problem = make_problem(two_bodies());
  const auto meshes = setup::check_interfaces(problem);
  EXPECT_EQ(setup::n_nodes_of(meshes.plate), n_columns * of_column);
  const setup::GlobalBodies whole(problem, meshes.plate, meshes.base);
  const solid::Span columns = {static_cast<int>(n_columns) - 6, static_cast<int>(n_columns)};
  auto part = setup::make_isolated_subdomain(problem, meshes.plate, whole.steps(), columns);
  const auto& body = part.stepper->bodies().back().columns();
  EXPECT_EQ(body.n_nodes(), 6 * of_column);
  EXPECT_EQ(body.global_number(body.n_nodes() - 1), n_columns * of_column - 1);
  EXPECT_EQ(part.plate.x_m.back(), problem.above().plate.width_m);

  // What it keeps goes back to it by its numbers.
  const auto all = mesh::Subset({{columns.begin, columns.end}});
  const auto kept = motion::keep(part.stepper->state(all), 0);
  std::int64_t largest = 0;
  for (const auto& run : kept.runs)
    largest = std::max(largest, run.key + static_cast<std::int64_t>(run.count) - 1);
  EXPECT_EQ(largest, n_columns * of_column - 1);
  std::vector<mesh::NodeColumns> bodies;
  for (const auto& of : whole.bodies()) bodies.emplace_back(mesh::blocks(of.mesh));
  const auto again = kept.in(all, all, bodies, true);
  EXPECT_EQ(again.values, kept.values);
  motion::StateRestorer restorer(part.stepper->state(all));
  restorer.add(again);
  EXPECT_NO_THROW(restorer.finish());
  const auto before = mesh::Subset({{0, columns.begin}});
  EXPECT_TRUE(kept.in(before, before, bodies, true).runs.empty());
}

TEST(LargePlate, ProbesHaveTheNumbersOfTheWhole) {
  auto config = two_bodies();
  config.probes.x_m = {141.4205, 0.0005, 141.421};
  config.probes.y_m = {70.7095, -70.7095, 0};
  const auto meshes = setup::check_interfaces(make_problem(config));
  const auto probes = setup::probes_of(make_problem(config), meshes.plate, meshes.base);
  ASSERT_EQ(probes.size(), 3U);
  const auto corner = (of_column - 2) * n_columns;
  const auto cell_at = [](std::int64_t n) { return std::array{n, n + 1, n + 1 + n_columns, n + n_columns}; };
  EXPECT_EQ(probes[0].node, cell_at(corner + n_columns - 2));
  EXPECT_EQ(probes[1].node, cell_at(corner));
  EXPECT_EQ(probes[1].body, 1U);
  EXPECT_EQ(probes[2].node, cell_at(n_columns - 2));
}

TEST(LargePlate, SnapshotsHaveNumbersOf64Bits) {
  const auto config = two_bodies();
  const auto [slabs, n_plate_cells] = setup::snapshot_mesh_in_rows(make_problem(config), 1000);
  EXPECT_EQ(slabs.n_nodes, 2U * n_columns * of_column);
  EXPECT_EQ(slabs.n_cells, 2U * (n_columns - 1) * (of_column - 1));
  EXPECT_EQ(n_plate_cells, slabs.n_cells / 2);
  // The last of the plate, the first of the base, the last of all.
  const auto look_at = [&, &all = slabs](std::size_t k, std::size_t first_node, std::size_t end_node,
                                         double y_m) {
    all.visit(k, [&](const mesh::Slab& slab) {
      EXPECT_EQ(slab.first_node, first_node);
      EXPECT_EQ(slab.first_node + slab.n_own, end_node);
      EXPECT_EQ(slab.mesh.y_m[slab.n_own - 1], y_m);
    });
  };
  const std::size_t of_plate = n_columns * of_column, n_plate_slabs = slabs.n_slabs / 2;
  look_at(n_plate_slabs - 1, of_plate - 2 * n_columns, of_plate, config.plate.height_m);
  look_at(n_plate_slabs, of_plate, of_plate + n_columns, 0);
  look_at(slabs.n_slabs - 1, 2 * of_plate - 2 * n_columns, 2 * of_plate, -config.plate.height_m);
}

}  // namespace
}  // namespace slipfront::advice
