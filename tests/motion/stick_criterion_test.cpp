// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/stick_criterion.hpp"

#include <gtest/gtest.h>

namespace slipfront::motion {
namespace {

constexpr double step_s = 1;

/// Of five nodes, of which the three in the middle count.
class FiveNodes : public ::testing::Test {
 protected:
  /// Until which time steps go on, with the changes shown so far.
  double ends_after_s(double slipping_m_per_s = 1e-3) {
    for (std::int64_t step = 0; step < 100; ++step)
      if (!criterion_.after_step({step, step_s}, {.fastest_slipping_m_per_s = slipping_m_per_s}))
        return static_cast<double>(step) * step_s;
    return infinity;
  }
  void show(double time_s, std::vector<SlipChange> changes = {}) {
    SlipUpdate seen;
    seen.time_s = time_s;
    seen.changes = std::move(changes);
    criterion_.at_update(seen);
  }
  static statics::Equilibrium state() {
    statics::Equilibrium state;
    state.tractions.x_m = {0, 1, 2, 3, 4};
    state.contact.resize(5);
    return state;
  }
  StickCriterion criterion_{state(), {1, 3}, 10, 1e-9};
};

TEST_F(FiveNodes, EndsWhereNothingSlips) {
  EXPECT_EQ(ends_after_s(), 11);
}

TEST_F(FiveNodes, WaitsForTheLastNodeWithinTheStretch) {
  show(2, {{1, true, 2, 1}, {2, true, 2, 1}});
  show(3, {{1, false, 3, 1}});
  show(4);
  EXPECT_EQ(ends_after_s(), infinity);
  show(5, {{2, false, 5, 1}});
  EXPECT_EQ(ends_after_s(), 16);
  EXPECT_EQ(criterion_.guaranteed_steps({5, step_s}), 9);
  show(12, {{1, true, 12, 1}});
  show(13, {{1, false, 13, 1}});
  EXPECT_EQ(ends_after_s(), 24);
}

TEST_F(FiveNodes, SlipThatHasFadedCountsAsStuck) {
  show(2, {{1, true, 2, 1}});
  EXPECT_EQ(ends_after_s(0.9e-9), 13);
  EXPECT_EQ(ends_after_s(1.1e-9), infinity);
}

TEST_F(FiveNodes, NodesBesideDoNotCount) {
  show(2, {{0, true, 2, 1}, {4, true, 2, 1}});
  show(20);
  EXPECT_EQ(ends_after_s(), 11);
}

TEST(StickCriterion, WaitsWhereANodeSlipsFasterThanEquilibriaMay) {
  statics::Equilibrium state;
  state.tractions.x_m = {0, 1};
  state.contact.resize(2);
  StickCriterion criterion(state, {0, 1}, 10, 1e-9, 1e-3);
  const auto goes_on = [&](std::int64_t step, double fastest_m_per_s) {
    return criterion.after_step({step, step_s}, {.fastest_in_contact_m_per_s = fastest_m_per_s});
  };
  EXPECT_TRUE(goes_on(12, 2e-3));
  EXPECT_TRUE(goes_on(22, 1e-3));
  EXPECT_FALSE(goes_on(23, 1e-3));
}

}  // namespace
}  // namespace slipfront::motion
