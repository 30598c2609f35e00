// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "advice/info.hpp"
#include "cases.hpp"
#include "fronts/front.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "problem/contact.hpp"
#include "support/files.hpp"

namespace slipfront::run {
namespace {

using interface::EventKind;
using interface::SlipWeakening;
using problem::make_problem;
using test::check_error;
using test::go_on;
using test::run_case;
using ::testing::HasSubstr;

/// A rupture from a patch at 0.05 m on a plate of 0.2 m without edges that reflect.
input::Case rupture() {
  auto c = test::prestressed_case();
  c.plate.sides = mesh::Sides::absorbing;
  c.plate.top = mesh::Top::absorbing;
  c.plate.height_m = 0.05;
  c.prestress.t_Pa = 2.3e6;
  c.friction = SlipWeakening{0.6, 0.3, 4e-6};
  c.nucleation.x_m = 0.05;
  c.nucleation.half_length_m = 0.02;
  c.time.end_s = 150e-6;
  return c;
}

/// The same with a table of friction.
input::Case rupture(const std::string& table, input::BetweenRows between_rows = {}) {
  auto c = rupture();
  test::set_table(c, table);
  c.friction_along_x.between_rows = between_rows;
  return c;
}

/// From the first to the last node that slipped.
std::pair<double, double> slipped_m(const Result& result) {
  const auto& record = result.event.record;
  double from = record.x_m.back(), to = record.x_m.front();
  for (const auto& onset : record.onsets) {
    from = std::min(from, record.x_m[onset.node]);
    to = std::max(to, record.x_m[onset.node]);
  }
  return {from, to};
}

TEST(FrictionAlongX, ABarrierStopsAFront) {
  EXPECT_EQ(slipped_m(run_case(rupture())), std::pair(0.0, 0.2));
  const auto result =
      run_case(rupture("x_m,mu_s,mu_k\n0,0.6,0.3\n0.12,5,5\n0.2,5,5\n", input::BetweenRows::stepwise));
  EXPECT_EQ(slipped_m(result).first, 0);
  EXPECT_NEAR(slipped_m(result).second, 0.118, 1e-9);
  const auto stopped = std::ranges::find(result.fronts, 1, &fronts::Front::direction);
  ASSERT_NE(stopped, result.fronts.end());
  EXPECT_EQ(stopped->end, fronts::End::arrest);
}

TEST(FrictionAlongX, EqualRowsAreTheUniformLawBitByBit) {
  const auto uniform = run_case(rupture());
  const auto varying = run_case(rupture("x_m,mu_s,mu_k,d_c_m\n0,0.6,0.3,4e-6\n0.2,0.6,0.3,4e-6\n"));
  EXPECT_EQ(test::history_of(varying).t_Pa, test::history_of(uniform).t_Pa);
  EXPECT_EQ(test::history_of(varying).slip_rate_m_per_s, test::history_of(uniform).slip_rate_m_per_s);
  ASSERT_EQ(varying.fronts.size(), uniform.fronts.size());
  for (std::size_t f = 0; f < varying.fronts.size(); ++f)
    for (std::size_t k = 0; k < varying.fronts[f].points.size(); ++k) {
      const auto &a = varying.fronts[f].points[k], &b = uniform.fronts[f].points[k];
      EXPECT_EQ(a.onset_s, b.onset_s);
      EXPECT_TRUE(a.U_r_J_per_m3 == b.U_r_J_per_m3 || std::isnan(a.U_r_J_per_m3 + b.U_r_J_per_m3));
    }
}

TEST(FrictionAlongX, FrontsAreMeasuredByEachNodesStrength) {
  auto c = rupture("x_m,mu_s\n0,0.55\n0.2,0.65\n");
  const auto initial = setup::make_initial_state(make_problem(c), go_on);
  const auto result = run_from(make_problem(c), initial, go_on);
  const auto elasticity = front_options(make_problem(c), initial).elasticity;
  int n = 0;
  for (const auto& front : result.fronts)
    for (const auto& point : front.points) {
      if (std::isnan(point.U_r_J_per_m3)) continue;
      const double mu_s = 0.55 + 0.5 * point.x_m;
      const double U_r = fronts::energy_density_J_per_m3({mu_s * point.p_r_Pa, point.p_r_Pa}, elasticity);
      EXPECT_NEAR(point.U_r_J_per_m3, U_r, 1e-12 * U_r);
      ++n;
    }
  EXPECT_GT(n, 20);
}

TEST(FrictionAlongX, StatesBeforeAreSharedByEqualFrictionOnly) {
  auto b = rupture();
  const auto a = rupture("x_m,mu_s\n0,0.6\n0.2,0.7\n");
  EXPECT_NE(make_problem(a).source.state_key, make_problem(b).source.state_key);
  b.friction_along_x = a.friction_along_x;
  EXPECT_EQ(make_problem(a).source.state_key, make_problem(b).source.state_key);
  b.friction_along_x.table.text += "\n";
  EXPECT_NE(make_problem(a).source.state_key, make_problem(b).source.state_key);
}

TEST(FrictionAlongX, ARampEndsWhereTheStrengthIsReachedFirst) {
  auto c = test::coarse_case();
  c.loading.shear_speed_m_per_s = 8e-3;
  test::law(c).mu_k = 0.05;
  constexpr double weak = 0.2;
  test::set_table(c, fmt::format("x_m,mu_s\n0,1.3\n0.055,1.3\n0.06,{}\n0.065,1.3\n0.2,1.3\n", weak));
  const auto direct = setup::make_initial_state(make_problem(c), go_on);
  EXPECT_NEAR(direct.subcritical.peak_x_m, 0.06, 1e-9);
  EXPECT_NEAR(direct.subcritical.peak_ratio, weak * (1 - c.loading.critical_margin), 1e-6);
  c.loading.method = statics::LoadingMethod::ramp;
  const auto ramp = setup::make_initial_state(make_problem(c), go_on);
  EXPECT_EQ(ramp.subcritical.peak_x_m, direct.subcritical.peak_x_m);
  EXPECT_EQ(ramp.supercritical.peak_x_m, direct.subcritical.peak_x_m);
  // Waves that go to and fro in the plate make the explicit state wobble.
  EXPECT_NEAR(ramp.supercritical.shear_m, direct.critical_shear_m, 0.005 * direct.critical_shear_m);
  EXPECT_GE(ramp.subcritical.peak_ratio, (1 - c.loading.critical_margin) * weak);
  EXPECT_LT(ramp.subcritical.peak_ratio, weak);
  // In its last step the node has begun to slip, and weakens from mu_s.
  ASSERT_EQ(ramp.ramp->n_onsets_inside(), 1);
  const auto& record = ramp.ramp->record;
  EXPECT_NEAR(record.x_m[record.onsets.back().node], 0.06, 1e-9);
  const double step_s = record.end_time_s / static_cast<double>(ramp.ramp->steps);
  // The last step finds what has happened up to its beginning, since the beginning of the step before.
  EXPECT_GE(record.onsets.back().time_s, record.end_time_s - 2 * step_s);
}

TEST(FrictionAlongX, AWeakenedPatchNeedsANodeThatWeakens) {
  auto c = rupture("x_m,mu_k\n0,0.6\n0.09,0.6\n0.11,0.3\n0.2,0.3\n");
  EXPECT_THAT(check_error(c), HasSubstr("nucleation.form = weakened does nothing"));
  c.nucleation.x_m = 0.12;
  EXPECT_EQ(check_error(c), test::accepted);
  c.event = EventKind::left;
  c.trigger.form = interface::TriggerForm::weakened;
  EXPECT_THAT(check_error(c), HasSubstr("event.trigger_form = weakened does nothing"));
}

TEST(FrictionAlongX, WarningsAndTriggersGoByEachNode) {
  auto c = rupture("x_m,mu_s\n0,0.4\n0.05,0.6\n0.2,0.6\n", input::BetweenRows::stepwise);
  c.event = EventKind::none;
  c.time.end_s = 1e-6;
  EXPECT_THAT(test::texts_of(run_case(c).notes),
              ::testing::Contains("t is beyond mu_s p at 25 of 101 nodes inside: they slip at once"));
  c.event = EventKind::right;
  c.trigger.form = interface::TriggerForm::raised;
  c.trigger.amount = 0.7;
  EXPECT_THAT(check_error(c), HasSubstr("where t is at least 0.7667 mu_s p"));
  test::set_table(c, "x_m,mu_s\n0,0.4\n0.05,0.6\n0.1,0.8\n0.2,0.8\n");
  EXPECT_EQ(check_error(c), test::accepted);
}

TEST(FrictionAlongX, InfoTellsTheWorstNode) {
  auto c = rupture();
  c.friction = interface::VelocityWeakening { 0.6, 0.3, 0.1 };
  EXPECT_TRUE(std::isnan(advice::info(make_problem(c)).well_posedness_x_m));
  test::set_table(c, "x_m,mu_k\n0,0.5\n0.1,0.2\n0.2,0.4\n");
  const auto varying = advice::info(make_problem(c));
  EXPECT_NEAR(varying.well_posedness_x_m, 0.1, 1e-9);
  c.friction_along_x = {};
  c.friction = interface::VelocityWeakening { 0.6, 0.2, 0.1 };
  EXPECT_DOUBLE_EQ(varying.well_posedness.growth_at_grid_per_s,
                   advice::info(make_problem(c)).well_posedness.growth_at_grid_per_s);
}

TEST(FrictionAlongX, ParametersOfNodesAreWritten) {
  const test::TemporaryFolder folder;
  const auto c = rupture("x_m,mu_s\n0,0.6\n0.2,0.7\n");
  write_static(folder.path(), make_problem(c), setup::make_initial_state(make_problem(c), go_on));
  const auto text = test::read_file(folder / "static.csv");
  EXPECT_THAT(text,
              ::testing::StartsWith(
                  "x_m,t_s_Pa,p_s_Pa,mu_s,mu_k,d_c_m,cohesion_Pa\n0,2300000,5000000,0.6,0.3,4e-06,0\n"));
  EXPECT_THAT(text, HasSubstr("\n0.05,2300000,5000000,0.625,0.3,4e-06,0\n"));
}

}  // namespace
}  // namespace slipfront::run
