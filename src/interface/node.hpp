// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "base/lanes.hpp"
#include "base/numbers.hpp"
#include "interface/balance.hpp"
#include "interface/friction/parameter.hpp"
#include "interface/friction/state_law.hpp"
#include "interface/interface.hpp"
#include "interface/regularisation.hpp"

// The contact update of a node, or of `lanes` of them: written once for a value type V.
namespace slipfront::interface {

/// An entry of each array of Interface.
template <class V, std::size_t n_law_states = 0>
struct Node {
  V initial_gap_m, mass_per_length_kg_m2, tangential_mass_ratio, strength_fraction;
  V v_x_m_per_s, v_y_m_per_s, u_y_m;
  V slip_rate_m_per_s, t_Pa, p_Pa, onset_ratio, strength_Pa;
  Mask<V> slipping;
  V slip_m;
  Memory<V> memory;
  V acceleration_m_per_s2;
  Mask<V> locked;
  std::array<V, n_law_states> law_states;
  bool is_time_weakening = false;
};

/// What is left of the coefficient of a node that may be weakened, see Interface::strength_fraction: exactly
/// the law's where strength_fraction is 1.
template <class V>
struct ForcedWeakening {
  V mu_k, strength_fraction, most;
  ForcedWeakening(V mu_at_rest, V mu_k_, V intact_, bool is_time_weakening)
      : mu_k(mu_k_), strength_fraction(intact_), most(V{} + infinity) {
    if (!is_time_weakening) return;
    most = select(strength_fraction < 1, mu_k + strength_fraction * (mu_at_rest - mu_k), most);
    strength_fraction = V{} + 1;
  }
  V operator()(V mu) const {
    const V left = mu - (1 - strength_fraction) * (mu - mu_k);
    return select(most < left, most, left);
  }
};

/// Pressure of the direct algorithm: what the gap at the step's end needs to be closed.
template <class N, class V>
inline void press_direct(N& n, V impedance, double per_step) {
  const V gap_rate = (n.initial_gap_m + n.u_y_m) * per_step;
  n.p_Pa = positive_part(-(n.v_y_m_per_s + gap_rate) * impedance);
  n.v_y_m_per_s += n.p_Pa / impedance;
}

/// Pressure of the predictor-corrector algorithm: what keeps the normal velocity of a locked node at zero.
template <class N, class V>
inline void press_locked(N& n, V impedance, double per_step) {
  const V v_y = n.v_y_m_per_s;
  const Mask<V> stays = n.locked && v_y <= 0;
  const Mask<V> lands = !n.locked && v_y + (n.initial_gap_m + n.u_y_m) * per_step < 0;
  n.u_y_m = select(lands, -n.initial_gap_m, n.u_y_m);
  n.locked = stays || lands;
  n.v_y_m_per_s = select(n.locked, V{}, v_y);
  n.p_Pa = select(stays, -v_y * impedance, V{});
}

/// Evaluations of the coefficient at the mean slip rate of the step, each with the rate that the one before
/// gave. The first alone, at the last rate, leaves an error of first order in dt; from the second on it is of
/// second order, and the third is nearer the solution of the implicit equation where friction weakens fast.
inline constexpr int rate_evaluations = 3;

/// How far towards the end of the step the slip rate is at which friction that rises with it is evaluated: in
/// the middle, which is of second order in dt, unless friction rises so steeply that the node would swing
/// about its balance from step to step; then so far that a linear law comes to its balance in one step.
/// @param softness  of the node: its impedance over d traction/d rate of friction
template <class V>
inline V implicit_weight(V softness) {
  return select(softness < 0.5, 1 - softness, V{} + 0.5);
}

/// Newton's steps to the slip rate at which friction that rises with it is evaluated: where that is steep the
/// iteration of weakening laws would diverge.
template <class Mu, class V>
struct Strengthening {
  static constexpr int most_evaluations = 40;
  static constexpr double rounding = 1e-14;
  const Mu& mu;
  V slip_m, compliance;  ///< what a coefficient takes off the slip rate, p/impedance
  V w;                   ///< share of the rate after the step

