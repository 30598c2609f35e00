// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/trace.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <queue>
#include <set>
#include <utility>

#include "base/numbers.hpp"

namespace slipfront::fronts {
namespace {

constexpr double rounding = 1e-6;  // of positions
/// A path with the node and time of its last advance.
struct Tip {
  Path path;
  int node = 0;
  double time_s = 0;
};

/// A node that a tip jumped over.
struct Skipped {
  int tip = -1;  // none
  double time_s = 0;
};

/// The tips of one direction that may still advance: at most one at a node.
struct LiveTips {
  std::set<int> nodes;
  std::vector<int> tip_at;  // [nodes] where there is one
};

/// Waits of a tip from an advance on; one that has advanced since is not meant.
struct Waiting {
  int tip = 0;
  double since_s = 0;
};

struct Tracing {
  std::span<const double> x_m;
  std::span<const double> first_onset_s;
  double reach_m = 0;
  double wait_s = 0;
  std::vector<Tip> tips;
  std::vector<Skipped> skipped;  // [nodes]
  LiveTips left, right;          // by direction of travel
  std::deque<Waiting> waiting;   // in the order of time
};

LiveTips& live(Tracing& tracing, int direction) {
  return direction < 0 ? tracing.left : tracing.right;
}

struct Attachment {
  int tip = -1;  // none
  double distance_m = infinity;
};

/// The nearest live tip that comes towards a node in a direction; -1 for none.
int nearest_tip(const Tracing& tracing, int node, int direction) {
  const LiveTips& tips = direction < 0 ? tracing.left : tracing.right;
  if (direction < 0) {
    const auto ahead = tips.nodes.upper_bound(node);
    return ahead == tips.nodes.end() ? -1 : tips.tip_at[*ahead];
  }
  const auto from = tips.nodes.lower_bound(node);
  return from == tips.nodes.begin() ? -1 : tips.tip_at[*std::prev(from)];
}

/// The front that an onset at `node` belongs to: of the tips that can reach it the nearest; of two at the
/// same distance the one that has waited longer, as no front is infinitely fast.
Attachment attachment(const Tracing& tracing, int node, double time_s) {
  const Skipped& skipped = tracing.skipped[node];
  if (skipped.tip >= 0 && time_s - skipped.time_s <= tracing.wait_s) return {skipped.tip, 0.0};
  Attachment best;
  int candidates[] = {nearest_tip(tracing, node, -1), nearest_tip(tracing, node, +1)};
  if (candidates[0] > candidates[1]) std::swap(candidates[0], candidates[1]);
  for (const int k : candidates) {
    if (k < 0) continue;
    const Tip& tip = tracing.tips[k];
    const double distance_m = std::abs(tracing.x_m[node] - tracing.x_m[tip.node]);
    if (std::abs(node - tip.node) > 1 && distance_m > tracing.reach_m) continue;
    const bool same = best.tip >= 0 && std::abs(distance_m - best.distance_m) < rounding * distance_m;
    const bool better = same ? tip.time_s < tracing.tips[best.tip].time_s : distance_m < best.distance_m;
    if (better) best = {k, distance_m};
  }
  return best;
}

void wait_at(Tracing& tracing, int tip_index) {
  const Tip& tip = tracing.tips[tip_index];
  LiveTips& tips = live(tracing, tip.path.direction);
  tips.nodes.insert(tip.node);
  tips.tip_at[tip.node] = tip_index;
  tracing.waiting.push_back({tip_index, tip.time_s});
}

/// Tips that have waited too long take no more onsets.
void drop_arrested(Tracing& tracing, double time_s) {
  while (!tracing.waiting.empty() && time_s - tracing.waiting.front().since_s > tracing.wait_s) {
    const Tip& tip = tracing.tips[tracing.waiting.front().tip];
    if (tip.time_s == tracing.waiting.front().since_s)
      live(tracing, tip.path.direction).nodes.erase(tip.node);
    tracing.waiting.pop_front();
  }
}

void attach(Tracing& tracing, int tip_index, int node, double time_s) {
  Tip& tip = tracing.tips[tip_index];
  const int direction = tip.path.direction;
  tip.path.nodes.push_back(node);
  if (direction * (node - tip.node) < 0) return;  // jumped over before
  for (int between = tip.node + direction; between != node; between += direction) {
    if (tracing.first_onset_s[between] > time_s) tracing.skipped[between] = {tip_index, time_s};
  }
  live(tracing, direction).nodes.erase(tip.node);
  tip.node = node;
  tip.time_s = time_s;
  wait_at(tracing, tip_index);
}

void nucleate(Tracing& tracing, int node, double time_s) {
  for (const int direction : {-1, +1}) {
    tracing.tips.push_back({{direction, {node}, {}}, node, time_s});
    wait_at(tracing, static_cast<int>(tracing.tips.size()) - 1);
  }
}

/// Distributes nodes that slip at the same instant: first what continues a front, nearest first, so that the
/// result does not depend on the order of the nodes; then a nucleation in the middle of the leftmost run of
/// neighbours. A node that is placed changes the nearest tip of none but its neighbours among those left:
/// those farther off are nearer to these.
class Simultaneous {
 public:
  Simultaneous(Tracing& tracing, std::span<const int> nodes, double time_s)
      : tracing_(tracing), nodes_(nodes), time_s_(time_s), previous_(nodes.size()), next_(nodes.size()) {
    const int n = static_cast<int>(nodes.size());
    for (int k = 0; k < n; ++k) {
      previous_[k] = k - 1;
      next_[k] = k + 1;
    }
  }

