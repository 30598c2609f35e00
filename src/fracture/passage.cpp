// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/passage.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "fronts/measures.hpp"

namespace slipfront::fracture {

namespace {

/// Distances behind the tip at which slip tells G, over the cohesive zone: beyond it, and near against the
/// crack.
constexpr double from_zones = 1.5, to_zones = 4;
/// Points of the path on each side by which the speed is found, at least, and within so many cohesive zones.
constexpr int speed_points = 4;
constexpr double speed_zones = 2;

/// Slope, where y is 0, of the parabola in r that fits y best; not a number from too few points.
double slope_at_root(const std::vector<double>& r, const std::vector<double>& y) {
  constexpr std::size_t fewest = 5;
  if (r.size() < fewest) return nan;
  const double scale = r.back();
  Eigen::MatrixX3d powers(std::ssize(r), 3);
  Eigen::VectorXd values(std::ssize(r));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double x = r[static_cast<std::size_t>(k)] / scale;
    powers.row(k) << 1, x, x * x;
    values[k] = y[static_cast<std::size_t>(k)];
  }
  const Eigen::Vector3d c = powers.colPivHouseholderQr().solve(values);
  // The slope where the parabola passes 0 upwards.
  const double square = c[1] * c[1] - 4 * c[2] * c[0];
  return square > 0 ? std::sqrt(square) / scale : nan;
}

/// By the slip of a row whose tip is x_tip_m.
double G_by_slip(const Recorded& recorded, std::size_t row, double x_tip_m, double zone_m,
                 double speed_m_per_s, const Bodies& bodies) {
  const auto& slip = recorded.tip_slip;
  const auto slips = slip.slip_of(row);
  const int direction = slip.direction[row];
  std::vector<double> r_m, squares;
  for (std::size_t k = 0; k < slips.size() && std::isfinite(slips[k]); ++k) {
    const auto node = static_cast<std::size_t>(slip.node[row] - direction * slip.steps_behind[k]);
    const double r = direction * (x_tip_m - recorded.x_m[node]);
    if (r < from_zones * zone_m || r > to_zones * zone_m) continue;
    r_m.push_back(r);
    squares.push_back(slips[k] * slips[k]);
  }
  const double per_G = slip_squared_per_G_and_distance(bodies, speed_m_per_s);
  return per_G > 0 ? slope_at_root(r_m, squares) / per_G : nan;
}

}  // namespace

std::vector<Passage> passages(const fronts::Front& front, const Recorded& recorded, const Bodies& bodies) {
  const auto& breakdown = recorded.breakdown;
  const double limit_m_per_s = limiting_speed_m_per_s(bodies);
  std::vector<Passage> all;
  std::map<std::int32_t, std::size_t> place_of;
  std::vector<double> way_m, onset_s, zones_m;
  all.reserve(front.points.size());
  for (const auto& point : front.points) {
    const auto node = static_cast<std::size_t>(point.node);
    Passage here;
    if (breakdown.complete.at(node) != 0) {
      here.stress_drop_Pa = std::abs(point.t_s_Pa) - breakdown.residual_t_Pa[node];
      here.cohesive_zone_m = point.v_tip_m_per_s * breakdown.time_s[node];
      if (point.v_tip_m_per_s < limit_m_per_s)
        here.K_Pa_sqrt_m =
            stress_intensity_Pa_sqrt_m(bodies, point.v_tip_m_per_s, breakdown.work_J_per_m2[node]);
    }
    if (std::isfinite(here.cohesive_zone_m)) zones_m.push_back(here.cohesive_zone_m);
    place_of[point.node] = all.size();
    way_m.push_back(std::abs(point.x_m - front.points.front().x_m));
    onset_s.push_back(point.onset_s);
    all.push_back(here);
  }
  if (zones_m.empty()) return all;
  std::ranges::nth_element(zones_m, zones_m.begin() + std::ssize(zones_m) / 2);
  const auto slowness_s_per_m =
      fronts::local_slopes(way_m, onset_s, speed_zones * zones_m[zones_m.size() / 2], speed_points);
  for (std::size_t row = 0; row < recorded.tip_slip.n_rows(); ++row) {
    const auto at = place_of.find(recorded.tip_slip.node[row]);
    if (recorded.tip_slip.direction[row] != front.direction || at == place_of.end()) continue;
    const auto& point = front.points[at->second];
    auto& here = all[at->second];
    if (!(slowness_s_per_m[at->second] > 0)) continue;
    const double speed_m_per_s = 1 / slowness_s_per_m[at->second];
    const double since_s = recorded.tip_slip.time_s[row] - point.onset_s;
    if (!(speed_m_per_s < limit_m_per_s) || !(here.cohesive_zone_m > 0)) continue;
    here.G_slip_J_per_m2 = G_by_slip(recorded, row, point.x_m + front.direction * speed_m_per_s * since_s,
                                     here.cohesive_zone_m, speed_m_per_s, bodies);
  }
  return all;
}

}  // namespace slipfront::fracture
