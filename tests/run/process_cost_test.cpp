// SPDX-License-Identifier: BSD-3-Clause
#include "run/process_cost.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "cases.hpp"
#include "run/choices.hpp"

namespace slipfront::run {
namespace {

/// A thousand columns of a thousand nodes, each node updated once in each of a thousand steps.
SharedWork square() {
  SharedWork work;
  work.n_nodes = work.n_cells = 1e6;
  work.n_columns = 1e3;
  work.node_updates_per_step = 1e6;
  work.node_updates_per_s = 1e8;
  work.bytes_per_column = 32e3;
  work.interface_bytes_per_column = 2e3;
  work.interface_share = 0.25;
  work.steps = 1000;
  work.advances = 20;
  work.statics_s = 7;
  work.statics_bytes = 1e9;
  work.bytes_per_interface_node = 1e3;
  work.program_bytes = 1e7;
  return work;
}

/// Parts of equal width.
motion::Division division(int n_columns, int n_parts, int halo, int steps_per_exchange = 1) {
  motion::Division division;
  for (int k = 0; k <= n_parts; ++k) division.first.push_back(n_columns / n_parts * k);
  division.halo = halo;
  division.steps_per_exchange = steps_per_exchange;
  return division;
}

constexpr Network ethernet = {1e-4, 1e8};
/// Nothing but computing takes time.
constexpr Handling at_once = {0, 1e300, 1e300};
constexpr Network immediate = {1e-300, 1e300};

/// Costs foretell which setting is best, no more.
constexpr double coarsely = 0.3;

TEST(ProcessCost, OfOneProcessIsItsComputing) {
  const auto cost = process_cost(square(), division(1000, 1, 10), 1, ethernet);
  EXPECT_DOUBLE_EQ(cost.own_s, 10);  // 1e9 updates
  EXPECT_DOUBLE_EQ(cost.event_s(), 10);
  EXPECT_DOUBLE_EQ(cost.total_s(), 17);
  EXPECT_EQ(cost.bytes_per_step, 0);
}

TEST(ProcessCost, FallsWithProcessesButForTheHaloAndTheStatics) {
  // 250 own columns and 10 on either side, of a part between two others.
  const auto cost = process_cost(square(), division(1000, 4, 10), 4, immediate, at_once);
  EXPECT_NEAR(cost.own_s / (10.0 / 4), 1, coarsely);
  EXPECT_NEAR(cost.halo_s / (10.0 * 20 / 1000), 1, coarsely);
  EXPECT_DOUBLE_EQ(cost.statics_s, 7);
  // On half as many processors.
  const auto shared = process_cost(square(), division(1000, 4, 10), 2, immediate, at_once);
  EXPECT_NEAR(shared.event_s() / cost.event_s(), 2, coarsely);
}

TEST(ProcessCost, OfExchangesIsWhatNoComputingCovers) {
  // Every fifth step 20 columns of 32,000 bytes leave. 270 columns take 2.7 ms a step.
  const auto of = [](const Network& network) {
    return process_cost(square(), division(1000, 4, 10, 5), 4, network, at_once);
  };
  constexpr double steps_s = 5 * 270e-5;
  EXPECT_DOUBLE_EQ(of(ethernet).bytes_per_step, 20 * 32e3 / 5);
  EXPECT_NEAR(of(ethernet).exchange_s, 0, 1e-200);
  const double by_bandwidth = of({1e-4, 1e7}).exchange_s, by_latency = of({2e-2, 1e8}).exchange_s;
  EXPECT_NEAR(by_bandwidth / (200 * (640e3 / 1e7 - steps_s)), 1, coarsely);
  EXPECT_NEAR(by_latency / (200 * (2e-2 - 0.75 * steps_s)), 1, coarsely);
}

TEST(ProcessCost, GrowsWithLatencyAndFallsWithBandwidth) {
  double before_s = 0;
  for (const double latency_s : {1e-7, 1e-2}) {
    const auto cost = process_cost(square(), division(1000, 4, 10), 4, {latency_s, 1e8});
    EXPECT_GT(cost.event_s(), before_s);
    before_s = cost.event_s();
  }
  before_s = 1e300;
  for (const double bytes_per_s : {1e6, 1e9}) {
    const auto cost = process_cost(square(), division(1000, 4, 10), 4, {1e-6, bytes_per_s});
    EXPECT_LT(cost.event_s(), before_s);
    before_s = cost.event_s();
  }
}

TEST(ProcessCost, OfMemoryFallsForAllButTheLeader) {
  const auto of = [](int n) { return process_cost(square(), division(1000, n, 10), n, ethernet); };
  const auto ten = of(10), twenty = of(20);
  EXPECT_LT(twenty.memory_bytes, ten.memory_bytes);
  EXPECT_DOUBLE_EQ(ten.leader_memory_bytes, 1e7 + 1e9);  // the statics
  EXPECT_DOUBLE_EQ(twenty.leader_memory_bytes, 1e7 + 1e9);
}

TEST(ProcessCost, TheStateBeforeIsKeptByThoseWhoFindIt) {
  auto config = test::coarse_case();
  EXPECT_FALSE(keeps_displacements(config, 4));
  config.loading.solver = statics::StaticSolver::petsc;
  EXPECT_TRUE(keeps_displacements(config, 4));
  EXPECT_FALSE(keeps_displacements(config, 1));
  auto free_top = config, ramp = config;
  free_top.loading.top_during_tilt = statics::TopEdge::free;
  EXPECT_FALSE(keeps_displacements(free_top, 4));
  ramp.loading.method = statics::LoadingMethod::ramp;
  EXPECT_FALSE(keeps_displacements(ramp, 4));
}

TEST(ProcessCost, NoProcessHoldsManySquaresWhereAllKeepTheStateBefore) {
  auto config = test::coarse_case();
  config.loading.solver = statics::StaticSolver::petsc;
  EXPECT_FALSE(leads_by_interface(config, 4));  // few nodes
  config.plate.element_size_m = 0.1e-3;
  ASSERT_EQ(config.plate.corner, mesh::Corner::relief);
  EXPECT_TRUE(leads_by_interface(config, 4));
  EXPECT_FALSE(leads_by_interface(config, 1));
  EXPECT_FALSE(leads_by_interface(config, 4, false));
  auto deep = config, fillet = config, graded = config, stretched = config;
  stretched.plate.width_m *= 1 + 2e-9;
  EXPECT_FALSE(leads_by_interface(stretched, 4));
  stretched.plate.width_m = config.plate.width_m * (1 + 1e-11);
  EXPECT_TRUE(leads_by_interface(stretched, 4));
  deep.plate.relief_depth_m = deep.plate.height_m;
  EXPECT_FALSE(leads_by_interface(deep, 4));
  fillet.plate.corner = mesh::Corner::fillet;
  EXPECT_FALSE(leads_by_interface(fillet, 4));
  graded.plate.coarsenings = 1;
  EXPECT_FALSE(leads_by_interface(graded, 4));
}

TEST(ProcessCost, FollowsFromACase) {
  auto config = test::coarse_case(interface::EventKind::left, 0.5e-3);
  config.time.interface_substeps = 1;
  config.time.interface_rows = 1;
  const auto info = run::info(config, Sharing{4, 4, ethernet});
  ASSERT_TRUE(info.shared);
  const auto& [division, cost] = *info.shared;
  EXPECT_EQ(division.n_parts(), 4);
  EXPECT_LT(cost.memory_bytes, cost.leader_memory_bytes);
  EXPECT_FALSE(run::info(config).shared);
  EXPECT_THROW(run::info(config, Sharing{1000, 4, ethernet}), UserError);
}

}  // namespace
}  // namespace slipfront::run