  Strengthening(const Mu& mu_, V slip, V compliance_, V last_rate, V v_trial)
      : mu(mu_), slip_m(slip), compliance(compliance_) {
    const V g = slope(last_rate);
    w = implicit_weight(1 / select(g > 2, g, V{} + 2));
    w = select(last_rate * v_trial < 0, V{} + 1, w);
  }
  V slope(V rate) const { return positive_part(mu.slope_s_per_m(absolute(rate), slip_m)) * compliance; }
  /// @param found  rate that the evaluation at `rate` has given
  V next(V rate, V found, V v_trial, Mask<V> sticks) const {
    const V g = select(sticks, V{}, w * slope(rate));
    const V next = (found + g * rate) / (1 + g);
    return select(next * v_trial < 0, V{}, next);
  }
};

/// Friction of a law by which nodes stick or slip.
/// @param impedance_x  effective mass along x over tributary length and dt
/// @tparam strengthens_somewhere  whether the law of any node does
template <ContactAlgorithm algorithm, SlipMemory slip_memory, bool strengthens_somewhere, class Mu,
          class Regularised, class V>
inline void slide(const LawConstants<Mu, V>& law, const Regularised& regularisation, double dt_s,
                  V impedance_x, Node<V>& n) {
  constexpr bool predicts = algorithm == ContactAlgorithm::predictor_corrector;
  constexpr int n_evaluations = predicts ? 1 : rate_evaluations;
  const Mu& mu = law.mu;
  const V p = n.p_Pa;
  const V cohesion = select(p > 0, law.cohesion_Pa, V{});
  const ForcedWeakening<V> weakened(law.mu_at_rest, law.mu_k, n.strength_fraction, n.is_time_weakening);
  const auto coefficient = [&](V speed, V slip) { return weakened(mu(speed, slip)); };

  const V last_rate = n.slip_rate_m_per_s;  // since the last update
  const auto step = regularisation.step(absolute(last_rate));

  const V v_trial = n.v_x_m_per_s;
  const V t_stop = v_trial * impedance_x;
  const V trial_traction = absolute(t_stop);
  V rate = last_rate, direction = t_stop, along = trial_traction;
  if constexpr (predicts) {
    // Newmark's predictor v + a dt of the velocity at the step's beginning.
    rate = last_rate + 0.5 * dt_s * n.acceleration_m_per_s2;
    // Friction opposes the motion: that of the trial, or, by the predictor, that of a node under way.
    const Mask<V> under_way = rate != 0 && p > 0;
    direction = select(under_way, rate, t_stop);
    along = select(under_way, copy_sign(V{} + 1, rate) * t_stop, trial_traction);
  }
  V strength{}, first_strength{}, t{}, v_x{}, evaluated_at{};
  Mask<V> sticks{};
  Memory<V> now;
  const auto evaluate = [&] {
    evaluated_at = rate;
    const V mu_now = coefficient(absolute(rate), n.slip_m);
    now = regularisation.now(step, n.memory, mu_now, p);
    strength = regularisation.strength(mu_now, p, now) + cohesion;
    sticks = along <= strength;  // not the contrary, so that a motion that is not a number is seen as slip
    t = select(sticks, t_stop, copy_sign(strength, direction));
    v_x = select(sticks, V{}, v_trial - t / impedance_x);
  };
  for (int k = 0; k < n_evaluations; ++k) {
    evaluate();
    if (k == 0) first_strength = strength;
    const V mean_rate = 0.5 * (last_rate + v_x);
    if (!any(mean_rate != rate)) break;  // further evaluations would repeat this one
    rate = mean_rate;
  }
  if constexpr (strengthens_somewhere && !predicts) {
    const Strengthening rises(mu, n.slip_m, p / impedance_x, last_rate, v_trial);
    rate = select(law.strengthens > 0, last_rate, evaluated_at);
    Mask<V> goes_on = law.strengthens > 0;  // a lane does not see how many evaluations others take
    for (int k = 0; k < rises.most_evaluations; ++k) {
      evaluate();
      const V next = rises.next(rate, rises.w * v_x + (1 - rises.w) * last_rate, v_trial, sticks);
      goes_on = goes_on && absolute(next - rate) > rises.rounding * absolute(rate);
      if (!any(goes_on)) break;
      rate = select(goes_on, next, rate);
    }
  }
  const Mask<V> slipping = !sticks && p > 0;

  V slip = n.slip_m + select(slipping, absolute(v_x) * dt_s, V{});
  if constexpr (slip_memory == SlipMemory::until_stick) slip = select(sticks && p != 0, V{}, slip);
  V mu_stuck = weakened(law.mu_at_rest);
  if constexpr (slip_memory != SlipMemory::none) mu_stuck = coefficient(V{}, slip);
  const V strength_at_rest = regularisation.strength(mu_stuck, p, now) + cohesion;

  if constexpr (predicts) n.acceleration_m_per_s2 = select(sticks, V{}, (v_x - last_rate) * (1 / dt_s));
  n.v_x_m_per_s = v_x;
  n.slip_rate_m_per_s = v_x;
  n.t_Pa = t;
  n.strength_Pa = select(sticks, strength_at_rest, select(n.slipping, strength, first_strength));
  const Mask<V> has_strength = n.strength_Pa > 0;
  n.onset_ratio = select(has_strength, trial_traction / select(has_strength, n.strength_Pa, V{} + 1), V{});
  n.slipping = slipping;
  n.slip_m = slip;
  n.memory = now;
}

/// Traction of a node in contact by its slip rate, at given states.
template <class Law, class V, std::size_t n_states>
struct RateFriction {
  static constexpr double slowest_m_per_s = 1e-12;
  const Law& law;
  const std::array<V, n_states>& states;
  V p, last, mu, effect;  ///< at `last`: mu, and d mu/d ln V

