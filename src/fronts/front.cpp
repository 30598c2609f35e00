// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/front.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fronts/fit.hpp"
#include "fronts/measures.hpp"
#include "fronts/trace.hpp"

namespace slipfront::fronts {
namespace {

// A tip this near to a node, in element lengths, is at the node: l* and positions are rounded numbers (0.67
// mm stands for an element of 0.6667 mm).
constexpr double position_tolerance = 0.02;
constexpr double position_rounding = 1e-6;
constexpr double waits = 3.0;  // of a tip, in times that a front of the event takes for its least length
constexpr double share_from_l_star = 5.0;  // no slipping share nearer to the start
constexpr double acceleration_half_width_m = 3e-3;
constexpr int acceleration_side_points = 4;

/// First onset of each node, and its place in record.onsets. [nodes]
struct FirstOnsets {
  std::vector<double> time_s;  // infinite where the node never slips
  std::vector<std::size_t> index;
};

FirstOnsets first_onsets(const record::SlipRecord& record) {
  FirstOnsets first{std::vector<double>(record.x_m.size(), infinity),
                    std::vector<std::size_t>(record.x_m.size())};
  for (std::size_t k = 0; k < record.onsets.size(); ++k) {
    const record::Onset& onset = record.onsets[k];
    SLIPFRONT_ASSERT(onset.node >= 0 && onset.node < std::ssize(record.x_m),
                     "onsets name nodes of the interface");
    if (onset.time_s < first.time_s[onset.node]) {
      first.time_s[onset.node] = onset.time_s;
      first.index[onset.node] = k;
    }
  }
  return first;
}

/// Begins and ends of slip of each node, in the order of time. [nodes]
struct SlipTimes {
  std::vector<std::vector<double>> begin_s;
  std::vector<std::vector<double>> end_s;
};

SlipTimes slip_times(const record::SlipRecord& record) {
  SlipTimes times{std::vector<std::vector<double>>(record.x_m.size()),
                  std::vector<std::vector<double>>(record.x_m.size())};
  for (const record::Onset& onset : record.onsets) times.begin_s[onset.node].push_back(onset.time_s);
  for (const record::Stop& stop : record.stops) {
    SLIPFRONT_ASSERT(stop.node >= 0 && stop.node < std::ssize(record.x_m),
                     "stops name nodes of the interface");
    times.end_s[stop.node].push_back(stop.time_s);
  }
  return times;
}

double last_until(const std::vector<double>& times_s, double time_s) {
  const auto after = std::ranges::upper_bound(times_s, time_s);
  return after == times_s.begin() ? -infinity : *(after - 1);
}

bool is_slipping(const SlipTimes& times, int node, double time_s) {
  const double begun_s = last_until(times.begin_s[node], time_s);
  return begun_s > -infinity && last_until(times.end_s[node], time_s) <= begun_s;
}

/// l* at a node: one element where that is longer.
double local_l_star_m(std::span<const double> x_m, int node, double l_star_m) {
  if (node > 0) l_star_m = std::max(l_star_m, x_m[node] - x_m[node - 1]);
  if (node + 1 < std::ssize(x_m)) l_star_m = std::max(l_star_m, x_m[node + 1] - x_m[node]);
  return l_star_m;
}

/// Motion of a tip along its path. [points of the path]
struct Passage {
  std::vector<double> run_m;       // distance from the start, ascending
  std::vector<double> time_s;      // when the tip passes: never falls along the path
  std::vector<std::size_t> onset;  // the onset, in record.onsets, by which it passes
};

Passage passage(const record::SlipRecord& record, const FirstOnsets& first, const Path& path) {
  const std::size_t n = path.nodes.size();
  Passage tip{std::vector<double>(n), std::vector<double>(n), std::vector<std::size_t>(n)};
  double earliest_s = infinity;
  std::size_t earliest = 0;
  for (std::size_t k = n;
       k-- > 0;) {  // from the far end: a node passes at the latest when one beyond it slips
    const int node = path.nodes[k];
    tip.run_m[k] = std::abs(record.x_m[node] - record.x_m[path.nodes[0]]);
    if (first.time_s[node] < earliest_s) {
      earliest_s = first.time_s[node];
      earliest = first.index[node];
    }
    tip.time_s[k] = earliest_s;
    tip.onset[k] = earliest;
  }
  return tip;
}

/// Two neighbouring points of a path around a position, and the position's share of the way from the first to
/// the second.
struct Bracket {
  std::size_t behind = 0;
  std::size_t ahead = 0;
  double fraction = 0;
};

/// @pre run_m lies within the path.
Bracket bracket(const Passage& tip, double run_m) {
  const auto upper = std::ranges::lower_bound(tip.run_m, run_m);
  const auto ahead = static_cast<std::size_t>(std::max(upper - tip.run_m.begin(), std::ptrdiff_t{1}));
  const std::size_t behind = ahead - 1;
  return {behind, ahead, (run_m - tip.run_m[behind]) / (tip.run_m[ahead] - tip.run_m[behind])};
}

double time_at(const Passage& tip, const Bracket& at) {
  return record::between(tip.time_s[at.behind], tip.time_s[at.ahead], at.fraction);
}

/// The first and the last point of a path that a length of it lies between.
struct Ends {
  std::size_t first = 0, last = 0;
};

/// A tip near to a node is at the node.
Ends ends_around(const Bracket& from, const Bracket& to) {
  return {from.fraction > 1.0 - position_tolerance ? from.ahead : from.behind,
          to.fraction < position_tolerance ? to.behind : to.ahead};
}

bool is_any_driven(const record::SlipRecord& record, const Path& path, const Ends& ends,
                   const FrontOptions& options) {
  const auto begin = path.nodes.begin();
  return std::any_of(begin + static_cast<std::ptrdiff_t>(ends.first),
                     begin + static_cast<std::ptrdiff_t>(ends.last) + 1,
                     [&](int node) { return is_driven(options, record.x_m[node]); });
}

/// Time in which information passes from one point to the other at the earliest.
double min_time_s(const record::SlipRecord& record, const Path& path, const Ends& ends) {
  const int n_elements = std::abs(path.nodes[ends.last] - path.nodes[ends.first]);
  return std::max(n_elements - 1, 1) * record.resolution_s;
}

/// Sets v_tip and its kind at a point of a path.
void set_speed(FrontPoint& point, const record::SlipRecord& record, const Path& path, const Passage& tip,
               double run_m, double l_star_m, const FrontOptions& options) {
  const bool is_centred = options.speed_interval == SpeedInterval::centred;
  const double from_m = run_m - (is_centred ? 0.5 : 1.0) * l_star_m;
  const double to_m = is_centred ? run_m + 0.5 * l_star_m : run_m;
  point.speed_kind = is_driven(options, point.x_m) ? SpeedKind::triggered : SpeedKind::path_end;
  if (from_m < 0.0 || to_m > tip.run_m.back()) return;
  const Bracket from = bracket(tip, from_m), to = bracket(tip, to_m);
  const Ends ends = ends_around(from, to);
  if (is_any_driven(record, path, ends, options)) {
    point.speed_kind = SpeedKind::triggered;
    return;
  }
  const double time_s = time_at(tip, to) - time_at(tip, from);
  const bool is_resolved = tip.time_s[ends.last] - tip.time_s[ends.first] >= min_time_s(record, path, ends);
  point.speed_kind = is_resolved && time_s > 0.0 ? SpeedKind::front : SpeedKind::simultaneous;
  if (point.speed_kind == SpeedKind::front) point.v_tip_m_per_s = l_star_m / time_s;
}

/// Tractions of a node at an onset; undefined beyond the halo.
record::Traction traction_at(const record::SlipRecord& record, std::size_t onset, int node) {
  const int offset = node - record.onsets[onset].node;
  if (std::abs(offset) > record.halo) return {nan, nan};
  const int index = offset + record.halo;
  return record.around_onset(onset)[static_cast<std::size_t>(index)];
}

/// Tractions of `node` when the tip is at run_m, which it has to reach before it reaches the node.
record::Traction traction_ahead(const record::SlipRecord& record, const Passage& tip, double run_m, int node,
                                double reaches_node_s) {
  Bracket at = bracket(tip, run_m);
  if (at.fraction < position_tolerance) at.fraction = 0.0;
  if (at.fraction > 1.0 - position_tolerance) at.fraction = 1.0;
  if (time_at(tip, at) >= reaches_node_s) return {nan, nan};  // a jump
  const record::Traction ahead = traction_at(record, tip.onset[at.ahead], node);
  if (at.fraction == 1.0) return ahead;
  const record::Traction behind = traction_at(record, tip.onset[at.behind], node);
  if (at.fraction == 0.0) return behind;
  return record::between(behind, ahead, at.fraction);
}

/// The zone that slips behind a tip, while the tip and the time go on along a path. Places are counted in
/// nodes from the path's start.
class SlippingZone {
 public:
  /// @param tolerated_gap_m  sticking nodes between slipping ones no farther apart do not end the zone
  SlippingZone(std::span<const double> x_m, const SlipTimes& slip, const Path& path, double tolerated_gap_m)
      : x_m_(x_m),
        slip_(slip),
        start_(path.nodes.front()),
        direction_(path.direction),
        gap_m_(tolerated_gap_m) {
    const int n = std::abs(path.nodes.back() - start_) + 1;
    for (int place = 0; place < n; ++place)
      for (const auto* times_s : {&slip.begin_s[node(place)], &slip.end_s[node(place)]})
        for (const double time_s : *times_s) changes_.emplace_back(time_s, place);
    std::ranges::sort(changes_);
  }

