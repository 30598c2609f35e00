// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "stability/modes.hpp"
#include "stability/verdict.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"
#include "verification/sliding.hpp"

namespace slipfront::verification::growing_modes_with_state {

namespace {

constexpr double length_m = 0.1;
constexpr double k_per_m = 2 * std::numbers::pi / length_m;
constexpr double p_Pa = 1e8, V_m_per_s = 0.1;

struct Slide {
  const char* name;
  stability::Bodies bodies;
  double direct;  ///< a p/V over the radiation damping
  double b_over_a;
  int order;                    ///< in h of the program's error
  std::array<double, 2> delay;  ///< of the state, d_c/V times k c_S: smallest and largest
  double end;                   ///< of the run, times k c_S

  /// k c_S of the body above.
  double rate_unit_per_s() const { return k_per_m * solid::shear_speed_m_per_s(bodies.above); }

  interface::ContactModel contact(double with_delay) const {
    interface::RateAndStateAging law;
    law.f0 = 1;
    law.V0_m_per_s = law.V_i_m_per_s = V_m_per_s;
    law.a = direct * stability::radiation_damping_Pa_s_per_m(bodies) * V_m_per_s / p_Pa;
    law.b = b_over_a * law.a;
    law.d_c_m = with_delay * V_m_per_s / rate_unit_per_s();
    return {law};
  }
};

std::array<Slide, 6> slides() {
  const solid::Material aluminium{
      .youngs_modulus_Pa = 70e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 2700, .stiffness_damping_s = 0};
  const stability::Bodies equal{undamped, undamped}, on_aluminium{undamped, aluminium};
  return {{{"rigid plane, fast", undamped, 1.5, 2, 2, {0.5, 2}, 2},
           {"rigid plane, slow", undamped, 5, 2, 1, {1, 4}, 2},
           {"equal bodies, fast", equal, 1.5, 2, 2, {0.5, 2}, 2},
           {"equal bodies, slow", equal, 5, 2, 1, {1, 4}, 2},
           {"PMMA on aluminium, fast", on_aluminium, 1.5, 2, 2, {0.5, 2}, 1},
           {"PMMA on aluminium, a > b", on_aluminium, 0.3, 0.8, 2, {0.1, 1}, 1}}};
}

/// s/(k c_S) of the mode that Newton's method finds from near it, decaying ones too.
Complex mode_near(Complex p, const Slide& slide, double delay) {
  const auto sliding = stability::uniform_sliding(slide.contact(delay).law, V_m_per_s, p_Pa);
  const auto f = [&](Complex at) {
    return stability::half_space_relation(slide.bodies, sliding, k_per_m, at);
  };
  for (int n = 0; n < 30; ++n) {
    const double small = 1e-5;
    p -= 2 * small * f(p) / (f(p + small) - f(p - small));
  }
  return p;
}

/// Of the mode that grows fastest at the smallest delay, followed to others.
struct Modes {
  std::vector<double> delay;
  std::vector<Complex> p;
};
Modes modes(const Slide& slide) {
  constexpr int last = 60;
  const auto sliding = stability::uniform_sliding(slide.contact(slide.delay[0]).law, V_m_per_s, p_Pa);
  Complex p = stability::fastest_growing_mode(slide.bodies, sliding, k_per_m).value().s_per_s /
              slide.rate_unit_per_s();
  Modes modes;
  for (int j = 0; j <= last; ++j) {
    const double delay = slide.delay[0] * std::pow(slide.delay[1] / slide.delay[0], 1.0 * j / last);
    p = mode_near(p, slide, delay);
    modes.delay.push_back(delay);
    modes.p.push_back(p);
  }
  return modes;
}

/// The rate with which the program carries a mode.
Complex carried(const Slide& slide, double delay, Complex p, int elements) {
  return carried_rate_per_s({.bodies = slide.bodies,
                             .contact = slide.contact(delay),
                             .pressure_Pa = p_Pa,
                             .speed_m_per_s = V_m_per_s,
                             .wavenumber_per_m = k_per_m,
                             .s_per_s = p * slide.rate_unit_per_s(),
                             .elements_per_wave = elements,
                             .end_s = slide.end / slide.rate_unit_per_s()}) /
         slide.rate_unit_per_s();
}

/// Without inertia waves between equal bodies are neutral at k_c = 2 (b - a) p/(mu* d_c), mu* = G (1 + nu) in
/// plane stress, and oscillate with (V/d_c) sqrt(b/a - 1): Rice and Ruina (1983).
void check_critical_wavenumber(Outcome& outcome) {
  const Slide slide{"", {undamped, undamped}, 40, 2, 1, {}, 8};
  const auto law = slide.contact(1).law.as<interface::RateAndStateAging>();
  const double modulus_Pa = solid::shear_modulus_Pa(undamped) * (1 + undamped.poissons_ratio);
  const double neutral_delay =
      2 * (law.b - law.a) * p_Pa / (modulus_Pa * k_per_m) * slide.rate_unit_per_s() / V_m_per_s;
  const auto rate = [&](double k_over_k_c) {  // over V/d_c
    const double delay = k_over_k_c * neutral_delay;
    const Complex p = mode_near({0, -1 / delay}, slide, delay);
    return delay *
           limit({carried(slide, delay, p, 16), carried(slide, delay, p, 32), carried(slide, delay, p, 64)},
                 slide.order, slide.order + 1)
               .value;
  };
  const Complex below = rate(0.98), above = rate(1.02);
  const double share = below.real() / (below - above).real();  // of the way from one to the other
  const char* reason = "inertia: the square of the frequency over k c_S";
  const double inertia = 1 / (neutral_delay * neutral_delay);
  outcome.check("neutral wavenumber of equal bodies, a p/V = 40 times the radiation damping, over k_c",
                0.98 + 0.04 * share, 1, inertia, reason);
  outcome.check("frequency there over V/d_c", -(below + share * (above - below)).imag(), 1, inertia, reason);
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  RateCharts charts("k c_S d_c / V", "growth rate / (k c_S)", "phase speed / c_S");
  charts.growth.log_x = charts.speed.log_x = true;
  Chart error{.x_label = "k h", .y_label = "|s - theory| / (k c_S)", .log_x = true, .log_y = true};
  for (const auto& slide : slides()) {
    const auto [delay, p] = modes(slide);
    RateCurves theory(charts.theory_label(), Curve::Kind::theory), found(slide.name, Curve::Kind::program);
    for (std::size_t j = 0; j < p.size(); ++j) theory.add(delay[j], p[j].real(), -p[j].imag());
    const std::size_t middle = p.size() / 2;
    for (const std::size_t j :
         effort == Effort::full ? std::vector{std::size_t{0}, middle, p.size() - 1} : std::vector{middle}) {
      const Complex rate = check_mode(
          fmt::format("{}, k c_S d_c/V = {:.3g}", slide.name, delay[j]),
          [&](int elements) { return carried(slide, delay[j], p[j], elements); }, p[j], slide.order,
          slide.order + 1, outcome);
      found.add(delay[j], rate.real(), -rate.imag());
    }
    charts.add(theory);
    charts.add(found);
    error.curves.push_back(check_order(
        slide.name, slide.name,
        [&](int elements) {
          return std::abs(carried(slide, delay[middle], p[middle], elements) - p[middle]);
        },
        slide.order, outcome));
  }
  check_critical_wavenumber(outcome);
  outcome.charts = {std::move(charts.growth), std::move(charts.speed), std::move(error)};
  return outcome;
}

}  // namespace slipfront::verification::growing_modes_with_state
