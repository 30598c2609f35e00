// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/error.hpp"
#include "interface/interface.hpp"
#include "interface/node.hpp"

// The contact update by a StateArrayLaw: as `slide` of a law with a state, of all nodes at once.
namespace slipfront::interface {

/// Finds the root of a function that rises from below 0 to above 0 between x and y, by Chandrupatla's choice
/// of bisection and inverse quadratic interpolation. The caller evaluates: one point after the other.
class Bracket {
 public:
  Bracket() = default;
  Bracket(double x, double f_x, double y, double f_y) : a_(y), f_a_(f_y), b_(x), f_b_(f_x) { next(0.5); }
  bool is_done() const { return done_; }
  double point() const { return point_; }
  void take(double f) {
    double c = b_, f_c = f_b_;
    if ((f > 0) == (f_a_ > 0)) {
      c = a_, f_c = f_a_;
    } else {
      b_ = a_, f_b_ = f_a_;
    }
    a_ = point_, f_a_ = f;
    const double xi = (a_ - b_) / (c - b_), phi = (f_a_ - f_b_) / (f_c - f_b_);
    const bool is_smooth = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    next(is_smooth ? f_a_ / (f_b_ - f_a_) * f_c / (f_b_ - f_c) +
                         (c - a_) / (b_ - a_) * f_a_ / (f_c - f_a_) * f_b_ / (f_c - f_b_)
                   : 0.5);
  }

