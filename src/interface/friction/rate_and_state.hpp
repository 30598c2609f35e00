// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/exponential.hpp"
#include "base/lanes.hpp"
#include "base/logarithm.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"
#include "interface/friction/state_law.hpp"

namespace slipfront::interface {

/// How psi changes while the surfaces slide at V.
enum class StateEvolution {
  aging,  ///< psi = f0 + b ln(V0 theta/d_c), d theta/dt = 1 - V theta/d_c (Dieterich 1979)
  slip,   ///< d psi/dt = -V/d_c (psi - psi_ss(V)), the slip law d theta/dt = -(V theta/d_c) ln(V theta/d_c)
          ///< (Ruina 1983)
  strong_weakening,  ///< as slip, towards a steady coefficient that falls to f_w beyond V_w
};

/// Parameters of strong weakening alone.
template <bool weakens_strongly>
struct StrongWeakening {};
template <>
struct StrongWeakening<true> {
  double f_w = 0.2;
  double V_w_m_per_s = 0.1;
};

/// tau = p a asinh[V/(2 V0) exp(psi/a)]: rate-and-state friction, regularised so that it is odd in V (Rice et
/// al. 2001). It never sticks. In steady sliding the coefficient is f0 + (a - b) ln(V/V0), for large
/// arguments; with strong weakening f_w + (that - f_w) [1 + (V/V_w)^8]^(-1/8) (Dunham et al. 2011).
template <StateEvolution evolution>
struct RateAndState : StrongWeakening<evolution == StateEvolution::strong_weakening> {
  static constexpr bool weakens_strongly = evolution == StateEvolution::strong_weakening;
  static constexpr const char* name = evolution == StateEvolution::aging  ? "rate_and_state_aging"
                                      : evolution == StateEvolution::slip ? "rate_and_state_slip"
                                                                          : "rate_and_state_strong";
  static constexpr const char* help =
      evolution == StateEvolution::aging  ? "rate and state, aging law; never sticks"
      : evolution == StateEvolution::slip ? "rate and state, slip law; never sticks"
                                          : "rate and state, slip law with strong rate weakening";
  static constexpr SlipMemory memory = SlipMemory::none;
  static constexpr std::array<LawState, 1> states = {{{"psi", "1", "state of the surfaces"}}};

  double a = 0.008;
  double b = 0.016;
  double d_c_m = 0.4e-6;
  double f0 = 0.6;
  double V0_m_per_s = 1e-6;
  double V_i_m_per_s = 1e-9;
  double theta_i_s = 0;  ///< 0: not given

  static constexpr auto parameters() {
    using L = RateAndState;
    std::array<Parameter<L>, weakens_strongly ? 9 : 7> all = {
        {{"a", &L::a, 1e-6, 10, "direct effect of the slip rate"},
         {"b", &L::b, 1e-6, 10, "effect of the state"},
         {"d_c_m", &L::d_c_m, 1e-12, 1e3, "slip over which the state changes"},
         {"f0", &L::f0, 0, 100, "coefficient of steady sliding at V0"},
         {"V0_m_per_s", &L::V0_m_per_s, 1e-30, 1e3, "reference slip rate"},
         {"V_i_m_per_s", &L::V_i_m_per_s, 1e-30, 1e3, "slip rate before the event"},
         {"theta_i_s", &L::theta_i_s, 0, 1e12,
          "theta before the event, exp((psi - f0)/b) d_c/V0; of it, V_i and prestress.t_Pa two decide the "
          "third; 0: it follows from the others"}}};
    if constexpr (weakens_strongly) {
      all[7] = {"f_w", &L::f_w, 0, 100, "coefficient of steady sliding far beyond V_w"};
      all[8] = {"V_w_m_per_s", &L::V_w_m_per_s, 1e-12, 1e3, "slip rate from which friction weakens"};
    }
    return all;
  }
  Message inconsistency() const { return {}; }

  /// The law with its constants folded. An aggregate of values V.
  template <class V>
  struct Evaluator {
    using States = std::array<V, 1>;
    V a, b, f0, V0_m_per_s, per_d_c_per_m, f_w, per_V_w_s_per_m;
    V per_a, per_b, per_V0_s_per_m;

