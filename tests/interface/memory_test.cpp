// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

TEST(SlipMemory, SlipWeakensForGood) {
  const ContactModel model{SlipWeakening{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  EXPECT_DOUBLE_EQ(s.strength_Pa[0], 0.6e6);
  EXPECT_TRUE(pull(model, s, 0.7e6, 1e6));
  EXPECT_NEAR(s.t_Pa[0], 0.6e6, rounding_Pa);
  const double first = 0.1e6 / impedance * dt;  // 0.25 um
  EXPECT_NEAR(s.slip_m[0], first, 1e-20);
  // Back again: the path grows, whatever the direction.
  pull(model, s, -0.625e6, 1e6);
  EXPECT_NEAR(s.t_Pa[0], -(0.3 + 0.3 * 0.75) * 1e6, rounding_Pa);
  EXPECT_NEAR(s.slip_m[0], 2 * first, 1e-20);
  // It sticks and does not heal.
  EXPECT_TRUE(pull(model, s, 0.1e6, 1e6));
  EXPECT_EQ(s.slipping[0], 0);
  EXPECT_NEAR(s.slip_m[0], 2 * first, 1e-20);
  EXPECT_NEAR(s.strength_Pa[0], 0.45e6, rounding_Pa);
  EXPECT_TRUE(pull(model, s, 0.46e6, 1e6));
}

TEST(SlipMemory, HealingCountsAnewFromEachSticking) {
  const ContactModel model{SlipWeakeningHealing{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  pull(model, s, 1.6e6, 1e6);
  EXPECT_NEAR(s.slip_m[0], 2.5e-6, 1e-20);
  pull(model, s, 0.4e6, 1e6);
  EXPECT_NEAR(s.t_Pa[0], 0.3e6, rounding_Pa);
  EXPECT_TRUE(pull(model, s, 0.2e6, 1e6));
  EXPECT_EQ(s.slip_m[0], 0);
  EXPECT_NEAR(s.strength_Pa[0], 0.6e6, rounding_Pa);
  EXPECT_FALSE(pull(model, s, 0.59e6, 1e6));
}

TEST(SlipMemory, MotionInTheAirNeitherWeakensNorHeals) {
  const ContactModel model{SlipWeakeningHealing{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  pull(model, s, 0.7e6, 1e6);
  const double slip = s.slip_m[0];
  for (const double v : {3.0, 0.0}) {
    move(model, s, v, 0.1);
    EXPECT_EQ(s.p_Pa[0], 0);
    EXPECT_EQ(s.strength_Pa[0], 0);
    EXPECT_EQ(s.slip_m[0], slip);
  }
}

TEST(Cohesion, AddsToTheStrengthInContact) {
  FrictionLaw law = SlipWeakening{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6};
  law.parameter(FrictionLaw::cohesion_key) = 0.2e6;
  for (const auto algorithm : {ContactAlgorithm::direct, ContactAlgorithm::predictor_corrector}) {
    const ContactModel model{law, {}, algorithm};
    auto s = resting_node(model, 1e6);
    EXPECT_EQ(s.strength_Pa[0], 0.8e6);
    pull(model, s, 0.79e6, 1e6);
    EXPECT_NEAR(s.t_Pa[0], 0.79e6, rounding_Pa);
    EXPECT_TRUE(pull(model, s, 5e6, 1e6));  // beyond d_c in one step
    pull(model, s, 5e6, 1e6);
    EXPECT_NEAR(s.t_Pa[0], 0.5e6, rounding_Pa);
    move(model, s, 1, 1);
    EXPECT_EQ(s.p_Pa[0], 0);
    EXPECT_EQ(s.t_Pa[0], 0);
    EXPECT_EQ(s.strength_Pa[0], 0);
  }
}

TEST(InitialPressure, DecidesOnTheStrengthInContact) {
  const ContactModel model{Coulomb{0.5}, {Relaxed::initial_pressure}};
  auto s = resting_node(model, 1e6);
  for (const double p_Pa : {3e6, 0.1e6}) {
    pull(model, s, 0.49e6, p_Pa);
    EXPECT_NEAR(s.t_Pa[0], 0.49e6, rounding_Pa);
    pull(model, s, 2e6, p_Pa);
    EXPECT_EQ(s.t_Pa[0], 0.5e6);
  }
  move(model, s, 1, 1);
  EXPECT_EQ(s.t_Pa[0], 0);
  pull(model, s, 2e6, 1e6);
  EXPECT_EQ(s.t_Pa[0], 0.5e6);
}

/// However steeply friction rises with the slip rate against the node's impedance, the node comes to the
/// balance of force and friction without swinging about it.
TEST(Strengthening, ASteepLawComesToItsBalance) {
  for (const double alpha : {1e-2, 1e-6, 1e-10}) {
    const VelocityWeakening law{.mu_s = 0.5, .mu_k = 0.9, .alpha_m2_per_s2 = alpha};
    const ContactModel model{law};
    auto s = resting_node(model, 1e6);
    const double force_Pa = 0.7e6, scale = std::sqrt(alpha / 0.4);
    const double balance = scale * std::log(2.0);  // mu = 0.9 - 0.4/2
    double v = 0;
    for (int k = 0; k < 4000; ++k) {
      const double before = v;
      pull(model, s, v * impedance + force_Pa, 1e6);
      v = s.slip_rate_m_per_s[0];
      EXPECT_GE(v, before - 1e-3 * balance) << alpha << ", step " << k;
      EXPECT_LT(v, 1.05 * balance) << alpha << ", step " << k;
    }
    EXPECT_NEAR(v, balance, 1e-9 * balance) << alpha;
    EXPECT_NEAR(s.t_Pa[0], force_Pa, 1) << alpha;
  }
}

TEST(Intact, InterpolatesBetweenTheKineticCoefficientAndTheLaw) {
  const ContactModel model{weakening};
  for (const double strength_fraction : {0.0, 0.25, 1.0}) {
    auto s = one_node();
    s.p_Pa[0] = 1e6;
    s.strength_fraction[0] = strength_fraction;
    start_contact(model, s);
    const double static_Pa = (0.6 + strength_fraction * 0.7) * 1e6;
    EXPECT_NEAR(s.strength_Pa[0], static_Pa, rounding_Pa);
    const auto mu = [&](double v) { return 0.6 + strength_fraction * (weakening_mu(v) - 0.6); };
    for (int k = 0; k < 2; ++k) {
      const double rate = s.slip_rate_m_per_s[0];
      pull(model, s, 1.5e6, 1e6);
      EXPECT_NEAR(s.t_Pa[0], strength_under_way(mu, rate, 1.5e6, 1e6), rounding_Pa);
    }
    // A node that sticks regains what is left of its static strength.
    pull(model, s, 0.1e6, 1e6);
    EXPECT_NEAR(s.strength_Pa[0], static_Pa, rounding_Pa);
  }
}

TEST(Intact, LimitsTheCoefficientOfANodeThatIsForced) {
  const ContactModel model{SlipWeakening{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  for (const double strength_fraction : {0.0, 0.5, 1.0}) {
    auto s = one_node();
    s.p_Pa[0] = 1e6;
    s.strength_fraction[0] = strength_fraction;
    s.is_time_weakening = true;
    start_contact(model, s);
    const double most_Pa = (0.3 + strength_fraction * 0.3) * 1e6;
    EXPECT_NEAR(s.strength_Pa[0], most_Pa, rounding_Pa);
    for (const double slip_m : {0.2e-6, 0.8e-6}) {
      s.slip_m[0] = slip_m;
      pull(model, s, 0.9e6, 1e6);
      EXPECT_NEAR(s.t_Pa[0], std::min(most_Pa, (0.6 - 0.3 * slip_m / 1e-6) * 1e6), rounding_Pa);
    }
  }
}

}  // namespace
}  // namespace slipfront::interface