  RateFriction(const Law& law_, const std::array<V, n_states>& states_, V p_Pa, V last_speed)
      : law(law_),
        states(states_),
        p(p_Pa),
        last(select(last_speed < slowest_m_per_s, V{} + slowest_m_per_s, last_speed)) {
    constexpr double small = 1e-4;
    const V below = law.coefficient((1 - small) * last, states),
            above = law.coefficient((1 + small) * last, states);
    mu = 0.5 * (below + above);
    effect = (above - below) / (2 * small);
  }
  /// Stiffness of the mass over that of the friction.
  V softness(V impedance) const { return last * impedance / (effect * p); }
  /// @param most  slip rate without friction, at w of the way through the step
  V traction(V most, V impedance, V w) const {
    const V size = select(most > 1e-200, most, V{} + 1e-200), per_rate = impedance / w;
    const V k = p / (per_rate * size);
    // Newton's step over ln V from the last rate.
    const V at = select(last < size, last, size), left = at / size;
    const V guess = logarithm(size / at) + (k * mu - (1 - left)) / (k * effect + left);
    const auto of_rate = [&](V speed) { return law.coefficient(speed, states); };
    return decay(log_slowing(of_rate, size, k, guess)).lost * size * per_rate;
  }
};
/// The same with an arsinh, by its inverse.
template <IsArsinh Law, class V, std::size_t n_states>
struct RateFriction<Law, V, n_states> {
  const Law& law;
  V s, a_p, per_a_p, last;

