// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "record/record.hpp"

namespace slipfront::fronts {

/// Where the tip of a slipping region is.
enum class TipAt {
  slip_rate,  ///< where the slip rate passes the threshold
  peak,       ///< where |t| is largest on the way to the largest slip rate; for nodes that never stick
};

/// Rebuilds the record from a history: a node slips while |slip rate| > threshold_m_per_s; the onset lies
/// where the slip rate, interpolated linearly in time, passes the threshold; tractions are interpolated to
/// that time. A node that slips at the first time has its onset there. With TipAt::peak each of these onsets
/// is moved to the top of the parabola through the largest |t| and the times before and after it, between the
/// stop before and the largest slip rate until the next stop.
/// @pre threshold_m_per_s > 0, halo >= 0, matrices of matching sizes.
record::SlipRecord record_from_history(const record::History& history, double threshold_m_per_s, int halo,
                                       TipAt tip = TipAt::slip_rate);

}  // namespace slipfront::fronts
