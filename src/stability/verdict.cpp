// SPDX-License-Identifier: BSD-3-Clause
#include "stability/verdict.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/numbers.hpp"
#include "stability/rupture.hpp"

namespace slipfront::stability {
namespace {

using interface::Relaxed;

double growth_at(const Bodies& bodies, const Sliding& sliding, double k) {
  const auto mode = fastest_growing_mode(bodies, sliding, k);
  return mode ? mode->growth_per_s() : 0;
}

struct Peak {
  double growth_per_s = 0, wavenumber_per_m = 0;
  bool at_short_end = false;
};

/// Fastest growth between two wavenumbers: a scan, ten to a decade, then golden sections about its best.
Peak fastest_between(const Bodies& bodies, const Sliding& sliding, double low, double high) {
  const int n = 1 + static_cast<int>(std::ceil(10 * std::log10(high / low)));
  const double ratio = std::pow(high / low, 1.0 / n);
  Peak best;
  int best_at = 0;
  std::vector<Mode> modes;
  const auto growth_here = [&](double k) {
    modes = growing_modes(bodies, sliding, k, modes);
    return modes.empty() ? 0 : modes.front().growth_per_s();
  };
  for (int i = 0; i <= n; ++i) {
    const double k = low * std::pow(ratio, i);
    const double growth = growth_here(k);
    if (growth > best.growth_per_s) {
      best = {growth, k, i == n};
      best_at = i;
    }
  }
  if (best.growth_per_s == 0 || best_at == 0 || best_at == n) return best;
  double from = std::log(best.wavenumber_per_m / ratio), to = std::log(best.wavenumber_per_m * ratio);
  while (to - from > 1e-3) {
    const double a = from + 0.382 * (to - from), b = from + 0.618 * (to - from);
    if (growth_here(std::exp(a)) > growth_here(std::exp(b)))
      to = b;
    else
      from = a;
  }
  best.wavenumber_per_m = std::exp(0.5 * (from + to));
  best.growth_per_s = growth_here(best.wavenumber_per_m);
  return best;
}

std::string statement_of(const WellPosedness& w, bool pressure_changes) {
  const bool drops = w.weakening_over_radiation > 1;
  if (w.unbounded)
    return fmt::format("ill-posed: shorter waves grow faster without bound ({}); the mesh decides",
                       drops              ? "weakening beyond radiation damping"
                       : pressure_changes ? "friction coupled to pressure"
                                          : "weakening with the slip rate feeds interface waves");
  if (w.fastest_growth_per_s == 0) return "well-posed: no wave grows on a half-space";
  if (w.growth_in_crossing > 1)
    return fmt::format(
        "bounded, not resolved: {} grow e-fold in {:.2g} s, while waves cross an element in {:.2g} s; the "
        "mesh decides",
        drops ? "waves of all lengths" : "the fastest waves", 1 / w.fastest_growth_per_s,
        w.growth_in_crossing / w.fastest_growth_per_s);
  if (w.fastest_wavelength_m == 0)
    return "bounded: growth still rises at ever shorter waves; the mesh decides which of them is seen";
  if (w.fastest_wavelength_m < w.grid_wavelength_m)
    return fmt::format("bounded, not resolved: waves of {:.3g} m grow fastest, the mesh carries {:.3g} m",
                       w.fastest_wavelength_m, w.grid_wavelength_m);
  if (w.fastest_wavelength_m > 0.999 * w.longest_wavelength_m)
    return "well-posed: growth is bounded and fastest at the longest waves";
  return fmt::format("well-posed: growth is bounded and fastest at {:.3g} m, {:.3g} elements",
                     w.fastest_wavelength_m, 2 * w.fastest_wavelength_m / w.grid_wavelength_m);
}

}  // namespace

double slower_c_L_m_per_s(const Bodies& bodies) {
  const double above = solid::longitudinal_speed_m_per_s(bodies.above);
  return bodies.below ? std::min(above, solid::longitudinal_speed_m_per_s(*bodies.below)) : above;
}

double damping_length_m(const Bodies& bodies) {
  const double above_s = bodies.above.stiffness_damping_s;
  return (bodies.below ? std::max(above_s, bodies.below->stiffness_damping_s) : above_s) *
         slower_c_L_m_per_s(bodies);
}

double radiation_damping_Pa_s_per_m(const Bodies& bodies) {
  const double below = bodies.below ? solid::shear_admittance_m_per_Pa_s(*bodies.below) : 0;
  return 1 / (solid::shear_admittance_m_per_Pa_s(bodies.above) + below);
}

bool growth_is_unbounded(const Bodies& bodies, const Sliding& sliding) {
  const auto damped = [](const solid::Material& m) { return m.stiffness_damping_s > 0; };
  // To short waves a damped body is rigid beside an undamped one.
  if (bodies.below && damped(bodies.above) != damped(*bodies.below))
    return growth_is_unbounded(damped(bodies.above) ? *bodies.below : bodies.above, sliding);
  // Waves with |s| far above the relaxation rate feel nothing of what is delayed.
  Sliding limit = sliding;
  limit.relaxed = Relaxed::none;
  limit.slip_slope_per_m = 0;
  if (sliding.relaxed != Relaxed::none) limit.mu = 0;
  if (sliding.relaxed == Relaxed::strength) limit.slope_s_per_m = 0;
  if (!damped(bodies.above)) return !growing_modes(bodies, limit, 1).empty();
  // Viscous stresses outgrow the slope and the elastic ones: with moduli beta_R E in place of E, the relation
  // without damping gives the square root of s.
  limit.slope_s_per_m = 0;
  const auto viscous = [](solid::Material m) {
    m.youngs_modulus_Pa *= m.stiffness_damping_s;
    m.stiffness_damping_s = 0;
    return m;
  };
  Bodies limits = viscous(bodies.above);
  if (bodies.below) limits.below = viscous(*bodies.below);
  return std::ranges::any_of(growing_modes(limits, limit, 1),
                             [](const Mode& mode) { return (mode.s_per_s * mode.s_per_s).real() > 0; });
}

namespace {

/// Under a law with a state, without inertia: of V/d_c the growth S solves a S^2 + (a - b + K) S + K = 0, K =
/// mu* k d_c/(2 p), and is fastest at the longest waves (Rice and Ruina 1983).
WellPosedness well_posedness_of_state(const Bodies& bodies, WellPosedness w) {
  const auto& s = w.sliding;
  const double V_over_d_c = s.state_rate_per_s;
  const double a = s.slope_s_per_m, weakening = -s.state_slope_s_per_m - a;
  const double K = 0.5 * modulus_Pa(bodies) * 2 * std::numbers::pi / w.longest_wavelength_m /
                   (s.pressure_Pa * s.state_rate_per_s);
  const double half = 0.5 * (weakening - K) / a, below = half * half - K / a;
  w.fastest_growth_per_s = half > 0 ? V_over_d_c * (below > 0 ? half + std::sqrt(below) : half) : 0;
  w.fastest_wavelength_m = half > 0 ? w.longest_wavelength_m : 0;
  w.statement = weakening <= 0 ? "well-posed: friction strengthens with the slip rate"
                : half <= 0
                    ? "well-posed: waves as long as the interface decay before the event, without inertia"
                    : fmt::format(
                          "well-posed: long waves grow, e-fold in {:.3g} s at the slip rate before the "
                          "event; the direct effect damps short ones",
                          1 / w.fastest_growth_per_s);
  return w;
}

/// Adds the growth under a law without a state. @throws Inseparable
void add_growth(const Bodies& bodies, double element_size_m, WellPosedness& w) {
  constexpr double pi = std::numbers::pi;
  w.growth_at_grid_per_s = growth_at(bodies, w.sliding, pi / element_size_m);
  w.unbounded = growth_is_unbounded(bodies, w.sliding);
  if (w.unbounded) {
    w.fastest_growth_per_s = infinity;
  } else {
    // Four decades beyond the mesh: there damping or delay has long decided.
    const auto peak =
        fastest_between(bodies, w.sliding, 2 * pi / w.longest_wavelength_m, 1e4 * pi / element_size_m);
    w.fastest_growth_per_s = peak.growth_per_s;
    if (peak.growth_per_s > 0 && !peak.at_short_end) w.fastest_wavelength_m = 2 * pi / peak.wavenumber_per_m;
  }
}

}  // namespace

WellPosedness well_posedness(const Bodies& bodies, const interface::FrictionLaw& law, double pressure_Pa,
                             double element_size_m, double longest_wavelength_m,
                             const interface::Regularisation& regularisation) {
  const auto& other = bodies.below ? *bodies.below : bodies.above;
  const double fastest_speed_m_per_s =
      std::max(solid::longitudinal_speed_m_per_s(bodies.above), solid::longitudinal_speed_m_per_s(other));
  WellPosedness w;
  w.sliding = uniform_sliding(law, 0, pressure_Pa, regularisation);
  w.grid_wavelength_m = 2 * element_size_m;
  w.longest_wavelength_m = std::max(longest_wavelength_m, w.grid_wavelength_m);
  w.damping_length_m = damping_length_m(bodies);
  w.damping_length_over_h = w.damping_length_m / element_size_m;
  w.weakening_over_radiation =
      0 - w.sliding.slope_s_per_m * pressure_Pa / radiation_damping_Pa_s_per_m(bodies);
  if (w.sliding.state_rate_per_s > 0) return well_posedness_of_state(bodies, w);
  try {
    add_growth(bodies, element_size_m, w);
  } catch (const Inseparable& why) {
    w.growth_at_grid_per_s = w.fastest_growth_per_s = nan;
    w.statement = fmt::format("no verdict: {}", why.what());
    return w;
  }
  w.growth_in_crossing = w.fastest_growth_per_s * element_size_m / fastest_speed_m_per_s;
  w.statement = statement_of(w, !are_alike(bodies));
  return w;
}

double damping_of_grid_waves_s(const Bodies& bodies, const interface::FrictionLaw& law,
                               const interface::Regularisation& regularisation, double element_size_m) {
  if (are_alike(bodies) || regularisation.relaxed != Relaxed::none) return 0;
  const bool weakens_with_rate = uniform_sliding(law, 0, 1).slope_s_per_m < 0;
  double c_S = solid::shear_speed_m_per_s(bodies.above);
  if (bodies.below) c_S = std::min(c_S, solid::shear_speed_m_per_s(*bodies.below));
  return (weakens_with_rate ? 0.35 : 0.1) * element_size_m / c_S;
}

}  // namespace slipfront::stability
