// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/circle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "base/error.hpp"
#include "fronts/measures.hpp"

namespace slipfront::kammer2012 {

namespace {

constexpr std::array angles_deg = {30.0, 45.0};

/// Nodes near a ray from the left corner, outwards.
struct Ray {
  double angle_deg = 0;
  std::vector<std::size_t> nodes;
};

/// Nodes within half an element of the ray.
Ray ray_at(double angle_deg, const mesh::Mesh& plate) {
  const double angle = angle_deg * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const double reach_m = 0.5 * mesh::distance_x_m(plate, plate.interface_nodes[0], plate.interface_nodes[1]);
  const auto along = [&](std::size_t n) { return c * plate.x_m[n] + s * plate.y_m[n]; };
  Ray ray{angle_deg, {}};
  for (std::size_t n = 0; n < plate.x_m.size(); ++n)
    if (std::abs(c * plate.y_m[n] - s * plate.x_m[n]) <= reach_m) ray.nodes.push_back(n);
  std::ranges::sort(ray.nodes, {}, along);
  return ray;
}

/// The outermost maximum that is light enough, and what lies behind it.
WaveOnRay wave_on(const Ray& ray, const motion::Snapshot& snapshot, const mesh::Mesh& plate,
                  double zone_from_m, double zone_to_m) {
  const auto speed = [&](std::size_t place) {
    const auto n = ray.nodes[place];
    return std::hypot(snapshot.v_m_per_s.x[n], snapshot.v_m_per_s.y[n]);
  };
  WaveOnRay wave{.time_s = snapshot.time_s, .angle_deg = ray.angle_deg};
  std::size_t place = ray.nodes.size();
  for (std::size_t k = ray.nodes.size() - 1; k-- > 0 && place == ray.nodes.size();)
    if (speed(k + 1) >= min_peak_m_per_s && speed(k) < speed(k + 1)) place = k + 1;
  if (place == ray.nodes.size()) return wave;
  const auto node = ray.nodes[place];
  const double x = plate.x_m[node];
  wave.distance_m = std::hypot(x - std::clamp(x, zone_from_m, zone_to_m), plate.y_m[node]);
  wave.peak_m_per_s = wave.lowest_behind_m_per_s = speed(place);
  while (place-- > 0 && speed(place) <= wave.peak_m_per_s)
    wave.lowest_behind_m_per_s = std::min(wave.lowest_behind_m_per_s, speed(place));
  return wave;
}

bool is_apart(const WaveOnRay& wave, double c_L_m_per_s) {
  return std::abs(wave.distance_m / (c_L_m_per_s * wave.time_s) - 1) <= max_off_c_L_t &&
         wave.lowest_behind_m_per_s <= max_gap * wave.peak_m_per_s;
}

/// The multiple of wave_interval_s that is nearest to a time.
int interval_of(double time_s) {
  return static_cast<int>(std::lround(time_s / wave_interval_s));
}

}  // namespace

std::vector<WaveOnRay> waves_on_rays(const std::vector<motion::Snapshot>& snapshots, const mesh::Mesh& plate,
                                     double zone_from_m, double zone_to_m) {
  std::vector<WaveOnRay> waves;
  if (snapshots.empty()) return waves;
  SLIPFRONT_ASSERT(snapshots.front().v_m_per_s.size() >= plate.x_m.size(), "snapshots of another plate");
  for (const double angle_deg : angles_deg) {
    const Ray ray = ray_at(angle_deg, plate);
    for (const auto& snapshot : snapshots)
      waves.push_back(wave_on(ray, snapshot, plate, zone_from_m, zone_to_m));
  }
  return waves;
}

std::vector<double> wave_times_s(const Outcome& left) {
  std::vector<double> times_s;
  const auto* front = main_front(left, 1);
  if (front == nullptr) return times_s;
  double entry_s = infinity, exit_s = -infinity;  // of the tip between the places
  for (const auto& p : front->points) {
    if (p.x_m < tip_from_m || p.x_m > tip_to_m) continue;
    entry_s = std::min(entry_s, p.onset_s);
    exit_s = std::max(exit_s, p.onset_s);
  }
  for (int k = 1; k * wave_interval_s <= exit_s; ++k)
    if (k * wave_interval_s >= entry_s) times_s.push_back(k * wave_interval_s);
  return times_s;
}

std::optional<Circle> circle(const Outcome& left) {
  std::map<int, std::vector<const WaveOnRay*>> by_time;
  for (const auto& wave : left.waves) by_time[interval_of(wave.time_s)].push_back(&wave);
  Circle result;
  std::vector<double> peaks, gaps, ratios;
  for (const double time_s : wave_times_s(left)) {
    const auto found = by_time.find(interval_of(time_s));
    if (found == by_time.end()) return std::nullopt;
    ++result.n_snapshots;
    bool apart = true;
    for (const auto* wave : found->second) {
      apart = apart && is_apart(*wave, left.speeds.c_L);
      if (std::isnan(wave->peak_m_per_s)) continue;
      peaks.push_back(wave->peak_m_per_s);
      gaps.push_back(wave->lowest_behind_m_per_s / wave->peak_m_per_s);
      ratios.push_back(wave->distance_m / (left.speeds.c_L * wave->time_s));
    }
    result.n_apart += apart ? 1 : 0;
  }
  if (result.n_snapshots == 0 && left.waves.empty()) return std::nullopt;
  result.peak_m_per_s = fronts::median(peaks);
  result.gap = fronts::median(gaps);
  result.over_c_L_t = fronts::median(ratios);
  return result;
}

}  // namespace slipfront::kammer2012
