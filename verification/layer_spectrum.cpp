// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "stability/modes.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"
#include "verification/sliding.hpp"

namespace slipfront::verification::layer_spectrum {

namespace {

constexpr double p_Pa = 1e6, V_m_per_s = 0.1, H_m = 0.1;

struct Law {
  const char* name;
  interface::ContactModel contact;
  int order, next_order;  ///< in h of the program's error
};

std::array<Law, 2> laws(double c_S) {
  return {{{"mu = 0.6", {interface::Coulomb{0.6}}, 2, 4},
           {"mu = 1.3, delayed",
            {interface::Coulomb{1.3}, {.relaxed = interface::Relaxed::pressure, .time_s = H_m / c_S}},
            1,
            2}}};
}

/// A layer that slides.
struct Layer {
  double c_S = solid::shear_speed_m_per_s(undamped), unit_per_s = c_S / H_m;

  /// s of the fastest mode, 0 where none grows.
  Complex fastest_per_s(const Law& law, double k) const {
    const auto sliding =
        stability::uniform_sliding(law.contact.law, V_m_per_s, p_Pa, law.contact.regularisation);
    const auto modes =
        stability::growing_layer_modes(undamped, sliding, k, H_m, 4 * c_S * std::max(k, 1 / H_m));
    return modes.empty() ? Complex{0} : modes.front().s_per_s;
  }
  /// The rate with which the program carries a mode, extrapolated to no mesh.
  ComplexLimit carried(const Law& law, double k, Complex s_per_s, double waves_in_H) const {
    // Later, waves of a few elements, which grow out of rounding (34 e-folds on the finest mesh up to
    // 2 H/c_S), would stop the sliding of single nodes.
    const double end_s = 1.5 / unit_per_s;
    std::array<Complex, 3> at;
    for (int level = 0; level < 3; ++level)
      at[level] = carried_rate_per_s(
                      {.bodies = undamped,
                       .contact = law.contact,
                       .pressure_Pa = p_Pa,
                       .speed_m_per_s = V_m_per_s,
                       .wavenumber_per_m = k,
                       .s_per_s = s_per_s,
                       .height_m = H_m,
                       .elements_per_wave = static_cast<int>(std::lround(24 / waves_in_H * std::exp2(level))),
                       .end_s = end_s}) /
                  unit_per_s;
    return limit(at, law.order, law.next_order);
  }
};

RateCurves in_theory(const Layer& layer, const Law& law, bool full, const char* label) {
  RateCurves rates(label, Curve::Kind::theory);
  for (double kH = 0.25; kH < 7; kH += full ? 0.0625 : 0.25) {
    const Complex s = layer.fastest_per_s(law, kH / H_m);
    rates.add(kH, s.real() / layer.unit_per_s, -s.imag() * H_m / (kH * layer.c_S));
  }
  return rates;
}

RateCurves checked(const Layer& layer, const Law& law, bool full, Outcome& outcome) {
  RateCurves rates(law.name, Curve::Kind::program);
  // Wave over height such that meshes of every level fit.
  for (const double waves_in_H :
       full ? std::vector{0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0} : std::vector{0.3, 0.8}) {
    const double kH = 2 * std::numbers::pi * waves_in_H, k = kH / H_m;
    const Complex s = layer.fastest_per_s(law, k);
    const auto [rate, uncertainty] = layer.carried(law, k, s, waves_in_H);
    rates.add(kH, rate.real(), -rate.imag() / kH);
    const std::string reason =
        "change of the complex rate when the finest mesh joins the extrapolation: 24, 48 and 96 elements "
        "per height";
    outcome.check(fmt::format("growth rate H/c_S, {}, k H = {:.3g}", law.name, kH), rate.real(),
                  s.real() / layer.unit_per_s, uncertainty, reason);
    outcome.check(fmt::format("frequency H/c_S, {}, k H = {:.3g}", law.name, kH), rate.imag(),
                  s.imag() / layer.unit_per_s, uncertainty, reason);
  }
  return rates;
}

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  Outcome outcome;
  const Layer layer;
  RateCharts charts("k H", "growth rate H / c_S", "phase speed / c_S");
  for (const auto& law : laws(layer.c_S)) {
    charts.add(in_theory(layer, law, full, charts.theory_label()));
    charts.add(checked(layer, law, full, outcome));
  }
  outcome.charts = {std::move(charts.growth), std::move(charts.speed)};
  return outcome;
}

}  // namespace slipfront::verification::layer_spectrum
