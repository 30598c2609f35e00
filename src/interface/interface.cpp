// SPDX-License-Identifier: BSD-3-Clause
#include "interface/interface.hpp"

#include <algorithm>
#include <cmath>

namespace slipfront::interface {

Interface::Interface(std::size_t n)
    : initial_gap_m(n),
      mass_per_length_kg_m2(n),
      tangential_mass_ratio(n, 1.0),
      intact(n, 1.0),
      v_x_m_per_s(n),
      v_y_m_per_s(n),
      u_y_m(n),
      slip_rate_m_per_s(n),
      t_Pa(n),
      p_Pa(n),
      demand_Pa(n),
      strength_Pa(n),
      slipping(n),
      slip_m(n),
      relaxed_Pa(n),
      target_Pa(n),
      acceleration_m_per_s2(n),
      locked(n) {}

namespace {

/// The coefficient of a node that may be weakened; exactly the law's where intact is 1.
double weakened(double mu, double mu_k, double intact) {
  return mu - (1 - intact) * (mu - mu_k);
}

/// Pressure of the direct algorithm: what the gap at the step's end needs to be closed.
double press_direct(Interface& s, std::size_t i, double impedance, double per_step) {
  const double gap_rate = (s.initial_gap_m[i] + s.u_y_m[i]) * per_step;
  const double p = std::max(0.0, -(s.v_y_m_per_s[i] + gap_rate) * impedance);
  s.v_y_m_per_s[i] += p / impedance;
  return p;
}

/// Pressure of the predictor-corrector algorithm: what keeps the normal velocity of a locked node at zero.
double press_locked(Interface& s, std::size_t i, double impedance, double per_step) {
  const double v_y = s.v_y_m_per_s[i];
  const bool was_locked = s.locked[i] != 0;
  const bool stays = was_locked && v_y <= 0;
  const bool lands = !was_locked && v_y + (s.initial_gap_m[i] + s.u_y_m[i]) * per_step < 0;
  s.u_y_m[i] = lands ? -s.initial_gap_m[i] : s.u_y_m[i];
  s.v_y_m_per_s[i] = stays || lands ? 0.0 : v_y;
  s.locked[i] = stays || lands;
  return stays ? -v_y * impedance : 0.0;
}

/// Evaluations of the coefficient at the mean slip rate of the step, each with the rate that the one before
/// gave. The first alone, at the last rate, leaves an error of first order in dt; from the second on it is of
/// second order, and the third is nearer the solution of the implicit equation where friction weakens fast.
constexpr int rate_evaluations = 3;

template <ContactAlgorithm algorithm, class Law, class Form>
bool update(const Law& law, const Form& form, double dt_s, Interface& s) {
  constexpr bool predicts = algorithm == ContactAlgorithm::predictor_corrector;
  constexpr int n_evaluations = predicts ? 1 : rate_evaluations;
  const auto mu = law.evaluator();
  const double mu_k = law.kinetic_coefficient();
  const double mu_at_rest = mu(0, 0);
  const double per_step = 1 / dt_s;
  unsigned changed = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double impedance = s.mass_per_length_kg_m2[i] * per_step;
    const double p =
        predicts ? press_locked(s, i, impedance, per_step) : press_direct(s, i, impedance, per_step);

    const double last_rate = s.slip_rate_m_per_s[i];  // since the last update
    const auto step = form.step(std::abs(last_rate), {s.relaxed_Pa[i], s.target_Pa[i]});

    const double impedance_x = impedance * s.tangential_mass_ratio[i];
    const double t_stop = s.v_x_m_per_s[i] * impedance_x;
    const double demand = std::abs(t_stop);
    // Newmark's predictor v + a dt of the velocity at the step's beginning.
    double rate = predicts ? last_rate + 0.5 * dt_s * s.acceleration_m_per_s2[i] : last_rate;
    // Friction opposes the motion: that of the trial, or, by the predictor, that of a node under way.
    const bool under_way = predicts && rate != 0 && p > 0;
    const double direction = under_way ? rate : t_stop;
    const double along = under_way ? std::copysign(1.0, rate) * t_stop : demand;
    double strength = 0, first_strength = 0, t = 0, v_x = 0;
    bool slips = false;
    Memory now;
    for (int k = 0; k < n_evaluations; ++k) {
      const double mu_now = weakened(mu(std::abs(rate), s.slip_m[i]), mu_k, s.intact[i]);
      now = step.now(mu_now, p);
      strength = Form::strength(mu_now, p, now);
      first_strength = k == 0 ? strength : first_strength;
      slips = !(along <= strength);  // so that a motion that is not a number shows up as a slip rate
      t = slips ? std::copysign(strength, direction) : t_stop;
      v_x = slips ? s.v_x_m_per_s[i] - t / impedance_x : 0.0;
      rate = 0.5 * (last_rate + v_x);
    }
    const std::uint8_t slipping = slips && p > 0;
    changed |= static_cast<unsigned>(slipping ^ s.slipping[i]);

    double slip = s.slip_m[i] + (slipping != 0 ? std::abs(v_x) * dt_s : 0.0);
    if constexpr (Law::memory == SlipMemory::until_stick) slip = slips || p == 0 ? slip : 0.0;
    const double mu_stuck = Law::memory == SlipMemory::none ? mu_at_rest : mu(0, slip);
    const double strength_at_rest = Form::strength(weakened(mu_stuck, mu_k, s.intact[i]), p, now);

    if constexpr (predicts) s.acceleration_m_per_s2[i] = slips ? (v_x - last_rate) * per_step : 0.0;
    s.v_x_m_per_s[i] = v_x;
    s.slip_rate_m_per_s[i] = v_x;
    s.t_Pa[i] = t;
    s.p_Pa[i] = p;
    s.demand_Pa[i] = demand;
    const double overcome = s.slipping[i] != 0 ? strength : first_strength;
    s.strength_Pa[i] = slips ? overcome : strength_at_rest;
    s.slipping[i] = slipping;
    s.slip_m[i] = slip;
    s.relaxed_Pa[i] = now.relaxed_Pa;
    s.target_Pa[i] = now.target_Pa;
  }
  return changed != 0;
}

}  // namespace

void start_contact(const ContactModel& model, Interface& s) {
  const double mu = static_coefficient(model.law), mu_k = kinetic_coefficient(model.law);
  s.begun = false;
  with_form(model.regularisation, 0, [&](const auto& form) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double mu_0 = weakened(mu, mu_k, s.intact[i]);
      s.strength_Pa[i] = mu_0 * s.p_Pa[i];
      const Memory memory = form.initial(mu_0, s.p_Pa[i]);
      s.relaxed_Pa[i] = memory.relaxed_Pa;
      s.target_Pa[i] = memory.target_Pa;
      s.slip_m[i] = 0;
      s.acceleration_m_per_s2[i] = 0;
      s.locked[i] = s.p_Pa[i] > 0;
    }
  });
}

bool update_contact(const ContactModel& model, double dt_s, Interface& state) {
  const double since_last_s = state.begun ? dt_s : 0;
  state.begun = true;
  return std::visit(
      [&](const auto& law) {
        return with_form(model.regularisation, since_last_s, [&](const auto& form) {
          return model.algorithm == ContactAlgorithm::direct
                     ? update<ContactAlgorithm::direct>(law, form, dt_s, state)
                     : update<ContactAlgorithm::predictor_corrector>(law, form, dt_s, state);
        });
      },
      model.law);
}

}  // namespace slipfront::interface
