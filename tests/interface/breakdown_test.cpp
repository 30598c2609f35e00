// SPDX-License-Identifier: BSD-3-Clause
#include "interface/breakdown.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/exponential_slip_weakening.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::interface {
namespace {

constexpr double dt_s = 1e-9, p_Pa = 5e6;
constexpr SlipWeakening linear{.mu_s = 0.6, .mu_k = 0.4, .d_c_m = 2e-6};

double linear_mu(double, double slip) {
  return 0.6 - 0.2 * std::min(slip / 2e-6, 1.0);
}

/// A node under a pressure that a function of the slip gives, at a slip rate that another one gives.
struct Slipping {
  ContactModel model;
  BreakdownMonitor monitor = BreakdownMonitor(3);
  double v_m_per_s = 0, slip_m = 0;
  bool slips = false;

  explicit Slipping(const FrictionLaw& law) : model{law} {}
  /// Updates node 1 alone: the node is driven so that it has the rate afterwards.
  template <class Coefficient>
  void go(double rate_m_per_s, Coefficient&& coefficient, double pressure_Pa = p_Pa) {
    const bool begins = !slips;
    slips = true;
    const double mean = 0.5 * (v_m_per_s + rate_m_per_s), cohesion_Pa = model.law.cohesion_Pa();
    const double mu = coefficient(mean, slip_m);
    const double strength_Pa = begins ? coefficient(0.0, 0.0) * pressure_Pa + cohesion_Pa : mu * pressure_Pa;
    const NodeFriction now{
        mu * pressure_Pa + cohesion_Pa, pressure_Pa, strength_Pa, cohesion_Pa, dt_s * mean, true};
    monitor.follow(
        dt_s, begins, [](std::size_t i) { return i == 1; }, [&](std::size_t) { return now; });
    slip_m += dt_s * mean;
    v_m_per_s = rate_m_per_s;
  }
  record::Breakdown found() const {
    return monitor.found(0, 3, [&](std::size_t) { return model.law.cohesion_Pa(); });
  }
};

/// A rate that rises and falls again, as behind a tip. @param n  updates
template <class Coefficient>
Slipping passed(const FrictionLaw& law, Coefficient&& coefficient, int n = 20000) {
  Slipping node(law);
  for (int k = 1; k <= n; ++k) node.go(2 * std::sqrt(k / 100.0) / (1 + k / 100.0), coefficient);
  return node;
}

TEST(Breakdown, LinearSlipWeakening) {
  const auto found = passed(linear, linear_mu).found();
  EXPECT_NEAR(found.work_J_per_m2[1], 0.5 * 0.2 * p_Pa * 2e-6, 1e-3);
  EXPECT_NEAR(found.distance_m[1], 2e-6, 2e-9);
  EXPECT_DOUBLE_EQ(found.peak_t_Pa[1], 0.6 * p_Pa);
  EXPECT_DOUBLE_EQ(found.residual_t_Pa[1], 0.4 * p_Pa);
  EXPECT_DOUBLE_EQ(found.residual_coefficient[1], 0.4);
  EXPECT_EQ(found.complete[1], 1);
  EXPECT_TRUE(std::isnan(found.work_J_per_m2[0]));
  EXPECT_EQ(found.complete[0], 0);
}

TEST(Breakdown, WithCohesion) {
  FrictionLaw law(linear);
  law.parameter("cohesion_Pa") = 1e6;
  Slipping node(law);
  for (int k = 1; k <= 10000; ++k) node.go(0.5, linear_mu);
  EXPECT_DOUBLE_EQ(node.found().peak_t_Pa[1], 0.6 * p_Pa + 1e6);
  EXPECT_NEAR(node.found().work_J_per_m2[1], 1.0, 1e-3);
  EXPECT_NEAR(node.found().residual_coefficient[1], 0.4, 1e-12);
}

TEST(Breakdown, PressureThatFallsIsNoBreakdown) {
  // The residual traction follows the pressure: what is lost at mu_k is heat.
  Slipping node(linear);
  for (int k = 1; k <= 20000; ++k) node.go(0.5, linear_mu, k < 8000 ? p_Pa : 0.5 * p_Pa);
  EXPECT_NEAR(node.found().work_J_per_m2[1], 1.0, 2e-3);
}

TEST(Breakdown, ExponentialWeakeningHasNoEndOfItsOwn) {
  const ExponentialSlipWeakening law{.mu_s = 0.6, .mu_k = 0.4, .d_c_m = 1e-6};
  const auto mu = [](double, double slip) { return 0.4 + 0.2 * std::exp(-slip / 1e-6); };
  const auto found = passed(law, mu, 400000).found();
  EXPECT_NEAR(found.work_J_per_m2[1], 0.2 * p_Pa * 1e-6, 5e-3);
  EXPECT_EQ(found.complete[1], 1);
}

TEST(Breakdown, OfRateWeakeningEndsWhereTheRateIsLargest) {
  const VelocityWeakening law;
  const auto mu = [](double speed, double) { return 0.4 + 0.2 / (1 + speed); };
  const auto found = passed(law, mu).found();
  EXPECT_NEAR(found.residual_coefficient[1], 0.4 + 0.2 / (1 + 1.0), 1e-4);  // at 1 m/s, to 0.1 % of the fall
  EXPECT_EQ(found.complete[1], 1);
  EXPECT_GT(found.work_J_per_m2[1], 0);
}

TEST(Breakdown, WithoutAFallThereIsNone) {
  const auto found = passed(Coulomb{}, [](double, double) { return 0.5; }).found();
  const auto risen = passed(Coulomb{}, [](double, double slip_m) { return 0.5 + 1e4 * slip_m; }).found();
  for (const auto& none : {found, risen}) {
    EXPECT_TRUE(std::isnan(none.work_J_per_m2[1]));
    EXPECT_TRUE(std::isnan(none.distance_m[1]));
    EXPECT_TRUE(std::isnan(none.time_s[1]));
    EXPECT_EQ(none.complete[1], 0);
  }
}

TEST(Breakdown, UnderWayIsNotComplete) {
  Slipping node(linear);
  for (int k = 1; k <= 1000; ++k) node.go(1, linear_mu);
  EXPECT_EQ(node.found().complete[1], 0);
  EXPECT_LT(node.found().work_J_per_m2[1], 0.5);
}

TEST(Breakdown, OpeningEndsIt) {
  Slipping node(linear);
  for (int k = 1; k <= 1000; ++k) node.go(1, linear_mu);
  const double work = node.found().work_J_per_m2[1];
  node.go(1, linear_mu, 0);
  node.go(1, linear_mu);
  EXPECT_EQ(node.found().work_J_per_m2[1], work);
}

/// A node at a growing slip rate, whose slip more than doubles between the first samples, beside one at rest.
TEST(Breakdown, OfSamplesFarApart) {
  record::History history;
  history.x_m = {0, 1};
  for (int k = 0; k <= 20; ++k) {
    const double time_s = k * 1e-7, slip_m = 1e6 * time_s * time_s;
    history.time_s.push_back(time_s);
    for (const bool slips : {true, false}) {
      const double mu = slips ? 0.6 - 0.2 * std::min(slip_m / 2.5e-7, 1.0) : 0.5;
      history.slip_m.push_back(slips ? slip_m : 0);
      history.slip_rate_m_per_s.push_back(slips ? 2e6 * time_s : 0);
      history.t_Pa.push_back(mu * p_Pa + 1e6);
      history.p_Pa.push_back(p_Pa);
    }
  }
  const auto found = breakdown_from_history(history, 1e-3, 1e6);
  // Linear in slip: trapezoids are exact.
  EXPECT_NEAR(found.work_J_per_m2[0], 0.5 * 0.2 * p_Pa * 2.5e-7, 1e-9);
  EXPECT_NEAR(found.peak_t_Pa[0], 0.6 * p_Pa + 1e6, 1e-3);
  EXPECT_NEAR(found.residual_coefficient[0], 0.4, 1e-12);
  EXPECT_EQ(found.complete[0], 1);
  EXPECT_TRUE(std::isnan(found.work_J_per_m2[1]));
}

}  // namespace
}  // namespace slipfront::interface
