// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "stability/modes.hpp"
#include "stability/verdict.hpp"
#include "verification/problems.hpp"
#include "verification/sliding.hpp"

namespace slipfront::verification::growing_modes_of_two {

namespace {

constexpr double length_m = 0.1;
constexpr double k_per_m = 2 * std::numbers::pi / length_m;
constexpr double p_Pa = 1e6, V_m_per_s = 0.1;

solid::Material undamped(double youngs_modulus_Pa, double poissons_ratio, double density_kg_per_m3) {
  return {.youngs_modulus_Pa = youngs_modulus_Pa,
          .poissons_ratio = poissons_ratio,
          .density_kg_per_m3 = density_kg_per_m3,
          .stiffness_damping_s = 0};
}

struct Pair {
  const char* name;
  stability::Bodies bodies;
  int order, next_order;  ///< in h of the program's error

  /// k c_S of the slower one.
  double rate_unit_per_s() const {
    return k_per_m *
           std::min(solid::shear_speed_m_per_s(bodies.above), solid::shear_speed_m_per_s(*bodies.below));
  }
};

std::array<Pair, 3> pairs() {
  const auto pmma = undamped(2.6e9, 0.37, 1200);
  return {{{"stiffer base", {pmma, undamped(5.0e9, 0.33, 1500)}, 2, 4},
           {"steel base", {pmma, undamped(210e9, 0.3, 7800)}, 2, 3},
           {"aluminium above", {undamped(70e9, 0.33, 2700), pmma}, 2, 3}}};
}

interface::ContactModel constant(double mu) {
  return {interface::Coulomb{mu}};
}

/// mu at the speed V falls with it by half of the pair's radiation damping.
interface::ContactModel falling(const Pair& pair, double mu) {
  const double slope = 0.5 * stability::radiation_damping_Pa_s_per_m(pair.bodies) / p_Pa;
  return weakening(mu, V_m_per_s, slope);
}

/// s of the fastest mode; some mode grows in all cases here.
Complex mode_per_s(const Pair& pair, const interface::ContactModel& contact) {
  const auto sliding = stability::uniform_sliding(contact.law, V_m_per_s, p_Pa);
  return stability::fastest_growing_mode(pair.bodies, sliding, k_per_m).value().s_per_s;
}

Complex carried_per_s(const Pair& pair, const interface::ContactModel& contact, Complex s_per_s,
                      int elements) {
  return carried_rate_per_s({.bodies = pair.bodies,
                             .contact = contact,
                             .pressure_Pa = p_Pa,
                             .speed_m_per_s = V_m_per_s,
                             .wavenumber_per_m = k_per_m,
                             .s_per_s = s_per_s,
                             .elements_per_wave = elements,
                             .end_s = 2 / pair.rate_unit_per_s()});
}

RateCurves in_theory(const Pair& pair, const char* label) {
  RateCurves rates(label, Curve::Kind::theory);
  for (int j = 0; j <= 76; ++j) {
    const double mu = 0.1 + 0.025 * j;
    const Complex s = mode_per_s(pair, constant(mu)) / pair.rate_unit_per_s();
    rates.add(mu, s.real(), -s.imag());
  }
  return rates;
}

/// Checks a rate, in k c_S, and returns it.
Complex checked(const Pair& pair, const char* response, const interface::ContactModel& contact, double mu,
                Outcome& outcome) {
  const Complex s = mode_per_s(pair, contact);
  return check_mode(
      fmt::format("{}, {}, mu = {}", pair.name, response, mu),
      [&](int elements) { return carried_per_s(pair, contact, s, elements) / pair.rate_unit_per_s(); },
      s / pair.rate_unit_per_s(), pair.order, pair.next_order, outcome);
}

RateCurves checked(const Pair& pair, bool full, Outcome& outcome) {
  RateCurves rates(pair.name, Curve::Kind::program);
  for (const double mu : full ? std::vector{0.3, 0.6, 1.0, 1.3, 2.0} : std::vector{0.6, 1.3}) {
    const Complex rate = checked(pair, "constant mu", constant(mu), mu, outcome);
    rates.add(mu, rate.real(), -rate.imag());
  }
  for (const double mu : full ? std::vector{1.0, 1.3} : std::vector{1.3})
    checked(pair, "mu falls with speed", falling(pair, mu), mu, outcome);
  return rates;
}

Curve errors(const Pair& pair, Outcome& outcome) {
  const Complex s = mode_per_s(pair, constant(1.3));
  const auto error = [&](int elements) {
    return std::abs(carried_per_s(pair, constant(1.3), s, elements) - s) / pair.rate_unit_per_s();
  };
  return check_order(pair.name, fmt::format("{}, constant mu = 1.3", pair.name), error, pair.order, outcome);
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  RateCharts charts("friction coefficient", "growth rate / (k c_S)", "phase speed / c_S");
  charts.growth.log_y = true;
  Chart error{.x_label = "k h", .y_label = "|s - theory| / (k c_S)", .log_x = true, .log_y = true};
  for (const auto& pair : pairs()) {
    charts.add(in_theory(pair, charts.theory_label()));
    charts.add(checked(pair, effort == Effort::full, outcome));
    error.curves.push_back(errors(pair, outcome));
  }
  outcome.charts = {std::move(charts.growth), std::move(charts.speed), std::move(error)};
  return outcome;
}

}  // namespace slipfront::verification::growing_modes_of_two
