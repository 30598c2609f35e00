// SPDX-License-Identifier: BSD-3-Clause
#include "run/batch.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <map>
#include <mutex>
#include <vector>

#include "base/interruption.hpp"
#include "run/cases.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

/// Two events of each of two initial states.
std::vector<input::Case> cases() {
  std::vector<input::Case> all;
  for (const double mu_s : {1.2, 1.3})
    for (const double end_s : {30e-6, 40e-6}) {
      auto config = test::coarse_case(interface::EventKind::spontaneous, 5e-3);
      test::law(config).mu_s = mu_s;
      config.time.end_s = end_s;
      all.push_back(config);
    }
  return all;
}

using Outcomes = std::map<std::size_t, std::vector<double>>;

/// Onsets and last energies of the cases that a batch comes to.
Outcomes run_all(Batch& batch) {
  Outcomes outcomes;
  std::mutex mutex;
  batch.run(cases(), [&](std::size_t k, const Result& result, const InitialState&, bool) {
    const std::scoped_lock lock(mutex);
    auto& values = outcomes[k];
    for (const auto& onset : result.event.record.onsets) values.push_back(onset.time_s);
    for (const auto& term : record::energy_terms) values.push_back(result.event.energies.back().*term.member);
  });
  return outcomes;
}

TEST(Batch, ComesToTheSameOnAnyNumberOfThreads) {
  Batch one(
      1, [] { return true; }, "interrupted"),
      several(
          3, [] { return true; }, "interrupted");
  const auto expected = run_all(one);
  ASSERT_EQ(expected.size(), 4U);
  EXPECT_GT(expected.at(1).size(), expected.at(0).size());  // more onsets in more time
  EXPECT_EQ(run_all(several), expected);
}

TEST(Batch, GoesOnWithWhatWasKeptWhenItIsInterrupted) {
  const test::TemporaryFolder folder;
  std::atomic<int> asked = 0;
  Batch interrupted(
      2, [&] { return ++asked < 100; }, "interrupted", folder.path());
  EXPECT_THROW(run_all(interrupted), Interrupted);
  Batch again(
      2, [] { return true; }, "interrupted", folder.path()),
      fresh(
          2, [] { return true; }, "interrupted");
  EXPECT_EQ(run_all(again), run_all(fresh));
  std::size_t n_kept = 0;
  Batch last(
      2, [] { return true; }, "interrupted", folder.path());
  std::mutex mutex;
  last.run(cases(), [&](std::size_t, const Result&, const InitialState&, bool was_kept) {
    const std::scoped_lock lock(mutex);
    n_kept += was_kept ? 1 : 0;
  });
  EXPECT_EQ(n_kept, 4U);
}

}  // namespace
}  // namespace slipfront::run
