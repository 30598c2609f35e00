// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/random.hpp"
#include "interface/interface.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

const ContactModel model{weakening};

TEST(Contact, FrictionStopsANodeWhereItCan) {
  for (const double sign : {1.0, -1.0}) {
    auto s = one_node();
    EXPECT_FALSE(pull(model, s, sign * 1.2e6, 1e6));
    EXPECT_NEAR(s.p_Pa[0], 1e6, 1e-8);
    EXPECT_NEAR(s.t_Pa[0], sign * 1.2e6, 1e-8);
    EXPECT_NEAR(s.onset_ratio[0], 1.2 / 1.3, 1e-14);
    EXPECT_EQ(s.v_x_m_per_s[0], 0);
    EXPECT_EQ(s.slip_rate_m_per_s[0], 0);
    EXPECT_EQ(s.slipping[0], 0);
    EXPECT_NEAR(s.v_y_m_per_s[0], 0, 1e-15);
  }
}

TEST(Contact, ANodeBeyondItsStrengthSlipsAgainstTheTraction) {
  for (const double sign : {1.0, -1.0}) {
    auto s = one_node();
    EXPECT_TRUE(pull(model, s, sign * 1.5e6, 1e6));
    // It weakens as it begins to move.
    const double first = strength_under_way(weakening_mu, 0, 1.5e6, 1e6);
    EXPECT_LT(first, 1.2e6);
    EXPECT_NEAR(s.t_Pa[0], sign * first, 1e-8);
    EXPECT_NEAR(s.onset_ratio[0], 1.5 / 1.3, 1e-14);
    EXPECT_EQ(s.slipping[0], 1);
    EXPECT_NEAR(s.v_x_m_per_s[0], sign * (1.5e6 - first) / impedance, 1e-14);
    EXPECT_EQ(s.slip_rate_m_per_s[0], s.v_x_m_per_s[0]);

    // The next step knows the slip rate.
    const double rate = std::abs(s.slip_rate_m_per_s[0]);
    EXPECT_FALSE(pull(model, s, sign * 1.4e6, 1e6));
    EXPECT_NEAR(s.t_Pa[0], sign * strength_under_way(weakening_mu, rate, 1.4e6, 1e6), 1e-7);
    EXPECT_EQ(s.slipping[0], 1);
  }
}

TEST(Contact, ASlippingNodeSticksAgainAndRegainsItsStrength) {
  auto s = one_node();
  EXPECT_TRUE(pull(model, s, 1.5e6, 1e6));
  EXPECT_TRUE(pull(model, s, 0.5e6, 1e6));  // the weakened strength can stop it now
  EXPECT_EQ(s.slipping[0], 0);
  EXPECT_EQ(s.slip_rate_m_per_s[0], 0);
  EXPECT_NEAR(s.t_Pa[0], 0.5e6, 1e-8);
  // Above mu_k p and the strength at the old slip rate, but below mu_s p.
  EXPECT_FALSE(pull(model, s, 1.29e6, 1e6));
  EXPECT_EQ(s.slipping[0], 0);
}

TEST(Contact, ASeparatingNodeIsReleased) {
  auto s = one_node();
  pull(model, s, 1.5e6, 1e6);
  ASSERT_EQ(s.slipping[0], 1);
  EXPECT_TRUE(move(model, s, 0.3, 0.1));  // it ceases to slip by leaving the plane
  EXPECT_EQ(s.p_Pa[0], 0);
  EXPECT_EQ(s.t_Pa[0], 0);
  EXPECT_EQ(s.slipping[0], 0);
  EXPECT_EQ(s.v_x_m_per_s[0], 0.3);
  EXPECT_EQ(s.v_y_m_per_s[0], 0.1);
  EXPECT_FALSE(update_contact(model, dt, s));
}

TEST(Contact, AGapClosesExactlyAtTheStepsEnd) {
  auto s = one_node();
  s.initial_gap_m[0] = 3e-7;
  s.u_y_m[0] = -2e-7;
  move(model, s, 0, -0.5);  // would go 0.4 um below the plane
  EXPECT_NEAR(s.p_Pa[0], 0.4 * impedance, 1e-8);
  const double gap = s.initial_gap_m[0] + s.u_y_m[0] + dt * s.v_y_m_per_s[0];
  EXPECT_NEAR(gap, 0, 1e-22);  // rounding of 1e-7

  // In contact at rest afterwards.
  s.u_y_m[0] += dt * s.v_y_m_per_s[0];
  move(model, s, s.v_x_m_per_s[0], -0.01);
  EXPECT_NEAR(s.p_Pa[0], 0.01 * impedance, 1e-8);
  EXPECT_NEAR(s.v_y_m_per_s[0], 0, 1e-15);
}

TEST(Contact, AReturningNodeSlipsAtTheSpeedItHas) {
  auto s = one_node();
  move(model, s, 2, 0.1);  // in the air: moves at 2 m/s
  s.u_y_m[0] += dt * s.v_y_m_per_s[0];
  EXPECT_TRUE(move(model, s, 2, -1));
  EXPECT_EQ(s.slipping[0], 1);
  EXPECT_NEAR(s.p_Pa[0], 0.9 * impedance, 1e-8);
  const double strength = strength_under_way(weakening_mu, 2, 2 * impedance, s.p_Pa[0]);
  EXPECT_NEAR(s.t_Pa[0], strength, 1e-12 * strength);
}

