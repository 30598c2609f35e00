// SPDX-License-Identifier: BSD-3-Clause
// The loop by observers that note how they are called.
#include "motion/observed_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "motion/observers/end_time.hpp"
#include "motion/support.hpp"
#include "support/state.hpp"

namespace slipfront::motion {
namespace {

using ::testing::ElementsAre;

using support::mu_s;

/// Notes calls by its letter, pauses at an interval of steps, and may end the run or stop a sweep.
class Noting final : public Observer {
 public:
  struct Plan {
    std::int64_t interval = many_steps, refused_step = -1, end_step = -1, row_step = -1;
    bool has_state = false;
  };
  Noting(std::string letter, std::vector<std::string>& notes, Plan plan)
      : letter_(std::move(letter)), notes_(&notes), plan_(plan) {}

  bool wants_row(const Now& now) const override { return now.step == plan_.row_step; }
  void take_row(const record::History& row) override {
    EXPECT_EQ(row.t_Pa.size(), row.x_m.size());
    note("row", std::lround(row.time_s.front() / step_s_));
  }
  bool after_step(const Now& now, const SlipRates& /*rates*/) override {
    note("step", now.step);
    return now.step != plan_.refused_step;
  }
  std::int64_t steps_to_pause(const Now& now) const override {
    return plan_.interval - now.step % plan_.interval;
  }
  void expect(const Now& now, std::int64_t n) override {
    step_s_ = now.step_s;
    note("expects", n);
  }
  void at_pause(Pause& pause) override { note("pause", pause.now().step); }
  std::optional<End> end(Pause& pause) override {
    if (pause.now().step != plan_.end_step) return {};
    return End{EventEnd::observer, letter_};
  }
  void at_end(Pause& pause) override { note("end", pause.now().step); }
  const char* name() const override { return plan_.has_state ? letter_.c_str() : nullptr; }
  void archive(StateArchive& archive) override { archive(plan_.end_step); }
  void restored(Pause& pause) override { note("restored", pause.now().step); }

 private:
  void note(const std::string& what, std::int64_t number) {
    notes_->push_back(letter_ + " " + what + " " + std::to_string(number));
  }
  std::string letter_;
  std::vector<std::string>* notes_;
  Plan plan_;
  double step_s_ = 0;
};

class Loop : public ::testing::Test {
 protected:
  mesh::Mesh mesh_ = support::tiny_plate(mesh::Corner::none);
  solid::Material material_;
  statics::Statics statics_{mesh_, material_, support::tilted, mu_s};
  statics::Equilibrium state_ = statics_.shear_to(0.5);
  Stepper stepper_{mesh_, material_, support::paper_law, {}};
  std::vector<std::string> notes_;

  ObservedRun run_of(const std::vector<std::pair<std::string, Noting::Plan>>& plans) {
    Observers list;
    for (const auto& [letter, plan] : plans) list.push_back(std::make_unique<Noting>(letter, notes_, plan));
    return {stepper_, {state_, mu_s, 0, 0}, state_.tractions.x_m, std::move(list)};
  }
  void SetUp() override { stepper_.start(state_, 0); }
};

TEST_F(Loop, CallsEachInItsPlace) {
  auto run = run_of(
      {{"a", {.interval = 2, .end_step = 3}}, {"b", {.refused_step = 3, .end_step = 3, .row_step = 1}}});
  const End end = run.run();
  EXPECT_EQ(end.why, EventEnd::observer);
  EXPECT_EQ(end.reason, "a");  // the first in the list
  EXPECT_EQ(stepper_.step(), 3);
  EXPECT_THAT(notes_, ElementsAre("a pause 0", "b pause 0", "a expects 2", "b expects 2",  //
                                  "a step 1", "b step 1", "b row 1", "a step 2", "b step 2", "a pause 2",
                                  "b pause 2", "a expects 2", "b expects 2",  //
                                  "a step 3", "b step 3", "a pause 3", "b pause 3", "a end 3", "b end 3"));
}

TEST_F(Loop, AnObserverThatEndsItAtOnceLetsNoStepPass) {
  auto run = run_of({{"a", {.end_step = 0}}});
  run.run();
  EXPECT_EQ(stepper_.step(), 0);
  EXPECT_THAT(notes_, ElementsAre("a pause 0", "a end 0"));
}

TEST_F(Loop, KeepsTheStateOfThoseThatHaveOne) {
  const Noting::Plan kept{.interval = 1, .end_step = 7, .has_state = true};
  const Noting::Plan other{.interval = 1, .has_state = true};
  auto run = run_of({{"a", kept}, {"b", {}}});
  auto restored = run_of({{"b", {}}, {"a", other}, {"c", {}}});
  test::copy_state(run, restored);
  restored.require_restored();
  EXPECT_THAT(notes_, ElementsAre("b restored 0", "a restored 0", "c restored 0"));
  notes_.clear();
  restored.run();
  EXPECT_EQ(stepper_.step(), 7);

  using Plans = std::vector<std::pair<std::string, Noting::Plan>>;
  for (const auto& plans : {Plans{}, {{"c", kept}}, {{"a", kept}, {"b", kept}}}) {
    auto of_others = run_of(plans);
    EXPECT_THROW(test::copy_state(run, of_others), StateError);
  }
}

TEST(Every, IsDueAtTheFirstStepAtOrAfterEachMultiple) {
  // Also where multiples are rounded, and not more often than each step.
  for (const double step_s : {1e-7, 0.1, 1.0 / 3})
    for (const double in_steps : {1e-3, 1.0, 2.0, 3.7, 10.0, 100.0 / 3}) {
      const double interval_s = in_steps * step_s;
      const Every every(interval_s);
      std::int64_t next = 0;
      for (std::int64_t step = 0; step < 2000; ++step) {
        const Now now{step, step_s};
        const bool is_due = now.time_s() >= static_cast<double>(next) * std::max(interval_s, step_s);
        EXPECT_EQ(every.is_due(now), is_due) << step_s << " " << in_steps << " " << step;
        if (is_due) ++next;
        EXPECT_TRUE(every.is_due({step + every.steps_to_next(now), step_s}));
        for (std::int64_t k = 1; k < every.steps_to_next(now); ++k)
          EXPECT_FALSE(every.is_due({step + k, step_s}));
      }
    }
}

}  // namespace
}  // namespace slipfront::motion