  RateFriction(const Law& law_, const std::array<V, n_states>& states, V p_Pa, V last_speed)
      : law(law_), a_p(law.a * p_Pa), per_a_p(1 / a_p), last(last_speed) {
    const V of_psi = sum_of(states) * law.per_a;
    s = select(of_psi < least_state, V{} + least_state, of_psi);
  }
  V softness(V impedance) const { return last * impedance * per_a_p; }
  V traction(V most, V impedance, V w) const {
    const V per_rate = impedance * per_a_p / w;  // tractions over a p
    const V over_V0 = most * law.per_V0_s_per_m;
    const V log_trial = logarithm(select(over_V0 > 1e-200, over_V0, V{} + 1e-200));
    return a_p * root_of_traction(most * per_rate, law.V0_m_per_s * per_rate, s, log_trial);
  }
};

/// Friction of a law with states, which never sticks: the states of this time and the slip rate V at this
/// time give t. V is between the half-step velocities before and after, w of the way. The fewer nodes are so
/// stiff that V is not in the middle the shorter the step, and on a given mesh the order two remains.
template <ContactAlgorithm algorithm, SlipMemory, bool, class Law, class Regularised, class V,
          std::size_t n_states>
inline void slide(const StateLawConstants<Law, V>& constants, const Regularised& regularisation, double dt_s,
                  V impedance_x, Node<V, n_states>& n) {
  const auto& law = constants.law;
  const V last_rate = n.slip_rate_m_per_s;
  const Memory<V> now =
      regularisation.now(regularisation.step(absolute(last_rate)), n.memory, V{} + 1, n.p_Pa);
  const V pressure =
      regularisation.strength(V{} + 1, n.p_Pa, now);  // 0 where the node is open, or has just landed
  const Mask<V> in_contact = pressure > 0;
  const V p = select(in_contact, pressure, V{} + 1);

  const V v_trial = n.v_x_m_per_s;
  const RateFriction friction(law, n.law_states, p, absolute(last_rate));
  V w = implicit_weight(friction.softness(impedance_x));
  V t{}, v_x{}, rate{};
  const auto solve = [&] {
    rate = w * v_trial + (1 - w) * last_rate;
    t = select(in_contact, copy_sign(friction.traction(absolute(rate), impedance_x, w), rate), V{});
    v_x = v_trial - t / impedance_x;
  };
  solve();
  // Friction can stop the motion that the forces would give, not turn it round.
  const Mask<V> turns = v_x * v_trial < 0;
  if (any(turns)) {
    w = select(turns, V{} + 1, w);
    solve();
  }
  rate = w * v_x + (1 - w) * last_rate;
  n.v_x_m_per_s = v_x;
  n.slip_rate_m_per_s = v_x;
  n.t_Pa = t;
  n.strength_Pa = absolute(t);
  n.onset_ratio = select(in_contact, absolute(rate) / constants.tip_slip_rate_m_per_s, V{});
  n.slipping = !(n.onset_ratio <= 1);  // a motion that is not a number is seen as slip
  n.slip_m += select(in_contact, absolute(v_x) * dt_s, V{});
  n.memory = now;
  n.law_states = law.evolved(n.law_states, absolute(v_x), dt_s);
}

/// @param law   ConstantsOf the node's law
/// @param regularisation  one of with_regularisation's
/// @return whether the node began or ceased to slip.
template <ContactAlgorithm algorithm, SlipMemory slip_memory, bool strengthens_somewhere = false, class Law,
          class Regularised, class N>
inline auto update_node(const Law& law, const Regularised& regularisation, double dt_s, N& n) {
  const double per_step = 1 / dt_s;
  const auto impedance = n.mass_per_length_kg_m2 * per_step;
  if constexpr (algorithm == ContactAlgorithm::predictor_corrector)
    press_locked(n, impedance, per_step);
  else
    press_direct(n, impedance, per_step);
  const auto slipped = n.slipping;
  slide<algorithm, slip_memory, strengthens_somewhere>(law, regularisation, dt_s,
                                                       impedance * n.tangential_mass_ratio, n);
  return n.slipping != slipped;
}

}  // namespace slipfront::interface
