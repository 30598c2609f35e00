// SPDX-License-Identifier: BSD-3-Clause
// Which onsets make a front, where it starts and why it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synthetic.hpp"

namespace slipfront::fronts::testing {
namespace {

constexpr double h = 0.2 / 300;
constexpr double V = 1000.0;

std::vector<int> nodes_of(const Front& front) {
  std::vector<int> nodes;
  for (const FrontPoint& point : front.points) nodes.push_back(point.node);
  return nodes;
}

std::vector<int> range(int first, int last) {
  std::vector<int> nodes;
  const int step = last >= first ? 1 : -1;
  for (int k = first; k != last + step; k += step) nodes.push_back(k);
  return nodes;
}

TEST(Paths, NoOnsets) {
  const auto x = nodes(301, h);
  EXPECT_TRUE(find(make_record(x, std::vector<double>(x.size(), never))).empty());
  EXPECT_TRUE(find(record::SlipRecord{}).empty());
}

TEST(Paths, NucleationStartsOneFrontToEachSide) {
  const auto x = nodes(301, h);
  const auto fronts = find(make_record(x, bilateral(x, x[100], V)));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(fronts[0].id, 0);
  EXPECT_EQ(fronts[0].direction, -1);
  EXPECT_EQ(nodes_of(fronts[0]), range(100, 0));
  EXPECT_EQ(fronts[0].end, End::contact_end);
  EXPECT_EQ(fronts[1].id, 1);
  EXPECT_EQ(fronts[1].direction, 1);
  EXPECT_EQ(nodes_of(fronts[1]), range(100, 300));
  EXPECT_EQ(fronts[1].end, End::contact_end);
}

TEST(Paths, NodesSlippingEarlyDoNotSplitAFront) {
  const auto x = nodes(301, h);
  auto tau = bilateral(x, 0.0, V);
  tau[50] = tau[49] - 0.1e-6;    // before the node behind it
  tau[120] = tau[118] - 0.1e-6;  // before the two nodes behind it
  tau[200] += 1.7e-6;            // and one late by two nodes
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 1u);
  EXPECT_EQ(nodes_of(fronts[0]), range(0, 300));
  EXPECT_DOUBLE_EQ(fronts[0].points[50].onset_s, tau[50]);
}

TEST(Paths, DaughterAheadIsAFrontOfItsOwn) {
  const auto x = nodes(301, h);
  // When the mother is at node 150, a daughter nucleates 9 nodes (6 mm) ahead.
  const auto tau = earlier(bilateral(x, 0.0, V), bilateral(x, x[159], V, x[150] / V + 0.01e-6));
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 3u);
  EXPECT_EQ(fronts[0].direction, 1);
  EXPECT_EQ(nodes_of(fronts[0]), range(0, 154));
  EXPECT_EQ(fronts[0].end, End::meets_front);
  EXPECT_EQ(fronts[1].direction, -1);
  EXPECT_EQ(nodes_of(fronts[1]), range(159, 155));
  EXPECT_EQ(fronts[1].end, End::meets_front);
  EXPECT_EQ(fronts[2].direction, 1);
  EXPECT_EQ(nodes_of(fronts[2]), range(159, 300));
  EXPECT_EQ(fronts[2].end, End::contact_end);
}

TEST(Paths, ShortPathBackFromADaughterIsDropped) {
  const auto x = nodes(301, h);
  // 4 nodes (2.67 mm) ahead: the way back to the mother is shorter than 2 mm.
  const auto tau = earlier(bilateral(x, 0.0, V), bilateral(x, x[154], V, x[150] / V + 0.01e-6));
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(fronts[0].end, End::meets_front);
  EXPECT_EQ(fronts[1].points.front().node, 154);
}

TEST(Paths, JumpUpToMinLengthIsNoDaughter) {
  const auto x = nodes(301, h);
  const auto tau = earlier(bilateral(x, 0.0, V), bilateral(x, x[153], V, x[150] / V + 0.01e-6));
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 1u);
  EXPECT_EQ(nodes_of(fronts[0]), range(0, 300));
}

TEST(Paths, TwoNucleationsMeet) {
  const auto x = nodes(301, h);
  const auto fronts = find(make_record(x, earlier(bilateral(x, 0.0, V), bilateral(x, x[300], V, 20.1e-6))));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(fronts[0].direction, 1);
  EXPECT_EQ(fronts[1].direction, -1);
  // They meet where x/V = 20.1 us + (0.2 - x)/V: x = 110.05 mm, between nodes 165 and 166.
  EXPECT_EQ(nodes_of(fronts[0]), range(0, 165));
  EXPECT_EQ(nodes_of(fronts[1]), range(300, 166));
  EXPECT_EQ(fronts[0].end, End::meets_front);
  EXPECT_EQ(fronts[1].end, End::meets_front);
}

TEST(Paths, ArrestBeforeNodesThatNeverSlip) {
  const auto x = nodes(301, h);
  auto tau = bilateral(x, 0.0, V);
  std::fill(tau.begin() + 201, tau.end(), never);
  const auto record = make_record(x, tau);
  const auto fronts = find(record);
  ASSERT_EQ(fronts.size(), 1u);
  EXPECT_EQ(fronts[0].points.back().node, 200);
  EXPECT_EQ(fronts[0].end, End::arrest);

  auto open_ahead = make_state(x);
  std::fill(open_ahead.p_s_Pa.begin() + 201, open_ahead.p_s_Pa.end(), 0.0);
  EXPECT_EQ(find_fronts(record, open_ahead, make_options())[0].end, End::contact_end);
}

