// SPDX-License-Identifier: BSD-3-Clause
// Observers of one's own in the event of a case: the example's, and one with a state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "cases.hpp"
#include "examples/downstream/slip_limit.hpp"
#include "motion/observers/interval_observer.hpp"
#include "sessions.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

using problem::make_problem;
using test::coarse_case;
using ::testing::HasSubstr;

motion::Observers list_of(std::unique_ptr<motion::Observer> observer) {
  motion::Observers list;
  list.push_back(std::move(observer));
  return list;
}

TEST(Observers, TheExampleEndsAnEventAtASlip) {
  const auto config = coarse_case();
  const auto initial = setup::make_initial_state(make_problem(config), test::go_on);
  const auto whole = run_from(make_problem(config), initial, test::go_on);
  const auto slip_m = test::history_of(whole).slip_m;
  const double limit_m = 0.5 * *std::ranges::max_element(slip_m);
  const auto result =
      run_from(make_problem(config), initial, test::go_on, {},
               list_of(std::make_unique<SlipLimit>(limit_m, config.output.history_interval_s)));
  EXPECT_EQ(result.event.end, motion::EventEnd::observer);
  EXPECT_THAT(end_of_event(result), HasSubstr("slip has reached"));
  // Up to there it is the same event: the last row of the history is the one that was looked at.
  const auto cut = test::history_of(result);
  const auto n_nodes = static_cast<std::ptrdiff_t>(cut.x_m.size());
  ASSERT_LT(cut.slip_m.size(), slip_m.size());
  EXPECT_TRUE(std::equal(cut.slip_m.begin(), cut.slip_m.end(), slip_m.begin()));
  EXPECT_GE(*std::max_element(cut.slip_m.end() - n_nodes, cut.slip_m.end()), limit_m);
  EXPECT_LT(*std::max_element(cut.slip_m.begin(), cut.slip_m.end() - n_nodes), limit_m);
}

/// Counts steps and looks, for a test to read, and keeps the counts.
class Counter final : public motion::IntervalObserver {
 public:
  struct Seen {
    std::int64_t steps = 0, updates = 0, ends = 0;
    std::vector<double> time_s;
  };
  explicit Counter(Seen& seen) : IntervalObserver(10e-6), seen_(seen) { seen_ = {}; }

  void at_update(const motion::SlipUpdate& seen) override {
    EXPECT_GT(seen.time_s, last_update_s_);
    last_update_s_ = seen.time_s;
    ++seen_.updates;
  }
  bool after_step(const motion::Now& now, const motion::SlipRates& rates) override {
    EXPECT_EQ(now.step, ++seen_.steps);
    EXPECT_TRUE(rates.finite);
    return true;
  }
  std::string look(record::History& row, const motion::Now& now, motion::Pause& pause) override {
    EXPECT_EQ(row.time_s, std::vector{now.time_s()});
    EXPECT_EQ(now.step + 1, pause.stepper().step());
    EXPECT_EQ(row.slip_m.size(), row.x_m.size());
    seen_.time_s.push_back(now.time_s());
    return {};
  }
  void at_end(motion::Pause& /*pause*/) override { ++seen_.ends; }
  const char* name() const override { return "counter"; }
  void archive(StateArchive& archive) override { archive(seen_.steps, seen_.updates, seen_.time_s); }

 private:
  Seen& seen_;
  double last_update_s_ = -1;
};

TEST(Observers, SeeAllOfARunThatStoppedAndChangeNothing) {
  auto config = coarse_case(interface::EventKind::left);
  config.time.quiet_s = 1;
  const auto run = [&](const std::filesystem::path& dir, const SessionHooks& hooks, bool goes_on,
                       const std::function<motion::Observers()>& observers) {
    results::ResultFolder folder(dir, run_work);
    auto options = test::with_threads(2);
    options.observers = observers;
    return goes_on ? resume(folder, nullptr, options, hooks)
                   : run_into(folder, make_problem(config), options, hooks);
  };
  const test::TemporaryFolder plain, observed;
  const auto expected = run(plain.path(), test::undisturbed, false, {});
  Counter::Seen seen;
  const auto observers = [&] { return list_of(std::make_unique<Counter>(seen)); };
  run(observed.path(), test::stopping_at("event", 50), false, observers);
  EXPECT_EQ(seen.ends, 1);
  EXPECT_EQ(seen.steps, 50);
  const auto result = run(observed.path(), test::undisturbed, true, observers);
  EXPECT_EQ(seen.ends, 1);  // of the second session
  EXPECT_EQ(seen.steps, expected.last.result.event.steps);
  EXPECT_EQ(seen.updates, seen.steps * config.time.interface_substeps);
  const double last_begins_s = expected.last.result.event.time_s - expected.last.result.step_s;
  ASSERT_EQ(std::ssize(seen.time_s), static_cast<std::ptrdiff_t>(last_begins_s / 10e-6) + 1);
  for (std::size_t k = 0; k < seen.time_s.size(); ++k) {
    EXPECT_GE(seen.time_s[k], 10e-6 * static_cast<double>(k));
    EXPECT_LT(seen.time_s[k], 10e-6 * static_cast<double>(k) + result.last.result.step_s);
  }
  for (const char* file : {"interface.h5", "fronts.csv", "fracture.csv", "energy.csv"})
    EXPECT_EQ(test::read_file(plain / file), test::read_file(observed / file)) << file;
}

TEST(Observers, ACheckpointIsOfTheObserversThatKeptIt) {
  const auto config = coarse_case();
  const test::TemporaryFolder dir;
  Counter::Seen seen;
  SessionOptions options;
  options.observers = [&] { return list_of(std::make_unique<Counter>(seen)); };
  const auto hooks = test::stopping_at("event", 50);
  results::ResultFolder folder(dir.path(), run_work);
  run_into(folder, make_problem(config), options, hooks);
  options.observers = {};
  EXPECT_THAT(test::error_of([&] { resume(folder, nullptr, options, hooks); }),
              HasSubstr("has observers of"));
}

}  // namespace
}  // namespace slipfront::run
