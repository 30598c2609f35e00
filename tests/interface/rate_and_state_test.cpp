// SPDX-License-Identifier: BSD-3-Clause
#include "interface/friction/rate_and_state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "interface/node.hpp"
#include "interface/node_laws.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

constexpr double p_Pa = 5e6;

double coefficient_of(const auto& law, double V, double psi) {
  return law.a * std::asinh(V / (2 * law.V0_m_per_s) * std::exp(psi / law.a));
}

TEST(RootOfTraction, SolvesItsEquationAtAllScales) {
  std::mt19937_64 random(1);
  const auto power_of_10 = [&](double from, double to) {
    return std::pow(10, std::uniform_real_distribution<double>(from, to)(random));
  };
  double worst = 0;
  for (int n = 0; n < 200000; ++n) {
    const double Y = power_of_10(-12, 5), k = power_of_10(-15, 6);
    const double s = std::uniform_real_distribution<double>(-20, 300)(random);
    const double y = root_of_traction(Y, k, s, std::log(Y / k));
    const double f = y + 2 * k * std::exp(-s) * std::sinh(y) - Y;
    const double slope = 1 + 2 * k * std::exp(-s) * std::cosh(y);
    ASSERT_GE(y, 0);
    ASSERT_LE(y, Y * (1 + 1e-15));
    worst = std::max(worst, std::abs(f / slope) / std::max(1.0, y));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(LogSlowing, SolvesItsEquationAtAllScales) {
  std::mt19937_64 random(1);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  int most_calls = 0;
  for (int n = 0; n < 20000; ++n) {
    const double a = std::pow(10, between(-4, 0)), u = between(-20, 60), k = std::pow(10, between(-8, 8));
    const double most = std::pow(10, between(-15, 3));
    int calls = 0;
    // a arsinh(exp(u) V)
    const auto mu = [&](double V) {
      ++calls;
      const double log_z = u + std::log(V > 1e-290 ? V : 1e-290);
      return a * (log_z > 20 ? log_z + std::log(2) : std::asinh(std::exp(log_z)));
    };
    const double d = log_slowing(mu, most, k, between(-10, 800));
    // As from one step to the next.
    calls = 0;
    ASSERT_NEAR(log_slowing(mu, most, k, d + 0.02), d, 1e-11 * d + 2e-18);  // each is off by 1e-18 at most
    most_calls = std::max(most_calls, calls);
    const double mu_there = mu(most * std::exp(-d)), slope = k * a + std::exp(-d);
    // 1e-18 of the slip rate is nothing.
    ASSERT_NEAR((k * mu_there + std::expm1(-d)) / slope, 0,
                1e-12 * std::max(d, std::min(1.0, k * mu_there)) + 1e-18);
  }
  EXPECT_LE(most_calls, 12);
}

/// Friction that stays at rest is not overcome by less.
TEST(LogSlowing, StopsWhereThereIsFrictionWithoutSlip) {
  const auto stops = [](double k) { return std::exp(-log_slowing([](double) { return 0.6; }, 1.0, k, 3.0)); };
  EXPECT_LT(stops(2), 1e-300);
  EXPECT_NEAR(stops(1), 0.4, 1e-14);
}

/// The aging law by its three functions alone.
template <class V>
struct ByItsFunctions {
  RateAndStateAging::Evaluator<V> law;
  using States = std::array<V, 1>;
  V coefficient(V speed_m_per_s, const States& states) const {
    return law.coefficient(speed_m_per_s, states);
  }
  States evolved(const States& states, V speed_m_per_s, double dt_s) const {
    return law.evolved(states, speed_m_per_s, dt_s);
  }
};

/// In lanes, from creep to fast slip, against Halley's steps.
TEST(LogSlowing, MovesANodeAsTheInverseOfTheArsinh) {
  const RateAndStateAging law;
  const auto in_all = in_lanes(FrictionLaw(law), law);
  const StateLawConstants<ByItsFunctions<SimdVector>, SimdVector> general{{in_all.law}, SimdVector{} + 0.1};
  auto known = in_all;
  known.tip_slip_rate_m_per_s = SimdVector{} + 0.1;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> power(-12, 1), part(-1, 1);
  Node<SimdVector, 1> n{};
  n.mass_per_length_kg_m2 = n.tangential_mass_ratio = n.strength_fraction = SimdVector{} + 1;
  n.mass_per_length_kg_m2 *= mass;
  n.law_states[0] = SimdVector{} + law.initial(2.5e6, p_Pa)[0];
  auto m = n;
  for (int step = 0; step < 300; ++step) {
    for (int k = 0; k < lanes; ++k) {
      n.v_x_m_per_s[k] = std::copysign(std::pow(10, power(random)), part(random)) + 2.6e6 / impedance;
      n.v_y_m_per_s[k] = -p_Pa * (1 + 0.1 * part(random)) / impedance;
    }
    m.v_x_m_per_s = n.v_x_m_per_s, m.v_y_m_per_s = n.v_y_m_per_s;
    const auto trial = n.v_x_m_per_s, last = n.slip_rate_m_per_s;
    update_node<ContactAlgorithm::direct, SlipMemory::none>(known, Immediate{}, dt, n);
    update_node<ContactAlgorithm::direct, SlipMemory::none>(general, Immediate{}, dt, m);
    for (int k = 0; k < lanes; ++k) {
      // w follows from a difference of mu, accurate to 1e-8: so much the places between the last rate and the
      // new one are off.
      ASSERT_NEAR(m.v_x_m_per_s[k], n.v_x_m_per_s[k],
                  2e-8 * (std::abs(n.v_x_m_per_s[k]) + std::abs(last[k])) + 1e-14 * std::abs(trial[k]));
      ASSERT_NEAR(m.t_Pa[k], n.t_Pa[k], 1e-8 * p_Pa);
      ASSERT_NEAR(m.law_states[0][k], n.law_states[0][k], 1e-9);
    }
    m = n;
  }
}

template <class Law>
class RateAndStateLaws : public testing::Test {};
using Laws = testing::Types<RateAndStateAging, RateAndStateSlip, RateAndStateStrong>;
TYPED_TEST_SUITE(RateAndStateLaws, Laws);

TYPED_TEST(RateAndStateLaws, StartWithTheGivenTractionAndSlipRate) {
  const TypeParam law;
  for (const double t_Pa : {2.65e6, 1e3, 4e6}) {
    const double psi = law.initial(t_Pa, p_Pa)[0];
    EXPECT_NEAR(coefficient_of(law, law.V_i_m_per_s, psi), t_Pa / p_Pa, 1e-13);
  }
  const double steady = law.initial(0, 0)[0];
  EXPECT_NEAR(coefficient_of(law, law.V_i_m_per_s, steady), static_coefficient(law), 1e-13);
}

TYPED_TEST(RateAndStateLaws, EvolveExactlyAtConstantSlipRate) {
  const TypeParam law;
  const auto e = law.evaluator();
  for (const double V : {1e-9, 1e-3, 2.0}) {
    // One long step is many short ones, and ends in steady sliding.
    const double long_s = 3 * law.d_c_m / V;
    double psi = 0.7;
    for (int n = 0; n < 100; ++n) psi = e.evolved(psi, V, long_s / 100);
    EXPECT_NEAR(psi, e.evolved(0.7, V, long_s), 1e-13);
    EXPECT_NEAR(e.evolved(0.7, V, 100 * long_s), e.steady_state(V), 1e-13);
    EXPECT_NEAR(coefficient_of(law, V, e.steady_state(V)), e.steady_coefficient(V), 1e-13);
  }
}

TEST(RateAndState, AgesByTheTimeAtRest) {
  const RateAndStateAging law;
  const auto e = law.evaluator();
  const auto theta_s = [&](double psi) {
    return law.d_c_m / law.V0_m_per_s * std::exp((psi - law.f0) / law.b);
  };
  EXPECT_NEAR(theta_s(e.evolved(0.65, 0, 4.0)), theta_s(0.65) + 4, 1e-11);
  const RateAndStateSlip slip;
  EXPECT_NEAR(slip.evaluator().evolved(0.65, 0, 4.0), 0.65, 1e-15);
}

/// With so small a b theta is beyond the range of doubles.
TEST(RateAndState, AgesWhateverTheAge) {
  for (const double b : {1e-3, 3e-4, 1e-6}) {
    RateAndStateAging law;
    law.b = b;
    const auto e = law.evaluator();
    EXPECT_NEAR(e.evolved(0.97, 1e-9, 1e-7), 0.97, 1e-12) << b;
    EXPECT_NEAR(e.evolved(0.97, 1.0, law.d_c_m), 0.97 - b, 1e-12) << b;
    EXPECT_NEAR(e.evolved(0.97, 1.0, 1e6 * law.d_c_m), e.steady_state(1), 1e-12) << b;
    EXPECT_NEAR(e.evolved(0.97, 0, 1), 0.97, 1e-12) << b;
  }
}

/// Where exp(psi/a) underflows there is no friction, and the motion stays finite.
TEST(RateAndState, ANodeWithoutFrictionGoesOn) {
  RateAndStateAging law;
  law.b = 10;
  const ContactModel model{law};
  auto s = Interface(1, model.law.states());
  s.mass_per_length_kg_m2[0] = mass;
  s.p_Pa[0] = 5e6;
  s.t_Pa[0] = 2.65e6;
  start_contact(model, s);
  s.law_states[0][0] = -100;
  for (int n = 0; n < 100; ++n) {
    pull(model, s, s.slip_rate_m_per_s[0] * impedance + 1e6, 5e6);
    EXPECT_NEAR(s.t_Pa[0], 0, 1e-6);
    EXPECT_NEAR(s.slip_rate_m_per_s[0], (n + 1) * 1e6 / impedance, 1e-9 * (n + 1));
  }
}

TEST(RateAndState, AVelocityStepJumpsByAAndFallsByB) {
  const double factor = 10, V = 1e-6;
  const RateAndStateSlip law;
  const auto e = law.evaluator();
  const double psi = e.steady_state(V);
  EXPECT_NEAR(coefficient_of(law, factor * V, psi) - e.steady_coefficient(V), law.a * std::log(factor),
              1e-12);
  for (const double slip_m : {0.1e-6, 0.4e-6, 2e-6}) {
    const double after = coefficient_of(law, factor * V, e.evolved(psi, factor * V, slip_m / (factor * V)));
    EXPECT_NEAR(after - e.steady_coefficient(factor * V),
                law.b * std::log(factor) * std::exp(-slip_m / law.d_c_m), 1e-12);
  }
}

TEST(RateAndState, FallsToFWBeyondVW) {
  const RateAndStateStrong law;
  const auto e = law.evaluator();
  EXPECT_NEAR(e.steady_coefficient(1e-6), 0.6, 1e-12);
  const double V = 1, low = 0.6 - 0.008 * std::log(V / 1e-6);
  EXPECT_NEAR(e.steady_coefficient(V), 0.2 + (low - 0.2) / std::pow(1 + 1e8, 0.125), 1e-12);
  EXPECT_NEAR(e.steady_coefficient(1e300), 0.2, 1e-9);
}

/// Nodes that are pushed to any slip rate, some of them open.
TYPED_TEST(RateAndStateLaws, BalanceTheNode) {
  const TypeParam law;
  const ContactModel model{law};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> power(-12, 1), part(-1, 1);
  Interface s(101, model.law.states());
  std::ranges::fill(s.mass_per_length_kg_m2, mass);
  std::ranges::fill(s.p_Pa, p_Pa);
  for (auto& t : s.t_Pa) t = 2.5e6;
  start_contact(model, s);
  for (int n = 0; n < 200; ++n) {
    const auto before = s;
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.v_x_m_per_s[i] = std::copysign(std::pow(10, power(random)), part(random)) + 2.6e6 / impedance;
      s.v_y_m_per_s[i] = -(i % 10 == 3 ? -1 : 1) * p_Pa * (1 + 0.1 * part(random)) / impedance;
    }
    const auto trial = s;
    update_contact(model, dt, s);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double t = s.t_Pa[i], v = s.v_x_m_per_s[i], psi = before.law_states[0][i];
      ASSERT_NEAR(t, (trial.v_x_m_per_s[i] - v) * impedance, 1e-7);
      ASSERT_NEAR(s.law_states[0][i], law.evaluator().evolved(psi, std::abs(v), dt), 1e-15);
      if (s.p_Pa[i] == 0) {
        ASSERT_EQ(t, 0);
        continue;
      }
      // t is that of a slip rate between those of both half-steps, nearer to the new one.
      const double V = std::copysign(
          2 * law.V0_m_per_s * std::exp(-psi / law.a) * std::sinh(std::abs(t) / (law.a * s.p_Pa[i])), t);
      const double last = before.slip_rate_m_per_s[i], middle = 0.5 * (last + v);
      const double rounding = 4e-15 * std::abs(trial.v_x_m_per_s[i]) + 1e-12 * (std::abs(V) + std::abs(last));
      ASSERT_GE(V, std::min(middle, v) - rounding) << i;
      ASSERT_LE(V, std::max(middle, v) + rounding) << i;
      ASSERT_GE(v * trial.v_x_m_per_s[i], -rounding * std::abs(trial.v_x_m_per_s[i]));
    }
  }
}

}  // namespace
}  // namespace slipfront::interface
