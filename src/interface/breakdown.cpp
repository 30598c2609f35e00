// SPDX-License-Identifier: BSD-3-Clause
#include "interface/breakdown.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/numbers.hpp"

namespace slipfront::interface {

namespace {

/// A breakdown has ended where slip has doubled without a fall of the coefficient that counts, or the
/// coefficient has risen by half of its fall. Before, it has to have come down by some share of its peak:
/// friction that depends on the slip rate goes up and down where slip begins.
constexpr double more_slip = 2, rise_that_ends = 0.5;
constexpr double fall_before_slip_ends = 0.01, fall_before_rise_ends = 0.1;  ///< over the peak
constexpr double fall_that_counts = 1e-3;                                    ///< of the one so far
constexpr double rounding = 1e-9;                                            ///< over the peak

/// On which the coefficient acts.
double pressure_Pa(const ContactModel& model, const Interface& s, std::size_t i) {
  const auto relaxed = model.regularisation.relaxed;
  const bool remembers = relaxed == Relaxed::pressure || relaxed == Relaxed::initial_pressure;
  return s.p_Pa[i] > 0 && remembers ? s.relaxed_Pa[i] : s.p_Pa[i];
}

void end_breakdown(Interface& s, std::size_t i) {
  s.breaking[i] = 0;
  s.broken[i] = 1;
}

void begin(const ContactModel& model, Interface& s, std::size_t i) {
  auto& b = s.breakdown;
  const double p_Pa = pressure_Pa(model, s, i);
  if (!(p_Pa > 0)) return end_breakdown(s, i);
  s.breaking[i] = 1;
  b.peak_t_Pa[i] = s.strength_Pa[i];
  b.peak_coefficient[i] = (s.strength_Pa[i] - model.law_at(i).cohesion_Pa()) / p_Pa;
  b.least_coefficient[i] = b.counted_coefficient[i] = b.peak_coefficient[i];
  b.residual_t_Pa[i] = s.strength_Pa[i];
}

void follow(const ContactModel& model, double dt_s, double v_before_m_per_s, Interface& s, std::size_t i) {
  auto& b = s.breakdown;
  const double p_Pa = pressure_Pa(model, s, i);
  if (!(p_Pa > 0)) {
    end_breakdown(s, i);
    return;
  }
  const double t_Pa = std::abs(s.t_Pa[i]) - model.law_at(i).cohesion_Pa();
  // As in the work of friction: at the mean velocity over the kick.
  const double slip_m = 0.5 * dt_s * (s.v_x_m_per_s[i] + v_before_m_per_s) * std::copysign(1.0, s.t_Pa[i]);
  const double coefficient = t_Pa / p_Pa;
  b.work_of_t_J_per_m2[i] += t_Pa * slip_m;
  b.work_of_p_J_per_m2[i] += p_Pa * slip_m;
  b.impulse_of_t_Pa_s[i] += t_Pa * dt_s;
  b.impulse_of_p_Pa_s[i] += p_Pa * dt_s;
  b.slip_m[i] += std::abs(slip_m);
  if (s.slipping[i] == 0) return;  // what a node bears that sticks is no friction
  if (coefficient > b.peak_coefficient[i]) {
    b.peak_coefficient[i] = b.least_coefficient[i] = b.counted_coefficient[i] = coefficient;
    b.peak_t_Pa[i] = b.residual_t_Pa[i] = std::abs(s.t_Pa[i]);
    b.impulse_of_t_Pa_s[i] = b.impulse_of_p_Pa_s[i] = 0;
    b.counted_slip_m[i] = b.slip_m[i];
    return;
  }
  if (coefficient < b.least_coefficient[i]) {
    b.least_coefficient[i] = coefficient;
    b.residual_t_Pa[i] = std::abs(s.t_Pa[i]);
    b.work_J_per_m2[i] = b.work_of_t_J_per_m2[i] - coefficient * b.work_of_p_J_per_m2[i];
    b.impulse_Pa_s[i] = b.impulse_of_t_Pa_s[i] - coefficient * b.impulse_of_p_Pa_s[i];
  }
  const double peak = b.peak_coefficient[i], fall = peak - coefficient;
  const double largest_fall = peak - b.least_coefficient[i];
  if (b.counted_coefficient[i] - coefficient > fall_that_counts * fall) {
    b.counted_coefficient[i] = coefficient;
    b.counted_slip_m[i] = b.slip_m[i];
  }
  const bool slip_ends =
      b.slip_m[i] > more_slip * b.counted_slip_m[i] && largest_fall > fall_before_slip_ends * peak;
  const bool rise_ends =
      largest_fall - fall > rise_that_ends * largest_fall && largest_fall > fall_before_rise_ends * peak;
  if (slip_ends || rise_ends) end_breakdown(s, i);
}

}  // namespace

void follow_breakdown(const ContactModel& model, double dt_s, std::span<const double> v_before_m_per_s,
                      bool changed, Interface& s) {
  const std::size_t n = s.size();
  for (std::size_t i = 0; changed && i < n; ++i)
    if (s.slipping[i] > (s.breaking[i] | s.broken[i])) begin(model, s, i);
  // Few nodes at a time: eight flags are looked at in one word.
  for (std::size_t first = 0; first < n; first += sizeof(std::uint64_t)) {
    std::uint64_t flags = 0;
    std::memcpy(&flags, &s.breaking[first], std::min(sizeof(flags), n - first));
    for (; flags != 0; flags &= flags - 1) {
      const auto i = first + static_cast<std::size_t>(std::countr_zero(flags)) / 8;
      follow(model, dt_s, v_before_m_per_s[i], s, i);
    }
  }
}

record::Breakdown breakdown_of(const ContactModel& model, const Interface& s, std::size_t first,
                               std::size_t end) {
  const auto& b = s.breakdown;
  record::Breakdown of;
  for (std::size_t i = first; i < end; ++i) {
    const bool begun = b.peak_t_Pa[i] > 0;
    const auto put = [&](std::vector<double>& to, double value) { to.push_back(begun ? value : nan); };
    // Work of the traction at its peak above the residual one. Friction that has but risen falls by rounding.
    const double fall = b.peak_coefficient[i] - b.least_coefficient[i];
    const bool weakens = fall > rounding * b.peak_coefficient[i] && b.work_J_per_m2[i] > 0;
    const double fall_Pa =
        weakens && b.peak_coefficient[i] > 0
            ? fall / b.peak_coefficient[i] * (b.peak_t_Pa[i] - model.law_at(i).cohesion_Pa())
            : 0;
    put(of.work_J_per_m2, weakens ? b.work_J_per_m2[i] : nan);
    put(of.peak_t_Pa, b.peak_t_Pa[i]);
    put(of.residual_t_Pa, b.residual_t_Pa[i]);
    put(of.residual_coefficient, b.least_coefficient[i]);
    put(of.distance_m, fall_Pa > 0 ? 2 * b.work_J_per_m2[i] / fall_Pa : nan);
    put(of.time_s, fall_Pa > 0 ? 2 * b.impulse_Pa_s[i] / fall_Pa : nan);
    of.complete.push_back(begun && weakens && b.impulse_Pa_s[i] > 0 ? s.broken[i] : 0);
  }
  return of;
}

record::Breakdown breakdown_from_history(const record::History& history, double threshold_m_per_s,
                                         double cohesion_Pa) {
  ContactModel model;
  model.law.parameter(FrictionLaw::cohesion_key) = cohesion_Pa;
  const std::size_t n = history.x_m.size();
  Interface state(n);
  for (std::size_t row = 0; row + 1 < history.time_s.size(); ++row) {
    const double dt_s = history.time_s[row + 1] - history.time_s[row];
    const auto slips = [&](std::size_t at) {
      return std::abs(history.slip_rate_m_per_s[at]) > threshold_m_per_s;
    };
    for (std::size_t i = 0; i < n; ++i)
      state.v_x_m_per_s[i] = (history.slip_m[(row + 1) * n + i] - history.slip_m[row * n + i]) / dt_s;
    const auto mean_m_per_s = state.v_x_m_per_s;
    // A trapezoid: half of the interval's slip under the tractions of each end. A breakdown ends at samples:
    // under the tractions of the last one nodes count as those that stick, but for those that begin to slip.
    for (const std::size_t end : {row, row + 1}) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = end * n + i;
        const bool begins =
            (state.breaking[i] | state.broken[i]) == 0 && (slips(row * n + i) || slips((row + 1) * n + i));
        state.t_Pa[i] = history.t_Pa[at];
        state.p_Pa[i] = history.p_Pa[at];
        state.strength_Pa[i] = std::abs(history.t_Pa[at]);
        state.slipping[i] = end == row ? begins : slips(at);
      }
      follow_breakdown(model, 0.5 * dt_s, mean_m_per_s, true, state);
    }
  }
  return breakdown_of(model, state, 0, n);
}

}  // namespace slipfront::interface
