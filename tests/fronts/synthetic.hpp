// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "fronts/front.hpp"

namespace slipfront::fronts::testing {

constexpr double h = 0.2 / 300;
constexpr double V = 1000.0;
constexpr double never = std::numeric_limits<double>::infinity();

inline std::vector<double> nodes(int n, double spacing_m) {
  std::vector<double> x;
  for (int k = 0; k < n; ++k) x.push_back(k * spacing_m);
  return x;
}

/// First onset times of a front from `start_m` with constant speed to both sides.
inline std::vector<double> bilateral(const std::vector<double>& x, double start_m, double speed,
                                     double begin_s = 0) {
  std::vector<double> tau;
  for (const double place : x) tau.push_back(begin_s + std::abs(place - start_m) / speed);
  return tau;
}

/// Who slips first, of two.
inline std::vector<double> earlier(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] = std::min(a[k], b[k]);
  return a;
}

struct Recipe {
  int halo = 3;
  double end_time_s = 1e-3;
  /// How long each node slips.
  std::function<double(double x_m)> duration_s = [](double) { return never; };
  std::function<record::Traction(double x_m, double time_s)> traction = [](double, double) {
    return record::Traction{4e6, 5e6};
  };
};

/// A record in which every node slips once, at tau (never where infinite).
inline record::SlipRecord make_record(const std::vector<double>& x, const std::vector<double>& tau,
                                      const Recipe& recipe = {}) {
  record::SlipRecord record;
  record.x_m = x;
  record.halo = recipe.halo;
  record.end_time_s = recipe.end_time_s;
  const int n = static_cast<int>(x.size());
  for (int k = 0; k < n; ++k) {
    if (!std::isfinite(tau[k])) continue;
    record.onsets.push_back({k, tau[k]});
    const double stop_s = tau[k] + recipe.duration_s(x[k]);
    if (stop_s < recipe.end_time_s) record.stops.push_back({k, stop_s});
  }
  std::ranges::stable_sort(record.onsets, {}, &record::Onset::time_s);
  std::ranges::stable_sort(record.stops, {}, &record::Stop::time_s);
  for (const record::Onset& onset : record.onsets) {
    for (int k = onset.node - recipe.halo; k <= onset.node + recipe.halo; ++k) {
      const bool inside = k >= 0 && k < n;
      record.around.push_back(inside ? recipe.traction(x[k], onset.time_s) : record::Traction{nan, nan});
    }
  }
  return record;
}

inline record::StaticState make_state(const std::vector<double>& x) {
  return {x, std::vector<double>(x.size(), 4e6), std::vector<double>(x.size(), 5e6)};
}

inline FrontOptions make_options(double l_star_m = FrontOptions{}.l_star_m) {
  FrontOptions options;
  options.mu_s = 1.3;
  options.elasticity = {2.6e9, 0.37, false};
  options.l_star_m = l_star_m;
  return options;
}

inline std::vector<Front> find(const record::SlipRecord& record,
                               const FrontOptions& options = make_options()) {
  return find_fronts(record, make_state(record.x_m), options);
}

}  // namespace slipfront::fronts::testing