    /// The coefficient of steady sliding, V > 0.
    V steady_coefficient(V speed_m_per_s) const {
      const V f = f0 + (a - b) * logarithm(speed_m_per_s * per_V0_s_per_m);
      if constexpr (!weakens_strongly) return f;
      // Beyond 1e3 V_w the 1 does not count, and powers stay in range.
      const V v = speed_m_per_s * per_V_w_s_per_m;
      const V v2 = v * v, v4 = v2 * v2, v8 = select(v < 1e30, v4 * v4, V{} + 1e240);
      return f_w + (f - f_w) * exp_minus(0.125 * logarithm(1 + v8));
    }
    /// psi of steady sliding, V > 0.
    V steady_state(V speed_m_per_s) const {
      const V log_V = logarithm(speed_m_per_s * per_V0_s_per_m);
      if constexpr (!weakens_strongly) return f0 - b * log_V;
      return state_of(steady_coefficient(speed_m_per_s), log_V);
    }
    /// psi at which sliding with ln(V/V0) has a coefficient tau/p > 0: a ln[2 V0/V sinh(tau/(a p))].
    V state_of(V coefficient, V log_V) const {
      const V y = coefficient * per_a;
      return coefficient + a * (logarithm(decay(2 * y).lost) - log_V);
    }
    /// d psi/dt while the surfaces slide at V >= 0.
    V state_rate_per_s(V psi, V speed_m_per_s) const {
      const V decay_per_s = speed_m_per_s * per_d_c_per_m;
      if constexpr (evolution != StateEvolution::aging) {
        constexpr double at_rest = 1e-150;
        const V speed = select(speed_m_per_s < at_rest, V{} + at_rest, speed_m_per_s);
        return decay_per_s * (steady_state(speed) - psi);
      }
      const V growth_per_s = V0_m_per_s * per_d_c_per_m * exp_minus((psi - f0) * per_b);
      return b * (growth_per_s - decay_per_s);
    }
    V coefficient(V speed_m_per_s, const States& psi) const {
      return arsinh_coefficient(*this, speed_m_per_s, psi);
    }
    States steady_states(V speed_m_per_s) const { return {steady_state(speed_m_per_s)}; }
    States rates_per_s(const States& psi, V speed_m_per_s) const {
      return {state_rate_per_s(psi[0], speed_m_per_s)};
    }
    States evolved(const States& psi, V speed_m_per_s, double dt_s) const {
      return {evolved(psi[0], speed_m_per_s, dt_s)};
    }
    /// psi after a time in which the surfaces slide at |V|: exact.
    V evolved(V psi, V speed_m_per_s, double dt_s) const {
      const auto [left, lost] = decay(speed_m_per_s * dt_s * per_d_c_per_m);
      constexpr double at_rest = 1e-150;
      const V speed = select(speed_m_per_s < at_rest, V{} + at_rest, speed_m_per_s);
      if constexpr (evolution != StateEvolution::aging) {
        const V steady = steady_state(speed);
        return steady + (psi - steady) * left;
      }
      // V0 theta/d_c as it grows; lost / V is dt/d_c at rest.
      const V grown = select(lost > 1e-140, V0_m_per_s * lost / speed, V0_m_per_s * per_d_c_per_m * dt_s);
      const V age = (psi - f0) * per_b;  // ln(V0 theta/d_c)
      constexpr double large = 600;
      const V within = select(age < large, age, V{});
      V next = f0 + b * logarithm(exp_minus(-within) * left + grown);
      if (any(age >= large)) {
        // The larger of the two terms apart, so that neither leaves the range of doubles.
        const V aged = age - speed_m_per_s * dt_s * per_d_c_per_m, healed = logarithm(grown);
        const V most = select(aged > healed, aged, healed);
        const V sum = f0 + b * (most + logarithm(1 + exp_minus(absolute(aged - healed))));
        next = select(age >= large, sum, next);
      }
      return next;
    }
  };
  Evaluator<double> evaluator() const {
    Evaluator<double> e{a, b, f0, V0_m_per_s, 1 / d_c_m, 0, 0, 1 / a, 1 / b, 1 / V0_m_per_s};
    if constexpr (weakens_strongly) {
      e.f_w = this->f_w;
      e.per_V_w_s_per_m = 1 / this->V_w_m_per_s;
    }
    return e;
  }

  double given_state() const { return f0 + b * std::log(V0_m_per_s * theta_i_s / d_c_m); }
  /// t before the event under p, of sliding at V_i: steadily, or with the theta_i that is given.
  double traction_before_Pa(double p_Pa) const {
    if (theta_i_s == 0) return evaluator().steady_coefficient(V_i_m_per_s) * p_Pa;
    const double u = given_state() / a + std::log(V_i_m_per_s / V0_m_per_s);
    return a * p_Pa * (u > 20 ? u : std::asinh(0.5 * std::exp(u)));
  }
  /// V_i where a node has t and p, and theta_i is given.
  double slip_rate_before_m_per_s(double t_Pa, double p_Pa) const {
    const double y = std::abs(t_Pa) / (a * p_Pa);
    return V0_m_per_s * std::exp(y - given_state() / a) * -std::expm1(-2 * y);
  }
  /// psi where a node that slides at V_i has t and p; of steady sliding where it is open or has no t.
  std::array<double, 1> initial(double t_Pa, double p_Pa) const {
    if (theta_i_s > 0) return {given_state()};
    const auto law = evaluator();
    if (!(p_Pa > 0) || t_Pa == 0) return law.steady_states(V_i_m_per_s);
    return {law.state_of(std::abs(t_Pa) / p_Pa, std::log(V_i_m_per_s / V0_m_per_s))};
  }

  /// By how much the coefficient falls with slip behind a tip that comes at 1 m/s to an interface in steady
  /// sliding at V_i: under the aging law b/d_c; under the slip law exponentially over d_c, as linear
  /// weakening of the same fracture energy over 2 d_c.
  double breakdown_per_m() const {
    if constexpr (evolution == StateEvolution::aging) return b / d_c_m;
    const auto law = evaluator();
    return (law.steady_state(V_i_m_per_s) - law.steady_state(1)) / (2 * d_c_m);
  }
};

using RateAndStateAging = RateAndState<StateEvolution::aging>;
using RateAndStateSlip = RateAndState<StateEvolution::slip>;
using RateAndStateStrong = RateAndState<StateEvolution::strong_weakening>;

}  // namespace slipfront::interface
