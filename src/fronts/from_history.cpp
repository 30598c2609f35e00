// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/from_history.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace slipfront::fronts {
namespace {

/// An onset with the place in the history it was found at, to interpolate the tractions there.
struct Found {
  record::Onset onset;
  std::size_t row = 0;    // the time lies between this row and the next
  double fraction = 0.0;  // of the way to the next row
};

void check(const record::History& history, double threshold_m_per_s, int halo) {
  SLIPFRONT_ASSERT(threshold_m_per_s > 0.0, "the slip rate of a sticking node is never exactly zero");
  SLIPFRONT_ASSERT(halo >= 0, "a halo is a number of nodes");
  const std::size_t n = history.time_s.size() * history.x_m.size();
  SLIPFRONT_ASSERT(
      history.slip_rate_m_per_s.size() == n && history.t_Pa.size() == n && history.p_Pa.size() == n,
      "matrices are [times x nodes]");
  SLIPFRONT_ASSERT(std::ranges::adjacent_find(history.time_s, std::greater_equal<>{}) == history.time_s.end(),
                   "times ascend strictly");
}

record::Traction traction_at(const record::History& history, const Found& found, std::size_t node) {
  const std::size_t n_nodes = history.x_m.size();
  const std::size_t here = found.row * n_nodes + node;
  const record::Traction at_row = {history.t_Pa[here], history.p_Pa[here]};
  if (found.fraction == 0.0) return at_row;
  const std::size_t next = here + n_nodes;
  return record::between(at_row, {history.t_Pa[next], history.p_Pa[next]}, found.fraction);
}

/// The onset of a slip by TipAt::peak. @param first, end  rows from the stop before on, and until the next
/// one
Found at_peak(const record::History& history, std::int32_t node_id, std::size_t first, std::size_t end) {
  const std::size_t n_nodes = history.x_m.size();
  const auto node = static_cast<std::size_t>(node_id);
  const auto size = [&](const std::vector<double>& field, std::size_t row) {
    return std::abs(field[row * n_nodes + node]);
  };
  const auto largest = [&](const std::vector<double>& field, std::size_t from, std::size_t to) {
    for (std::size_t row = from + 1; row < to; ++row)
      if (size(field, row) > size(field, from)) from = row;
    return from;
  };
  const std::size_t fastest = largest(history.slip_rate_m_per_s, first, end);
  const std::size_t top = largest(history.t_Pa, first, fastest + 1);
  const auto& time_s = history.time_s;
  double peak_s = time_s[top];
  if (top > 0 && top + 1 < time_s.size()) {
    const double before_s = time_s[top] - time_s[top - 1], after_s = time_s[top + 1] - time_s[top];
    const double rise = size(history.t_Pa, top) - size(history.t_Pa, top - 1);
    const double fall = size(history.t_Pa, top) - size(history.t_Pa, top + 1);
    if (rise >= 0 && fall >= 0 && rise + fall > 0)
      peak_s +=
          0.5 * (rise * after_s * after_s - fall * before_s * before_s) / (rise * after_s + fall * before_s);
  }
  const std::size_t row = peak_s < time_s[top] ? top - 1 : top;
  const double fraction =
      peak_s == time_s[row] ? 0 : (peak_s - time_s[row]) / (time_s[row + 1] - time_s[row]);
  return {{node_id, peak_s}, row, fraction};
}

}  // namespace

record::SlipRecord record_from_history(const record::History& history, double threshold_m_per_s, int halo,
                                       TipAt tip) {
  check(history, threshold_m_per_s, halo);
  record::SlipRecord record;
  record.x_m = history.x_m;
  record.halo = halo;
  if (history.time_s.empty()) return record;
  record.end_time_s = history.time_s.back();

  const std::size_t n_nodes = history.x_m.size();
  const auto rate = [&](std::size_t row, std::size_t node) {
    return history.slip_rate_m_per_s[row * n_nodes + node];
  };
  const auto slips = [&](double v) { return std::abs(v) > threshold_m_per_s; };

  std::vector<Found> found;
  for (std::size_t node = 0; node < n_nodes; ++node) {
    const auto id = static_cast<std::int32_t>(node);
    std::size_t first_row = 0;  // since the last stop
    const auto end_slip = [&](std::size_t end) {
      if (tip == TipAt::peak) found.back() = at_peak(history, id, first_row, end);
      first_row = end;
    };
    if (slips(rate(0, node))) found.push_back({{id, history.time_s[0]}, 0, 0.0});
    for (std::size_t row = 0; row + 1 < history.time_s.size(); ++row) {
      const double v0 = rate(row, node);
      const double v1 = rate(row + 1, node);
      const bool turns = (v0 > 0.0) != (v1 > 0.0);  // through rest: a stop and an onset in one interval
      if (slips(v0) && (!slips(v1) || turns)) {
        const double fraction = (v0 - std::copysign(threshold_m_per_s, v0)) / (v0 - v1);
        record.stops.push_back({id, record::between(history.time_s[row], history.time_s[row + 1], fraction)});
        end_slip(row + 1);
      }
      if (slips(v1) && (!slips(v0) || turns)) {
        const double fraction = (std::copysign(threshold_m_per_s, v1) - v0) / (v1 - v0);
        found.push_back(
            {{id, record::between(history.time_s[row], history.time_s[row + 1], fraction)}, row, fraction});
      }
    }
    if (slips(rate(history.time_s.size() - 1, node))) end_slip(history.time_s.size());
  }

  // Nodes are already in order, so a stable sort puts simultaneous events from left to right.
  std::ranges::stable_sort(found, {}, [](const Found& f) { return f.onset.time_s; });
  std::ranges::stable_sort(record.stops, {}, &record::Stop::time_s);
  for (const Found& f : found) {
    record.onsets.push_back(f.onset);
    for (int offset = -halo; offset <= halo; ++offset) {
      const int node = f.onset.node + offset;
      const bool inside = node >= 0 && node < static_cast<int>(n_nodes);
      record.around.push_back(inside ? traction_at(history, f, static_cast<std::size_t>(node))
                                     : record::Traction{nan, nan});
    }
  }
  return record;
}

}  // namespace slipfront::fronts