  /// Length of the contiguous zone behind a tip at a node, not farther back than the start.
  /// @pre time_s does not fall from call to call.
  double length_m(int tip_node, double time_s) {
    for (; next_ < changes_.size() && changes_[next_].first <= time_s; ++next_) {
      const int place = changes_[next_].second;
      is_slipping(slip_, node(place), time_s) ? begin(place) : end(place);
    }
    const int tip = std::abs(tip_node - start_);
    const auto ahead = slipping_.lower_bound(tip);
    if (ahead == slipping_.begin() || is_gap(*std::prev(ahead), tip)) return 0.0;
    const int rear = *std::prev(rears_.upper_bound(*std::prev(ahead)));
    return std::abs(x_m_[tip_node] - x_m_[node(rear)]);
  }

 private:
  int node(int place) const { return start_ + direction_ * place; }
  bool is_gap(int behind, int ahead) const {
    return ahead - behind > 1 && std::abs(x_m_[node(ahead)] - x_m_[node(behind)]) > gap_m_;
  }
  void begin(int place) {
    if (!slipping_.insert(place).second) return;
    mark(slipping_.find(place));
    mark(slipping_.upper_bound(place));
  }
  void end(int place) {
    const auto found = slipping_.find(place);
    if (found == slipping_.end()) return;
    rears_.erase(place);
    mark(slipping_.erase(found));
  }
  /// Whether a zone ends at a slipping place.
  void mark(std::set<int>::const_iterator place) {
    if (place == slipping_.end()) return;
    const bool is_rear = place == slipping_.begin() || is_gap(*std::prev(place), *place);
    if (is_rear)
      rears_.insert(*place);
    else
      rears_.erase(*place);
  }

