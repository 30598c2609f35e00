// SPDX-License-Identifier: BSD-3-Clause
#include "verification/orders.hpp"

#include <fmt/core.h>

#include <cmath>

#include "solid/operator.hpp"
#include "verification/body.hpp"

namespace slipfront::verification {

double observed_order(const std::vector<double>& h_m, const std::vector<double>& error) {
  const auto n = static_cast<double>(h_m.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < h_m.size(); ++k) {
    const double a = std::log(h_m[k]), b = std::log(error[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

Curve order_line(int order, const std::vector<double>& h_m, double last_error) {
  Curve line{fmt::format("slope {}", order), Curve::Kind::theory, h_m, {}};
  for (const double h : h_m) line.y.push_back(last_error * std::pow(h / h_m.back(), order));
  return line;
}

double factor_of_step(const mesh::Mesh& mesh, double step_s) {
  const double omega = solid::largest_frequency_rad_per_s(solid::make_operator(mesh, undamped));
  return step_s / solid::stable_step_s(omega, 0);
}

Steps steps_to(double time_s, double h_m, double coarsest_h_m) {
  const double c_L = solid::longitudinal_speed_m_per_s(undamped);
  const auto refinement = static_cast<int>(std::lround(coarsest_h_m / h_m));
  const int n = refinement * static_cast<int>(std::ceil(time_s * c_L / (0.85 * coarsest_h_m)));
  return {n, time_s / n};
}

}  // namespace slipfront::verification