 private:
  void next(double share) {
    const double nearest = std::abs(f_a_) < std::abs(f_b_) ? a_ : b_;
    const double least = 2 * std::numeric_limits<double>::epsilon() * std::abs(nearest) / std::abs(b_ - a_);
    done_ = !(least < 0.5) || f_a_ == 0 || f_b_ == 0;
    point_ = done_ ? nearest : a_ + std::clamp(share, least, 1 - least) * (b_ - a_);
  }
  double a_ = 0, f_a_ = 0, b_ = 0, f_b_ = 0, point_ = 0;
  bool done_ = true;
};

template <class Regularised>
bool update_by(const StateArrayLaw& law, const ContactModel& model, const Regularised& regularisation,
               double dt_s, Interface& s) {
  using Values = std::vector<double>;
  const std::size_t n = s.size();
  const double per_step = 1 / dt_s;
  Values pressure(n), impedance(n), w(n), rate(n), t(n), v_x(n);
  std::vector<Memory<double>> now(n);
  for (std::size_t i = 0; i < n; ++i) {
    Node<double> node{};
    node.initial_gap_m = s.initial_gap_m[i];
    node.u_y_m = s.u_y_m[i];
    node.v_y_m_per_s = s.v_y_m_per_s[i];
    const double impedance_y = s.mass_per_length_kg_m2[i] * per_step;
    press_direct(node, impedance_y, per_step);
    s.v_y_m_per_s[i] = node.v_y_m_per_s;
    s.p_Pa[i] = node.p_Pa;
    impedance[i] = impedance_y * s.tangential_mass_ratio[i];
    now[i] = regularisation.now(regularisation.step(std::abs(s.slip_rate_m_per_s[i])),
                                {s.relaxed_Pa[i], s.target_Pa[i]}, 1.0, node.p_Pa);
    pressure[i] = regularisation.strength(1.0, node.p_Pa, now[i]);
  }
  Values speed(n), value(n), further(n);
  const auto evaluate = [&](Values& to) { law.coefficient(speed, s.law_states, to); };

  // The way from the rate before to that after at which V is, as in `slide`.
  constexpr double small = 1e-4, slow_m_per_s = 1e-12;
  const auto last = [&](std::size_t i) { return std::max(std::abs(s.slip_rate_m_per_s[i]), slow_m_per_s); };
  for (std::size_t i = 0; i < n; ++i) speed[i] = (1 - small) * last(i);
  evaluate(value);
  for (std::size_t i = 0; i < n; ++i) speed[i] = (1 + small) * last(i);
  evaluate(further);
  for (std::size_t i = 0; i < n; ++i) {
    const double softness = 2 * small * last(i) * impedance[i] / (pressure[i] * (further[i] - value[i]));
    w[i] = implicit_weight(softness);
  }

  /// Slip rates of nodes in contact: V from 0 to the rate without friction, where p mu(V) is what the mass
  /// takes of it; over ln V, in which friction is nearly a straight line.
  const auto solve = [&](auto&& concerns) {
    std::vector<Bracket> brackets(n);
    Values most(n), low(n), f_high(n), f_low(n);
    std::vector<std::uint8_t> is_open(n);
    const auto excess = [&](std::size_t i, double V, double mu) {
      return pressure[i] * mu - (most[i] - V) * impedance[i] / w[i];
    };
    const auto solved = [&](std::size_t i) { return concerns(i) && pressure[i] > 0 && most[i] > 1e-200; };
    for (std::size_t i = 0; i < n; ++i) {
      if (!concerns(i)) continue;
      rate[i] = w[i] * s.v_x_m_per_s[i] + (1 - w[i]) * s.slip_rate_m_per_s[i];
      speed[i] = most[i] = std::abs(rate[i]);
      low[i] = std::log(most[i]);
      is_open[i] = solved(i);
    }
    evaluate(f_high);
    for (std::size_t i = 0; i < n; ++i) f_high[i] = excess(i, most[i], f_high[i]);
    for (double down = 1; std::ranges::any_of(is_open, [](auto open) { return open != 0; }); down *= 2) {
      for (std::size_t i = 0; i < n; ++i)
        if (is_open[i]) speed[i] = std::exp(low[i] -= down);
      evaluate(value);
      for (std::size_t i = 0; i < n; ++i) {
        if (!is_open[i]) continue;
        f_low[i] = excess(i, speed[i], value[i]);
        if (f_low[i] > 0 && speed[i] > 0) continue;
        if (f_low[i] > 0)
          throw UserError("mu is {:.3g} without slip; under a law with a state it is 0 there", value[i]);
        is_open[i] = 0;
        brackets[i] = Bracket(low[i], f_low[i], std::log(most[i]), f_high[i]);
      }
    }
    while (std::ranges::any_of(brackets, [](const Bracket& b) { return !b.is_done(); })) {
      for (std::size_t i = 0; i < n; ++i)
        if (solved(i)) speed[i] = std::exp(brackets[i].point());
      evaluate(value);
      for (std::size_t i = 0; i < n; ++i)
        if (!brackets[i].is_done()) brackets[i].take(excess(i, speed[i], value[i]));
    }
    for (std::size_t i = 0; i < n; ++i)
      if (solved(i)) speed[i] = std::exp(brackets[i].point());
    evaluate(value);
    for (std::size_t i = 0; i < n; ++i) {
      if (!concerns(i)) continue;
      t[i] = solved(i) ? std::copysign(pressure[i] * value[i], rate[i]) : 0;
      v_x[i] = s.v_x_m_per_s[i] - t[i] / impedance[i];
    }
  };
  solve([](std::size_t) { return true; });
  std::vector<std::uint8_t> turns(n);
  for (std::size_t i = 0; i < n; ++i) {
    turns[i] = v_x[i] * s.v_x_m_per_s[i] < 0;
    if (turns[i]) w[i] = 1;
  }
  if (std::ranges::any_of(turns, [](auto turned) { return turned != 0; }))
    solve([&](std::size_t i) { return turns[i] != 0; });

  bool changed = false;
  for (std::size_t i = 0; i < n; ++i) {
    const bool in_contact = pressure[i] > 0;
    rate[i] = w[i] * v_x[i] + (1 - w[i]) * s.slip_rate_m_per_s[i];
    s.v_x_m_per_s[i] = s.slip_rate_m_per_s[i] = v_x[i];
    s.t_Pa[i] = t[i];
    s.strength_Pa[i] = std::abs(t[i]);
    s.onset_ratio[i] = in_contact ? std::abs(rate[i]) / model.tip_slip_rate_m_per_s : 0;
    const auto slips = static_cast<std::uint8_t>(!(s.onset_ratio[i] <= 1));
    changed = changed || slips != s.slipping[i];
    s.slipping[i] = slips;
    if (in_contact) s.slip_m[i] += std::abs(v_x[i]) * dt_s;
    s.relaxed_Pa[i] = now[i].relaxed_Pa;
    s.target_Pa[i] = now[i].target_Pa;
    speed[i] = std::abs(v_x[i]);
  }
  law.evolve(speed, dt_s, s.law_states);
  return changed;
}

}  // namespace slipfront::interface