  std::span<const double> x_m_;
  const SlipTimes& slip_;
  int start_, direction_;
  double gap_m_;
  std::vector<std::pair<double, int>> changes_;  // times and places at which slip begins or ends
  std::size_t next_ = 0;
  std::set<int> slipping_, rears_;
};

SlipMode mode_of(const std::vector<FrontPoint>& points, const FrontOptions& options) {
  int defined = 0, crack = 0, pulse = 0;
  for (const FrontPoint& point : points) {
    if (std::isnan(point.slipping_share)) continue;
    ++defined;
    if (point.slipping_share > options.crack_share) ++crack;
    if (point.slipping_share < options.pulse_share) ++pulse;
  }
  const double enough = options.mode_fraction * defined;
  if (defined > 0 && crack >= enough) return SlipMode::crack;
  if (defined > 0 && pulse >= enough) return SlipMode::pulse;
  return SlipMode::mixed;
}

Front measure(const record::SlipRecord& record, const record::StaticState& state, const FirstOnsets& first,
              const SlipTimes& slip, const Path& path, const FrontOptions& options, Pauses& pauses) {
  Front front;
  front.direction = path.direction;
  front.end = path.end;
  const Passage tip = passage(record, first, path);
  SlippingZone zone(record.x_m, slip, path, reach_m(options));
  std::vector<double> speed_m_per_s;
  for (std::size_t k = 0; k < path.nodes.size(); ++k) {
    pauses.count();
    const int node = path.nodes[k];
    const double run_m = tip.run_m[k];
    const double l_star_m = local_l_star_m(record.x_m, node, options.l_star_m);
    FrontPoint point;
    point.node = node;
    point.x_m = record.x_m[node];
    point.onset_s = first.time_s[node];
    set_speed(point, record, path, tip, run_m, l_star_m, options);
    point.t_s_Pa = state.t_s_Pa[node];
    point.p_s_Pa = state.p_s_Pa[node];
    const record::Traction at_onset = traction_at(record, first.index[node], node);
    point.t_r_Pa = at_onset.t_Pa;
    point.p_r_Pa = at_onset.p_Pa;

    if (!is_excluded(options, point.x_m) && run_m > l_star_m * (1.0 + position_tolerance)) {
      const record::Traction ahead = traction_ahead(record, tip, run_m - l_star_m, node, tip.time_s[k]);
      point.t_d_Pa = ahead.t_Pa;
      point.p_d_Pa = ahead.p_Pa;
      if (!std::isnan(ahead.t_Pa)) {
        point.U_s_J_per_m3 = energy_density_J_per_m3(ahead, options.elasticity);
        const auto of_node = static_cast<std::size_t>(node);
        point.U_r_J_per_m3 = energy_density_J_per_m3(
            {options.mu_s[of_node] * at_onset.p_Pa + options.cohesion_Pa[of_node], at_onset.p_Pa},
            options.elasticity);
      }
    }
    if (run_m >= share_from_l_star * l_star_m) {
      point.slipping_share = zone.length_m(node, tip.time_s[k]) / run_m;
    }
    speed_m_per_s.push_back(point.v_tip_m_per_s);
    front.points.push_back(point);
  }
  const std::vector<double> slope =
      local_slopes(tip.run_m, speed_m_per_s, acceleration_half_width_m, acceleration_side_points);
  for (std::size_t k = 0; k < slope.size(); ++k) front.points[k].accelerating = slope[k] > 0.0;
  front.mode = mode_of(front.points, options);
  return front;
}

/// See arrest_time_s.
double longest_wait_s(std::span<const double> x_m, std::span<const double> first_onset_s,
                      const FrontOptions& options) {
  if (!options.arrest_time_by_event) return options.arrest_time_s;
  std::vector<double> spacing_m, slowness_s_per_m;
  for (std::size_t k = 1; k < x_m.size(); ++k) {
    spacing_m.push_back(x_m[k] - x_m[k - 1]);
    const double delay_s = std::abs(first_onset_s[k] - first_onset_s[k - 1]);
    if (delay_s > 0.0 && std::isfinite(delay_s) && !is_driven(options, x_m[k]) &&
        !is_driven(options, x_m[k - 1]))
      slowness_s_per_m.push_back(delay_s / spacing_m.back());
  }
  if (slowness_s_per_m.empty()) return options.arrest_time_s;
  const double length_m = std::max(options.min_length_m, median(spacing_m));
  return std::max(options.arrest_time_s, waits * length_m * median(slowness_s_per_m));
}

}  // namespace

double arrest_time_s(const record::SlipRecord& record, const FrontOptions& options) {
  return longest_wait_s(record.x_m, first_onsets(record).time_s, options);
}

double energy_density_J_per_m3(const record::Traction& traction, const Elasticity& elasticity) {
  const double nu = elasticity.poissons_ratio;
  const double normal = elasticity.plane_strain ? 1.0 - nu * nu : 1.0;
  return (2.0 * (1.0 + nu) * traction.t_Pa * traction.t_Pa + normal * traction.p_Pa * traction.p_Pa) /
         (2.0 * elasticity.youngs_modulus_Pa);
}

bool is_driven(const FrontOptions& options, double x_m) {
  return std::ranges::any_of(options.driven, [&](const Zone& zone) {
    const double rounding_m = 1e-9 * (zone.to_m - zone.from_m);
    return x_m >= zone.from_m - rounding_m && x_m <= zone.to_m + rounding_m;
  });
}

std::string_view name(End end) {
  constexpr std::array<std::string_view, 5> names = {"arrest", "meets_front", "contact_end", "record_edge",
                                                     "record_end"};
  return names[static_cast<std::size_t>(end)];
}

std::string_view name(SlipMode mode) {
  constexpr std::array<std::string_view, 3> names = {"crack", "pulse", "mixed"};
  return names[static_cast<std::size_t>(mode)];
}

std::string_view name(SpeedKind kind) {
  constexpr std::array<std::string_view, 4> names = {"front", "triggered", "simultaneous", "path_end"};
  return names[static_cast<std::size_t>(kind)];
}

std::vector<Front> find_fronts(const record::SlipRecord& record, const record::StaticState& state,
                               const FrontOptions& options) {
  const std::size_t n = record.x_m.size();
  SLIPFRONT_ASSERT(state.x_m == record.x_m && state.t_s_Pa.size() == n && state.p_s_Pa.size() == n,
                   "the static state is given at the record's nodes");
  SLIPFRONT_ASSERT(
      record.around.size() == record.onsets.size() * (2 * static_cast<std::size_t>(record.halo) + 1),
      "tractions are kept around every onset");
  SLIPFRONT_ASSERT(options.l_star_m > 0.0, "the speed is taken over a length");

  const FirstOnsets first = first_onsets(record);
  const SlipTimes slip = slip_times(record);
  FrontOptions tracing = options;
  tracing.arrest_time_s = longest_wait_s(record.x_m, first.time_s, options);
  std::vector<Front> fronts;
  Pauses pauses(options.pause);
  for (const Path& path : trace_paths(record.x_m, first.time_s, state.p_s_Pa, record.end_time_s, tracing)) {
    const double length_m = std::abs(record.x_m[path.nodes.back()] - record.x_m[path.nodes.front()]);
    if (path.nodes.size() < 2 || length_m < options.min_length_m * (1.0 - position_rounding)) continue;
    fronts.push_back(measure(record, state, first, slip, path, options, pauses));
  }
  std::ranges::stable_sort(fronts, {}, [](const Front& front) { return front.points.front().onset_s; });
  for (std::size_t k = 0; k < fronts.size(); ++k) fronts[k].id = static_cast<int>(k);
  return fronts;
}

}  // namespace slipfront::fronts
