// SPDX-License-Identifier: BSD-3-Clause
#include "solve/recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slipfront::solve {
namespace {

constexpr double mu_s = 0.5;
constexpr std::size_t n_nodes = 5;

/// Five nodes 1 mm apart under p = 4 Pa, each at t/p = 0.25, half of mu_s.
Equilibrium at_rest() {
  Equilibrium e;
  for (std::size_t k = 0; k < n_nodes; ++k) e.tractions.x_m.push_back(1e-3 * static_cast<double>(k));
  e.tractions.t_s_Pa.assign(n_nodes, 1.0);
  e.tractions.p_s_Pa.assign(n_nodes, 4.0);
  e.contact.assign(n_nodes, Contact::stick);
  return e;
}

interface::Interface unchanged() {
  interface::Interface s(n_nodes);
  s.t_Pa.assign(n_nodes, 1.0);
  s.p_Pa.assign(n_nodes, 4.0);
  s.demand_Pa.assign(n_nodes, 1.0);
  s.strength_Pa.assign(n_nodes, mu_s * 4.0);
  return s;
}

void set(interface::Interface& s, std::size_t node, double demand, double t, double p, bool slips) {
  s.demand_Pa[node] = demand;
  s.t_Pa[node] = t;
  s.p_Pa[node] = p;
  s.strength_Pa[node] = mu_s * p;
  s.slipping[node] = slips;
}

TEST(Recorder, LocatesTheOnsetInsideTheStep) {
  Recorder recorder(at_rest(), mu_s, 1);
  recorder.observe(0, unchanged(), false);
  recorder.observe(1, unchanged(), false);
  auto s = unchanged();
  // |t| / (mu_s p) goes from 0.5 to 2.5: through 1 after a quarter of the step from 1 s to 3 s.
  set(s, 2, 2.5 * mu_s * 8, 0.3 * 8, 8, true);
  set(s, 1, 3, 3, 12, false);
  set(s, 3, 1.8, 1.8, 3.6, false);
  recorder.observe(3, s, true);
  const auto record = recorder.take(4);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_EQ(record.onsets[0].node, 2);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 1.5);
  EXPECT_EQ(record.end_time_s, 4);
  EXPECT_EQ(record.x_m, at_rest().tractions.x_m);
  // Tractions interpolated to that time; at the node itself the strength mu_s p, not the weakened traction.
  EXPECT_EQ(record.halo, 1);
  const auto around = record.around_onset(0);
  ASSERT_EQ(around.size(), 3);
  EXPECT_DOUBLE_EQ(around[0].t_Pa, 1.5);
  EXPECT_DOUBLE_EQ(around[0].p_Pa, 6);
  EXPECT_DOUBLE_EQ(around[1].t_Pa, mu_s * 5);
  EXPECT_DOUBLE_EQ(around[1].p_Pa, 5);
  EXPECT_DOUBLE_EQ(around[2].t_Pa, 1.2);
  EXPECT_DOUBLE_EQ(around[2].p_Pa, 3.9);
}

TEST(Recorder, KeepsTheSignOfTheTraction) {
  Recorder recorder(at_rest(), mu_s, 0);
  recorder.observe(0, unchanged(), false);
  auto s = unchanged();
  set(s, 2, 6, -2, 4, true);
  recorder.observe(1, s, true);
  EXPECT_DOUBLE_EQ(recorder.take(1).around_onset(0)[0].t_Pa, -mu_s * 4);
}

TEST(Recorder, HasNoTractionsBeyondTheEnds) {
  Recorder recorder(at_rest(), mu_s, 2);
  recorder.observe(0, unchanged(), false);
  auto s = unchanged();
  set(s, 1, 4, 2, 4, true);
  set(s, 4, 6, 2, 4, true);
  recorder.observe(1, s, true);
  const auto record = recorder.take(1);
  ASSERT_EQ(record.onsets.size(), 2);
  ASSERT_EQ(record.around.size(), 10);
  // The node at the right end passes its strength first (ratio to 3, against 2).
  EXPECT_EQ(record.onsets[0].node, 4);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 0.2);
  EXPECT_EQ(record.onsets[1].node, 1);
  EXPECT_DOUBLE_EQ(record.onsets[1].time_s, 1.0 / 3);
  const auto at_end = record.around_onset(0), near_start = record.around_onset(1);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(std::isnan(at_end[k].t_Pa), k > 2) << k;
    EXPECT_EQ(std::isnan(at_end[k].p_Pa), k > 2) << k;
    EXPECT_EQ(std::isnan(near_start[k].t_Pa), k < 1) << k;
  }
  // The halo went with its onset when they were put in order: both nodes slip at 2 of 4 Pa.
  EXPECT_DOUBLE_EQ(at_end[2].t_Pa, mu_s * 4);
  EXPECT_DOUBLE_EQ(near_start[2].t_Pa, mu_s * 4);
  EXPECT_DOUBLE_EQ(at_end[1].t_Pa, 1);
}

TEST(Recorder, ANodeThatWasNotPressedBeginsNow) {
  auto before = at_rest();
  before.contact[3] = Contact::open;
  before.tractions.t_s_Pa[3] = before.tractions.p_s_Pa[3] = 0;
  Recorder recorder(before, mu_s, 0);
  auto s = unchanged();
  set(s, 3, 0, 0, 0, false);
  recorder.observe(0, s, false);
  set(s, 3, 6, 2, 4, true);
  recorder.observe(2, s, true);
  const auto record = recorder.take(2);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_EQ(record.onsets[0].time_s, 2);
}

