// SPDX-License-Identifier: BSD-3-Clause
#include "interface/breakdown.hpp"

#include <cmath>

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

}  // namespace

double pressure_of_friction_Pa(const ContactModel& model, const Interface& s, std::size_t i) {
  const auto relaxed = model.regularisation.relaxed;
  const bool remembers = relaxed == Relaxed::pressure || relaxed == Relaxed::initial_pressure;
  return s.p_Pa[i] > 0 && remembers ? s.relaxed_Pa[i] : s.p_Pa[i];
}

BreakdownMonitor::BreakdownMonitor(std::size_t n_nodes) {
  for_each_array([&](auto& values) { values.assign(n_nodes, 0); });
}

void BreakdownMonitor::end(std::size_t i) {
  breaking_[i] = 0;
  broken_[i] = 1;
}

void BreakdownMonitor::begin(const NodeFriction& now, std::size_t i) {
  if (!(now.p_Pa > 0)) return end(i);
  breaking_[i] = 1;
  peak_t_Pa_[i] = residual_t_Pa_[i] = now.strength_Pa;
  peak_coefficient_[i] = (now.strength_Pa - now.cohesion_Pa) / now.p_Pa;
  least_coefficient_[i] = counted_coefficient_[i] = peak_coefficient_[i];
}

void BreakdownMonitor::follow(double dt_s, const NodeFriction& now, std::size_t i) {
  if (!(now.p_Pa > 0)) return end(i);
  const double t_Pa = std::abs(now.t_Pa) - now.cohesion_Pa;
  const double slip_m = now.slip_m * std::copysign(1.0, now.t_Pa);
  const double coefficient = t_Pa / now.p_Pa;
  work_of_t_J_per_m2_[i] += t_Pa * slip_m;
  work_of_p_J_per_m2_[i] += now.p_Pa * slip_m;
  impulse_of_t_Pa_s_[i] += t_Pa * dt_s;
  impulse_of_p_Pa_s_[i] += now.p_Pa * dt_s;
  slip_m_[i] += std::abs(slip_m);
  if (!now.slips) return;  // what a node bears that sticks is no friction
  if (coefficient > peak_coefficient_[i]) {
    peak_coefficient_[i] = least_coefficient_[i] = counted_coefficient_[i] = coefficient;
    peak_t_Pa_[i] = residual_t_Pa_[i] = std::abs(now.t_Pa);
    impulse_of_t_Pa_s_[i] = impulse_of_p_Pa_s_[i] = 0;
    counted_slip_m_[i] = slip_m_[i];
    return;
  }
  if (coefficient < least_coefficient_[i]) {
    least_coefficient_[i] = coefficient;
    residual_t_Pa_[i] = std::abs(now.t_Pa);
    work_J_per_m2_[i] = work_of_t_J_per_m2_[i] - coefficient * work_of_p_J_per_m2_[i];
    impulse_Pa_s_[i] = impulse_of_t_Pa_s_[i] - coefficient * impulse_of_p_Pa_s_[i];
  }
  const double peak = peak_coefficient_[i], fall = peak - coefficient;
  const double largest_fall = peak - least_coefficient_[i];
  if (counted_coefficient_[i] - coefficient > fall_that_counts * fall) {
    counted_coefficient_[i] = coefficient;
    counted_slip_m_[i] = slip_m_[i];
  }
  const bool slip_ends =
      slip_m_[i] > more_slip * counted_slip_m_[i] && largest_fall > fall_before_slip_ends * peak;
  const bool rise_ends =
      largest_fall - fall > rise_that_ends * largest_fall && largest_fall > fall_before_rise_ends * peak;
  if (slip_ends || rise_ends) end(i);
}

void BreakdownMonitor::add_found(std::size_t i, double cohesion_Pa, record::Breakdown& all) const {
  const bool begun = peak_t_Pa_[i] > 0;
  const auto put = [&](std::vector<double>& to, double value) { to.push_back(begun ? value : nan); };
  // Work of the traction at its peak above the residual one. Friction that has but risen falls by rounding.
  const double fall = peak_coefficient_[i] - least_coefficient_[i];
  const bool weakens = fall > rounding * peak_coefficient_[i] && work_J_per_m2_[i] > 0;
  const double fall_Pa =
      weakens && peak_coefficient_[i] > 0 ? fall / peak_coefficient_[i] * (peak_t_Pa_[i] - cohesion_Pa) : 0;
  put(all.work_J_per_m2, weakens ? work_J_per_m2_[i] : nan);
  put(all.peak_t_Pa, peak_t_Pa_[i]);
  put(all.residual_t_Pa, residual_t_Pa_[i]);
  put(all.residual_coefficient, least_coefficient_[i]);
  put(all.distance_m, fall_Pa > 0 ? 2 * work_J_per_m2_[i] / fall_Pa : nan);
  put(all.time_s, fall_Pa > 0 ? 2 * impulse_Pa_s_[i] / fall_Pa : nan);
  all.complete.push_back(begun && weakens && impulse_Pa_s_[i] > 0 ? broken_[i] : 0);
}

record::Breakdown breakdown_from_history(const record::History& history, double threshold_m_per_s,
                                         double cohesion_Pa) {
  const std::size_t n = history.x_m.size();
  BreakdownMonitor monitor(n);
  for (std::size_t row = 0; row + 1 < history.time_s.size(); ++row) {
    const double half_s = 0.5 * (history.time_s[row + 1] - history.time_s[row]);
    const auto slips = [&](std::size_t at) {
      return std::abs(history.slip_rate_m_per_s[at]) > threshold_m_per_s;
    };
    // A trapezoid: half of the interval's slip under the tractions of each end. A breakdown ends at samples:
    // under the tractions of the last one nodes count as those that stick, but for those that begin to slip.
    for (const std::size_t end : {row, row + 1}) {
      std::vector<std::uint8_t> counts(n);
      for (std::size_t i = 0; i < n; ++i) {
        const bool begins = !monitor.has_begun(i) && (slips(row * n + i) || slips((row + 1) * n + i));
        counts[i] = end == row ? begins : slips(end * n + i);
      }
      monitor.follow(
          half_s, true, [&](std::size_t i) { return counts[i]; },
          [&](std::size_t i) {
            const std::size_t at = end * n + i;
            const double slip_m = 0.5 * (history.slip_m[(row + 1) * n + i] - history.slip_m[row * n + i]);
            return NodeFriction{history.t_Pa[at], history.p_Pa[at], std::abs(history.t_Pa[at]),
                                cohesion_Pa,      slip_m,           counts[i] != 0};
          });
    }
  }
  return monitor.found(0, n, [&](std::size_t) { return cohesion_Pa; });
}

}  // namespace slipfront::interface
