// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/outcome.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "fronts/measures.hpp"
#include "synthetic.hpp"

namespace slipfront::kammer2012 {
namespace {

using namespace synthetic;

TEST(CriterionValue, OfEachCriterion) {
  fronts::FrontPoint p;
  p.t_s_Pa = 4e6;
  p.p_s_Pa = 5e6;
  p.t_d_Pa = 3e6;
  p.p_d_Pa = 4e6;
  p.U_s_J_per_m3 = 2e4;
  p.U_r_J_per_m3 = 2.5e4;
  EXPECT_DOUBLE_EQ(criterion_value(p, Criterion::static_ratio), 0.8);
  EXPECT_DOUBLE_EQ(criterion_value(p, Criterion::dynamic_ratio), 0.75);
  EXPECT_DOUBLE_EQ(criterion_value(p, Criterion::energy_rise), 0.25);
  p.t_d_Pa = p.U_s_J_per_m3 = fronts::undefined;
  EXPECT_TRUE(std::isnan(criterion_value(p, Criterion::dynamic_ratio)));
  EXPECT_TRUE(std::isnan(criterion_value(p, Criterion::energy_rise)));
}

TEST(Counts, LeavesOutTheTriggerZoneAndItsMargin) {
  // Zone and margin of 10 mm each, from the edge of contact.
  const auto at = [](double x) {
    fronts::FrontPoint p;
    p.x_m = x;
    return p;
  };
  const auto left = make_left(linear(0.8, 0.4)), right = make_right(linear(0.8, 0.4));
  EXPECT_FALSE(counts(left, left.fronts[0], at(contact_from_m + 19.9e-3)));
  EXPECT_TRUE(counts(left, left.fronts[0], at(contact_from_m + 20.1e-3)));
  EXPECT_TRUE(counts(left, left.fronts[0], at(contact_to_m)));
  EXPECT_FALSE(counts(right, right.fronts[0], at(contact_to_m - 19.9e-3)));
  EXPECT_TRUE(counts(right, right.fronts[0], at(contact_to_m - 20.1e-3)));
  EXPECT_TRUE(counts(right, right.fronts[0], at(contact_from_m)));

  auto wide = left;
  wide.config.trigger.zone_m = 30e-3;
  EXPECT_FALSE(counts(wide, wide.fronts[0], at(contact_from_m + 39e-3)));
  wide.config.fronts.trigger_margin_m = 0;
  EXPECT_TRUE(counts(wide, wide.fronts[0], at(contact_from_m + 31e-3)));
}

TEST(Counts, LeavesOutTheNeighbourhoodOfSpontaneousNucleationOnly) {
  const auto o = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  const auto& front = o.fronts[0];
  EXPECT_TRUE(counts(o, front, front.points[0]));
  EXPECT_FALSE(counts(o, front, front.points[4], 5e-3 + 1e-9));
  EXPECT_TRUE(counts(o, front, front.points[6], 5e-3 + 1e-9));
  const auto right = make_right(linear(0.8, 1.5));
  EXPECT_TRUE(counts(right, right.fronts[0], right.fronts[0].points[30], 50e-3));
}

TEST(CriterionSeries, HasTheSamePointsForEveryCriterion) {
  auto o = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  o.fronts[0].points[10].v_tip_m_per_s = fronts::undefined;
  o.fronts[0].points[20].U_s_J_per_m3 = fronts::undefined;
  const std::array<const Outcome*, 1> one = {&o};
  for (const auto criterion : {Criterion::static_ratio, Criterion::dynamic_ratio, Criterion::energy_rise}) {
    const auto series = criterion_series(one, criterion);
    ASSERT_EQ(series.size(), 2U);
    EXPECT_EQ(series[0].x.size(), o.fronts[0].points.size() - 3);  // nor the first point
    EXPECT_EQ(series[1].x.size(), o.fronts[1].points.size() - 1);
    EXPECT_DOUBLE_EQ(series[1].y[5], o.fronts[1].points[6].v_tip_m_per_s / o.speeds.c_L);
    EXPECT_DOUBLE_EQ(series[1].x[5], criterion_value(o.fronts[1].points[6], criterion));
  }
}

TEST(Collapse, RecoversThePapersCurve) {
  const auto s = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  const auto left = make_left(square(0.8, 0.4)), right = make_right(square(0.8, 1.6));
  const std::array<const Outcome*, 3> three = {&s, &left, &right};
  const auto c = collapse(three);
  ASSERT_TRUE(c.fitted);
  EXPECT_EQ(c.share_in_paper_band, 1);
  // Exact data: what is left is the bisection on c, which ends at rounding.
  EXPECT_NEAR(c.fit.a.value, 0.76, 1e-6);
  EXPECT_NEAR(c.fit.b.value, 1.80, 1e-6);
  EXPECT_NEAR(c.fit.c.value, 3.05, 1e-6);
  EXPECT_LT(c.fit.rms, 1e-6);
  EXPECT_EQ(c.n_points, c.fit.n_points);
  // One curve, so the spread over the fronts is what a bin's width leaves.
  EXPECT_LT(c.energy_rise.cases.median_relative, c.static_ratio.cases.median_relative);
}

TEST(Collapse, CountsTheShareWithinTheBand) {
  auto o = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  std::size_t n = 0, n_off = 0;
  for (auto& front : o.fronts) {
    for (auto& p : front.points) {
      if (std::isnan(p.v_tip_m_per_s)) continue;
      // Alternately just inside, just outside, and a fall of energy, which no point of the curve has.
      const auto kind = n++ % 4;
      if (kind == 1) p.v_tip_m_per_s += 0.069 * o.speeds.c_L;
      if (kind == 2) p.v_tip_m_per_s -= 0.071 * o.speeds.c_L;
      if (kind == 3) set_energy_rise(p, -0.1);
      n_off += kind >= 2;
    }
  }
  const std::array<const Outcome*, 1> one = {&o};
  const auto c = collapse(one);
  EXPECT_EQ(c.n_points, n);
  EXPECT_DOUBLE_EQ(c.share_in_paper_band, static_cast<double>(n - n_off) / static_cast<double>(n));
}

TEST(Collapse, OfNothing) {
  const auto o = make_event("spontaneous", EventKind::spontaneous);
  const std::array<const Outcome*, 1> one = {&o};
  const auto c = collapse(one);
  EXPECT_FALSE(c.fitted);
  EXPECT_EQ(c.n_points, 0U);
  EXPECT_TRUE(std::isnan(c.share_in_paper_band));
}

TEST(SpeedChange, OfAScaledRunIsTheScale) {
  const auto reference = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  auto run = reference;
  for (auto& front : run.fronts)
    for (auto& p : front.points) p.v_tip_m_per_s *= front.direction > 0 ? 1.2 : 0.7;
  const auto change = speed_change(run, reference);
  // More nodes against the shear than along it.
  EXPECT_NEAR(change.median, -0.3, 1e-12);
  EXPECT_NEAR(change.median_absolute, 0.3, 1e-12);
  EXPECT_NEAR(change.largest, 0.3, 1e-12);
}

TEST(SpeedChange, InterpolatesBetweenTheNodesOfAnotherMesh) {
  const auto reference = make_left(linear(0.8, 0.4));
  auto run = reference;
  // Every second node: the speed is linear in x on both sides of the peak, so interpolation is exact there.
  std::erase_if(run.fronts[0].points, [k = 0](const fronts::FrontPoint&) mutable { return k++ % 2 != 0; });
  for (auto& p : run.fronts[0].points) p.v_tip_m_per_s *= 1.1;
  const auto change = speed_change(run, reference);
  EXPECT_NEAR(change.median, 0.1, 1e-12);
  EXPECT_GT(change.n_points, 100U);
}

TEST(SpeedChange, WithoutCommonPointsIsUndefined) {
  const auto left = make_left(linear(0.8, 0.4)), right = make_right(linear(0.8, 0.4));
  const auto change = speed_change(left, right);
  EXPECT_EQ(change.n_points, 0U);
  EXPECT_TRUE(std::isnan(change.median));
  EXPECT_TRUE(std::isnan(change.largest));
}

TEST(MainFront, IsTheLongestInItsDirection) {
  auto o = make_spontaneous(linear(0.8, 1.5), linear(0.8, 1.2));
  o.fronts.insert(o.fronts.begin(), make_front(0.05, 0.03, linear(0.8, 1), o.speeds.c_L));
  EXPECT_EQ(main_front(o, -1), &o.fronts[1]);
  EXPECT_EQ(main_front(o, 1), &o.fronts[2]);
  EXPECT_EQ(longest_front(o), &o.fronts[1]);
  o.fronts.resize(1);
  EXPECT_EQ(main_front(o, 1), nullptr);
  EXPECT_EQ(longest_front(o), &o.fronts[0]);
  o.fronts.clear();
  EXPECT_EQ(longest_front(o), nullptr);
}

/// A run with the given onsets, of which only what make_outcome reads is there.
run::Result make_result(const std::vector<record::Onset>& onsets) {
  run::Result result;
  result.event.record.x_m = make_event("", EventKind::spontaneous).common.x_m;
  result.event.record.onsets = onsets;
  return result;
}

run::InitialState make_initial() {
  run::InitialState initial;
  initial.common.tractions = make_event("", EventKind::spontaneous).common;
  initial.common.peak_x_m = peak_x_m;
  initial.common.inside_from_m = contact_from_m + 10e-3;
  initial.common.inside_to_m = contact_to_m - 10e-3;
  initial.critical_shear_m = 0.47e-3;
  return initial;
}

TEST(MakeOutcome, TakesTheFirstOnsetInside) {
  // Node k at k mm; node 5 is outside.
  const auto o = make_outcome("run", make_result({{5, 0}, {150, 2e-6}, {144, 1e-6}}), make_initial());
  EXPECT_DOUBLE_EQ(o.first_onset_x_m, 0.144);
  EXPECT_DOUBLE_EQ(o.contact_from_m, contact_from_m);
  EXPECT_DOUBLE_EQ(o.contact_to_m, contact_to_m);
  EXPECT_EQ(o.peak_x_m, peak_x_m);
  EXPECT_TRUE(std::isnan(o.ramp_critical_shear_m));
}

TEST(MakeOutcome, OfSeveralFirstOnsetsTakesTheFarthestFromThePeak) {
  const auto o =
      make_outcome("run", make_result({{145, 1e-6}, {147, 1e-6}, {144, 1e-6}, {170, 2e-6}}), make_initial());
  EXPECT_DOUBLE_EQ(o.first_onset_x_m, 0.147);
  EXPECT_TRUE(std::isnan(make_outcome("run", make_result({{5, 0}}), make_initial()).first_onset_x_m));
}

TEST(MakeOutcome, LeavesOutShortFronts) {
  auto result = make_result({{145, 0}});
  const double c_L = 1584;
  result.fronts = {make_front(0.1, 0.109, linear(0.8, 1), c_L), make_front(0.1, 0.11, linear(0.8, 1), c_L),
                   make_front(0.1, 0.05, linear(0.8, 1), c_L)};
  const auto o = make_outcome("run", result, make_initial());
  ASSERT_EQ(o.fronts.size(), 2U);
  for (const auto& front : o.fronts) EXPECT_GE(fronts::length_m(front), criteria_length_m * (1 - 1e-9));
}

}  // namespace
}  // namespace slipfront::kammer2012
