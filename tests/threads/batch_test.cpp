// SPDX-License-Identifier: BSD-3-Clause
#include "run/batch.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <map>
#include <mutex>
#include <vector>

#include "base/error.hpp"
#include "run/cases.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

/// Two events of each of two initial states.
std::vector<Problem> cases() {
  std::vector<Problem> all;
  for (const double mu_s : {1.2, 1.3})
    for (const double end_s : {30e-6, 40e-6}) {
      auto config = test::coarse_case(interface::EventKind::spontaneous, 5e-3);
      test::law(config).mu_s = mu_s;
      config.time.end_s = end_s;
      all.push_back(problem::make_problem(config));
    }
  return all;
}

using Outcomes = std::map<std::size_t, std::vector<double>>;

/// Onsets and last energies of the cases that a batch comes to.
/// @param n_kept  raised by those that were done before
Outcomes run_all(Batch& batch, std::atomic<int>* n_kept = nullptr) {
  Outcomes outcomes;
  std::mutex mutex;
  batch.run(cases(), [&](std::size_t k, const Result& result, const InitialState&, bool was_kept) {
    const std::scoped_lock lock(mutex);
    if (was_kept && n_kept != nullptr) ++*n_kept;
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
  const auto go_on = [] { return true; };
  std::atomic<bool> is_wanted = true;
  std::atomic<int> n_done = 0, n_kept = 0;
  const auto stop_after_one = [&](std::size_t, const Result&, const InitialState&, bool) {
    ++n_done;
    is_wanted = false;
  };
  Batch interrupted(
      1, [&] { return is_wanted.load(); }, "interrupted", folder.path());
  EXPECT_THROW(interrupted.run(cases(), stop_after_one), Interrupted);
  EXPECT_EQ(n_done, 1);
  Batch again(2, go_on, "interrupted", folder.path()), fresh(2, go_on, "interrupted");
  EXPECT_EQ(run_all(again, &n_kept), run_all(fresh));
  EXPECT_EQ(n_kept, 1);
}

}  // namespace
}  // namespace slipfront::run
