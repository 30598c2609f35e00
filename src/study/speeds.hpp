// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fronts/front.hpp"

namespace slipfront::study {

/// Stations nearer than this to the start of a front are left out: the speed diverges there.
inline constexpr double nucleation_m = 5e-3;

/// What a study keeps of a run.
struct MainFronts {
  std::vector<fronts::Front> fronts;  ///< the longest in each direction
  fronts::FrontOptions options;       ///< with the zones left out
};

/// A place at which speeds are compared.
struct Place {
  double x_m = 0;
  int direction = 0;  ///< of the front, +1 or -1 along x
};

std::vector<fronts::Front> main_fronts(const std::vector<fronts::Front>& all);

/// Whole multiples of the spacing where the fronts have a speed, outside nucleation and excluded zones.
std::vector<Place> stations(const MainFronts& own, double spacing_m);

/// V_tip of a front where its tip passes x, linear between its points; NaN beyond them.
double v_tip_at(const fronts::Front& front, double x_m);

/// The same of the main front in the place's direction; NaN where there is none.
double speed_at(const MainFronts& fronts, const Place& place);

}  // namespace slipfront::study
