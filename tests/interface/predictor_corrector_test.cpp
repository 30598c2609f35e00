// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

ContactModel with(const FrictionLaw& law) {
  return {law, {}, ContactAlgorithm::predictor_corrector};
}
const ContactModel model = with(weakening);

TEST(PredictorCorrector, ALandingNodeIsPutOntoThePlane) {
  auto s = resting_node(model, 0);
  s.initial_gap_m[0] = 0.3e-6;
  s.u_y_m[0] = -0.1e-6;
  move(model, s, 0.5, -0.19);  // stops just above
  EXPECT_EQ(s.v_y_m_per_s[0], -0.19);
  EXPECT_EQ(s.u_y_m[0], -0.1e-6);
  move(model, s, 0.5, -0.21);
  EXPECT_EQ(s.u_y_m[0] + dt * s.v_y_m_per_s[0], -0.3e-6);  // exactly
  EXPECT_EQ(s.v_y_m_per_s[0], 0);
  EXPECT_EQ(s.p_Pa[0], 0);
  EXPECT_EQ(s.t_Pa[0], 0);
  EXPECT_EQ(s.v_x_m_per_s[0], 0.5);
  EXPECT_EQ(s.slipping[0], 0);
  EXPECT_EQ(s.locked[0], 1);
  // From then on it is pressed and slips at the speed it has.
  EXPECT_TRUE(pull(model, s, 0.5 * impedance, 1e5));
  EXPECT_NEAR(s.p_Pa[0], 1e5, rounding_Pa);
  EXPECT_NEAR(s.t_Pa[0], 1e5 * weakening_mu(0.5), rounding_Pa);
}

TEST(PredictorCorrector, TakesTheCoefficientAtThePredictedSlipRate) {
  for (const double sign : {1.0, -1.0}) {
    auto s = resting_node(model, 1e6);
    EXPECT_TRUE(pull(model, s, sign * 1.5e6, 1e6));
    EXPECT_NEAR(s.t_Pa[0], sign * 1.3e6, rounding_Pa);
    const double v = 0.2e6 / impedance;
    EXPECT_NEAR(s.slip_rate_m_per_s[0], sign * v, 1e-15);
    EXPECT_NEAR(s.acceleration_m_per_s2[0], sign * v / dt, 1e-9);
    // v + a dt/2 = 1.5 v at the beginning of the next step.
    EXPECT_FALSE(pull(model, s, sign * 2e6, 1e6));
    EXPECT_NEAR(s.t_Pa[0], sign * 1e6 * weakening_mu(1.5 * v), rounding_Pa);
    EXPECT_EQ(s.slipping[0], 1);
  }
}

TEST(PredictorCorrector, SticksWhereTheVelocityWouldChangeItsSign) {
  const auto coulomb = with(Coulomb{.mu = 0.5});
  for (const double sign : {1.0, -1.0})
    for (const double t_stop : {0.4e6, -0.1e6, -0.9e6}) {
      auto s = resting_node(coulomb, 1e6);
      pull(coulomb, s, sign * 0.8e6, 1e6);
      ASSERT_EQ(s.slipping[0], 1);
      // Even where the trial drags it back by more than the strength, which the direct algorithm lets slip.
      EXPECT_TRUE(pull(coulomb, s, sign * t_stop, 1e6));
      EXPECT_EQ(s.v_x_m_per_s[0], 0);
      EXPECT_EQ(s.slipping[0], 0);
      EXPECT_NEAR(s.t_Pa[0], sign * t_stop, rounding_Pa);
      EXPECT_EQ(s.acceleration_m_per_s2[0], 0);
    }
}

TEST(PredictorCorrector, FrictionOpposesThePredictionAlsoWhereItHasTurned) {
  // v = 0.1 m/s, a dt/2 = -0.2 m/s: the node is taken to move back, so friction pushes it on.
  const auto coulomb = with(Coulomb{.mu = 0.5});
  auto s = resting_node(coulomb, 1e6);
  s.slip_rate_m_per_s[0] = 0.1;
  s.acceleration_m_per_s2[0] = -0.4 / dt;
  pull(coulomb, s, -0.8e6, 1e6);
  EXPECT_NEAR(s.t_Pa[0], -0.5e6, rounding_Pa);
  EXPECT_NEAR(s.v_x_m_per_s[0], -0.3e6 / impedance, 1e-15);
}

