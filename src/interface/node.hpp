// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/lanes.hpp"
#include "interface/friction/parameter.hpp"
#include "interface/interface.hpp"
#include "interface/regularisation.hpp"

// The contact update of a node, or of `lanes` of them: written once for a value type V.
namespace slipfront::interface {

/// An entry of each array of Interface.
template <class V>
struct Node {
  V initial_gap_m, mass_per_length_kg_m2, tangential_mass_ratio, intact;
  V v_x_m_per_s, v_y_m_per_s, u_y_m;
  V slip_rate_m_per_s, t_Pa, p_Pa, trial_traction_Pa, strength_Pa;
  Mask<V> slipping;
  V slip_m;
  Memory<V> memory;
  V acceleration_m_per_s2;
  Mask<V> locked;
};

/// The coefficient of a node that may be weakened; exactly the law's where intact is 1.
template <class V>
inline V weakened(V mu, V mu_k, V intact) {
  return mu - (1 - intact) * (mu - mu_k);
}

/// Pressure of the direct algorithm: what the gap at the step's end needs to be closed.
template <class V>
inline void press_direct(Node<V>& n, V impedance, double per_step) {
  const V gap_rate = (n.initial_gap_m + n.u_y_m) * per_step;
  n.p_Pa = positive_part(-(n.v_y_m_per_s + gap_rate) * impedance);
  n.v_y_m_per_s += n.p_Pa / impedance;
}

/// Pressure of the predictor-corrector algorithm: what keeps the normal velocity of a locked node at zero.
template <class V>
inline void press_locked(Node<V>& n, V impedance, double per_step) {
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

/// @param law   LawConstants of the node
/// @param form  one of with_form's
/// @return whether the node began or ceased to slip.
template <ContactAlgorithm algorithm, SlipMemory slip_memory, class Law, class Form, class V>
inline Mask<V> update_node(const Law& law, const Form& form, double dt_s, Node<V>& n) {
  constexpr bool predicts = algorithm == ContactAlgorithm::predictor_corrector;
  constexpr int n_evaluations = predicts ? 1 : rate_evaluations;
  const auto& [mu, mu_at_rest, mu_k] = law;
  const double per_step = 1 / dt_s;

  const V impedance = n.mass_per_length_kg_m2 * per_step;
  if constexpr (predicts)
    press_locked(n, impedance, per_step);
  else
    press_direct(n, impedance, per_step);
  const V p = n.p_Pa;

  const V last_rate = n.slip_rate_m_per_s;  // since the last update
  const auto step = form.step(absolute(last_rate));

  const V impedance_x = impedance * n.tangential_mass_ratio;
  const V v_trial = n.v_x_m_per_s;
  const V t_stop = v_trial * impedance_x;
  n.trial_traction_Pa = absolute(t_stop);
  V rate = last_rate, direction = t_stop, along = n.trial_traction_Pa;
  if constexpr (predicts) {
    // Newmark's predictor v + a dt of the velocity at the step's beginning.
    rate = last_rate + 0.5 * dt_s * n.acceleration_m_per_s2;
    // Friction opposes the motion: that of the trial, or, by the predictor, that of a node under way.
    const Mask<V> under_way = rate != 0 && p > 0;
    direction = select(under_way, rate, t_stop);
    along = select(under_way, copy_sign(V{} + 1, rate) * t_stop, n.trial_traction_Pa);
  }
  V strength{}, first_strength{}, t{}, v_x{};
  Mask<V> sticks{};
  Memory<V> now;
  for (int k = 0; k < n_evaluations; ++k) {
    const V mu_now = weakened(mu(absolute(rate), n.slip_m), mu_k, n.intact);
    now = form.now(step, n.memory, mu_now, p);
    strength = form.strength(mu_now, p, now);
    if (k == 0) first_strength = strength;
    sticks = along <= strength;  // not the contrary, so that a motion that is not a number is seen as slip
    t = select(sticks, t_stop, copy_sign(strength, direction));
    v_x = select(sticks, V{}, v_trial - t / impedance_x);
    const V mean_rate = 0.5 * (last_rate + v_x);
    if (!any(mean_rate != rate)) break;  // further evaluations would repeat this one
    rate = mean_rate;
  }
  const Mask<V> slipping = !sticks && p > 0;
  const Mask<V> changed = slipping != n.slipping;

  V slip = n.slip_m + select(slipping, absolute(v_x) * dt_s, V{});
  if constexpr (slip_memory == SlipMemory::until_stick) slip = select(sticks && p != 0, V{}, slip);
  V mu_stuck = mu_at_rest;
  if constexpr (slip_memory != SlipMemory::none) mu_stuck = mu(V{}, slip);
  const V strength_at_rest = form.strength(weakened(mu_stuck, mu_k, n.intact), p, now);

  if constexpr (predicts) n.acceleration_m_per_s2 = select(sticks, V{}, (v_x - last_rate) * per_step);
  n.v_x_m_per_s = v_x;
  n.slip_rate_m_per_s = v_x;
  n.t_Pa = t;
  n.strength_Pa = select(sticks, strength_at_rest, select(n.slipping, strength, first_strength));
  n.slipping = slipping;
  n.slip_m = slip;
  n.memory = now;
  return changed;
}

}  // namespace slipfront::interface
