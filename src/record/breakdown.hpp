// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "base/numbers.hpp"
#include "record/column.hpp"

namespace slipfront::record {

/// How friction has broken down at the nodes of an interface. Not a number where no slip has begun; work,
/// distance and time also where friction has not fallen. [nodes]
///
/// The residual coefficient is the least (|t| - cohesion)/p from the beginning of slip on, until slip has
/// doubled without a fall that counts, of 0.1 % of the one so far, or the coefficient has risen by half of
/// its fall. Residual traction is the cohesion and the residual coefficient times p, at each time.
struct Breakdown {
  std::vector<double> work_J_per_m2, peak_t_Pa, residual_t_Pa, residual_coefficient, distance_m, time_s;
  /// 1 where the breakdown came to its end, 0 where it was under way when the event ended. [nodes]
  std::vector<double> complete;

  /// Over the nodes where friction has fallen, each with its length; not a number where it has at none.
  double total_work_J_per_m(const std::vector<double>& tributary_m) const {
    double sum = nan;
    for (std::size_t k = 0; k < work_J_per_m2.size(); ++k)
      if (!std::isnan(work_J_per_m2[k]))
        sum = (std::isnan(sum) ? 0 : sum) + work_J_per_m2[k] * tributary_m[k];
    return sum;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(work_J_per_m2, peak_t_Pa, residual_t_Pa, residual_coefficient, distance_m, time_s, complete);
  }
};

inline constexpr std::array<Column<Breakdown, std::vector<double>>, 7> breakdown_fields = {{
    {"breakdown_work_J_per_m2", "J/m2", "work of the traction above the residual one: the fracture energy",
     &Breakdown::work_J_per_m2},
    {"peak_t_Pa", "Pa", "largest |t|, where slip begins", &Breakdown::peak_t_Pa},
    {"residual_t_Pa", "Pa", "|t| where its ratio to p, less the cohesion, is least",
     &Breakdown::residual_t_Pa},
    {"residual_coefficient", "1", "that least ratio", &Breakdown::residual_coefficient},
    {"weakening_distance_m", "m", "slip in which a linear fall from peak to residual does the breakdown work",
     &Breakdown::distance_m},
    {"weakening_time_s", "s",
     "time of a fall linear in time with the same impulse above the residual traction", &Breakdown::time_s},
    {"breakdown_complete", "1", "1 where the breakdown came to its end", &Breakdown::complete},
}};

}  // namespace slipfront::record
