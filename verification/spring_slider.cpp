// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "interface/interface.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::spring_slider {

namespace {

using Complex = std::complex<double>;

constexpr double pressure_Pa = 5e6;
constexpr double V_m_per_s = 1e-2;
constexpr double mass_kg_per_m2 = 10;

interface::RateAndStateAging law() {
  interface::RateAndStateAging law;
  law.d_c_m = 1e-6;
  law.V_i_m_per_s = V_m_per_s;
  return law;
}

double rate_per_s() {
  return V_m_per_s / law().d_c_m;
}
/// m V^2/(p d_c)
double inertia() {
  return mass_kg_per_m2 * V_m_per_s * V_m_per_s / (pressure_Pa * law().d_c_m);
}
double critical_stiffness() {
  return (law().b - law().a) * (1 + inertia() / law().a);
}

/// Slip rate less V of a slider that is pulled at V by a spring, [steps], from a small deviation.
/// @param stiffness  k d_c/p
std::vector<double> motion(double stiffness, double dt_s, double end_s) {
  const interface::ContactModel model { law() };
  interface::Interface node(1, model.law.states());
  const double k_Pa_per_m = stiffness * pressure_Pa / law().d_c_m;
  const double steady_Pa = interface::static_coefficient(law()) * pressure_Pa;
  node.mass_per_length_kg_m2[0] = mass_kg_per_m2;
  node.p_Pa[0] = pressure_Pa;
  node.t_Pa[0] = steady_Pa;
  start_contact(model, node);
  constexpr double deviation = 1e-7;  // of V, which the spring's force brings about at once
  double v = V_m_per_s, stretch_m = (steady_Pa + deviation * law().a * pressure_Pa) / k_Pa_per_m;
  node.slip_rate_m_per_s[0] = v;
  std::vector<double> after;
  for (int n = 0; n < std::lround(end_s / dt_s); ++n) {
    node.v_x_m_per_s[0] = v + dt_s * k_Pa_per_m * stretch_m / mass_kg_per_m2;
    node.v_y_m_per_s[0] = -dt_s * pressure_Pa / mass_kg_per_m2;
    update_contact(model, dt_s, node);
    v = node.v_x_m_per_s[0];
    stretch_m += dt_s * (V_m_per_s - v);
    after.push_back(v - V_m_per_s);
  }
  return after;
}

/// The upper one of the pair s of x = Re A exp(s t), of samples in steps of interval_s: x[n + 1] = c x[n] + d
/// x[n - 1], by least squares.
Complex exponent(const std::vector<double>& x, double interval_s) {
  double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
  for (std::size_t n = 1; n + 1 < x.size(); ++n) {
    aa += x[n] * x[n];
    ab += x[n] * x[n - 1];
    bb += x[n - 1] * x[n - 1];
    ay += x[n] * x[n + 1];
    by += x[n - 1] * x[n + 1];
  }
  const double determinant = aa * bb - ab * ab;
  const double c = (ay * bb - by * ab) / determinant, d = (by * aa - ay * ab) / determinant;
  return std::log(0.5 * (c + std::sqrt(Complex(c * c + 4 * d)))) / interval_s;
}

/// s d_c/V as the program has it.
Complex measured(double stiffness, double dt_s) {
  const double interval_s = 0.2 / rate_per_s();
  auto x = motion(stiffness, dt_s, 30 / rate_per_s());
  const auto every = static_cast<std::size_t>(std::lround(interval_s / dt_s));
  std::vector<double> samples;
  // What decays faster than the pair has gone after some d_c/V.
  for (auto n = 50 * every; n < x.size(); n += every) samples.push_back(x[n]);
  return exponent(samples, interval_s) / rate_per_s();
}

/// Root of M S^3 + (a + M) S^2 + (a - b + K) S + K = 0 that comes from the pair without inertia.
Complex expected(double stiffness) {
  const double a = law().a, b = law().b, M = inertia(), K = stiffness;
  const double half = 0.5 * (b - a - K) / a;
  Complex S = half + std::sqrt(Complex(half * half - K / a));
  for (int n = 0; n < 50; ++n)
    S -= (((M * S + (a + M)) * S + (a - b + K)) * S + K) / ((3 * M * S + 2 * (a + M)) * S + (a - b + K));
  return S;
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  Curve growth{"growth, theory", Curve::Kind::theory}, frequency{"frequency, theory", Curve::Kind::theory};
  Curve growth_found{"growth"}, frequency_found{"frequency"};
  for (double share = 0.5; share < 1.551; share += 0.05) {
    const Complex S = expected(share * critical_stiffness());
    growth.add(share, S.real());
    frequency.add(share, S.imag());
  }
  const double dt_s = 1e-2 / rate_per_s();
  for (const double share : {0.6, 0.8, 1.0, 1.2, 1.4}) {
    const Complex S = measured(share * critical_stiffness(), dt_s),
                  theory = expected(share * critical_stiffness());
    growth_found.add(share, S.real());
    frequency_found.add(share, S.imag());
    const std::string reason = "of second order in the step, 1e-2 d_c/V";
    outcome.check(fmt::format("growth at {:.1f} k_c, of V/d_c", share), S.real(), theory.real(), 1e-4,
                  reason);
    outcome.check(fmt::format("frequency at {:.1f} k_c, of V/d_c", share), S.imag(), theory.imag(), 1e-4,
                  reason);
  }
  outcome.charts.push_back({"k/k_c",
                            "growth and frequency over V/d_c",
                            false,
                            false,
                            {growth, frequency, growth_found, frequency_found}});

  std::vector<double> steps, errors;
  for (const double share : {4e-2, 2e-2, 1e-2, 5e-3}) {
    if (effort == Effort::quick && share < 1e-2) continue;
    steps.push_back(share);
    errors.push_back(
        std::abs(measured(critical_stiffness(), share / rate_per_s()) - expected(critical_stiffness())));
  }
  outcome.check("order in the step at k_c", observed_order(steps, errors), 2, 0.1, "the scheme's");
  Curve found{"program"};
  for (std::size_t k = 0; k < steps.size(); ++k) found.add(steps[k], errors[k]);
  outcome.charts.push_back(
      {"step over d_c/V", "error over V/d_c", true, true, {order_line(2, steps, errors.back()), found}});
  return outcome;
}

}  // namespace slipfront::verification::spring_slider
