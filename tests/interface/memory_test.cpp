// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using test::dt;
using test::impedance;
using test::pull;
using test::resting_node;
using test::rounding_Pa;

// Tolerances: tractions of 1e6 Pa through a velocity and back, a few roundings of 1e-16 each: 1e-8 Pa.

TEST(SlipMemory, SlipWeakensForGood) {
  const ContactModel model{SlipWeakening{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  EXPECT_DOUBLE_EQ(s.strength_Pa[0], 0.6e6);
  pull(s, 0.7e6, 1e6);
  EXPECT_TRUE(update_contact(model, dt, s));
  EXPECT_NEAR(s.t_Pa[0], 0.6e6, rounding_Pa);
  const double first = 0.1e6 / impedance * dt;  // 0.25 um
  EXPECT_NEAR(s.slip_m[0], first, 1e-20);
  // Back again: the path grows, whatever the direction.
  pull(s, -0.625e6, 1e6);
  update_contact(model, dt, s);
  EXPECT_NEAR(s.t_Pa[0], -(0.3 + 0.3 * 0.75) * 1e6, rounding_Pa);
  EXPECT_NEAR(s.slip_m[0], 2 * first, 1e-20);
  // It sticks and does not heal.
  pull(s, 0.1e6, 1e6);
  EXPECT_TRUE(update_contact(model, dt, s));
  EXPECT_EQ(s.slipping[0], 0);
  EXPECT_NEAR(s.slip_m[0], 2 * first, 1e-20);
  EXPECT_NEAR(s.strength_Pa[0], 0.45e6, rounding_Pa);
  pull(s, 0.46e6, 1e6);
  EXPECT_TRUE(update_contact(model, dt, s));
}

TEST(SlipMemory, HealingCountsAnewFromEachSticking) {
  const ContactModel model{SlipWeakeningHealing{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  pull(s, 1.6e6, 1e6);
  update_contact(model, dt, s);
  EXPECT_NEAR(s.slip_m[0], 2.5e-6, 1e-20);
  pull(s, 0.4e6, 1e6);
  update_contact(model, dt, s);
  EXPECT_NEAR(s.t_Pa[0], 0.3e6, rounding_Pa);
  pull(s, 0.2e6, 1e6);
  EXPECT_TRUE(update_contact(model, dt, s));
  EXPECT_EQ(s.slip_m[0], 0);
  EXPECT_NEAR(s.strength_Pa[0], 0.6e6, rounding_Pa);
  pull(s, 0.59e6, 1e6);
  EXPECT_FALSE(update_contact(model, dt, s));
}

TEST(SlipMemory, MotionInTheAirNeitherWeakensNorHeals) {
  const ContactModel model{SlipWeakeningHealing{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 1e-6}};
  auto s = resting_node(model, 1e6);
  pull(s, 0.7e6, 1e6);
  update_contact(model, dt, s);
  const double slip = s.slip_m[0];
  for (const double v : {3.0, 0.0}) {
    s.v_x_m_per_s[0] = v;
    s.v_y_m_per_s[0] = 0.1;
    update_contact(model, dt, s);
    EXPECT_EQ(s.p_Pa[0], 0);
    EXPECT_EQ(s.strength_Pa[0], 0);
    EXPECT_EQ(s.slip_m[0], slip);
  }
}

TEST(Intact, InterpolatesBetweenTheKineticCoefficientAndTheLaw) {
  const ContactModel model{VelocityWeakening{.mu_s = 1.3, .mu_k = 0.6, .alpha_m2_per_s2 = 0.1}};
  for (const double intact : {0.0, 0.25, 1.0}) {
    Interface s(1);
    s.mass_per_length_kg_m2[0] = test::mass;
    s.p_Pa[0] = 1e6;
    s.intact[0] = intact;
    start_contact(model, s);
    EXPECT_NEAR(s.strength_Pa[0], (0.6 + intact * 0.7) * 1e6, rounding_Pa);
    pull(s, 1.5e6, 1e6);
    update_contact(model, dt, s);
    const auto mu = [&](double v) { return 0.6 + intact * 0.7 * std::exp(-v * std::sqrt(7.0)); };
    EXPECT_NEAR(s.t_Pa[0], test::strength_under_way(mu, 0, 1.5e6, 1e6), rounding_Pa);
    const double rate = s.slip_rate_m_per_s[0];
    pull(s, 1.5e6, 1e6);
    update_contact(model, dt, s);
    EXPECT_NEAR(s.t_Pa[0], test::strength_under_way(mu, rate, 1.5e6, 1e6), rounding_Pa);
    // A node that sticks regains what is left of its static strength.
    pull(s, 0.1e6, 1e6);
    update_contact(model, dt, s);
    EXPECT_NEAR(s.strength_Pa[0], (0.6 + intact * 0.7) * 1e6, rounding_Pa);
  }
}

TEST(Intact, DoesNothingWhereTheLawDoesNotWeaken) {
  const ContactModel model{Coulomb{.mu = 0.4}};
  auto s = resting_node(model, 1e6);
  s.intact[0] = 0;
  pull(s, 1e6, 1e6);
  update_contact(model, dt, s);
  EXPECT_NEAR(s.t_Pa[0], 0.4e6, rounding_Pa);
}

}  // namespace
}  // namespace slipfront::interface
