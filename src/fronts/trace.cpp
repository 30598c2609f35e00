// SPDX-License-Identifier: BSD-3-Clause
#include "fronts/trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipfront::fronts {
namespace {

constexpr double rounding = 1e-6;  // of positions
constexpr double infinity = std::numeric_limits<double>::infinity();

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

struct Tracing {
  std::span<const double> x_m;
  std::span<const double> first_onset_s;
  double reach_m = 0;
  double wait_s = 0;
  std::vector<Tip> tips;
  std::vector<Skipped> skipped;  // [nodes]
};

struct Attachment {
  int tip = -1;  // none
  double distance_m = infinity;
};

/// The front that an onset at `node` belongs to: of the tips that can reach it the nearest; of two at the
/// same distance the one that has waited longer, as no front is infinitely fast.
Attachment attachment(const Tracing& tracing, int node, double time_s) {
  const Skipped& skipped = tracing.skipped[node];
  if (skipped.tip >= 0 && time_s - skipped.time_s <= tracing.wait_s) return {skipped.tip, 0.0};
  Attachment best;
  for (std::size_t k = 0; k < tracing.tips.size(); ++k) {
    const Tip& tip = tracing.tips[k];
    const int nodes_ahead = tip.path.direction * (node - tip.node);
    if (nodes_ahead <= 0 || time_s - tip.time_s > tracing.wait_s) continue;
    const double distance_m = std::abs(tracing.x_m[node] - tracing.x_m[tip.node]);
    if (nodes_ahead > 1 && distance_m > tracing.reach_m) continue;
    const bool same = best.tip >= 0 && std::abs(distance_m - best.distance_m) < rounding * distance_m;
    const bool better = same ? tip.time_s < tracing.tips[best.tip].time_s : distance_m < best.distance_m;
    if (better) best = {static_cast<int>(k), distance_m};
  }
  return best;
}

void attach(Tracing& tracing, int tip_index, int node, double time_s) {
  Tip& tip = tracing.tips[tip_index];
  const int direction = tip.path.direction;
  if (direction * (node - tip.node) < 0) {  // jumped over before
    const auto is_behind = [&](int other) { return direction * (other - node) < 0; };
    tip.path.nodes.insert(std::ranges::partition_point(tip.path.nodes, is_behind), node);
    return;
  }
  for (int between = tip.node + direction; between != node; between += direction) {
    if (tracing.first_onset_s[between] > time_s) tracing.skipped[between] = {tip_index, time_s};
  }
  tip.path.nodes.push_back(node);
  tip.node = node;
  tip.time_s = time_s;
}

void nucleate(Tracing& tracing, int node, double time_s) {
  for (const int direction : {-1, +1}) tracing.tips.push_back({{direction, {node}, {}}, node, time_s});
}

/// Distributes nodes that slip at the same instant: first what continues a front, nearest first, so that the
/// result does not depend on the order of the nodes; then a nucleation in the middle of the leftmost run of
/// neighbours.
void place_simultaneous(Tracing& tracing, std::vector<int> nodes, double time_s) {
  while (!nodes.empty()) {
    auto chosen = nodes.begin();
    Attachment best;
    for (auto it = nodes.begin(); it != nodes.end(); ++it) {
      const Attachment candidate = attachment(tracing, *it, time_s);
      if (candidate.distance_m < best.distance_m) {
        best = candidate;
        chosen = it;
      }
    }
    if (best.tip >= 0) {
      attach(tracing, best.tip, *chosen, time_s);
    } else {
      std::ptrdiff_t run = 1;
      while (run < std::ssize(nodes) && nodes[run] == nodes[run - 1] + 1) ++run;
      chosen = nodes.begin() + run / 2;
      nucleate(tracing, *chosen, time_s);
    }
    nodes.erase(chosen);
  }
}

End end_of(const Tracing& tracing, const Tip& tip, std::span<const double> p_s_Pa, double end_time_s) {
  const int n = static_cast<int>(tracing.x_m.size());
  const int next = tip.node + tip.path.direction;
  if (next < 0 || next >= n) return End::contact_end;
  for (int ahead = next; ahead >= 0 && ahead < n; ahead += tip.path.direction) {
    if (ahead != next && std::abs(tracing.x_m[ahead] - tracing.x_m[tip.node]) > tracing.reach_m) break;
    if (tracing.first_onset_s[ahead] - tip.time_s <= tracing.wait_s) return End::meets_front;
  }
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
  Tracing tracing{x_m, first_onset_s, reach_m(options), options.arrest_time_s, {}, {}};
  tracing.skipped.resize(x_m.size());

  std::vector<int> order;
  for (int node = 0; node < static_cast<int>(x_m.size()); ++node) {
    if (std::isfinite(first_onset_s[node])) order.push_back(node);
  }
  std::ranges::stable_sort(order, {}, [&](int node) { return first_onset_s[node]; });
  for (auto begin = order.begin(); begin != order.end();) {
    const double time_s = first_onset_s[*begin];
    const auto end = std::find_if(begin, order.end(), [&](int node) { return first_onset_s[node] > time_s; });
    place_simultaneous(tracing, {begin, end}, time_s);
    begin = end;
  }

  std::vector<Path> paths;
  for (Tip& tip : tracing.tips) {
    tip.path.end = end_of(tracing, tip, p_s_Pa, end_time_s);
    paths.push_back(std::move(tip.path));
  }
  return paths;
}

}  // namespace slipfront::fronts
