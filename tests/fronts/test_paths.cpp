// SPDX-License-Identifier: BSD-3-Clause
// Which onsets make a front, where it starts and why it ends.
#include <gtest/gtest.h>

#include "synthetic.hpp"

namespace slipfront::fronts::testing {
namespace {

const std::vector<double> x = nodes(301, h);

std::vector<Front> fronts_of(const std::vector<double>& tau, const Recipe& recipe = {}) {
  return find(make_record(x, tau, recipe));
}

/// A front that passes all nodes from one to another.
void expect_front(const Front& front, int first, int last, End end) {
  const int direction = last > first ? 1 : -1;
  EXPECT_EQ(front.direction, direction);
  EXPECT_EQ(front.end, end);
  ASSERT_EQ(front.points.size(), std::abs(last - first) + 1u);
  int node = first - direction;
  for (const FrontPoint& point : front.points) EXPECT_EQ(point.node, node += direction);
}

/// From the left end at V; nodes beyond the 200th never slip.
std::vector<double> arrested() {
  auto tau = bilateral(x, 0.0, V);
  std::fill(tau.begin() + 201, tau.end(), never);
  return tau;
}

/// A front from the left end, and a nucleation so many nodes ahead when it is at node 150.
std::vector<double> with_daughter(int nodes_ahead) {
  return earlier(bilateral(x, 0.0, V), bilateral(x, x[150 + nodes_ahead], V, x[150] / V + 0.01e-6));
}

TEST(Paths, NoOnsets) {
  EXPECT_TRUE(fronts_of(std::vector<double>(x.size(), never)).empty());
  EXPECT_TRUE(find(record::SlipRecord{}).empty());
}

TEST(Paths, NucleationStartsOneFrontToEachSide) {
  const auto fronts = fronts_of(bilateral(x, x[100], V));
  ASSERT_EQ(fronts.size(), 2u);
  EXPECT_EQ(fronts[0].id, 0);
  EXPECT_EQ(fronts[1].id, 1);
  expect_front(fronts[0], 100, 0, End::contact_end);
  expect_front(fronts[1], 100, 300, End::contact_end);
}

TEST(Paths, NodesSlippingEarlyDoNotSplitAFront) {
  auto tau = bilateral(x, 0.0, V);
  tau[50] = tau[49] - 0.1e-6;    // before the node behind it
  tau[120] = tau[118] - 0.1e-6;  // before the two nodes behind it
  tau[200] += 1.7e-6;            // and one late by two nodes
  const auto fronts = fronts_of(tau);
  ASSERT_EQ(fronts.size(), 1u);
  expect_front(fronts[0], 0, 300, End::contact_end);
  EXPECT_DOUBLE_EQ(fronts[0].points[50].onset_s, tau[50]);
}

TEST(Paths, DaughterAheadIsAFrontOfItsOwn) {
  const auto fronts = fronts_of(with_daughter(9));
  ASSERT_EQ(fronts.size(), 3u);
  expect_front(fronts[0], 0, 154, End::meets_front);
  expect_front(fronts[1], 159, 155, End::meets_front);
  expect_front(fronts[2], 159, 300, End::contact_end);
  // 4 nodes (2.67 mm) ahead: the way back to the mother is shorter than 2 mm.
  const auto near = fronts_of(with_daughter(4));
  ASSERT_EQ(near.size(), 2u);
  EXPECT_EQ(near[0].end, End::meets_front);
  EXPECT_EQ(near[1].points.front().node, 154);
  // 2 mm are no daughter.
  const auto jump = fronts_of(with_daughter(3));
  ASSERT_EQ(jump.size(), 1u);
  expect_front(jump[0], 0, 300, End::contact_end);
}

TEST(Paths, TwoNucleationsMeet) {
  const auto fronts = fronts_of(earlier(bilateral(x, 0.0, V), bilateral(x, x[300], V, 20.1e-6)));
  ASSERT_EQ(fronts.size(), 2u);
  // They meet where x/V = 20.1 us + (0.2 - x)/V: x = 110.05 mm, between nodes 165 and 166.
  expect_front(fronts[0], 0, 165, End::meets_front);
  expect_front(fronts[1], 300, 166, End::meets_front);
}

TEST(Paths, ArrestBeforeNodesThatNeverSlip) {
  const auto record = make_record(x, arrested());
  const auto fronts = find(record);
  ASSERT_EQ(fronts.size(), 1u);
  expect_front(fronts[0], 0, 200, End::arrest);

  auto open_ahead = make_state(x);
  std::fill(open_ahead.p_s_Pa.begin() + 201, open_ahead.p_s_Pa.end(), 0.0);
  EXPECT_EQ(find_fronts(record, open_ahead, make_options())[0].end, End::contact_end);
}

TEST(Paths, RecordEndsWhileTheFrontRuns) {
  const auto tau = arrested();
  EXPECT_EQ(fronts_of(tau, {.end_time_s = tau[200] + 19e-6})[0].end, End::record_end);
  EXPECT_EQ(fronts_of(tau, {.end_time_s = tau[200] + 21e-6})[0].end, End::arrest);
}

TEST(Paths, SlipAfterAnArrestIsAnotherFront) {
  auto tau = bilateral(x, 0.0, V);
  for (int k = 201; k <= 300; ++k) tau[k] += 50e-6;
  const auto fronts = fronts_of(tau);
  ASSERT_EQ(fronts.size(), 2u);
  expect_front(fronts[0], 0, 200, End::arrest);
  expect_front(fronts[1], 201, 300, End::contact_end);

  for (int k = 201; k <= 300; ++k) tau[k] -= 31e-6;  // a wait of 19 us and one node's 0.67 us
  EXPECT_EQ(fronts_of(tau).size(), 1u);
}

TEST(Paths, ATipWaitsLongerWhereSlipSpreadsSlowly) {
  constexpr double slow = 30.0;  // 22 us from node to node
  auto tau = bilateral(x, 0.0, slow);
  const auto record = make_record(x, tau, {.end_time_s = 10e-3});
  auto options = make_options();
  EXPECT_TRUE(find(record, options).empty());
  options.arrest_time_by_event = true;
  EXPECT_NEAR(arrest_time_s(record, options), 3 * options.min_length_m / slow, 1e-12);
  const auto leftwards = make_record(x, bilateral(x, x.back(), slow), {.end_time_s = 10e-3});
  EXPECT_NEAR(arrest_time_s(leftwards, options), 3 * options.min_length_m / slow, 1e-12);
  const auto fronts = find(record, options);
  ASSERT_EQ(fronts.size(), 1u);
  expect_front(fronts[0], 0, 300, End::contact_end);

  for (int k = 201; k <= 300; ++k) tau[k] += 300e-6;
  const auto two = find(make_record(x, tau, {.end_time_s = 10e-3}), options);
  ASSERT_EQ(two.size(), 2u);
  expect_front(two[0], 0, 200, End::arrest);

  EXPECT_EQ(arrest_time_s(make_record(x, bilateral(x, 0.0, V)), options), options.arrest_time_s);
}

TEST(Paths, BeyondTheLastPlaceOfARecordNothingIsKnown) {
  auto options = make_options();
  options.whole_interface = false;
  const auto fronts = find(make_record(x, bilateral(x, x[150], V)), options);
  ASSERT_EQ(fronts.size(), 2u);
  expect_front(fronts[0], 150, 0, End::record_edge);
  expect_front(fronts[1], 150, 300, End::record_edge);
}

TEST(Paths, ASearchCanBeEnded) {
  struct Interrupted {};
  const auto many = nodes(20'000, h);
  auto options = make_options();
  options.pause = [] { throw Interrupted(); };
  EXPECT_THROW(find(make_record(many, bilateral(many, 0.0, V)), options), Interrupted);
}

TEST(Paths, IsolatedNodesArePassed) {
  // That never slip, slip late, or slipped and healed long before the front comes.
  for (const auto& [begin_s, odd_s] : {std::pair{0.0, never}, {0.0, 250e-6}, {100e-6, 10e-6}}) {
    auto tau = bilateral(x, 0.0, V, begin_s);
    tau[100] = odd_s;
    const auto fronts = fronts_of(tau);
    ASSERT_EQ(fronts.size(), 1u);
    EXPECT_EQ(fronts[0].points.size(), 300u);
    EXPECT_EQ(fronts[0].points[100].node, 101);
  }
}

TEST(Paths, GapsLongerThanMinLengthAreNotPassed) {
  auto tau = bilateral(x, 0.0, V);
  tau[100] = tau[101] = tau[102] = never;  // from node 99 to 103 are 2.67 mm
  const auto fronts = fronts_of(tau);
  ASSERT_EQ(fronts.size(), 2u);
  expect_front(fronts[0], 0, 99, End::arrest);
  EXPECT_EQ(fronts[1].points.front().node, 103);
  tau[102] = x[102] / V;  // 2 mm are
  EXPECT_EQ(fronts_of(tau).size(), 1u);
}

TEST(Paths, ShortPathsAreDropped) {
  std::vector<double> tau(x.size(), never);
  for (int k = 0; k <= 2; ++k) tau[100 + k] = k * 1e-6;
  EXPECT_TRUE(fronts_of(tau).empty());
  tau[103] = 3e-6;
  EXPECT_EQ(fronts_of(tau).size(), 1u);
}

TEST(Paths, SimultaneousNodesMakeOneNucleationInTheirMiddle) {
  std::vector<double> tau;
  for (const double place : x) tau.push_back(std::max(0.0, std::abs(place - x[150]) - 5.5 * h) / V);
  const auto fronts = fronts_of(tau);
  ASSERT_EQ(fronts.size(), 2u);
  expect_front(fronts[0], 150, 0, End::contact_end);
  expect_front(fronts[1], 150, 300, End::contact_end);
}

TEST(Paths, CoarseMeshWiderThanMinLength) {
  const auto coarse = nodes(81, 2.5e-3);
  const auto fronts = find(make_record(coarse, bilateral(coarse, coarse[40], V)));
  ASSERT_EQ(fronts.size(), 2u);
  expect_front(fronts[1], 40, 80, End::contact_end);
}

TEST(Paths, MirrorImage) {
  auto tau = earlier(bilateral(x, x[31], V), bilateral(x, x[222], 1.7 * V, 12.3e-6));
  tau[100] = tau[99] - 0.03e-6;
  for (int k = 270; k <= 300; ++k) tau[k] += 44e-6;
  auto mirrored = tau;
  std::ranges::reverse(mirrored);
  const auto fronts = fronts_of(tau);
  const auto images = fronts_of(mirrored);
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
      const double of_image = image->points[k].v_tip_m_per_s;
      EXPECT_TRUE(std::isnan(v) ? std::isnan(of_image) : std::abs(of_image - v) <= 1e-9 * v);  // rounding
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
