// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "mesh/mesh.hpp"
#include "motion/time_stepper.hpp"
#include "papers/kammer2012/outcome.hpp"

// The longitudinal wave ahead of the left-triggered front: the circular white zone of Fig. 3 (a).
namespace slipfront::kammer2012 {

/// The wave is looked for at multiples of this time while the front's tip is between these places.
inline constexpr double wave_interval_s = 5e-6, tip_from_m = 60e-3, tip_to_m = 130e-3;

// What the wave has to be, in this share of the snapshots and on both rays.
inline constexpr double min_share_of_snapshots = 0.8;
inline constexpr double min_peak_m_per_s = 1;  ///< the light half of the paper's colours
inline constexpr double max_off_c_L_t = 0.1;   ///< share of c_L t between wave and trigger zone
inline constexpr double max_gap = 0.5;         ///< lowest velocity behind the wave, over the wave's

/// The wave on each ray of each snapshot of an event triggered at the left edge.
/// @param plate        its nodes come first in the snapshots
/// @param zone_from_m  ends of the trigger zone along x
std::vector<WaveOnRay> waves_on_rays(const std::vector<motion::Snapshot>& snapshots, const mesh::Mesh& plate,
                                     double zone_from_m, double zone_to_m);

/// When a run of the left-triggered event needs snapshots; none without a front.
std::vector<double> wave_times_s(const Outcome& left);

/// How clearly the wave stands apart.
struct Circle {
  int n_snapshots = 0;        ///< at wave_times_s
  int n_apart = 0;            ///< of them, with the wave as it has to be on both rays
  double peak_m_per_s = nan;  ///< medians over rays and snapshots of the wave's velocity,
  double gap = nan;           ///< of the lowest velocity behind it over its own,
  double over_c_L_t = nan;    ///< and of its distance from the trigger zone over c_L t; NaN without a wave

  bool holds() const { return n_snapshots > 0 && n_apart >= min_share_of_snapshots * n_snapshots; }
};

/// None without snapshots at wave_times_s.
std::optional<Circle> circle(const Outcome& left);

}  // namespace slipfront::kammer2012
