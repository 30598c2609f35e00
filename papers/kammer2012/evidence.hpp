// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "papers/kammer2012/scorecard.hpp"

// What the tests of the claims read off the runs, and how they state it.
namespace slipfront::kammer2012 {

inline constexpr double near_nucleation_m = 5e-3;  ///< next to a spontaneous nucleation, left out of maxima
inline constexpr double mm = 1e3;

std::string percent(double share);

/// Points of a front that count and have a speed.
std::vector<const fronts::FrontPoint*> speed_points(const Outcome& outcome, const fronts::Front& front,
                                                    double leave_out = 0);

/// Whether a speed lies within the paper's band at an energy rise; not where the rise is negative or
/// undefined.
bool in_paper_band(double energy_rise, double v_over_c_L);

/// The fit and the share within the band, in words and as figures.
/// @pre collapse.fitted
std::string describe(const Collapse& collapse);
std::vector<Figure> figures_of(const Collapse& collapse);

enum class Kind { crack, pulse, mixed };
Kind kind_of(const Outcome& outcome, const fronts::FrontPoint& point);

/// Points of each kind along the fronts of the runs, or of those among them that are not triggered.
std::array<int, 3> count_kinds(std::span<const Outcome> outcomes, bool spontaneous_only);

/// Null where it was not run.
const StudyOutcome* find_study(const Reproduction& runs, std::string_view name);

}  // namespace slipfront::kammer2012