TEST(Contact, FrictionThatWeakensWithTheRateIsOfSecondOrderInTheStep) {
  // m dv/dt = T - mu(v) p of a sliding node under a constant drag, against the same with steps 64 times
  // finer.
  const double p = 1e6, T = 1.25e6, end = 8e-6, start = 0.05;
  const auto final_rate = [&](int n) {
    const double step = end / n;
    auto s = one_node();
    s.slip_rate_m_per_s[0] = start;
    // Kicks of half a step first and last, so that all runs go from time 0 to the end.
    for (int k = 0; k <= n; ++k) {
      const double kick = k == 0 || k == n ? step / 2 : step;
      s.v_x_m_per_s[0] = s.slip_rate_m_per_s[0] + kick * T / mass;
      s.v_y_m_per_s[0] = -p * kick / mass;
      update_contact(model, kick, s);
    }
    return s.slip_rate_m_per_s[0];
  };
  const double exact = final_rate(64 * 256);
  EXPECT_GT(exact, 2);  // the node gets much faster and weaker on the way
  const double coarse = std::abs(final_rate(128) - exact), fine = std::abs(final_rate(256) - exact);
  EXPECT_GT(coarse, 1e-6);
  // 2, but for the next term of the error.
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.25);
}

TEST(Contact, TellsWhetherAnyNodeChanged) {
  // Two changes in one step must not cancel; nor may one that begins while another ceases.
  using Flags = std::vector<std::uint8_t>;
  Interface s(3);
  s.mass_per_length_kg_m2.assign(3, mass);
  for (const auto& [drag_Pa, expected] : {std::pair(std::vector{1.5e6, 0.5e6, 1.5e6}, Flags{1, 0, 1}),
                                          std::pair(std::vector{0.1e6, 2e6, 2e6}, Flags{0, 1, 1})}) {
    for (std::size_t i = 0; i < 3; ++i) s.v_x_m_per_s[i] = drag_Pa[i] / impedance;
    s.v_y_m_per_s.assign(3, -1e6 / impedance);
    EXPECT_TRUE(update_contact(model, dt, s));
    EXPECT_EQ(s.slipping, expected);
  }
}

TEST(Contact, ObeysItsConditionsWhateverTheTrial) {
  // Signorini's and Coulomb's conditions at the step's end, and friction that never drives.
  slipfront::Random random(1);
  const int n = 10000;
  Interface s(n);
  for (int i = 0; i < n; ++i) {
    s.mass_per_length_kg_m2[i] = mass * (1.5 + random());
    s.initial_gap_m[i] = i % 2 == 0 ? 0 : 0.5e-6 * (1 + random());
    s.v_x_m_per_s[i] = random();
    s.v_y_m_per_s[i] = random();
    s.slip_rate_m_per_s[i] = i % 3 == 0 ? 0 : random();
    s.slipping[i] = i % 3 == 1;
  }
  const Interface trial = s;
  update_contact(model, dt, s);
  int n_stick = 0, n_slip = 0, n_open = 0;
  for (int i = 0; i < n; ++i) {
    const double scale = s.mass_per_length_kg_m2[i] / dt;  // Pa per m/s
    const double gap_rate = s.initial_gap_m[i] / dt + s.v_y_m_per_s[i];
    ASSERT_GE(s.p_Pa[i], 0);
    ASSERT_GE(gap_rate, -1e-15);
    ASSERT_LE(s.p_Pa[i] * gap_rate, 1e-15 * scale * 2);
    // Between mu_k p and mu_s p, whatever the slip rate.
    ASSERT_LE(std::abs(s.t_Pa[i]), 1.3 * s.p_Pa[i] * (1 + 1e-15));
    ASSERT_GE(s.t_Pa[i] * s.v_x_m_per_s[i], 0);
    // Momentum: the tractions are what changed the trial velocity.
    ASSERT_NEAR(trial.v_x_m_per_s[i] - s.v_x_m_per_s[i], s.t_Pa[i] / scale, 1e-15);
    ASSERT_NEAR(s.v_y_m_per_s[i] - trial.v_y_m_per_s[i], s.p_Pa[i] / scale, 4e-15);
    if (s.p_Pa[i] == 0) {
      ++n_open;
      ASSERT_EQ(s.slipping[i], 0);
    } else if (s.slipping[i] != 0) {
      ++n_slip;
      ASSERT_GE(std::abs(s.t_Pa[i]), 0.6 * s.p_Pa[i] * (1 - 1e-15));
      // A node that begins to slip tells the strength that it has overcome.
      if (trial.slipping[i] != 0) {
        ASSERT_EQ(std::abs(s.t_Pa[i]), s.strength_Pa[i]);
      } else if (trial.slip_rate_m_per_s[i] == 0) {
        ASSERT_EQ(s.strength_Pa[i], 1.3 * s.p_Pa[i]);
      }
    } else {
      ++n_stick;
      ASSERT_EQ(s.v_x_m_per_s[i], 0);
    }
  }
  for (const int count : {n_stick, n_slip, n_open}) EXPECT_GT(count, n / 10);
}

}  // namespace
}  // namespace slipfront::interface
