// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "record/column.hpp"

namespace slipfront::record {

/// Tractions of the plane on the plate: p >= 0 in compression, t > 0 when it opposes sliding to +x. Pa.
struct Traction {
  double t_Pa = 0;
  double p_Pa = 0;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(t_Pa, p_Pa);
  }
};

/// On the way from one value to the other; std::lerp may return a number where one of them is none.
inline double between(double from, double to, double share) {
  return from + share * (to - from);
}
inline Traction between(const Traction& from, const Traction& to, double share) {
  return {between(from.t_Pa, to.t_Pa, share), between(from.p_Pa, to.p_Pa, share)};
}

/// A node begins to slip.
struct Onset {
  std::int32_t node = 0;  ///< index along the interface, left to right
  double time_s = 0;      ///< located inside the step, where |t|/p passes the static friction coefficient
  template <class Archive>
  void serialize(Archive& archive) {
    archive(node, time_s);
  }
};

/// A slipping node sticks again.
struct Stop {
  std::int32_t node = 0;
  double time_s = 0;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(node, time_s);
  }
};

/// What a run records of its interface at full time resolution: beginnings and ends of slip, and the
/// tractions around each beginning. All that front analysis needs, whatever the decimation of the history.
struct SlipRecord {
  std::vector<double> x_m;       ///< [nodes] positions along the interface, ascending
  int halo = 0;                  ///< nodes on each side whose tractions are kept at an onset
  std::vector<Onset> onsets;     ///< in the order of time; a node that slips again appears again
  std::vector<Traction> around;  ///< [onsets x (2 halo + 1)] tractions of nodes node - halo ... node + halo
                                 ///< at the onset's time; nodes beyond the interface's ends are NaN
  std::vector<Stop> stops;       ///< in the order of time
  double end_time_s = 0;         ///< the record covers [0, end_time_s]
  std::uint64_t n_onsets_left_out = 0;  ///< of nodes that had slipped before; find_fronts does not need them
  /// Longest time between two looks at the interface. Nodes that begin to slip within it know nothing of each
  /// other: the time between them is no travel time. 0 where that is unknown.
  double resolution_s = 0;

  /// All beginnings of slip.
  std::uint64_t n_onsets() const { return onsets.size() + n_onsets_left_out; }

  /// Tractions of nodes node - halo ... node + halo at onset k.
  std::span<const Traction> around_onset(std::size_t k) const {
    const std::size_t n = 2 * static_cast<std::size_t>(halo) + 1;
    return {around.data() + k * n, n};
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(x_m, halo, onsets, around, stops, end_time_s, n_onsets_left_out, resolution_s);
  }
};

/// Whether a record's parts fit each other: lengths, nodes that there are, and times.
bool is_consistent(const SlipRecord& record);

/// Time history of an interface, from a run or from elsewhere. Matrices are row-major [times x nodes].
struct History {
  std::vector<double> time_s;  ///< [times], ascending
  std::vector<double> x_m;     ///< [nodes], ascending
  std::vector<double> slip_m, slip_rate_m_per_s, t_Pa, p_Pa;
  std::vector<std::vector<double>> law_states = {};  ///< matrices, of the friction law's states; none without
};

using HistoryColumn = Column<History, std::vector<double>>;

inline constexpr HistoryColumn history_time = {"time_s", "s", "time since the start of the event",
                                               &History::time_s};
inline constexpr HistoryColumn history_place = {"x_m", "m", "position along the interface from the left edge",
                                                &History::x_m};
/// The matrices of every history, in the order of the files.
inline constexpr std::array<HistoryColumn, 4> history_fields = {{
    {"slip_m", "m", "displacement of the plate along x relative to its base, since the start, [times, nodes]",
     &History::slip_m},
    {"slip_rate_m_per_s", "m/s", "velocity of the plate along x relative to its base, [times, nodes]",
     &History::slip_rate_m_per_s},
    {"t_Pa", "Pa", "tangential traction, positive against sliding to +x, [times, nodes]", &History::t_Pa},
    {"p_Pa", "Pa", "contact pressure, positive in compression, [times, nodes]", &History::p_Pa},
}};

/// Numbers of a row: the time, and each field at all nodes.
inline std::size_t history_row_values(std::size_t n_nodes, std::size_t n_law_states) {
  return 1 + (history_fields.size() + n_law_states) * n_nodes;
}
/// The members that a row has such numbers of, in the order of the files. @tparam OfHistory  perhaps constant
template <class OfHistory>
auto members_of(OfHistory& history) {
  auto members = members_of(history, history_fields);
  for (auto& values : history.law_states) members.push_back(&values);
  return members;
}

/// Tractions before the event, at the nodes of the interface. [nodes]
struct StaticState {
  std::vector<double> x_m;
  std::vector<double> t_s_Pa;
  std::vector<double> p_s_Pa;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(x_m, t_s_Pa, p_s_Pa);
  }
};

}  // namespace slipfront::record
