// SPDX-License-Identifier: BSD-3-Clause
#include "run/process_cost.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

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
  EXPECT_DOUBLE_EQ(cost.own_s, 10.0 / 4);
  EXPECT_DOUBLE_EQ(cost.halo_s, 10.0 * 20 / 1000);
  EXPECT_NEAR(cost.event_s(), 10.0 * 270 / 1000, 1e-12);
  EXPECT_DOUBLE_EQ(cost.statics_s, 7);
}

TEST(ProcessCost, OfTwoHasAHaloOnOneSide) {
  const auto cost = process_cost(square(), division(1000, 2, 10), 2, immediate, at_once);
  EXPECT_DOUBLE_EQ(cost.halo_s, 10.0 * 10 / 1000);
  EXPECT_DOUBLE_EQ(cost.bytes_per_step, 10 * 4e3 * 8);
}

TEST(ProcessCost, OfExchangesIsWhatNoComputingCovers) {
  // Every fifth step 20 columns of 32,000 bytes leave. 270 columns take 2.7 ms a step.
  const auto of = [](const Network& network) {
    return process_cost(square(), division(1000, 4, 10, 5), 4, network, at_once);
  };
  constexpr double steps_s = 5 * 270e-5;
  EXPECT_DOUBLE_EQ(of(ethernet).bytes_per_step, 20 * 32e3 / 5);
  EXPECT_NEAR(of(ethernet).exchange_s, 0, 1e-200);
  // Bandwidth alone: what the network carries takes longer than the steps.
  EXPECT_NEAR(of({1e-4, 1e7}).exchange_s, 200 * (640e3 / 1e7 - steps_s), 1e-12);
  // Latency: the interface leaves after a quarter of the steps' time, in messages of 20,000 bytes.
  EXPECT_NEAR(of({2e-2, 1e8}).exchange_s, 200 * (2e-2 + 40e3 / 1e8 - 0.75 * steps_s), 1e-12);
  const auto packed = process_cost(square(), division(1000, 4, 10, 5), 4, ethernet, {0, 1e300, 1e9});
  EXPECT_NEAR(packed.exchange_s, 200 * 2 * 640e3 / 1e9, 1e-12);
  // A byte on its way takes a nanosecond from the computing, of two processors that four processes share two.
  EXPECT_NEAR(of({1e-4, 1e8, 1e-9}).exchange_s, 200 * 2 * 640e-6, 1e-12);
  const auto shared = process_cost(square(), division(1000, 4, 10, 5), 2, {1e-4, 1e8, 1e-9}, at_once);
  EXPECT_NEAR(shared.exchange_s, 200 * 2 * 2 * 640e-6, 1e-12);
}

TEST(ProcessCost, OfExchangesDoesNotDependOnCommands) {
  // 1000 steps, 50 with each command: 62 times 16, and 8 more.
  const auto cost = process_cost(square(), division(1000, 2, 1, 16), 2, {1, 1e300}, at_once);
  EXPECT_NEAR(cost.exchange_s, 62 * (1 - 0.75 * 16 * 501e-5), 1e-9);
  EXPECT_DOUBLE_EQ(cost.bytes_per_step, 62 * 32e3 / 1000);
}

TEST(ProcessCost, OfEnergiesIsThatOfSteps) {
  auto work = square();
  work.energies = 10;
  const auto cost = process_cost(work, division(1000, 4, 10), 4, ethernet, at_once);
  EXPECT_DOUBLE_EQ(cost.own_s, 2.5 * 1.01);
  EXPECT_DOUBLE_EQ(cost.command_s, 30 * 2 * 2 * 1e-4);
}

TEST(ProcessCost, OfProcessorsThatAreSharedIsThatOfFewer) {
  const auto own = process_cost(square(), division(1000, 4, 10), 4, ethernet);
  const auto shared = process_cost(square(), division(1000, 4, 10), 2, ethernet);
  EXPECT_DOUBLE_EQ(shared.own_s, 2 * own.own_s);
  EXPECT_DOUBLE_EQ(shared.halo_s, 2 * own.halo_s);
  const auto more = process_cost(square(), division(1000, 4, 10), 100, ethernet);
  EXPECT_DOUBLE_EQ(more.own_s, own.own_s);
}

TEST(ProcessCost, GrowsWithLatencyAndFallsWithBandwidth) {
  double before_s = 0;
  for (const double latency_s : {1e-7, 1e-6, 1e-4, 1e-2}) {
    const auto cost = process_cost(square(), division(1000, 4, 10), 4, {latency_s, 1e8});
    EXPECT_GT(cost.event_s(), before_s);
    before_s = cost.event_s();
  }
  before_s = 1e300;
  for (const double bytes_per_s : {1e6, 1e7, 1e8, 1e9}) {
    const auto cost = process_cost(square(), division(1000, 4, 10), 4, {1e-6, bytes_per_s});
    EXPECT_LT(cost.event_s(), before_s);
    before_s = cost.event_s();
  }
}

TEST(ProcessCost, OfCommandsGrowsWithTheLevelsOfTheTree) {
  const Handling handling = {2e-6, 1e300, 1e300};
  constexpr std::array<std::pair<int, int>, 5> levels_of = {{{1, 0}, {2, 1}, {8, 3}, {10, 4}, {100, 7}}};
  for (const auto& [n_parts, levels] : levels_of) {
    const auto cost = process_cost(square(), division(1000, n_parts, 10), n_parts, {1e-4, 1e300}, handling);
    EXPECT_DOUBLE_EQ(cost.command_s, 20 * 2 * levels * (1e-4 + 2e-6)) << n_parts;
  }
}

