// SPDX-License-Identifier: BSD-3-Clause
#include "interface/quasi_dynamic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "interface/friction/rate_and_state.hpp"

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
  std::vector<double> t_Pa, p_Pa, psi, V(n), psi_per_s(n);
  for (std::size_t k = 0; k < n; ++k) {
    p_Pa.push_back(std::pow(10, between(4, 8)));
    psi.push_back(between(0.2, 0.9));
    t_Pa.push_back(between(-1, 1) * p_Pa.back());
  }
  QuasiDynamicFriction friction({law}, n, damping);
  friction.balance(t_Pa, p_Pa, psi, V, psi_per_s);
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
  const std::vector<double> t_Pa = {1e6, 0}, p_Pa = {0, 5e6}, psi = {0.6, 0.6};
  std::vector<double> V(2, 1), psi_per_s(2);
  friction.balance(t_Pa, p_Pa, psi, V, psi_per_s);
  EXPECT_EQ(V, (std::vector<double>{0, 0}));
  for (const double rate : psi_per_s) EXPECT_GT(rate, 0);  // the surfaces age
}

TEST(QuasiDynamicFriction, BeginsByThetaOrInSteadySliding) {
  RateAndStateAging law;
  const auto first_state = [&] { return QuasiDynamicFriction({law}, 1, damping).initial_states().front(); };
  EXPECT_DOUBLE_EQ(first_state(), law.f0 - law.b * std::log(law.V_i_m_per_s / law.V0_m_per_s));
  law.theta_i_s = 100;
  EXPECT_DOUBLE_EQ(first_state(), law.f0 + law.b * std::log(law.V0_m_per_s * 100 / law.d_c_m));
}

}  // namespace
}  // namespace slipfront::interface
