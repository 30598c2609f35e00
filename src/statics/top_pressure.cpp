// SPDX-License-Identifier: BSD-3-Clause
#include "statics/top_pressure.hpp"

#include <utility>

#include "base/interpolation.hpp"

namespace slipfront::statics {

std::vector<double> TopPressure::forces_N_per_m(const std::vector<double>& nodes_x_m) const {
  std::vector<double> forces(nodes_x_m.size(), 0.0);
  for (std::size_t k = 0; k + 1 < nodes_x_m.size(); ++k) {
    const double left_m = nodes_x_m[k], right_m = nodes_x_m[k + 1];
    double from_m = left_m;
    // Pressure times the nodes' shares is of second order, of which Simpson's rule is exact.
    const auto add_until = [&](double to_m) {
      const double middle_m = 0.5 * (from_m + to_m), sixth_m = (to_m - from_m) / 6;
      for (const auto& [at_m, weight_m] :
           {std::pair(from_m, sixth_m), {middle_m, 4 * sixth_m}, {to_m, sixth_m}}) {
        const double share = (at_m - left_m) / (right_m - left_m),
                     force = weight_m * interpolated(x_m, p_Pa, at_m);
        forces[k] += (1 - share) * force;
        forces[k + 1] += share * force;
      }
      from_m = to_m;
    };
    for (const double place_m : x_m)
      if (place_m > left_m && place_m < right_m) add_until(place_m);
    add_until(right_m);
  }
  return forces;
}

double TopPressure::force_N_per_m(double width_m) const {
  const auto of_ends = forces_N_per_m({0, width_m});
  return of_ends.front() + of_ends.back();
}

}  // namespace slipfront::statics
