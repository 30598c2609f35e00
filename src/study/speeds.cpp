// SPDX-License-Identifier: BSD-3-Clause
#include "study/speeds.hpp"

#include <cmath>

#include "fronts/measures.hpp"
#include "study/sequence.hpp"

namespace slipfront::study {

std::vector<fronts::Front> main_fronts(const std::vector<fronts::Front>& all) {
  std::vector<fronts::Front> main;
  for (const int direction : {-1, 1}) {
    const fronts::Front* longest = nullptr;
    for (const auto& front : all)
      if (front.direction == direction && (!longest || length_m(front) > length_m(*longest)))
        longest = &front;
    if (longest) main.push_back(*longest);
  }
  return main;
}

std::vector<Place> stations(const MainFronts& own, double spacing_m) {
  std::vector<Place> places;
  for (const auto& front : own.fronts) {
    const double start_m = front.points.front().x_m, end_m = front.points.back().x_m;
    const auto first = std::llround(std::ceil(std::min(start_m, end_m) / spacing_m));
    for (auto k = first; static_cast<double>(k) * spacing_m <= std::max(start_m, end_m); ++k) {
      const double x = static_cast<double>(k) * spacing_m;
      if (std::abs(x - start_m) < nucleation_m || fronts::is_excluded(own.options, x)) continue;
      if (std::isfinite(v_tip_at(front, x))) places.push_back({x, front.direction});
    }
  }
  return places;
}

double v_tip_at(const fronts::Front& front, double x_m) {
  for (std::size_t k = 0; k + 1 < front.points.size(); ++k) {
    const auto& a = front.points[k];
    const auto& b = front.points[k + 1];
    const double share = (x_m - a.x_m) / (b.x_m - a.x_m);
    if (share < 0 || share > 1) continue;
    if (share == 0) return a.v_tip_m_per_s;
    if (share == 1) return b.v_tip_m_per_s;
    return a.v_tip_m_per_s + share * (b.v_tip_m_per_s - a.v_tip_m_per_s);
  }
  return undefined;
}

double speed_at(const MainFronts& fronts, const Place& place) {
  for (const auto& front : fronts.fronts)
    if (front.direction == place.direction) return v_tip_at(front, place.x_m);
  return undefined;
}

}  // namespace slipfront::study
