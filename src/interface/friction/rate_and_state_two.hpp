// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "interface/friction/rate_and_state.hpp"

namespace slipfront::interface {

/// The aging law with two states (Ruina 1983; Gu et al. 1984): psi = psi_1 + psi_2, psi_1 = f0 + b1 ln(V0
/// theta_1/d_c1), psi_2 = b2 ln(V0 theta_2/d_c2), each theta ageing for itself. In steady sliding b is b1 +
/// b2.
struct RateAndStateAgingTwo {
  static constexpr const char* name = "rate_and_state_aging_two";
  static constexpr const char* help = "rate and state, aging law with two states; never sticks";
  static constexpr SlipMemory memory = SlipMemory::none;
  static constexpr std::array<LawState, 2> states = {
      {{"psi_1", "1", "first state of the surfaces"}, {"psi_2", "1", "second state of the surfaces"}}};

  double a = 0.008;
  double b1 = 0.012, b2 = 0.004;
  double d_c1_m = 0.4e-6, d_c2_m = 4e-6;
  double f0 = 0.6;
  double V0_m_per_s = 1e-6;
  double V_i_m_per_s = 1e-9;

  static constexpr auto parameters() {
    using L = RateAndStateAgingTwo;
    return std::array<Parameter<L>, 8>{
        {{"a", &L::a, 1e-6, 10, "direct effect of the slip rate"},
         {"b1", &L::b1, 1e-6, 10, "effect of the first state"},
         {"b2", &L::b2, 1e-6, 10, "effect of the second state"},
         {"d_c1_m", &L::d_c1_m, 1e-12, 1e3, "slip over which the first state changes"},
         {"d_c2_m", &L::d_c2_m, 1e-12, 1e3, "slip over which the second state changes"},
         {"f0", &L::f0, 0, 100, "coefficient of steady sliding at V0"},
         {"V0_m_per_s", &L::V0_m_per_s, 1e-30, 1e3, "reference slip rate"},
         {"V_i_m_per_s", &L::V_i_m_per_s, 1e-30, 1e3, "slip rate before the event"}}};
  }
  Message inconsistency() const { return {}; }

  template <class V>
  struct Evaluator {
    using States = std::array<V, 2>;
    V a, per_a, V0_m_per_s, per_V0_s_per_m;
    RateAndStateAging::Evaluator<V> first, second;

    V coefficient(V speed_m_per_s, const States& psi) const {
      return arsinh_coefficient(*this, speed_m_per_s, psi);
    }
    States evolved(const States& psi, V speed_m_per_s, double dt_s) const {
      return {first.evolved(psi[0], speed_m_per_s, dt_s), second.evolved(psi[1], speed_m_per_s, dt_s)};
    }
  };
  Evaluator<double> evaluator() const {
    return {a,
            1 / a,
            V0_m_per_s,
            1 / V0_m_per_s,
            RateAndStateAging{{}, a, b1, d_c1_m, f0, V0_m_per_s}.evaluator(),
            RateAndStateAging{{}, a, b2, d_c2_m, 0, V0_m_per_s}.evaluator()};
  }

  /// Both thetas are by the same factor older than in steady sliding.
  std::array<double, 2> initial(double t_Pa, double p_Pa) const {
    const auto law = evaluator();
    const double first = law.first.steady_state(V_i_m_per_s), second = law.second.steady_state(V_i_m_per_s);
    if (!(p_Pa > 0) || t_Pa == 0) return {first, second};
    const double psi = law.first.state_of(std::abs(t_Pa) / p_Pa, std::log(V_i_m_per_s / V0_m_per_s));
    const double log_older = (psi - first - second) / (b1 + b2);
    return {first + b1 * log_older, second + b2 * log_older};
  }
};

}  // namespace slipfront::interface