TEST(Paths, RecordEndsWhileTheFrontRuns) {
  const auto x = nodes(301, h);
  auto tau = bilateral(x, 0.0, V);
  std::fill(tau.begin() + 201, tau.end(), never);
  const double last_onset_s = tau[200];
  EXPECT_EQ(find(make_record(x, tau, {.end_time_s = last_onset_s + 19e-6}))[0].end, End::record_end);
  EXPECT_EQ(find(make_record(x, tau, {.end_time_s = last_onset_s + 21e-6}))[0].end, End::arrest);
}

TEST(Paths, SlipAfterAnArrestIsAnotherFront) {
  const auto x = nodes(301, h);
  auto tau = bilateral(x, 0.0, V);
  for (int k = 201; k <= 300; ++k) tau[k] += 50e-6;
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(nodes_of(fronts[0]), range(0, 200));
  EXPECT_EQ(fronts[0].end, End::arrest);
  EXPECT_EQ(nodes_of(fronts[1]), range(201, 300));

  for (int k = 201; k <= 300; ++k) tau[k] -= 31e-6;  // a wait of 19 us and one node's 0.67 us
  EXPECT_EQ(find(make_record(x, tau)).size(), 1u);
}

TEST(Paths, IsolatedNodesArePassed) {
  const auto x = nodes(301, h);
  for (const double odd : {never, 250e-6}) {
    auto tau = bilateral(x, 0.0, V);
    tau[100] = odd;
    const auto fronts = find(make_record(x, tau));
    ASSERT_EQ(fronts.size(), 1u);
    EXPECT_EQ(fronts[0].points.size(), 300u);
    EXPECT_EQ(fronts[0].points[100].node, 101);
  }
  auto tau = bilateral(x, 0.0, V, 100e-6);
  tau[100] = 10e-6;  // slipped and healed long before the front comes
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 1u);
  EXPECT_EQ(fronts[0].points.size(), 300u);
}

TEST(Paths, GapsLongerThanMinLengthAreNotPassed) {
  const auto x = nodes(301, h);
  auto tau = bilateral(x, 0.0, V);
  tau[100] = tau[101] = tau[102] = never;  // from node 99 to 103 are 2.67 mm
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(fronts[0].points.back().node, 99);
  EXPECT_EQ(fronts[0].end, End::arrest);
  EXPECT_EQ(fronts[1].points.front().node, 103);
  tau[102] = x[102] / V;  // 2 mm are
  EXPECT_EQ(find(make_record(x, tau)).size(), 1u);
}

TEST(Paths, ShortPathsAreDropped) {
  const auto x = nodes(301, h);
  std::vector<double> tau(x.size(), never);
  for (int k = 0; k <= 2; ++k) tau[100 + k] = k * 1e-6;
  EXPECT_TRUE(find(make_record(x, tau)).empty());
  tau[103] = 3e-6;
  EXPECT_EQ(find(make_record(x, tau)).size(), 1u);
}

TEST(Paths, SimultaneousNodesMakeOneNucleationInTheirMiddle) {
  const auto x = nodes(301, h);
  std::vector<double> tau;
  for (const double place : x) tau.push_back(std::max(0.0, std::abs(place - x[150]) - 5.5 * h) / V);
  const auto fronts = find(make_record(x, tau));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(nodes_of(fronts[0]), range(150, 0));
  EXPECT_EQ(nodes_of(fronts[1]), range(150, 300));
}

TEST(Paths, CoarseMeshWiderThanMinLength) {
  const auto x = nodes(81, 2.5e-3);
  const auto fronts = find(make_record(x, bilateral(x, x[40], V)));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(nodes_of(fronts[1]), range(40, 80));
}

TEST(Paths, MirrorImage) {
  const auto x = nodes(301, h);
  auto tau = earlier(bilateral(x, x[31], V), bilateral(x, x[222], 1.7 * V, 12.3e-6));
  tau[100] = tau[99] - 0.03e-6;
  for (int k = 270; k <= 300; ++k) tau[k] += 44e-6;
  auto mirrored = tau;
  std::ranges::reverse(mirrored);
  auto fronts = find(make_record(x, tau));
  auto images = find(make_record(x, mirrored));
  ASSERT_EQ(fronts.size(), 5u);
  ASSERT_EQ(images.size(), fronts.size());
  for (const Front& front : fronts) {
    const auto image = std::ranges::find_if(images, [&](const Front& other) {
      return other.direction == -front.direction &&
             other.points.front().node == 300 - front.points.front().node;
    });
    ASSERT_NE(image, images.end());
    ASSERT_EQ(image->points.size(), front.points.size());
    EXPECT_EQ(image->end, front.end);
    for (std::size_t k = 0; k < front.points.size(); ++k) {
      EXPECT_EQ(image->points[k].node, 300 - front.points[k].node);
      const double v = front.points[k].v_tip_m_per_s;
      if (std::isnan(v)) {
        EXPECT_TRUE(std::isnan(image->points[k].v_tip_m_per_s));
      } else {
        EXPECT_NEAR(image->points[k].v_tip_m_per_s, v, 1e-9 * v);  // rounding of positions
      }
    }
  }
}

TEST(Paths, Names) {
  EXPECT_EQ(name(End::arrest), "arrest");
  EXPECT_EQ(name(End::meets_front), "meets_front");
  EXPECT_EQ(name(End::contact_end), "contact_end");
  EXPECT_EQ(name(End::record_end), "record_end");
  EXPECT_EQ(name(SlipMode::crack), "crack");
  EXPECT_EQ(name(SlipMode::pulse), "pulse");
  EXPECT_EQ(name(SlipMode::mixed), "mixed");
}

}  // namespace
}  // namespace slipfront::fronts::testing
