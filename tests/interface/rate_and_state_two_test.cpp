// SPDX-License-Identifier: BSD-3-Clause
#include "interface/friction/rate_and_state_two.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

constexpr double p_Pa = 5e6;

TEST(RateAndStateTwo, StartsWithTheGivenTractionAndSlipRate) {
  const RateAndStateAgingTwo law;
  const auto e = law.evaluator();
  for (const double t_Pa : {2.65e6, 1e3, 4e6})
    EXPECT_NEAR(e.coefficient(law.V_i_m_per_s, law.initial(t_Pa, p_Pa)), t_Pa / p_Pa, 1e-13);
  // Without t in steady sliding: f0 + (a - b1 - b2) ln(V_i/V0).
  EXPECT_NEAR(e.coefficient(law.V_i_m_per_s, law.initial(0, p_Pa)), 0.6 + 0.008 * std::log(1e3), 1e-13);
  EXPECT_NEAR(static_coefficient(law), 0.6 + 0.008 * std::log(1e3), 1e-13);
}

TEST(RateAndStateTwo, AVelocityStepJumpsByAAndFallsByEachB) {
  const RateAndStateAgingTwo law;
  const auto e = law.evaluator();
  const double V = 1e-6, factor = 10;
  const auto before = steady_states(law, V);
  const double first = e.coefficient(V, before);
  EXPECT_NEAR(first, law.f0, 1e-13);
  for (const double slip_m : {0.0, 0.1e-6, 1e-6, 5e-6, 1e-3}) {
    const auto of = [&](double b, double d_c_m) {
      return b * std::log(1 / factor + (1 - 1 / factor) * std::exp(-slip_m / d_c_m));
    };
    const auto after = e.evolved(before, factor * V, slip_m / (factor * V));
    EXPECT_NEAR(e.coefficient(factor * V, after) - first,
                law.a * std::log(factor) + of(law.b1, law.d_c1_m) + of(law.b2, law.d_c2_m), 1e-13);
  }
}

/// Two states over one d_c are one with b1 + b2.
TEST(RateAndStateTwo, WithOneDcIsTheAgingLaw) {
  RateAndStateAgingTwo law;
  law.d_c2_m = law.d_c1_m;
  const RateAndStateAging one{{}, law.a, law.b1 + law.b2, law.d_c1_m};
  const ContactModel model{law}, of_one{one};
  Interface s(1, model.law.states()), expected(1, of_one.law.states());
  for (auto* node : {&s, &expected}) {
    node->mass_per_length_kg_m2[0] = mass;
    node->t_Pa[0] = 2.5e6;
    node->p_Pa[0] = p_Pa;
  }
  start_contact(model, s), start_contact(of_one, expected);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> power(-12, 1), part(-1, 1);
  for (int n = 0; n < 300; ++n) {
    const double v = std::copysign(std::pow(10, power(random)), part(random)) + 2.6e6 / impedance;
    const double v_y = -p_Pa * (1 + 0.1 * part(random)) / impedance;
    move(model, s, v, v_y), move(of_one, expected, v, v_y);
    ASSERT_NEAR(s.t_Pa[0], expected.t_Pa[0], 1e-12 * p_Pa);
    ASSERT_NEAR(s.law_states[0][0] + s.law_states[1][0], expected.law_states[0][0], 1e-13);
  }

  // What is told of it follows by differences.
  const auto found = *state_response(law, 0), known = *state_response(one, 0);
  EXPECT_EQ(found.a, known.a);
  EXPECT_NEAR(found.b, known.b, 1e-10);
  EXPECT_NEAR(found.d_c_m, known.d_c_m, 1e-3 * known.d_c_m);  // of a step of 1e-3
  EXPECT_NEAR(found.breakdown_per_m, known.breakdown_per_m, 1e-3 * known.breakdown_per_m);
  const auto breakdown = *state_breakdown(law, 2.5e6, p_Pa, 1),
             of_known = *state_breakdown(one, 2.5e6, p_Pa, 1);
  EXPECT_NEAR(breakdown.energy_over_pressure_m / of_known.energy_over_pressure_m, 1, 1e-3);
  EXPECT_NEAR(breakdown.residual_coefficient, of_known.residual_coefficient, 1e-12);
}

}  // namespace
}  // namespace slipfront::interface
