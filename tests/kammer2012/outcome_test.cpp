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

std::array<const Outcome*, 1> only(const Outcome& o) {
  return {&o};
}

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
  p.t_d_Pa = p.U_s_J_per_m3 = nan;
  EXPECT_TRUE(std::isnan(criterion_value(p, Criterion::dynamic_ratio)));
  EXPECT_TRUE(std::isnan(criterion_value(p, Criterion::energy_rise)));
}

TEST(Counts, LeavesOutTheTriggerZoneAndItsMargin) {
  auto left = make_left(linear(0.8, 0.4));
  const auto right = make_right(linear(0.8, 0.4));
  const auto counts_at = [](const Outcome& o, double x_m) {
    fronts::FrontPoint p;
    p.x_m = x_m;
    return counts(o, o.fronts[0], p);
  };
  // Zone and margin of 10 mm each, from the edge of contact.
  for (const double at_m : {19.9e-3, 20.1e-3, contact_to_m - contact_from_m}) {
    EXPECT_EQ(counts_at(left, contact_from_m + at_m), at_m > 20e-3) << at_m;
    EXPECT_EQ(counts_at(right, contact_to_m - at_m), at_m > 20e-3) << at_m;
  }
  left.config.trigger.zone_m = 30e-3;
  EXPECT_FALSE(counts_at(left, contact_from_m + 39e-3));
  left.config.fronts.trigger_margin_m = 0;
  EXPECT_TRUE(counts_at(left, contact_from_m + 31e-3));
}

TEST(Counts, LeavesOutTheNeighbourhoodOfSpontaneousNucleationOnly) {
  const auto o = make_spontaneous(), right = make_right(linear(0.8, 1.5));
  const auto& front = o.fronts[0];
  EXPECT_TRUE(counts(o, front, front.points[0]));
  EXPECT_FALSE(counts(o, front, front.points[4], 5e-3 + 1e-9));
  EXPECT_TRUE(counts(o, front, front.points[6], 5e-3 + 1e-9));
  EXPECT_TRUE(counts(right, right.fronts[0], right.fronts[0].points[30], 50e-3));
}

TEST(CriterionSeries, HasTheSamePointsForEveryCriterion) {
  auto o = make_spontaneous();
  o.fronts[0].points[10].v_tip_m_per_s = nan;
  o.fronts[0].points[20].U_s_J_per_m3 = nan;
  for (const auto criterion : {Criterion::static_ratio, Criterion::dynamic_ratio, Criterion::energy_rise}) {
    const auto series = criterion_series(only(o), criterion);
    ASSERT_EQ(series.size(), 2U);
    EXPECT_EQ(series[0].x.size(), o.fronts[0].points.size() - 3);  // nor the first point
    EXPECT_EQ(series[1].x.size(), o.fronts[1].points.size() - 1);
    EXPECT_DOUBLE_EQ(series[1].y[5], o.fronts[1].points[6].v_tip_m_per_s / o.speeds.c_L);
    EXPECT_DOUBLE_EQ(series[1].x[5], criterion_value(o.fronts[1].points[6], criterion));
  }
}

TEST(Collapse, CountsTheShareWithinTheBand) {
  auto o = make_spontaneous();
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
  const auto c = collapse(only(o));
  EXPECT_EQ(c.n_points, n);
  EXPECT_DOUBLE_EQ(c.share_in_paper_band, static_cast<double>(n - n_off) / static_cast<double>(n));
}

TEST(SpeedChange, OfAScaledRunIsTheScale) {
  const auto reference = make_spontaneous();
  auto run = reference;
  for (auto& front : run.fronts)
    for (auto& p : front.points) p.v_tip_m_per_s *= front.direction > 0 ? 1.2 : 0.7;
  const auto change = speed_change(run, reference);
  // More nodes against the shear than along it.
  EXPECT_NEAR(change.median, -0.3, 1e-12);
  EXPECT_NEAR(change.median_absolute, 0.3, 1e-12);
  EXPECT_NEAR(change.largest, 0.3, 1e-12);

  // Every second node: the speed is linear in x on both sides of the peak, so interpolation is exact there.
  const auto left = make_left(linear(0.8, 0.4));
  run = left;
  std::erase_if(run.fronts[0].points, [k = 0](const fronts::FrontPoint&) mutable { return k++ % 2 != 0; });
  for (auto& p : run.fronts[0].points) p.v_tip_m_per_s *= 1.1;
  EXPECT_NEAR(speed_change(run, left).median, 0.1, 1e-12);
  EXPECT_GT(speed_change(run, left).n_points, 100U);

  // No place is common to these.
  const auto none = speed_change(left, make_right(linear(0.8, 0.4)));
  EXPECT_EQ(none.n_points, 0U);
  EXPECT_TRUE(std::isnan(none.median) && std::isnan(none.largest));
}

TEST(MainFront, IsTheLongestInItsDirection) {
  auto o = make_spontaneous();
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

/// What make_outcome takes from a run with the given onsets; node k lies at k mm.
Outcome outcome_of(const std::vector<record::Onset>& onsets, const std::vector<fronts::Front>& fronts = {}) {
  const auto state = make_event("", EventKind::spontaneous).common;
  run::Result result;
  result.event.record.x_m = state.x_m;
  result.event.record.onsets = onsets;
  result.fronts = fronts;
  run::InitialState initial;
  initial.subcritical.tractions = state;
  initial.subcritical.peak_x_m = peak_x_m;
  initial.subcritical.inside_from_m = contact_from_m + 10e-3;
  initial.subcritical.inside_to_m = contact_to_m - 10e-3;
  initial.critical_shear_m = 0.47e-3;
  return make_outcome("run", result, initial);
}

TEST(MakeOutcome, TakesTheFirstOnsetInside) {
  const auto o = outcome_of({{5, 0}, {150, 2e-6}, {144, 1e-6}});  // node 5 is outside
  EXPECT_DOUBLE_EQ(o.first_onset_x_m, 0.144);
  EXPECT_DOUBLE_EQ(o.contact_from_m, contact_from_m);
  EXPECT_DOUBLE_EQ(o.contact_to_m, contact_to_m);
  EXPECT_EQ(o.peak_x_m, peak_x_m);
  EXPECT_TRUE(std::isnan(o.ramp_critical_shear_m));
  // Of several the farthest from the peak.
  EXPECT_DOUBLE_EQ(outcome_of({{145, 1e-6}, {147, 1e-6}, {144, 1e-6}, {170, 2e-6}}).first_onset_x_m, 0.147);
  EXPECT_TRUE(std::isnan(outcome_of({{5, 0}}).first_onset_x_m));
}

TEST(MakeOutcome, LeavesOutShortFronts) {
  std::vector<fronts::Front> fronts;
  for (const double to_m : {0.109, 0.11, 0.05}) fronts.push_back(make_front(0.1, to_m, linear(0.8, 1), 1584));
  const auto o = outcome_of({{145, 0}}, fronts);
  ASSERT_EQ(o.fronts.size(), 2U);
  for (const auto& front : o.fronts) EXPECT_GE(fronts::length_m(front), criteria_length_m * (1 - 1e-9));
}

}  // namespace
}  // namespace slipfront::kammer2012
