// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/numbers.hpp"
#include "fronts/fit.hpp"
#include "papers/kammer2012/cases.hpp"
#include "run/run.hpp"

namespace slipfront::kammer2012 {

/// The outermost maximum of |v| of at least min_peak_m_per_s on a ray from the plate's left corner.
struct WaveOnRay {
  double time_s = 0, angle_deg = 0;
  double distance_m = nan;    ///< from the nearest place of the trigger zone; NaN: no such maximum
  double peak_m_per_s = nan;  ///< |v| there
  double lowest_behind_m_per_s =
      nan;  ///< least |v| on the way back to where it is exceeded, or to the corner
};

/// What analysis needs of a run, without its histories and fields.
struct Outcome {
  std::string name;
  input::Case config;
  run::WaveSpeeds speeds;
  std::vector<fronts::Front> fronts;  ///< at least criteria_length_m long
  record::StaticState common;
  double contact_from_m = 0, contact_to_m = 0;
  double inside_from_m = 0, inside_to_m = 0;
  double peak_x_m = 0;         ///< of t_s/p_s inside
  double first_onset_x_m = 0;  ///< inside; of several at once the farthest from the peak; NaN: none
  double critical_shear_m = 0;
  double ramp_critical_shear_m = 0;  ///< NaN where there was no ramp
  std::size_t ramp_onsets = 0;       ///< beginnings of slip at the edges during the ramp
  double trigger_work_J_per_m = 0;   ///< NaN without energies
  std::vector<WaveOnRay> waves;      ///< of each snapshot; triggered at the left edge alone

  bool triggered() const { return interface::is_at_edge(config.event); }
};

/// Shorter fronts are left out of the claims.
inline constexpr double criteria_length_m = 10e-3;

Outcome make_outcome(const std::string& name, const run::Result& result, const run::InitialState& initial);

/// The longest front in a direction; null where there is none.
const fronts::Front* main_front(const Outcome& outcome, int direction);

/// The longest front of all; null where there is none.
const fronts::Front* longest_front(const Outcome& outcome);

/// Whether a point counts: outside the trigger zone and its margin and, with leave_out_m, not that near to
/// the start of a front that nucleated by itself.
bool counts(const Outcome& outcome, const fronts::Front& front, const fronts::FrontPoint& point,
            double leave_out_m = 0);

enum class Criterion { static_ratio, dynamic_ratio, energy_rise };

/// t_s/p_s, t_d/p_d or (U_r - U_s)/U_s of a point.
double criterion_value(const fronts::FrontPoint& point, Criterion criterion);

/// The last stretch before a front's end, where the paper sees its speed leave the energy criterion.
inline constexpr double tail_m = 20e-3;

/// Whether a point lies within tail_m of the end of a front that arrests or runs out of contact.
bool in_tail(const fronts::Front& front, const fronts::FrontPoint& point);

/// V_tip/c_L against a criterion, a series for each front of each run; points that count and for which the
/// speed and all criteria are defined.
std::vector<fronts::Series> criterion_series(std::span<const Outcome* const> outcomes, Criterion criterion,
                                             bool without_tails = false);

/// The same with all fronts of a run in one series.
std::vector<fronts::Series> case_series(std::span<const Outcome* const> outcomes, Criterion criterion);

/// The paper's fit of Fig. 6 and its band.
struct PaperFit {
  double a = 0.76, b = 1.80, c = 3.05, band = 0.07;
  double operator()(double energy_rise) const;
};

/// How well one criterion orders the speeds of a set of runs.
struct Collapse {
  /// Spread of V_tip/c_L at equal criterion, between the runs and between all their fronts.
  struct Spreads {
    fronts::Spread cases, fronts;
  };
  Spreads static_ratio, dynamic_ratio, energy_rise;
  bool fitted = false;
  fronts::ExponentialFit fit;  ///< of V_tip/c_L against the energy rise
  double share_in_paper_band = 0;
  std::size_t n_points = 0;
};
Collapse collapse(std::span<const Outcome* const> outcomes, bool without_tails = false);

/// Bins of a criterion's range in spreads and ratios.
inline constexpr int criterion_bins = 20;

/// Change of V_tip against a reference run of the same event at equal x: over the nodes of the reference's
/// longest front in each direction where both count.
struct SpeedChange {
  double median = 0;           ///< of (V - V_ref) / V_ref; NaN without common points
  double median_absolute = 0;  ///< of its absolute value
  double largest = 0;          ///< absolute value
  std::size_t n_points = 0;
};
SpeedChange speed_change(const Outcome& run, const Outcome& reference);

}  // namespace slipfront::kammer2012
