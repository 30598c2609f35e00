// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fronts/front.hpp"

namespace slipfront::fronts {

/// Distance from a front's first point to its last.
double length_m(const Front& front);

/// Smoothed dy/ds at every point: the slope of the least-squares line through the points with |s - s_i| <=
/// half_width, or through the nearest side_points on either side where those reach farther (fewer at the ends
/// of the series). Points with NaN in y are not used but get a slope, too. NaN where fewer than 3 points can
/// be used.
/// @pre s ascends, y has its size.
std::vector<double> local_slopes(std::span<const double> s, std::span<const double> y, double half_width,
                                 int side_points);

/// Neighbouring points of a path over which one quantity falls while another rises.
struct Stretch {
  std::size_t first = 0;  ///< index of its first point in the given data
  std::size_t last = 0;   ///< and of its last
  double length_m = 0;
  double fall = 0;  ///< falling quantity, first point minus last; not smoothed
  double rise = 0;  ///< rising quantity, last point minus first; not smoothed
};
struct StretchOptions {
  double min_length_m = 5e-3;
  double half_width_m = 2e-3;  ///< of the slopes, see local_slopes; at least 2 points on each side
};

/// All maximal stretches of at least min_length_m where the smoothed slope of `falling` is negative and that
/// of `rising` is positive. Points with NaN in either are left out; more than two of them in a row end a
/// stretch.
/// @param s_m  ascending distance along the path; falling and rising have its size.
std::vector<Stretch> find_stretches(std::span<const double> s_m, std::span<const double> falling,
                                    std::span<const double> rising, const StretchOptions& options = {});

}  // namespace slipfront::fronts
