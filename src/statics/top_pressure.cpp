// SPDX-License-Identifier: BSD-3-Clause
#include "statics/top_pressure.hpp"

#include <algorithm>
#include <utility>

namespace slipfront::statics {

double TopPressure::at_Pa(double at_m) const {
  const auto next = std::ranges::upper_bound(x_m, at_m) - x_m.begin();
  if (next == 0) return p_Pa.front();
  if (next == std::ssize(x_m)) return p_Pa.back();
  const double part = (at_m - x_m[next - 1]) / (x_m[next] - x_m[next - 1]);
  return p_Pa[next - 1] + part * (p_Pa[next] - p_Pa[next - 1]);
}

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
        const double share = (at_m - left_m) / (right_m - left_m), force = weight_m * at_Pa(at_m);
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
