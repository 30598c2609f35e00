// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

TEST(Regularisation, RateAddsSlipRateAndTime) {
  EXPECT_DOUBLE_EQ(relaxation_rate_per_s({Relaxed::strength, 2e-6, 0.5, 1e-6}, 1.5), 2e6);
  EXPECT_DOUBLE_EQ(relaxation_rate_per_s({.relaxed = Relaxed::strength, .time_s = 2e-6}, 1.5), 0.5e6);
  EXPECT_EQ(relaxation_rate_per_s({.relaxed = Relaxed::strength, .length_m = 1e-6}, 0), 0);
}

TEST(Regularisation, AStepOfPressureIsForgottenExponentially) {
  // Under a constant coefficient both forms are mu (p + (p_0 - p) exp(-t/t*)), exactly, whatever the step.
  const double before = 1e6, t_star = 3e-6;
  for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure})
    for (const double after : {before, 2.5e6})
      for (const double step : {0.25e-6, 1e-6, 5e-6}) {
        const ContactModel model{Coulomb{.mu = 0.5}, {.relaxed = relaxed, .time_s = t_star}};
        auto s = resting_node(model, before);
        EXPECT_DOUBLE_EQ(s.relaxed_Pa[0], relaxed == Relaxed::strength ? 0.5e6 : 1e6);
        const double Z = mass / step;
        for (int k = 1; k <= 20; ++k) {
          s.v_x_m_per_s[0] = 2e6 / Z;
          s.v_y_m_per_s[0] = -after / Z;
          update_contact(model, step, s);
          // The first update is at time 0.
          EXPECT_NEAR(s.t_Pa[0], 0.5 * (after + (before - after) * std::exp(-(k - 1) * step / t_star)),
                      rounding_Pa);
          EXPECT_EQ(s.strength_Pa[0], s.t_Pa[0]);
          EXPECT_NEAR(s.p_Pa[0], after, rounding_Pa);  // the pressure itself is not delayed
        }
      }
}

TEST(Regularisation, SlipSetsThePaceWhereThereIsALength) {
  // At slip rates v_k the strength has come nearer to mu p by exp(-sum (v_k + v*) dt/L).
  const Regularisation r{Relaxed::strength, 4e-6, 0.125, std::numeric_limits<double>::infinity()};
  const ContactModel model{Coulomb{.mu = 0.5}, r};
  auto s = resting_node(model, 1e6);
  double exponent = 0;
  for (int k = 0; k < 10; ++k) {
    if (k > 0) exponent += (std::abs(s.slip_rate_m_per_s[0]) + 0.125) * dt / 4e-6;
    pull(model, s, (k % 2 == 0 ? 1 : -1) * 1.5e6, 2e6);
    EXPECT_NEAR(std::abs(s.t_Pa[0]), 0.5 * (2e6 - 1e6 * std::exp(-exponent)), rounding_Pa);
  }
  EXPECT_GT(exponent, 1);
}

TEST(Regularisation, AnInstantScaleIsThePlainLaw) {
  // In double precision nothing is left of the past, and the target is not lagged behind.
  for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure}) {
    const ContactModel plain{weakening};
    const ContactModel model{weakening, {.relaxed = relaxed, .time_s = dt / 1e300}};
    auto a = resting_node(plain, 1e6), b = resting_node(model, 1e6);
    pull(plain, a, 0.1e6, 1e6);  // at time 0, still at rest
    pull(model, b, 0.1e6, 1e6);
    for (int k = 0; k < 50; ++k) {
      const double t = 1e6 * (1 + std::sin(0.7 * k)), p = 1e6 * (0.3 + std::cos(0.3 * k));
      EXPECT_EQ(pull(plain, a, t, p), pull(model, b, t, p)) << k;
      EXPECT_EQ(a.t_Pa, b.t_Pa) << k;
      EXPECT_EQ(a.v_x_m_per_s, b.v_x_m_per_s) << k;
      EXPECT_EQ(a.slipping, b.slipping) << k;
    }
  }
}