TEST(ProcessCost, OfSamplesAndSnapshotsIsPackedSentAndJoined) {
  auto work = square();
  const Handling handling = {0, 1e9, 1e300};
  const auto none = process_cost(work, division(1000, 4, 10), 4, ethernet, handling);
  const double known = 20 * 25 * 1e3;  // of the last update of each command
  EXPECT_NEAR(none.gathering_s, 0.75 * known / 1e8 + 1.75 * known / 1e9, 1e-12);
  work.history_rows = 100;
  work.values_per_row = 4e3;
  const auto rows = process_cost(work, division(1000, 4, 10), 4, ethernet, handling);
  const double bytes = 100 * 4e3 * 8;
  EXPECT_NEAR(rows.gathering_s - none.gathering_s, 0.75 * bytes / 1e8 + 1.75 * bytes / 1e9, 1e-12);
  const auto alone = process_cost(work, division(1000, 1, 10), 1, ethernet, handling);
  EXPECT_NEAR(alone.gathering_s, bytes / 1e9, 1e-12);
  work.snapshots = 3;
  const auto both = process_cost(work, division(1000, 4, 10), 4, ethernet, handling);
  const double more = 3 * 32e6;
  EXPECT_NEAR(both.gathering_s - rows.gathering_s, 0.75 * more / 1e8 + 1.25 * more / 1e9, 1e-9);
}

TEST(ProcessCost, OfSnapshotsCountsTheMessagesForTheirPieces) {
  auto work = square();
  const auto none = process_cost(work, division(1000, 100, 2), 100, ethernet, {2e-6, 1e9, 1e9});
  work.snapshots = 3;
  const auto some = process_cost(work, division(1000, 100, 2), 100, ethernet, {2e-6, 1e9, 1e9});
  // Of a million nodes each of four components in two pieces.
  EXPECT_NEAR(some.command_s - none.command_s, 3 * 8 * 2 * (1e-4 + 99 * 2e-6), 1e-12);
}

TEST(ProcessCost, OfLargeAnswersIsARoundTripOnEachLevel) {
  const auto small = process_cost(square(), division(1000, 4, 10), 4, ethernet);
  const auto with_rows = [](double n) {
    auto work = square();
    work.values_per_row = 4e3;
    work.history_rows = n;
    return process_cost(work, division(1000, 4, 10), 4, ethernet);
  };
  // 46,250 bytes of a part and 92,500 of two.
  EXPECT_NEAR(with_rows(100).command_s - small.command_s, 20 * 2e-4, 1e-12);
  EXPECT_NEAR(with_rows(1000).command_s - small.command_s, 20 * 2 * 2e-4, 1e-12);
}

TEST(ProcessCost, OfMemoryFallsForAllButTheLeader) {
  const auto of = [](int n) { return process_cost(square(), division(1000, n, 10), n, ethernet); };
  const auto ten = of(10), twenty = of(20);
  // 120 columns and 70, and on each side three messages as large as the halo.
  const double rest = 1e7 + 3 * 2 * 10 * 32e3;
  EXPECT_NEAR((ten.memory_bytes - rest) / (twenty.memory_bytes - rest), 120.0 / 70, 1e-9);
  EXPECT_DOUBLE_EQ(ten.leader_memory_bytes, 1e7 + 1e9);  // the statics
  EXPECT_DOUBLE_EQ(twenty.leader_memory_bytes, 1e7 + 1e9);
}

TEST(ProcessCost, OfTheLeadersMemoryFallsWhereAllKeepTheStateBefore) {
  auto work = square();
  work.statics_bytes = 0;
  const auto of_leader = [&] {
    return process_cost(work, division(1000, 4, 10), 4, ethernet).leader_memory_bytes;
  };
  const double gathered = of_leader();
  work.keeps_displacements = true;
  EXPECT_NEAR(gathered - of_leader(), 4 * sizeof(double) * work.n_nodes, 1);
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
  // Passed on by the leader nevertheless.
  auto work = square();
  work.statics_bytes = 0;
  work.keeps_displacements = true;
  const auto held = process_cost(work, division(1000, 4, 10), 4, ethernet);
  work.leads_by_interface = true;
  work.corner_bytes = 1e6;
  const auto cost = process_cost(work, division(1000, 4, 10), 4, ethernet);
  EXPECT_EQ(cost.start_s, held.start_s);
  EXPECT_LT(cost.leader_memory_bytes, held.leader_memory_bytes);
}

TEST(ProcessCost, FollowsFromACase) {
  auto config = test::coarse_case(interface::EventKind::left, 0.5e-3);
  config.time.interface_substeps = 1;
  config.time.interface_rows = 1;
  const auto info = run::info(config, Sharing{4, 4, ethernet});
  ASSERT_TRUE(info.shared);
  const auto& [division, cost] = *info.shared;
  EXPECT_EQ(division.n_parts(), 4);
  // u and v of the node in each row, and of its interface node what the contact keeps.
  const double rows = static_cast<double>(info.n_nodes) / static_cast<double>(info.n_interface);
  const double values =
      cost.bytes_per_step * division.steps_per_exchange / (2 * division.halo) / sizeof(double);
  EXPECT_GE(values, 4 * rows);
  EXPECT_LT(values, 1.5 * (4 * rows + 40));
  // A quarter; the rate is measured once more, in fewer steps at once, beside whatever the machine does.
  const double alone_s = info.node_updates / info.node_updates_per_s;
  EXPECT_GT(cost.own_s, 0.1 * alone_s);
  EXPECT_LT(cost.own_s, 0.6 * alone_s);
  EXPECT_LT(cost.memory_bytes, cost.leader_memory_bytes);
  EXPECT_FALSE(run::info(config).shared);
  EXPECT_THROW(run::info(config, Sharing{1000, 4, ethernet}), UserError);
}

}  // namespace
}  // namespace slipfront::run