TEST(Recorder, SlipInTheFirstUpdateBeginsAtTimeZero) {
  Recorder recorder(at_rest(), mu_s, 0);
  auto s = unchanged();
  set(s, 0, 6, 2, 4, true);
  recorder.observe(0, s, true);
  const auto record = recorder.take(1);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_EQ(record.onsets[0].time_s, 0);
}

TEST(Recorder, InitiallySlippingNodesHaveNoOnsetUntilTheySlipAnew) {
  auto before = at_rest();
  before.contact[2] = Contact::slip;
  Recorder recorder(before, mu_s, 0);
  EXPECT_EQ(recorder.n_slipping(), 1);
  auto s = unchanged();
  set(s, 2, 2, 2, 4, true);
  recorder.observe(0, s, false);
  set(s, 2, 1, 1, 4, false);
  recorder.observe(1, s, true);
  EXPECT_EQ(recorder.n_slipping(), 0);
  set(s, 2, 3, 2, 4, true);
  recorder.observe(2, s, true);
  EXPECT_EQ(recorder.n_slipping(), 1);
  recorder.observe(3, s, false);
  const auto record = recorder.take(3);
  ASSERT_EQ(record.stops.size(), 1);
  EXPECT_EQ(record.stops[0].node, 2);
  EXPECT_EQ(record.stops[0].time_s, 1);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 1.5);  // ratio from 0.5 to 1.5
}

TEST(Recorder, CreepIsNoMotion) {
  Recorder recorder(at_rest(), mu_s, 0, 1e-2);
  auto s = unchanged();
  recorder.observe(0, s, false);
  EXPECT_EQ(recorder.last_motion_s(), 0);
  set(s, 1, 3, 2, 4, true);
  s.slip_rate_m_per_s[1] = -0.02;
  recorder.observe(1, s, true);
  EXPECT_EQ(recorder.last_motion_s(), 1);
  s.slip_rate_m_per_s[1] = -0.009;  // slower than creep
  s.slip_rate_m_per_s[3] = 5;       // in the air
  recorder.observe(2, s, false);
  EXPECT_EQ(recorder.last_motion_s(), 1);
  EXPECT_EQ(recorder.n_slipping(), 1);
  s.slip_rate_m_per_s[1] = 0.011;
  recorder.observe(3, s, false);
  EXPECT_EQ(recorder.last_motion_s(), 3);
}

TEST(Recorder, SeesTheMotionOfAnyNode) {
  // More nodes than the vectors of the search hold, and a rest.
  constexpr std::size_t n = 19;
  for (std::size_t node = 0; node < n; ++node) {
    Equilibrium e;
    e.tractions.x_m.assign(n, 0.0);
    e.tractions.t_s_Pa.assign(n, 1.0);
    e.tractions.p_s_Pa.assign(n, 4.0);
    e.contact.assign(n, Contact::slip);
    Recorder recorder(e, mu_s, 0, 0.01);
    interface::Interface s(n);
    s.slipping.assign(n, 1);
    s.slip_rate_m_per_s.assign(n, -0.009);
    s.slipping[node] = 0;
    s.slip_rate_m_per_s[node] = 1;  // in the air
    recorder.observe(1, s, true);
    EXPECT_EQ(recorder.last_motion_s(), 0) << node;
    s.slipping[node] = 1;
    s.slip_rate_m_per_s[node] = -0.011;
    recorder.observe(2, s, true);
    EXPECT_EQ(recorder.last_motion_s(), 2) << node;
  }
}

TEST(Recorder, TheOnsetIsWhereTheStrengthIsPassed) {
  // A strength that is not mu_s p: relaxed, or of a weakened node. It falls from 2 Pa to 1.6 Pa while the
  // demand rises from 1.6 Pa to 1.92 Pa: the ratio from 0.8 to 1.2, through 1 after half of the step.
  Recorder recorder(at_rest(), mu_s, 0);
  auto s = unchanged();
  s.t_Pa[2] = 1.6;
  recorder.observe(0, s, false);
  set(s, 2, 1.92, 1.6, 4, true);
  s.strength_Pa[2] = 1.6;
  recorder.observe(1, s, true);
  const auto record = recorder.take(1);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 0.5);
  EXPECT_DOUBLE_EQ(record.around_onset(0)[0].t_Pa, 1.8);
  EXPECT_DOUBLE_EQ(record.around_onset(0)[0].p_Pa, 4);
}

TEST(Recorder, TimesAscend) {
  // Onsets found in the order of nodes, at times that run the other way within each step.
  Recorder recorder(at_rest(), mu_s, 0);
  recorder.observe(0, unchanged(), false);
  auto s = unchanged();
  for (std::size_t k = 0; k < 3; ++k) set(s, k, 3 + static_cast<double>(k), 2, 4, true);
  recorder.observe(1, s, true);
  set(s, 3, 3, 2, 4, true);
  set(s, 4, 30, 2, 4, true);
  set(s, 0, 1, 1, 4, false);
  recorder.observe(2, s, true);
  set(s, 1, 1, 1, 4, false);
  recorder.observe(3, s, true);
  const auto record = recorder.take(3);
  std::vector<int> order;
  double last = 0;
  for (const auto& onset : record.onsets) {
    order.push_back(onset.node);
    EXPECT_GE(onset.time_s, last);
    last = onset.time_s;
  }
  EXPECT_EQ(order, (std::vector<int>{2, 1, 0, 4, 3}));
  ASSERT_EQ(record.stops.size(), 2);
  EXPECT_EQ(record.stops[0].node, 0);
  EXPECT_EQ(record.stops[1].node, 1);
  EXPECT_EQ(recorder.n_slipping(), 3);
}

}  // namespace
}  // namespace slipfront::solve