TEST(PredictorCorrector, WorksWithEachLawAndForm) {
  // From rest under constant drag mu_s p resists the first slipping step of the predictor-corrector, and what
  // a strength that follows at once has lost on the way that of the direct algorithm.
  for (const FrictionLaw& law : {FrictionLaw(weakening), FrictionLaw(Coulomb{}), FrictionLaw(SlipWeakening{}),
                                 FrictionLaw(SlipWeakeningHealing{})})
    for (const Relaxed relaxed : {Relaxed::none, Relaxed::strength, Relaxed::pressure})
      for (const auto algorithm : {ContactAlgorithm::direct, ContactAlgorithm::predictor_corrector}) {
        const ContactModel any{law, {.relaxed = relaxed, .length_m = 1e-6, .time_s = 1e-6}, algorithm};
        auto s = resting_node(any, 1e6);
        const double drag_Pa = (static_coefficient(law) + 0.1) * 1e6;
        EXPECT_TRUE(pull(any, s, drag_Pa, 1e6));
        const auto mu = [&](double v) { return friction_coefficient(law, v, 0); };
        const bool at_once = algorithm == ContactAlgorithm::direct && relaxed != Relaxed::strength;
        const double strength =
            at_once ? strength_under_way(mu, 0, drag_Pa, 1e6) : static_coefficient(law) * 1e6;
        const double v = (drag_Pa - strength) / impedance;
        EXPECT_NEAR(s.t_Pa[0], strength, rounding_Pa);
        EXPECT_NEAR(s.v_x_m_per_s[0], v, 1e-14);
        EXPECT_NEAR(s.slip_m[0], v * dt, 1e-20);
      }
}

TEST(PredictorCorrector, ObeysItsConditionsWhateverTheTrial) {
  slipfront::Random random(1);
  const int n = 10000;
  Interface s(n);
  for (int i = 0; i < n; ++i) {
    s.mass_per_length_kg_m2[i] = mass * (1.5 + random());
    s.locked[i] = i % 2 == 1;
    s.initial_gap_m[i] = i % 2 == 1 ? 0 : 0.5e-6 * (1 + random());
    s.v_x_m_per_s[i] = random();
    s.v_y_m_per_s[i] = random();
    s.slip_rate_m_per_s[i] = i % 3 == 0 ? 0 : random();
    s.acceleration_m_per_s2[i] = i % 3 == 0 ? 0 : random() / dt;
  }
  const Interface trial = s;
  update_contact(model, dt, s);
  int n_stick = 0, n_slip = 0, n_landed = 0, n_open = 0;
  for (int i = 0; i < n; ++i) {
    const double scale = s.mass_per_length_kg_m2[i] / dt;  // Pa per m/s
    const double rate = trial.slip_rate_m_per_s[i] + 0.5 * dt * trial.acceleration_m_per_s2[i];
    const double mu = weakening.evaluator()(std::abs(rate), 0);
    ASSERT_GE(s.p_Pa[i], 0);
    ASSERT_GE(s.initial_gap_m[i] + s.u_y_m[i] + dt * s.v_y_m_per_s[i], -1e-22);  // rounding of 1e-6 m
    ASSERT_NEAR(trial.v_x_m_per_s[i] - s.v_x_m_per_s[i], s.t_Pa[i] / scale, 1e-15);
    if (s.locked[i] == 0) {
      ++n_open;
      ASSERT_EQ(s.v_y_m_per_s[i], trial.v_y_m_per_s[i]);
      ASSERT_EQ(s.p_Pa[i], 0);
    } else if (trial.locked[i] == 0) {
      ++n_landed;
      ASSERT_EQ(s.p_Pa[i], 0);
      ASSERT_EQ(s.u_y_m[i], -s.initial_gap_m[i]);
    } else {
      ASSERT_EQ(s.v_y_m_per_s[i], 0);
      ASSERT_NEAR(s.p_Pa[i], -trial.v_y_m_per_s[i] * scale, 1e-15 * scale);
      if (s.slipping[i] != 0) {
        ++n_slip;
        ASSERT_NEAR(std::abs(s.t_Pa[i]), mu * s.p_Pa[i], 1e-15 * scale * 4);
        if (rate != 0) {
          ASSERT_GT(s.t_Pa[i] * rate, 0);
          ASSERT_GT(s.v_x_m_per_s[i] * rate, 0);
        }
      } else {
        ++n_stick;
        ASSERT_EQ(s.v_x_m_per_s[i], 0);
      }
    }
  }
  for (const int count : {n_stick, n_slip, n_landed, n_open}) EXPECT_GT(count, n / 20);
}

}  // namespace
}  // namespace slipfront::interface
