// SPDX-License-Identifier: BSD-3-Clause
#include "interface/interface.hpp"

#include <algorithm>
#include <cmath>

namespace slipfront::interface {

Interface::Interface(std::size_t n)
    : initial_gap_m(n),
      mass_per_length_kg_m2(n),
      v_x_m_per_s(n),
      v_y_m_per_s(n),
      u_y_m(n),
      slip_rate_m_per_s(n),
      t_Pa(n),
      p_Pa(n),
      demand_Pa(n),
      slipping(n) {}

namespace {

template <class Evaluator>
bool update(const Evaluator& mu, double dt_s, Interface& s) {
  const double per_step = 1 / dt_s;
  unsigned changed = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double impedance = s.mass_per_length_kg_m2[i] * per_step;
    const double gap_rate = (s.initial_gap_m[i] + s.u_y_m[i]) * per_step;
    const double p = std::max(0.0, -(s.v_y_m_per_s[i] + gap_rate) * impedance);
    const double t_stop = s.v_x_m_per_s[i] * impedance;
    const double demand = std::abs(t_stop);
    const double strength = mu(std::abs(s.slip_rate_m_per_s[i])) * p;
    const bool slips =
        !(demand <= strength);  // so that a motion that is not a number shows up as a slip rate
    const double t = slips ? std::copysign(strength, t_stop) : t_stop;
    const std::uint8_t slipping = slips && p > 0;
    changed |= static_cast<unsigned>(slipping ^ s.slipping[i]);
    s.v_x_m_per_s[i] = slips ? s.v_x_m_per_s[i] - t / impedance : 0.0;
    s.v_y_m_per_s[i] += p / impedance;
    s.slip_rate_m_per_s[i] = s.v_x_m_per_s[i];
    s.t_Pa[i] = t;
    s.p_Pa[i] = p;
    s.demand_Pa[i] = demand;
    s.slipping[i] = slipping;
  }
  return changed != 0;
}

}  // namespace

bool update_contact(const FrictionLaw& law, double dt_s, Interface& state) {
  return std::visit([&](const auto& l) { return update(l.evaluator(), dt_s, state); }, law);
}

}  // namespace slipfront::interface
