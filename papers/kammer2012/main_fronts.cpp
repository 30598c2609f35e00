// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/main_fronts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "fronts/measures.hpp"

namespace slipfront::kammer2012 {

namespace {

using fronts::Front;
using fronts::FrontPoint;

bool starts_the_event(const Outcome& o, const Front& front) {
  const FrontPoint& start = front.points.front();
  if (o.triggered()) return !counts(o, front, start);
  return std::abs(start.x_m - o.first_onset_x_m) <= nucleation_reach_m;
}

/// Number of points before the speed stays low.
std::size_t points_before_slow_end(const Front& front, double slow_m_per_s) {
  std::size_t n = front.points.size();
  for (std::size_t k = n; k-- > 0;) {
    const double v = front.points[k].v_tip_m_per_s;
    if (v >= slow_m_per_s) break;
    if (v < slow_m_per_s) n = k;  // an undefined speed decides nothing
  }
  return n;
}

std::span<const FrontPoint> counted_points(const Outcome& o, const Front& front) {
  const std::size_t end = points_before_slow_end(front, slow_share * o.speeds.c_L);
  std::size_t begin = 0;
  while (begin < end && !counts(o, front, front.points[begin], nucleation_reach_m)) ++begin;
  return std::span(front.points).subspan(begin, end - begin);
}

/// The runs with their main fronts alone, these without their ends.
std::vector<Outcome> without_tails(std::span<const MainFront> mains) {
  std::vector<Outcome> runs;
  const Outcome* last = nullptr;
  for (const auto& m : mains) {
    if (m.outcome != last) {
      runs.push_back(*m.outcome);
      runs.back().fronts.clear();
      last = m.outcome;
    }
    Front kept = *m.front;
    kept.points.clear();
    std::ranges::copy_if(m.points, std::back_inserter(kept.points),
                         [&](const FrontPoint& p) { return !in_tail(m, p); });
    if (!kept.points.empty()) runs.back().fronts.push_back(std::move(kept));
  }
  return runs;
}

}  // namespace

const Front* first_front(const Outcome& outcome, int direction) {
  const Front* longest = nullptr;
  for (const auto& front : outcome.fronts)
    if (front.direction == direction && starts_the_event(outcome, front) &&
        (longest == nullptr || fronts::length_m(front) > fronts::length_m(*longest)))
      longest = &front;
  return longest;
}

std::vector<MainFront> main_fronts(std::span<const Outcome* const> outcomes) {
  std::vector<MainFront> list;
  for (const auto* o : outcomes) {
    for (const int direction : {-1, 1}) {
      const Front* front = first_front(*o, direction);
      if (front == nullptr) continue;
      const auto points = counted_points(*o, *front);
      if (!points.empty()) list.push_back({o, front, points});
    }
  }
  return list;
}

bool in_tail(const MainFront& front, const FrontPoint& point) {
  const bool slows_down = &front.points.back() != &front.front->points.back();
  if (!slows_down && front.front->end == fronts::End::record_end) return false;
  return std::abs(point.x_m - front.points.back().x_m) <= tail_m * (1 + 1e-9);
}

Collapse collapse_without_tails(std::span<const MainFront> mains) {
  const auto runs = without_tails(mains);
  std::vector<const Outcome*> pointers;
  pointers.reserve(runs.size());
  for (const auto& o : runs) pointers.push_back(&o);
  return collapse(pointers);
}

}  // namespace slipfront::kammer2012
