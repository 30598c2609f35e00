// SPDX-License-Identifier: BSD-3-Clause
#include "interface/quasi_dynamic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/numbers.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "interface/friction/rate_and_state_two.hpp"

namespace slipfront::interface {
namespace {

constexpr double damping = 1.07e6;

template <class Law>
class QuasiDynamicLaws : public testing::Test {};
using Laws = testing::Types<RateAndStateAging, RateAndStateSlip, RateAndStateStrong>;
TYPED_TEST_SUITE(QuasiDynamicLaws, Laws);

TYPED_TEST(QuasiDynamicLaws, BalanceTheTractionByFrictionAndRadiation) {
  const TypeParam law;
  std::mt19937_64 random(1);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  const std::size_t n = 1000;
  std::vector<double> t_Pa, p_Pa, psi, V(n);
  LawStates states_per_s(1, V);
  for (std::size_t k = 0; k < n; ++k) {
    p_Pa.push_back(std::pow(10, between(4, 8)));
    psi.push_back(between(0.2, 0.9));
    t_Pa.push_back(between(-1, 1) * p_Pa.back());
  }
  QuasiDynamicFriction friction({law}, n, damping);
  friction.balance(t_Pa, p_Pa, {psi}, nan, V, states_per_s);
  const auto& psi_per_s = states_per_s[0];
  for (std::size_t k = 0; k < n; ++k) {
    const double u = std::log(std::abs(V[k]) / (2 * law.V0_m_per_s)) + psi[k] / law.a;
    const double asinh = u > 20 ? u + std::log(2) : std::asinh(std::exp(u));
    const double borne_Pa = std::copysign(law.a * p_Pa[k] * asinh, V[k]) + damping * V[k];
    EXPECT_NEAR(borne_Pa, t_Pa[k], 1e-11 * p_Pa[k]) << k;
    // Over so short a time that psi hardly changes; the error of the difference is of second order in it.
    const double rate = std::abs(V[k]) / law.d_c_m + std::abs(psi_per_s[k]) / law.b;
    const double short_s = 1e-6 / rate;
    const double change = law.evaluator().evolved(psi[k], std::abs(V[k]), short_s) - psi[k];
    EXPECT_NEAR(psi_per_s[k], change / short_s, 1e-5 * law.b * rate + 1e-15 / short_s) << k;
  }
}

TEST(QuasiDynamicFriction, RestsWithoutPressureAndWithoutTraction) {
  const QuasiDynamicFriction friction({RateAndStateAging{}}, 2, damping);
  const std::vector<double> t_Pa = {1e6, 0}, p_Pa = {0, 5e6};
  std::vector<double> V(2, 1);
  LawStates per_s(1, V);
  friction.balance(t_Pa, p_Pa, {{0.6, 0.6}}, nan, V, per_s);
  EXPECT_EQ(V, (std::vector<double>{0, 0}));
  for (const double rate : per_s[0]) EXPECT_GT(rate, 0);  // the surfaces age
}

/// The law with two states as functions over all nodes.
StateArrayLaw functions_of(const RateAndStateAgingTwo& law, std::size_t n) {
  const auto at = [](const LawStates& states, std::size_t i) {
    return std::array<double, 2>{states[0][i], states[1][i]};
  };
  StateArrayLaw functions;
  functions.coefficient = [=, e = law.evaluator()](auto V, const LawStates& states, auto mu) {
    for (std::size_t i = 0; i < n; ++i) mu[i] = e.coefficient(V[i], at(states, i));
  };
  functions.evolve = [=, e = law.evaluator()](auto V, double dt_s, LawStates& states) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto after = e.evolved(at(states, i), V[i], dt_s);
      states[0][i] = after[0], states[1][i] = after[1];
    }
  };
  return functions;
}

/// By the solve for any law, and by differences over a short time.
TEST(QuasiDynamicFriction, OfFunctionsIsThatOfTheLaw) {
  const std::size_t n = 200;
  RateAndStateAgingTwo law;
  FrictionLaw functions = law;
  functions.set_function(functions_of(law, n));
  const QuasiDynamicFriction known({law}, n, damping), general({functions}, n, damping);
  EXPECT_EQ(general.initial_states(), known.initial_states());
  EXPECT_EQ(general.a(), known.a());
  EXPECT_EQ(general.d_c_m(), known.d_c_m());
  const auto one = [](std::size_t) { return 1.0; };
  EXPECT_NEAR(general.change(3, one) / known.change(3, one), 1, 1e-6);
  std::mt19937_64 random(1);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  std::vector<double> t_Pa, p_Pa, V(n), V_known(n);
  LawStates states(2), per_s(2, V), per_s_known(2, V);
  for (std::size_t k = 0; k < n; ++k) {
    p_Pa.push_back(k % 10 == 0 ? 0 : std::pow(10, between(4, 8)));
    t_Pa.push_back(between(-1, 1) * p_Pa.back());
    states[0].push_back(between(0.3, 0.7)), states[1].push_back(between(-0.1, 0.1));
  }
  for (int repeat = 0; repeat < 2; ++repeat) {  // at first without a slip rate to begin from
    known.balance(t_Pa, p_Pa, states, nan, V_known, per_s_known);
    general.balance(t_Pa, p_Pa, states, 1e-12, V, per_s);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_NEAR(V[k], V_known[k], 1e-9 * std::abs(V_known[k])) << k;
    }
  }
  // Of a node so slow that states change evenly, but for rounding, over the time given.
  general.balance(t_Pa, p_Pa, states, 1e-3, V, per_s);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < 2; ++j)
      if (const double rate = std::abs(per_s_known[j][k]), speed = std::abs(V_known[k]);
          rate < 1e-3 && speed < 1e-7) {
        EXPECT_NEAR(per_s[j][k], per_s_known[j][k], 1e-3 * (rate + law.b1 * speed / law.d_c1_m) + 1e-12);
      }
}

TEST(QuasiDynamicFriction, BeginsByThetaOrInSteadySliding) {
  RateAndStateAging law;
  const auto first_state = [&] { return QuasiDynamicFriction({law}, 1, damping).initial_states()[0][0]; };
  EXPECT_DOUBLE_EQ(first_state(), law.f0 - law.b * std::log(law.V_i_m_per_s / law.V0_m_per_s));
  law.theta_i_s = 100;
  EXPECT_DOUBLE_EQ(first_state(), law.f0 + law.b * std::log(law.V0_m_per_s * 100 / law.d_c_m));
}

}  // namespace
}  // namespace slipfront::interface
