// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/main_fronts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "fronts/measures.hpp"
#include "synthetic.hpp"

namespace slipfront::kammer2012 {
namespace {

using namespace synthetic;

double constant(double) {
  return 1.0;
}

std::vector<MainFront> mains_of(const Outcome& o) {
  const std::array<const Outcome*, 1> one = {&o};
  return main_fronts(one);
}

/// The first and last place that count of the only main front.
std::pair<double, double> counted(const Outcome& o) {
  const auto mains = mains_of(o);
  EXPECT_EQ(mains.size(), 1U);
  return {mains.at(0).points.front().x_m, mains.at(0).points.back().x_m};
}

/// Speeds over c_L of the last points of the front triggered on the left, which is otherwise fast.
Outcome left_ending_with(const std::vector<double>& speeds) {
  Outcome o = make_left(constant);
  auto& points = o.fronts[0].points;
  for (std::size_t k = 0; k < speeds.size(); ++k)
    points[points.size() - speeds.size() + k].v_tip_m_per_s = speeds[k] * o.speeds.c_L;
  return o;
}

constexpr double left_end_m = 0.194;  // of make_left

TEST(MainFronts, AreOfEachEventThoseOfItsStart) {
  const auto runs = make_good();
  const std::array<const Outcome*, 3> three = {&runs.spontaneous, &runs.left, &runs.right};
  const auto mains = main_fronts(three);
  ASSERT_EQ(mains.size(), 4U);
  EXPECT_EQ(mains[0].front, &runs.spontaneous.fronts[0]);
  EXPECT_EQ(mains[1].front, &runs.spontaneous.fronts[1]);
  EXPECT_EQ(mains[2].front, &runs.left.fronts[0]);
  EXPECT_EQ(mains[3].front, &runs.right.fronts[0]);
  EXPECT_EQ(mains[3].outcome, &runs.right);
  for (const auto& m : mains) EXPECT_EQ(&m.points.back(), &m.front->points.back());
}

TEST(MainFronts, NoneWithoutAFrontThatIsFast) {
  EXPECT_TRUE(mains_of(make_event("left", EventKind::left)).empty());
  EXPECT_EQ(first_front(make_left(constant), -1), nullptr);
  EXPECT_TRUE(mains_of(make_left([](double) { return 0.09; })).empty());
  // Fast in front of the points that count alone.
  EXPECT_TRUE(mains_of(make_left([](double x) { return x < 0.02 ? 1.0 : 0.09; })).empty());
}

TEST(MainFronts, CountFromFiveMillimetresBeyondASpontaneousNucleation) {
  const Outcome o = make_spontaneous(constant, constant);
  const auto mains = mains_of(o);
  ASSERT_EQ(mains.size(), 2U);
  for (const auto& m : mains) {
    const auto distance = [&](const fronts::FrontPoint& p) { return std::abs(p.x_m - peak_x_m); };
    EXPECT_NEAR(distance(m.points.front()), 5.5e-3, 0.6e-3);
    EXPECT_GE(distance(m.points.front()), 5e-3);
    EXPECT_LT(distance(*(&m.points.front() - 1)), 5e-3);
  }
}

TEST(MainFronts, CountFromTenMillimetresBeyondTheTriggerZone) {
  for (const double zone_m : {9.5e-3, 14.5e-3}) {
    Outcome left = make_left(constant), right = make_right(constant);
    left.config.trigger.zone_m = right.config.trigger.zone_m = zone_m;
    EXPECT_NEAR(counted(left).first, contact_from_m + zone_m + 10.5e-3, 1e-9);
    EXPECT_NEAR(counted(right).first, contact_to_m - zone_m - 10.5e-3, 1e-9);
  }
}

TEST(MainFronts, AreNotThoseOfOtherStarts) {
  // Longer than the one along the shear from the nucleation, but in the wake of the other.
  Outcome o = make_spontaneous(constant, constant);
  o.fronts.push_back(make_front(0.02, 0.12, constant, o.speeds.c_L));
  const auto mains = mains_of(o);
  ASSERT_EQ(mains.size(), 2U);
  EXPECT_EQ(mains[1].front, &o.fronts[1]);

  // Ahead of the trigger's front, which meets it.
  Outcome left = make_left(constant);
  left.fronts[0] = make_front(contact_from_m, 0.09, constant, left.speeds.c_L);
  left.fronts.push_back(make_front(0.092, 0.194, constant, left.speeds.c_L));
  EXPECT_NEAR(counted(left).second, 0.09, 1e-9);
}

TEST(MainFronts, StartWithinReachOfTheFirstOnsetOrInTheMarginOfTheTriggerZone) {
  Outcome o = make_spontaneous(constant, constant);
  for (const auto& [distance_m, n] : {std::pair{4.9e-3, 2U}, {5.1e-3, 0U}, {nan, 0U}}) {
    o.first_onset_x_m = peak_x_m + distance_m;
    EXPECT_EQ(mains_of(o).size(), n) << distance_m;
  }
  const double margin_end_m = contact_from_m + 20e-3;
  o = make_left(constant);
  o.fronts[0] = make_front(margin_end_m - 0.5e-3, 0.1, constant, o.speeds.c_L);
  EXPECT_NEAR(counted(o).first, margin_end_m + 0.5e-3, 1e-9);
  o.fronts[0] = make_front(margin_end_m + 0.5e-3, 0.1, constant, o.speeds.c_L);
  EXPECT_TRUE(mains_of(o).empty());
}

TEST(MainFronts, EndWhereTheSpeedStaysLow) {
  const double none = nan;
  const std::pair<std::vector<double>, double> examples[] = {
      {{0.11, 0.099, 0.01, 0.05}, 3e-3},
      {{0.05, 0.05, 0.05, 0.11}, 0},  // slow for a while only
      {{0.05, 0.11, 0.05, 0.05}, 2e-3},
      {{none, none, none}, 0},  // neither low nor high
      {{0.05, none, 0.05, none}, 4e-3},
      {{0.5, none, 0.05}, 1e-3}};  // not known to be slow until the point behind it
  for (const auto& [speeds, cut_m] : examples)
    EXPECT_NEAR(counted(left_ending_with(speeds)).second, left_end_m - cut_m, 1e-9)
        << testing::PrintToString(speeds);
}

TEST(MainFronts, TailIsTheLastTwentyMillimetresThatCount) {
  const auto n_in_tail = [](const Outcome& o) {
    const auto mains = mains_of(o);
    return std::ranges::count_if(mains.at(0).points, [&](const auto& p) { return in_tail(mains[0], p); });
  };
  Outcome o = make_left(constant);
  for (const auto end : {fronts::End::arrest, fronts::End::meets_front, fronts::End::contact_end}) {
    o.fronts[0].end = end;
    EXPECT_EQ(n_in_tail(o), 21);  // a point each millimetre, both ends included
  }
  o.fronts[0].end = fronts::End::record_end;  // it may still run
  EXPECT_EQ(n_in_tail(o), 0);
  Outcome slow = left_ending_with({0.05, 0.05, 0.05});
  slow.fronts[0].end = fronts::End::record_end;
  EXPECT_EQ(n_in_tail(slow), 21);
  const auto mains = mains_of(slow);
  EXPECT_FALSE(in_tail(mains[0], *(mains[0].points.end() - 22)));
}

}  // namespace
}  // namespace slipfront::kammer2012
