// SPDX-License-Identifier: BSD-3-Clause
#include "python/histories.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "base/numbers.hpp"

namespace slipfront::python {
namespace {

/// Nodes on each side of an onset whose tractions t_d and p_d may need.
int halo_of(std::span<const double> x_m, double l_star_m) {
  double smallest_m = infinity, largest_m = 0;
  for (std::size_t k = 1; k < x_m.size(); ++k) {
    smallest_m = std::min(smallest_m, x_m[k] - x_m[k - 1]);
    largest_m = std::max(largest_m, x_m[k] - x_m[k - 1]);
  }
  const double nodes = std::ceil(std::max(l_star_m, largest_m) / smallest_m) + 1;
  return static_cast<int>(std::min(nodes, static_cast<double>(x_m.size())));
}

void require_shape(const Rows& rows, const Values& time_s, const Values& x_m, const char* name) {
  require(rows.shape(0) == time_s.size() && rows.shape(1) == x_m.size(),
          std::string(name) + " must be an array [times, nodes]");
}

}  // namespace

record::StaticState to_state(const Values& x_m, const Values& t_s_Pa, const Values& p_s_Pa) {
  require(x_m.size() >= 2, "x_m has fewer than two values");
  require_ascending(view(x_m), "x_m");
  require_length(t_s_Pa, x_m.size(), "t_s_Pa");
  require_length(p_s_Pa, x_m.size(), "p_s_Pa");
  return {to_vector(x_m), to_vector(t_s_Pa), to_vector(p_s_Pa)};
}

record::History to_history(const Values& time_s, const Values& x_m, const Rows& slip_rate_m_per_s,
                           const Rows& t_Pa, const Rows& p_Pa) {
  require(time_s.size() >= 2, "time_s has fewer than two values");
  require_ascending(view(time_s), "time_s");
  require(x_m.size() >= 2, "x_m has fewer than two values");
  require_ascending(view(x_m), "x_m");
  require_shape(slip_rate_m_per_s, time_s, x_m, "slip_rate_m_per_s");
  require_shape(t_Pa, time_s, x_m, "t_Pa");
  require_shape(p_Pa, time_s, x_m, "p_Pa");
  return {to_vector(time_s), to_vector(x_m), {}, to_vector(slip_rate_m_per_s),
          to_vector(t_Pa),   to_vector(p_Pa)};
}

record::SlipRecord to_record(const record::History& history, double threshold_m_per_s, double l_star_m,
                             fronts::TipAt tip) {
  require(threshold_m_per_s > 0, "threshold_m_per_s must be above 0");
  return fronts::record_from_history(history, threshold_m_per_s, halo_of(history.x_m, l_star_m), tip);
}

}  // namespace slipfront::python
