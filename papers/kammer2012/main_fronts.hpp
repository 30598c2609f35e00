// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "papers/kammer2012/outcome.hpp"

namespace slipfront::kammer2012 {

/// Fronts that start no farther than this from the first onset start at the nucleation. Points nearer than
/// this to the start of a front that nucleated by itself do not count.
inline constexpr double nucleation_reach_m = 5e-3;

/// A main front is over where its speed stays below this share of c_L.
inline constexpr double slow_share = 0.1;

/// A front that belongs to its event's nucleation or trigger, and those of its points that count.
struct MainFront {
  const Outcome* outcome = nullptr;
  const fronts::Front* front = nullptr;
  std::span<const fronts::FrontPoint> points;  ///< of `front`, neighbours in the order of travel
};

/// The longest front in a direction that starts at its event's nucleation or trigger; null where there is
/// none. In a triggered event: that starts in the trigger zone or in the margin beyond it, where points do
/// not count. In any other: that starts within nucleation_reach_m of the first onset. Fronts in the wake of
/// others, and those that nucleate ahead of them, are none.
const fronts::Front* first_front(const Outcome& outcome, int direction);

/// The main fronts of runs: of each the first_front against the shear and along it, where there is one with
/// points that count. The points begin beyond the trigger zone and its margin, or nucleation_reach_m from
/// where a front nucleated by itself. They end with the front, or before the first point from which V_tip
/// stays below slow_share c_L: is nowhere defined and above that again, up to the front's end. A slow stretch
/// behind which the front is fast again belongs to it.
std::vector<MainFront> main_fronts(std::span<const Outcome* const> outcomes);

/// Whether a point lies in the last tail_m before the end of a main front's points. A front that may still
/// run when the record ends has no such end.
bool in_tail(const MainFront& front, const fronts::FrontPoint& point);

/// How well each criterion orders the speeds of main fronts without their tails.
Collapse collapse_without_tails(std::span<const MainFront> mains);

}  // namespace slipfront::kammer2012
