// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "verification/loaded_plane.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::nucleation {

namespace {

constexpr double pressure_Pa = 5e7, b = 0.016, a = 0.2 * b, f0 = 0.6;
constexpr double L_b_m = 0.01;
constexpr double half_length = 1.3774;  ///< of the slip that runs away, over L_b
constexpr double rise = 0.3781;         ///< -(a/b) d_c d(1/V)/dt
constexpr double ln_V_theta_over_d_c = 7;

/// Of the shape of V, 1 in the middle: the sum of these times sin(angle), sin(3 angle), ..., cos(angle) =
/// x/half-length, with which V - (L_b/2)|k| V is `rise` where V is not 0.
constexpr std::array shape = {0.68124, -0.28245, 0.03485, -0.00137};
double V_shape(double x_over_L_b) {
  if (std::abs(x_over_L_b) >= half_length) return 0;
  const double angle = std::acos(x_over_L_b / half_length);
  double V = 0;
  for (std::size_t n = 0; n < shape.size(); ++n)
    V += shape[n] * std::sin(static_cast<double>(2 * n + 1) * angle);
  return V;
}
constexpr double mean_V = 0.25 * std::numbers::pi * shape[0];  ///< over the length

/// Coefficients less f0, by x/L_b: of the load, and of sliding at V_i.
struct Begin {
  std::function<double(double)> load, at_V_i;
};
/// Slip that has the shape of the one that runs away.
Begin in_shape() {
  const double load = b * ln_V_theta_over_d_c;
  return {[=](double) { return load; },
          [=](double x) { return load - a * std::log(std::max(V_shape(x), 1e-4)); }};
}
/// A bump of the load and of the state.
Begin bump(double width) {
  const auto f = [=](double x) { return b * std::max(-2.0, ln_V_theta_over_d_c - x * x / (width * width)); };
  return {f, f};
}

/// What slip does while it grows, over its largest rate in units of d_c c_S/L_b.
struct Growth {
  Curve length, rise;
};
Growth growth(const std::string& label, const Begin& begin, double V_i, int elements, double width) {
  const double c_S = solid::shear_speed_m_per_s(undamped);
  interface::RateAndStateAging law;
  law.a = a, law.b = b, law.f0 = f0;
  law.d_c_m = L_b_m * b * pressure_Pa / (2 * sliding_stiffness_Pa());
  const double V_unit = law.d_c_m * c_S / L_b_m;
  law.V0_m_per_s = law.V_i_m_per_s = V_i * V_unit;
  const auto t_Pa = [](const std::function<double(double)>& f) {
    return [&f](double x_m) { return pressure_Pa * (f0 + f(x_m / L_b_m)); };
  };
  LoadedBody body({.width_m = width * L_b_m,
                   .height_m = 0.5 * width * L_b_m,
                   .h_m = L_b_m / elements,
                   .pressure_Pa = pressure_Pa,
                   .law = law,
                   .t_at_V_i_Pa = t_Pa(begin.at_V_i)});
  body.load(t_Pa(begin.load));
  Growth growth{{label}, {label}};
  double last_V = 0, last_s = 0, next_V = V_i * V_unit;
  while (next_V < 0.1 * V_unit) {
    body.advance();
    const auto& V = body.interface_state().slip_rate_m_per_s;
    const double largest = std::ranges::max(V);
    if (largest < next_V) continue;
    double sum = 0;
    for (const double v : V) sum += v / elements;
    if (last_V > 0) {
      growth.length.add(largest / V_unit, sum / largest / (2 * mean_V));
      growth.rise.add(largest / V_unit,
                      a / b * law.d_c_m * (1 / last_V - 1 / largest) / (body.time_s() - last_s));
    }
    last_V = largest, last_s = body.time_s(), next_V = 1.3 * largest;
  }
  return growth;
}

constexpr double zone_half_length_m = 0.01;

/// Growth rate of slip in a zone between barriers under linear slip weakening, in c_S per half-length.
/// @param length  of the zone over the critical one
double zone_growth(double length, int elements) {
  constexpr double mu_s = 0.6, mu_k = 0.1;
  // Uenishi and Rice (2003): the critical half-length is 0.5789 mu* d_c/(strength drop).
  const double d_c_m =
      zone_half_length_m / length * (mu_s - mu_k) * pressure_Pa / (0.57889 * 2 * sliding_stiffness_Pa());
  const double h_m = zone_half_length_m / elements;
  LoadedBody body({.width_m = 16 * zone_half_length_m,
                   .height_m = 8 * zone_half_length_m,
                   .h_m = h_m,
                   .pressure_Pa = pressure_Pa,
                   .law = interface::SlipWeakening{mu_s, mu_k, d_c_m}});
  constexpr double overload = 1e-9;
  body.load([&](double x_m) {
    return pressure_Pa *
           (std::abs(x_m) < zone_half_length_m - 0.1 * h_m ? mu_s * (1 + overload) : 0.5 * mu_s);
  });
  const double unit_s = zone_half_length_m / solid::shear_speed_m_per_s(undamped);
  const auto log_V_at = [&](double time_s) {
    while (body.time_s() < time_s) body.advance();
    return std::log(std::ranges::max(body.interface_state().slip_rate_m_per_s));
  };
  const double before = log_V_at(9 * unit_s), from_s = body.time_s();
  return (log_V_at(15 * unit_s) - before) / (body.time_s() - from_s) * unit_s;
}

/// The length that does not grow, from rates s of longer ones: for small s what the motion outside the zone
/// takes goes with s^2 (ln(1/s) + a constant), in two dimensions.
double critical_length(const std::array<double, 3>& lengths, const std::array<double, 3>& s) {
  Eigen::Matrix3d terms;
  for (int j = 0; j < 3; ++j) terms.row(j) << 1, -s[j] * s[j] * std::log(s[j]), s[j] * s[j];
  return terms.partialPivLu().solve(Eigen::Vector3d(lengths.data()))[0];
}

/// The zone ends between the last node that slips and the next one: an error of first order in h.
Chart check_slip_weakening(Outcome& outcome) {
  constexpr std::array lengths = {1.05, 1.1, 1.15, 1.2};
  Chart chart{.x_label = "length of the zone / critical length",
              .y_label = "growth rate / (c_S / half-length)"};
  std::array<double, 3> nearer, farther;
  for (int k = 0; k < 3; ++k) {
    const int elements = 10 << k;
    Curve rates{fmt::format("slip weakening, a/h = {}", elements)};
    for (const double length : lengths) rates.add(length, zone_growth(length, elements));
    const auto& s = rates.y;
    nearer[k] = critical_length({lengths[0], lengths[1], lengths[2]}, {s[0], s[1], s[2]});
    farther[k] = critical_length({lengths[1], lengths[2], lengths[3]}, {s[1], s[2], s[3]});
    rates.add(nearer[k], 0);
    chart.curves.push_back(std::move(rates));
  }
  const auto near = limit(nearer[0], nearer[1], nearer[2], 1, 2),
             far = limit(farther[0], farther[1], farther[2], 1, 2);
  outcome.check(
      "length of a zone that does not grow under slip weakening, over 1.1578 mu* d_c/(strength drop)",
      near.value, 1, near.uncertainty + std::abs(far.value - near.value),
      "changes when the finest mesh joins the extrapolation, and when the shortest zone does");
  return chart;
}

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  Outcome outcome;
  std::vector<Growth> found;
  const int elements = full ? 20 : 10;
  const double width = full ? 32 : 16;
  found.push_back(growth("in its shape", in_shape(), 1e-3, elements, width));
  constexpr double V = 0.01;
  const double inertia = rise * b / a * V * half_length;
  const double tolerance = 1.0 / (elements * elements) + std::pow(half_length / width, 2) + inertia * inertia;
  const char* reason =
      "squares of h/L_b, of the half-length over the body's width and over the way of a shear wave in an "
      "e-fold";
  outcome.check("half-length over L_b", found[0].length.value_at(V), half_length, tolerance * half_length,
                reason);
  outcome.check("-(a/b) d_c d(1/V)/dt", found[0].rise.value_at(V), rise, tolerance * rise, reason);
  if (full) {
    found.push_back(growth("narrower", bump(0.3), 1e-4, 10, 16));
    found.push_back(growth("wider", bump(0.5), 1e-4, 10, 16));
  }
  Chart length{.x_label = "V / (d_c c_S / L_b)", .y_label = "half-length / L_b", .log_x = true};
  Chart rate{.x_label = length.x_label, .y_label = "-(a/b) d_c d(1/V)/dt", .log_x = true};
  length.curves.push_back({"theory", Curve::Kind::theory, {1e-4, 0.1}, {half_length, half_length}});
  rate.curves.push_back({"theory", Curve::Kind::theory, {1e-4, 0.1}, {rise, rise}});
  for (auto& g : found) {
    length.curves.push_back(std::move(g.length));
    rate.curves.push_back(std::move(g.rise));
  }
  outcome.charts = {std::move(length), std::move(rate)};
  if (full) outcome.charts.push_back(check_slip_weakening(outcome));
  return outcome;
}

}  // namespace slipfront::verification::nucleation
