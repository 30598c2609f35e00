// SPDX-License-Identifier: BSD-3-Clause
#include "paper/main_fronts.hpp"

#include <cmath>

#include "fronts/measures.hpp"

namespace slipfront::paper {

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

}  // namespace slipfront::paper
