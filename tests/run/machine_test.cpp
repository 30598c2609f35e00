// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases.hpp"
#include "run/choices.hpp"
#include "run/sequence.hpp"
#include "run/sequence_session.hpp"
#include "sessions.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

namespace fs = std::filesystem;
using record::LoadingPhase;
using test::stopping_at;

/// A block that a soft pusher moves under a dead load.
input::Case pushed_block(int max_events) {
  auto config = test::coarse_case();
  config.sequence.max_events = max_events;
  config.loading.shear_speed_over_c_L = 1e-9;
  config.loading.mean_pressure_Pa = 5e6;
  config.time.quiet_s = 0.45e-3;
  config.time.end_s = 11e-3;
  test::law(config).mu_s = 0.7;
  test::law(config).mu_k = 0.5;
  config.plate.corner = mesh::Corner::none;
  config.machine = {2e9, 0, {8e-3, 16e-3}};
  return config;
}

void run_all(Sequence& sequence, const input::Case& config) {
  while (sequence.end().empty()) sequence.record_event(run_from(config, *sequence.next(), test::go_on));
}

double largest_term(const std::vector<record::LoadingRow>& rows) {
  double largest = 0;
  for (const auto& row : rows)
    for (const auto& term : record::energy_terms)
      largest = std::max(largest, std::abs(row.energies.*term.member));
  return largest;
}

TEST(SequenceOnAMachine, UnderADeadLoadKeepsItsNormalForceAndItsBooks) {
  for (const int substeps : {1, 6}) {
    auto config = pushed_block(6);
    config.time.interface_substeps = substeps;
    Sequence sequence(config, test::go_on);
    run_all(sequence, config);
    const auto& rows = sequence.loading();
    ASSERT_EQ(rows.size(), 1 + 3 * 6U);
    const double normal = rows.front().normal_force_N_per_m, largest = largest_term(rows);
    EXPECT_NEAR(normal, 5e6 * config.plate.width_m, 1e-9 * normal);
    for (const auto& row : rows) {
      EXPECT_LT(std::abs(imbalance_J_per_m(row, rows.front())), 1e-11 * largest);
      if (row.phase == LoadingPhase::slip_ends) continue;  // waves
      EXPECT_NEAR(row.normal_force_N_per_m, normal, 1e-10 * normal);
      if (row.phase == LoadingPhase::tilted) continue;
      EXPECT_TRUE(row.shear_height_m > 8e-3 && row.shear_height_m < 16e-3);
      EXPECT_NEAR(row.pressure_moment_N - rows.front().pressure_moment_N,
                  row.shear_force_N_per_m * row.shear_height_m, 1e-10 * normal * config.plate.width_m);
    }
    for (std::size_t k = 3; k < rows.size(); k += 3) {
      ASSERT_EQ(rows[k].phase, LoadingPhase::at_rest);
      if (substeps == 1) {
        EXPECT_GT(rows[k].wave_loss_J_per_m, rows[k - 1].wave_loss_J_per_m);
      }
      EXPECT_LT(rows[k].energies.machine, rows[k - 2].energies.machine);  // the spring shortens in an event
    }
    // All of the shear force comes through the spring.
    EXPECT_GT(rows.back().energies.machine, 0.1 * std::pow(rows.back().shear_force_N_per_m, 2) / (2 * 2e9));
  }
}

TEST(SequenceOnAMachine, OfATopEdgeKeepsItsBooks) {
  auto config = pushed_block(4);
  config.machine = {1e10, 2e10};
  Sequence sequence(config, test::go_on);
  run_all(sequence, config);
  const auto& rows = sequence.loading();
  for (const auto& row : rows)
    EXPECT_LT(std::abs(imbalance_J_per_m(row, rows.front())), 1e-11 * largest_term(rows));
  const auto& last = rows.back();
  EXPECT_NE(last.normal_force_N_per_m, rows.front().normal_force_N_per_m);
}

TEST(SequenceOnAMachine, IsTheSameWhereverItWasStopped) {
  const test::TemporaryFolder folder;
  const auto config = pushed_block(2);
  SessionOptions options;
  options.threads = 1;
  const auto start = [&](const fs::path& dir, const SessionHooks& hooks) {
    results::ResultFolder place(dir, run_work);
    run_sequence_into(place, config, options, hooks, [](std::size_t, const record::SequenceEvent&) {});
  };
  start(folder / "whole", test::undisturbed);
  for (const auto& [part, step] : {std::pair{"event 1", 100}, {"event 2", 150}}) {
    const auto dir = folder / part;
    EXPECT_THROW(start(dir, stopping_at(part, step)), Interrupted);
    {
      results::ResultFolder place(dir, run_work);
      resume_sequence(place, nullptr, options, test::undisturbed,
                      [](std::size_t, const record::SequenceEvent&) {});
    }
    for (const char* file :
         {"loading.csv", "events.csv", "events/0001/energy.csv", "events/0002/interface.h5"})
      EXPECT_EQ(test::read_file(dir / file), test::read_file(folder / "whole" / file)) << part << ' ' << file;
  }
}

}  // namespace
}  // namespace slipfront::run
