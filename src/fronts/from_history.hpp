// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "record/record.hpp"

namespace slipfront::fronts {

/// Rebuilds the record from a history: a node slips while |slip rate| > threshold_m_per_s; the onset lies
/// where the slip rate, interpolated linearly in time, passes the threshold; tractions are interpolated to
/// that time. A node that slips at the first time has its onset there.
/// @pre threshold_m_per_s > 0, halo >= 0, matrices of matching sizes.
record::SlipRecord record_from_history(const record::History& history, double threshold_m_per_s, int halo);

}  // namespace slipfront::fronts