TEST(Regularisation, AStuckNodeRegainsItsStaticStrength) {
  // Both slip to nearly mu_k p, then stick. With the relaxed strength the static one comes back with time;
  // with the relaxed pressure at once.
  for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure}) {
    const ContactModel model{weakening, {.relaxed = relaxed, .time_s = dt}};
    auto s = resting_node(model, 1e6);
    for (int k = 0; k < 60; ++k) {
      pull(model, s, 50e6, 1e6);  // more than 100 m/s: mu is mu_k, also at half of it
    }
    EXPECT_NEAR(s.strength_Pa[0], 0.6e6, 1e-4);
    pull(model, s, 0.1e6, 1e6);
    ASSERT_EQ(s.slipping[0], 0);
    const double S = s.strength_Pa[0];
    EXPECT_NEAR(S, relaxed == Relaxed::strength ? 0.6e6 : 1.3e6, 1e-4);
    // The target rises to mu_s p within one step, then stays.
    pull(model, s, 0.1e6, 1e6);
    const double next = 1.3e6 + (S - 1.3e6) * (1 - std::exp(-1));
    EXPECT_NEAR(s.strength_Pa[0], next, rounding_Pa);
    pull(model, s, 0.1e6, 1e6);
    EXPECT_NEAR(s.strength_Pa[0], 1.3e6 + (next - 1.3e6) * std::exp(-1), rounding_Pa);
  }
}

TEST(Regularisation, AStuckNodeWithoutARateAtRestKeepsItsStrength) {
  const ContactModel model{weakening, {.relaxed = Relaxed::strength, .length_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  for (const double p : {2e6, 0.5e6}) {
    EXPECT_FALSE(pull(model, s, 1.2e6, p));
    EXPECT_NEAR(s.strength_Pa[0], 1.3e6, rounding_Pa);
  }
}

TEST(Regularisation, AnOpenNodeHasNoStrengthAndForgetsAtTheSameRate) {
  for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure}) {
    const ContactModel model{Coulomb{.mu = 0.5}, {.relaxed = relaxed, .time_s = 2 * dt}};
    auto s = resting_node(model, 1e6);
    const double start = s.relaxed_Pa[0];
    for (int k = 1; k <= 3; ++k) {
      move(model, s, 0.01, 0.1);
      EXPECT_EQ(s.t_Pa[0], 0);
      EXPECT_EQ(s.strength_Pa[0], 0);
      EXPECT_EQ(s.slipping[0], 0);
      EXPECT_EQ(s.v_x_m_per_s[0], 0.01);
      EXPECT_NEAR(s.relaxed_Pa[0], start * std::exp(-0.5 * (k - 1)), rounding_Pa);
    }
    // A heavy impact does not raise the strength at once.
    pull(model, s, 5e6, 10e6);
    const double lag = (1 - std::exp(-0.5)) / 0.5;
    const double q = 10e6 * (1 - lag) + 1e6 * std::exp(-1.5);
    EXPECT_NEAR(s.t_Pa[0], 0.5 * q, 10 * rounding_Pa);
  }
}

TEST(Regularisation, AWeakenedPatchLosesItsStrengthAtTheFormsOwnPace) {
  for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure}) {
    const ContactModel model{weakening, {.relaxed = relaxed, .time_s = dt}};
    auto s = resting_node(model, 1e6);
    s.strength_fraction[0] = 0;
    for (int k = 0; k < 2; ++k) {  // the first at time 0
      pull(model, s, 0.5e6, 1e6);
    }
    const double expected = relaxed == Relaxed::strength ? 0.6e6 + 0.7e6 * std::exp(-1) : 0.6e6;
    EXPECT_NEAR(s.strength_Pa[0], expected, rounding_Pa);
  }
}

}  // namespace
}  // namespace slipfront::interface
