// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/exponential.hpp"
#include "base/lanes.hpp"
#include "base/logarithm.hpp"
#include "interface/friction/parameter.hpp"

// A friction law with states is a struct with `states`, `V_i_m_per_s`, the slip rate before the event, and
//   initial(t_Pa, p_Pa)           states of a node that slides at V_i under t and p; where t or p is 0 those
//   of
//                                 steady sliding
// and its Evaluator, an aggregate of values V, has
//   coefficient(V, states)        mu at slip rates V >= 0, 0 at rest; it rises with V
//   evolved(states, V, dt_s)      states after a time at V >= 0, however long
// What else is asked of a law follows from these, unless it knows better: an Evaluator may have
// steady_states(V), steady_coefficient(V) and rates_per_s(states, V), a law d_c_m, breakdown_per_m(),
// traction_before_Pa(p_Pa) and slip_rate_before_m_per_s(t_Pa, p_Pa).
namespace slipfront::interface {

template <class Law>
inline constexpr std::size_t n_states_of = 0;
template <HasStates Law>
inline constexpr std::size_t n_states_of<Law> = Law::states.size();

/// Evaluators with mu = a arsinh[V/(2 V0) exp(psi/a)], psi the sum of the states.
template <class Evaluator>
concept IsArsinh = requires(const Evaluator& e) {
  e.a;
  e.per_a;
  e.V0_m_per_s;
  e.per_V0_s_per_m;
};

template <class V, std::size_t n>
V sum_of(const std::array<V, n>& states) {
  V sum = states[0];
  for (std::size_t k = 1; k < n; ++k) sum += states[k];
  return sum;
}

template <IsArsinh Evaluator, class V, std::size_t n>
V arsinh_coefficient(const Evaluator& law, V speed_m_per_s, const std::array<V, n>& states) {
  constexpr double at_rest = 1e-290;
  const V v = speed_m_per_s * law.per_V0_s_per_m;
  const V u = sum_of(states) * law.per_a + logarithm(0.5 * select(v > at_rest, v, V{} + at_rest));
  // arsinh(exp(u)) = max(u, 0) + ln(exp(-max(u, 0)) exp(u) + sqrt(...)), so that nothing leaves the range.
  const V above = positive_part(u), part = exp_minus(above - u), other = exp_minus(above);
  return law.a * (above + logarithm(part + square_root(part * part + other * other)));
}

template <class Law>
auto steady_states(const Law& law, double speed_m_per_s) {
  const auto evaluator = law.evaluator();
  if constexpr (requires { evaluator.steady_states(speed_m_per_s); }) {
    return evaluator.steady_states(speed_m_per_s);
  } else {
    constexpr double far_m = 1e9;  // beyond any slip over which states change
    return evaluator.evolved(law.initial(0, 0), speed_m_per_s, far_m / speed_m_per_s);
  }
}

template <class Law>
double steady_coefficient(const Law& law, double speed_m_per_s) {
  const auto evaluator = law.evaluator();
  if constexpr (requires { evaluator.steady_coefficient(speed_m_per_s); })
    return evaluator.steady_coefficient(speed_m_per_s);
  else
    return evaluator.coefficient(speed_m_per_s, steady_states(law, speed_m_per_s));
}

template <class Law>
double steady_slope_s_per_m(const Law& law, double speed_m_per_s) {
  const double small = 1e-4 * speed_m_per_s;
  return (steady_coefficient(law, speed_m_per_s + small) - steady_coefficient(law, speed_m_per_s - small)) /
         (2 * small);
}

/// d mu/d ln V at once, at given states.
template <class Evaluator, std::size_t n>
double direct_effect(const Evaluator& law, double speed_m_per_s, const std::array<double, n>& states) {
  if constexpr (IsArsinh<Evaluator>) {
    return law.a;
  } else {
    constexpr double small = 1e-4;
    return (law.coefficient((1 + small) * speed_m_per_s, states) -
            law.coefficient((1 - small) * speed_m_per_s, states)) /
           (2 * small);
  }
}

/// A change of a state over which mu is straight.
inline double small_change(double state) {
  return state != 0 ? 1e-6 * std::abs(state) : 1e-6;
}

/// |d mu/d state| of one of them, at given ones.
template <class Evaluator, std::size_t n>
double state_effect(const Evaluator& law, double speed_m_per_s, const std::array<double, n>& states,
                    std::size_t k) {
  if constexpr (IsArsinh<Evaluator>) {
    return 1;
  } else {
    auto other = states;
    other[k] += small_change(states[k]);
    return std::abs(law.coefficient(speed_m_per_s, other) - law.coefficient(speed_m_per_s, states)) /
           small_change(states[k]);
  }
}

/// Slip over which 1 - 1/e of what the states do to mu has come after a small step of the slip rate; d_c of a
/// law with one state.
template <class Law>
double following_slip_m(const Law& law, double speed_m_per_s) {
  if constexpr (requires { law.d_c_m; }) {
    return law.d_c_m;
  } else {
    constexpr double step = 1.001, shortest_m = 1e-15, longest_m = 1e6, rounding = 1e-12;
    const auto evaluator = law.evaluator();
    const double V = step * speed_m_per_s;
    const auto before = steady_states(law, speed_m_per_s);
    const double first = evaluator.coefficient(V, before);
    const double last = evaluator.coefficient(V, steady_states(law, V));
    double from = std::log(shortest_m), to = std::log(longest_m);
    while (to - from > rounding) {
      const double middle = 0.5 * (from + to);
      const double now = evaluator.coefficient(V, evaluator.evolved(before, V, std::exp(middle) / V));
      ((now - last) / (first - last) > std::exp(-1) ? from : to) = middle;
    }
    return std::exp(from);
  }
}

/// By how much mu falls with slip behind a tip that comes at 1 m/s to an interface in steady sliding at V_i,
/// at first.
template <class Law>
double breakdown_per_m(const Law& law) {
  if constexpr (requires { law.breakdown_per_m(); }) {
    return law.breakdown_per_m();
  } else {
    const auto evaluator = law.evaluator();
    const auto before = steady_states(law, law.V_i_m_per_s);
    const double slip_m = 0.1 * following_slip_m(law, law.V_i_m_per_s);
    return (evaluator.coefficient(1, before) -
            evaluator.coefficient(1, evaluator.evolved(before, 1, slip_m))) /
           slip_m;
  }
}

}  // namespace slipfront::interface