  void place() {
    const int n = static_cast<int>(nodes_.size());
    for (int k = 0; k < n; ++k) consider(k);
    while (true) {
      if (!nearest_.empty()) {
        place_nearest();
        continue;
      }
      while (first_ < n && is_placed(first_)) ++first_;
      if (first_ == n) return;
      int run = 1;
      while (next_[first_ + run - 1] == first_ + run && first_ + run < n &&
             nodes_[first_ + run] == nodes_[first_ + run - 1] + 1)
        ++run;
      nucleate(tracing_, nodes_[first_ + run / 2], time_s_);
      take_out(first_ + run / 2);
    }
  }

 private:
  using Candidate = std::pair<double, int>;  // distance from its tip, index of the node

  bool is_placed(int k) const { return next_[k] < 0; }

  void consider(int k) {
    if (const Attachment found = attachment(tracing_, nodes_[k], time_s_); found.tip >= 0)
      nearest_.emplace(found.distance_m, k);
  }

  void place_nearest() {
    const auto [distance_m, k] = nearest_.top();
    nearest_.pop();
    if (is_placed(k)) return;
    const Attachment now = attachment(tracing_, nodes_[k], time_s_);
    if (now.tip < 0) return;
    if (now.distance_m != distance_m) {  // its tip has moved on
      nearest_.emplace(now.distance_m, k);
      return;
    }
    attach(tracing_, now.tip, nodes_[k], time_s_);
    take_out(k);
  }

  void take_out(int k) {
    const int before = previous_[k], after = next_[k];
    next_[k] = -1;
    if (after < static_cast<int>(nodes_.size())) {
      previous_[after] = before;
      consider(after);
    }
    if (before >= 0) {
      next_[before] = after;
      consider(before);
    }
  }

  Tracing& tracing_;
  std::span<const int> nodes_;  // ascending
  double time_s_;
  std::vector<int> previous_, next_;  // unplaced ones; next_ is -1 of one that is placed
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> nearest_;
  int first_ = 0;  // none before it is left
};

/// The earliest onset that a tip at a node can reach in a direction: at the next node, or within reach_m.
/// [nodes], infinite where there is none
std::vector<double> earliest_ahead_s(const Tracing& tracing, int direction) {
  const int n = static_cast<int>(tracing.x_m.size());
  std::vector<double> earliest_s(tracing.x_m.size(), infinity);
  std::deque<int> ahead;  // of ascending distance and time: each is the earliest up to the one before it
  for (int node = direction > 0 ? n - 1 : 0; node >= 0 && node < n; node -= direction) {
    const int next = node + direction;
    if (next < 0 || next >= n) continue;
    while (!ahead.empty() && tracing.first_onset_s[ahead.front()] >= tracing.first_onset_s[next])
      ahead.pop_front();
    ahead.push_front(next);
    while (ahead.back() != next && std::abs(tracing.x_m[ahead.back()] - tracing.x_m[node]) > tracing.reach_m)
      ahead.pop_back();
    earliest_s[node] = tracing.first_onset_s[ahead.back()];
  }
  return earliest_s;
}

/// Why a tip ends, with the earliest onset it could have gone on with.
End end_of(const Tracing& tracing, const Tip& tip, std::span<const double> p_s_Pa, double end_time_s,
           double ahead_s, bool whole_interface) {
  const int n = static_cast<int>(tracing.x_m.size());
  const int next = tip.node + tip.path.direction;
  if (next < 0 || next >= n) return whole_interface ? End::contact_end : End::record_edge;
  if (ahead_s - tip.time_s <= tracing.wait_s) return End::meets_front;
  if (p_s_Pa[next] <= 0.0) return End::contact_end;
  return tip.time_s + tracing.wait_s > end_time_s ? End::record_end : End::arrest;
}

}  // namespace

double reach_m(const FrontOptions& options) {
  return options.min_length_m * (1.0 + rounding);
}

std::vector<Path> trace_paths(std::span<const double> x_m, std::span<const double> first_onset_s,
                              std::span<const double> p_s_Pa, double end_time_s,
                              const FrontOptions& options) {
  const std::size_t n = x_m.size();
  Tracing tracing;
  tracing.x_m = x_m;
  tracing.first_onset_s = first_onset_s;
  tracing.reach_m = reach_m(options);
  tracing.wait_s = options.arrest_time_s;
  tracing.skipped.resize(n);
  tracing.left.tip_at.resize(n);
  tracing.right.tip_at.resize(n);

  std::vector<int> order;
  for (int node = 0; node < static_cast<int>(n); ++node) {
    if (std::isfinite(first_onset_s[node])) order.push_back(node);
  }
  std::ranges::stable_sort(order, {}, [&](int node) { return first_onset_s[node]; });
  Pauses pauses(options.pause);
  for (auto begin = order.begin(); begin != order.end();) {
    pauses.count();
    const double time_s = first_onset_s[*begin];
    const auto end = std::find_if(begin, order.end(), [&](int node) { return first_onset_s[node] > time_s; });
    drop_arrested(tracing, time_s);
    Simultaneous(tracing, {begin, end}, time_s).place();
    begin = end;
  }

  const auto left_s = earliest_ahead_s(tracing, -1), right_s = earliest_ahead_s(tracing, +1);
  std::vector<Path> paths;
  for (Tip& tip : tracing.tips) {
    const int direction = tip.path.direction;
    const double ahead_s = (direction < 0 ? left_s : right_s)[static_cast<std::size_t>(tip.node)];
    tip.path.end = end_of(tracing, tip, p_s_Pa, end_time_s, ahead_s, options.whole_interface);
    std::ranges::sort(tip.path.nodes, {}, [&](int node) { return direction * node; });
    paths.push_back(std::move(tip.path));
  }
  return paths;
}

}  // namespace slipfront::fronts
