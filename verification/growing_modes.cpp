// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/numbers.hpp"
#include "interface/friction/coulomb.hpp"
#include "stability/modes.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"
#include "verification/sliding.hpp"

namespace slipfront::verification::growing_modes {

namespace {

constexpr double length_m = 0.1;
constexpr double k_per_m = 2 * std::numbers::pi / length_m;
constexpr double p_Pa = 1e6, V_m_per_s = 0.1;

double rate_unit_per_s() {
  return k_per_m * solid::shear_speed_m_per_s(undamped);
}

/// A way in which friction answers, and the orders in h of the program's error with it.
struct Response {
  const char* name;
  interface::ContactModel (*contact)(double mu);
  int order, next_order;
};

interface::ContactModel at_once(double mu) {
  return {interface::Coulomb{mu}};
}

/// mu at the speed V falls with it by 0.3 of the radiation damping, |mu'| p = 0.3 G/c_S.
interface::ContactModel falling(double mu) {
  const double slope =
      0.3 * solid::shear_modulus_Pa(undamped) / (solid::shear_speed_m_per_s(undamped) * p_Pa);
  return weakening(mu, V_m_per_s, slope);
}

/// The strength follows with the time 1/(k c_S).
interface::ContactModel delayed(double mu) {
  return {interface::Coulomb{mu}, {.relaxed = interface::Relaxed::strength, .time_s = 1 / rate_unit_per_s()}};
}

constexpr std::array<Response, 3> responses = {{{"constant mu", at_once, 2, 4},
                                                {"mu falls with speed", falling, 2, 3},
                                                {"strength delayed", delayed, 2, 3}}};

/// s/(k c_S) of the mode that grows; at mu = 1 of the constant law, of the neutral one.
Complex mode(const interface::ContactModel& contact) {
  const auto sliding = stability::uniform_sliding(contact.law, V_m_per_s, p_Pa, contact.regularisation);
  if (sliding.mu == 1 && sliding.slope_s_per_m == 0 && sliding.relaxed == interface::Relaxed::none)
    return {0, -std::numbers::sqrt2};
  const auto fastest = stability::fastest_growing_mode(undamped, sliding, k_per_m);
  return fastest ? fastest->s_per_s / rate_unit_per_s() : Complex{nan, 0};
}

/// The rate with which the program carries a mode.
Complex carried(const interface::ContactModel& contact, Complex p, int elements) {
  return carried_rate_per_s({.bodies = undamped,
                             .contact = contact,
                             .pressure_Pa = p_Pa,
                             .speed_m_per_s = V_m_per_s,
                             .wavenumber_per_m = k_per_m,
                             .s_per_s = p * rate_unit_per_s(),
                             .elements_per_wave = elements,
                             .end_s = 2 / rate_unit_per_s()}) /
         rate_unit_per_s();
}

RateCurves in_theory(const Response& response, const char* label) {
  RateCurves rates(label, Curve::Kind::theory);
  for (int j = 0; j <= 64; ++j) {
    const double mu = 0.4 + 0.025 * j;
    const Complex p = mode(response.contact(mu));
    if (!std::isnan(p.real())) rates.add(mu, p.real(), -p.imag());
  }
  return rates;
}

RateCurves checked(const Response& response, bool full, Outcome& outcome) {
  RateCurves rates(response.name, Curve::Kind::program);
  for (const double mu : full ? std::vector{0.6, 1.0, 1.1, 1.3, 1.6, 2.0} : std::vector{1.0, 1.3}) {
    const auto contact = response.contact(mu);
    const Complex p = mode(contact);
    if (std::isnan(p.real())) continue;
    const auto rate = check_mode(
        fmt::format("{}, mu = {}", response.name, mu),
        [&](int elements) { return carried(contact, p, elements); }, p, response.order, response.next_order,
        outcome);
    rates.add(mu, rate.real(), -rate.imag());
  }
  return rates;
}

Curve errors(const Response& response, Outcome& outcome) {
  const auto contact = response.contact(1.3);
  const Complex p = mode(contact);
  return check_order(
      response.name, fmt::format("{}, mu = 1.3", response.name),
      [&](int elements) { return std::abs(carried(contact, p, elements) - p); }, response.order, outcome);
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  RateCharts charts("friction coefficient", "growth rate / (k c_S)", "phase speed / c_S");
  Chart error{.x_label = "k h", .y_label = "|s - theory| / (k c_S)", .log_x = true, .log_y = true};
  for (const auto& response : responses) {
    charts.add(in_theory(response, charts.theory_label()));
    charts.add(checked(response, effort == Effort::full, outcome));
    error.curves.push_back(errors(response, outcome));
  }
  outcome.charts = {std::move(charts.growth), std::move(charts.speed), std::move(error)};
  return outcome;
}

}  // namespace slipfront::verification::growing_modes
