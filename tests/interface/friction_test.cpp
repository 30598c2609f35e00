// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "interface/friction/registry.hpp"

namespace slipfront::interface {
namespace {

/// Calls f(law) with a default-constructed law of each type in the registry.
template <class F, class... Laws>
void for_each_law(F&& f, LawList<Laws...>) {
  (f(Laws{}), ...);
}
template <class F>
void for_each_law(F&& f) {
  for_each_law(f, Registry{});
}

TEST(Registry, HoldsTheLawsTheCaseFileNames) {
  std::set<std::string> names;
  for_each_law([&](const auto& law) { names.insert(law.name); });
  EXPECT_EQ(names, (std::set<std::string>{
                       "velocity_weakening", "coulomb", "slip_weakening", "slip_weakening_healing",
                       "slip_weakening_exponential", "slip_table", "slip_rate_table", "rate_and_state_aging",
                       "rate_and_state_slip", "rate_and_state_strong", "rate_and_state_aging_two"}));
  EXPECT_EQ(names.size(), law_descriptions().size());
}

TEST(Registry, EachLawIsUsableByDefault) {
  for_each_law([]<class Law>(const Law& law) {
    SCOPED_TRACE(law.name);
    EXPECT_EQ(law.inconsistency().text, "");
    if constexpr (!HasStates<Law>) {
      // Strength before slip is the static one; by default speed and slip never make it stronger, or weaker
      // than the kinetic one, which they reach.
      const auto mu = law.evaluator();
      EXPECT_DOUBLE_EQ(mu(0, 0), law.static_coefficient());
      EXPECT_DOUBLE_EQ(mu(1e6, 1e6), law.kinetic_coefficient());
      EXPECT_EQ(static_coefficient(FrictionLaw(law)), law.static_coefficient());
      EXPECT_EQ(kinetic_coefficient(FrictionLaw(law)), law.kinetic_coefficient());
      for (const double v : {0.0, 1e-9, 1e-3, 1.0, 1e3})
        for (const double slip : {0.0, 1e-9, 1e-6, 1e-3}) {
          EXPECT_GE(mu(v, slip), law.kinetic_coefficient());
          EXPECT_LE(mu(v, slip), mu(0, 0));
          // The compiler contracts products and sums of the two differently.
          EXPECT_DOUBLE_EQ(friction_coefficient(FrictionLaw(law), v, slip), mu(v, slip));
          EXPECT_DOUBLE_EQ(friction_slope_s_per_m(FrictionLaw(law), v, slip), mu.slope_s_per_m(v, slip));
          if (law.memory == SlipMemory::none) {
            EXPECT_EQ(mu(v, slip), mu(v, 0));
          }
        }
    }
  });
}

TEST(Registry, SlopesAreTheDerivativesWithTheSlipRate) {
  // Central differences of step d: their error is d^2/6 times the third derivative, at most 1e-8 * 0.7
  // * 2.65^3 / 6 = 2.2e-8 here.
  const double d = 1e-4;
  for_each_law([&]<class Law>(const Law& law) {
    SCOPED_TRACE(law.name);
    if constexpr (!HasStates<Law>) {
      const auto mu = law.evaluator();
      for (const double v : {0.01, 0.3, 2.0})
        EXPECT_NEAR(mu.slope_s_per_m(v, 1e-6), (mu(v + d, 1e-6) - mu(v - d, 1e-6)) / (2 * d), 3e-8);
    }
  });
}

TEST(Registry, ParametersReachTheirMembers) {
  for_each_law([](auto law) {
    using Law = decltype(law);
    SCOPED_TRACE(law.name);
    std::set<std::string> keys;
    double value = 0.25;
    for (const auto& p : Law::parameters()) {
      EXPECT_TRUE(keys.insert(p.key).second) << p.key;
      EXPECT_GE(law.*p.member, p.min) << p.key;
      EXPECT_LE(law.*p.member, p.max) << p.key;
      law.*p.member = value;
      value += 0.125;
    }
    // Each parameter has a separate member, and there is no other member.
    value = 0.25;
    for (const auto& p : Law::parameters()) {
      EXPECT_EQ(law.*p.member, value) << p.key;
      value += 0.125;
    }
    std::size_t lists = 0;
    if constexpr (requires { Law::lists(); }) lists = sizeof(std::span<double>) * Law::lists().size();
    EXPECT_EQ(sizeof(Law), sizeof(double) * Law::parameters().size() + lists);
  });
}

TEST(VelocityWeakening, FallsFromStaticToKinetic) {
  const VelocityWeakening law{.mu_s = 1.3, .mu_k = 0.6, .alpha_m2_per_s2 = 0.1};
  const auto mu = law.evaluator();
  EXPECT_DOUBLE_EQ(mu(0, 0), 1.3);
  EXPECT_DOUBLE_EQ(mu(1e3, 0), 0.6);
  // By hand: sqrt(0.7 / 0.1) = 2.6457513 s/m; at 0.1 m/s 0.6 + 0.7 exp(-0.26457513) = 1.1372724.
  EXPECT_NEAR(mu(0.1, 0), 1.1372724, 5e-7);
  for (int k = 1; k <= 100; ++k) EXPECT_LT(mu(0.02 * k, 0), mu(0.02 * (k - 1), 0));
  // mu'(0) = -(mu_s - mu_k)^(3/2) / sqrt(alpha)
  const auto weak = VelocityWeakening{.mu_s = 1.3, .mu_k = 1.0, .alpha_m2_per_s2 = 0.1}.evaluator();
  EXPECT_DOUBLE_EQ(weak.slope_s_per_m(0, 0), -std::pow(0.3, 1.5) / std::sqrt(0.1));
}

TEST(VelocityWeakening, RisesFromStaticToKinetic) {
  const auto mu = VelocityWeakening{.mu_s = 0.6, .mu_k = 0.9, .alpha_m2_per_s2 = 0.1}.evaluator();
  EXPECT_DOUBLE_EQ(mu(0, 0), 0.6);
  EXPECT_DOUBLE_EQ(mu(1e3, 0), 0.9);
  // By hand: sqrt(0.3 / 0.1) = 1.7320508 s/m; at 0.1 m/s 0.9 - 0.3 exp(-0.17320508) = 0.6477105.
  EXPECT_NEAR(mu(0.1, 0), 0.6477105, 5e-7);
  EXPECT_DOUBLE_EQ(mu.slope_s_per_m(0, 0), std::pow(0.3, 1.5) / std::sqrt(0.1));
}

TEST(SlipWeakening, ExponentialFallsByOneOverEInEachCriticalSlip) {
  const ExponentialSlipWeakening law{.mu_s = 0.6, .mu_k = 0.2, .d_c_m = 2e-6};
  const auto mu = law.evaluator();
  EXPECT_DOUBLE_EQ(mu(0, 0), 0.6);
  EXPECT_NEAR(mu(7, 2e-6), 0.2 + 0.4 / M_E, 1e-15);
  EXPECT_NEAR(mu(0, 6e-6), 0.2 + 0.4 / (M_E * M_E * M_E), 1e-15);
  // The linear law with twice d_c has the same fracture energy, (mu_s - mu_k) p d_c.
  double excess_m = 0;
  for (int k = 0; k < 10000; ++k) excess_m += (mu(0, (k + 0.5) * 4e-9) - 0.2) * 4e-9;
  EXPECT_NEAR(excess_m, 0.5 * 0.4 * law.weakening_slip_m(), 1e-6 * excess_m);
}

TEST(SlipWeakening, FallsLinearlyOverTheCriticalSlip) {
  const SlipWeakening law{.mu_s = 0.75, .mu_k = 0.25, .d_c_m = 4e-6};
  const auto mu = law.evaluator();
  EXPECT_DOUBLE_EQ(mu(0, 0), 0.75);
  EXPECT_DOUBLE_EQ(mu(7, 1e-6), 0.625);
  EXPECT_DOUBLE_EQ(mu(0, 3e-6), 0.375);
  EXPECT_DOUBLE_EQ(mu(0, 4e-6), 0.25);
  EXPECT_EQ(mu(0, 1), 0.25);
}

TEST(FrictionTable, IsLinearBetweenRowsAndConstantAfterTheLast) {
  const std::array<double, 4> slip_m{0, 1e-6, 4e-6, 20e-6}, mu{0.62, 0.50, 0.26, 0.34};
  SlipTable law;
  law.at = slip_m;
  law.mu = mu;
  EXPECT_EQ(law.inconsistency().text, "");
  EXPECT_EQ(law.static_coefficient(), 0.62);
  EXPECT_EQ(law.kinetic_coefficient(), 0.26);
  const auto value = law.evaluator();
  EXPECT_EQ(value(7, 0), 0.62);
  for (const auto& [at_m, expected] :
       {std::pair(0.25e-6, 0.59), {1e-6, 0.50}, {2e-6, 0.42}, {4e-6, 0.26}, {12e-6, 0.30}, {1.0, 0.34}})
    EXPECT_DOUBLE_EQ(value(0, at_m), expected);
  law.mu_factor = 0.5;
  EXPECT_DOUBLE_EQ(law.evaluator()(0, 2e-6), 0.21);
  EXPECT_EQ(law.kinetic_coefficient(), 0.13);

  // 0.12/2 + 0.24 over 1 um, 0.24/2 over 3 um above 0.26, through a drop of 0.36; the rise behind is none.
  EXPECT_DOUBLE_EQ(law.weakening_slip_m(), 2 * (0.30 * 1e-6 + 0.12 * 3e-6) / 0.36);
  EXPECT_EQ(weakening_slip_m(SlipWeakening{.mu_s = 0.6, .mu_k = 0.3, .d_c_m = 3e-6}), 3e-6);
  EXPECT_EQ(weakening_slip_m(VelocityWeakening{}), std::nullopt);

  // The copy that the rest of the program holds has lists of its own.
  const FrictionLaw held = law;
  EXPECT_EQ(friction_coefficient(held, 0, 2e-6), law.evaluator()(0, 2e-6));
  EXPECT_EQ(held.list("table_mu"), std::vector<double>(mu.begin(), mu.end()));
}

TEST(FrictionTable, OfSlipRatesHasTheSlopesOfItsRows) {
  const SlipRateTable law;
  const auto mu = law.evaluator();
  EXPECT_DOUBLE_EQ(mu(0.05, 3), 0.5);
  EXPECT_DOUBLE_EQ(mu.slope_s_per_m(0, 0), -2);
  EXPECT_DOUBLE_EQ(mu.slope_s_per_m(0.05, 0), -2);
  EXPECT_NEAR(mu.slope_s_per_m(0.5, 0), -0.1 / 0.9, 1e-15);
  EXPECT_EQ(mu.slope_s_per_m(1.5, 0), 0);
}

TEST(FrictionTable, RefusesWhatIsNoTable) {
  const auto problem = [](const std::vector<double>& at, const std::vector<double>& mu) {
    SlipTable law;
    law.at = at;
    law.mu = mu;
    return law.inconsistency().text;
  };
  const std::string length =
      "friction.table_slip_m and friction.table_mu must be of one length, 2 to 32 numbers";
  EXPECT_EQ(problem({0, 1}, {0.6, 0.3}), "");
  EXPECT_EQ(problem({}, {}), length);
  EXPECT_EQ(problem({0}, {0.6}), length);
  EXPECT_EQ(problem({0, 1, 2}, {0.6, 0.3}), length);
  EXPECT_EQ(problem(std::vector<double>(33), std::vector<double>(33)), length);
  EXPECT_EQ(problem({1e-6, 1}, {0.6, 0.3}), "friction.table_slip_m must begin with 0 and ascend");
  EXPECT_EQ(problem({0, 1, 1}, {0.6, 0.3, 0.2}), "friction.table_slip_m must begin with 0 and ascend");
  EXPECT_EQ(problem({0, 1}, {0.3, 0.6}), "");  // strengthens
}

TEST(StateBreakdown, OfAgingAndSlipLawsIsKnown) {
  constexpr double p_Pa = 5e6, t_Pa = 3.4e6, V = 1;
  const auto fall_of = [&](const auto& law) {
    return law.initial(t_Pa, p_Pa)[0] - law.evaluator().steady_state(V);
  };
  // At V far above d_c/theta psi falls linearly under the aging law, by b/d_c, exponentially under the slip
  // law.
  const RateAndStateAging aging{};
  const double fall = fall_of(aging);
  const auto of_aging = state_breakdown(aging, t_Pa, p_Pa, V);
  EXPECT_NEAR(of_aging->energy_over_pressure_m, aging.d_c_m * (0.5 * fall * fall / aging.b),
              0.02 * of_aging->energy_over_pressure_m);
  EXPECT_DOUBLE_EQ(of_aging->residual_coefficient, aging.evaluator().steady_coefficient(V));
  const RateAndStateSlip slip{};
  EXPECT_NEAR(state_breakdown(slip, t_Pa, p_Pa, V)->energy_over_pressure_m, slip.d_c_m * fall_of(slip),
              1e-3 * slip.d_c_m * fall_of(slip));
  EXPECT_FALSE(state_breakdown(SlipWeakening{}, t_Pa, p_Pa, V));
}

}  // namespace
}  // namespace slipfront::interface
