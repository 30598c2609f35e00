// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "base/numbers.hpp"

namespace slipfront::interface {

/// How a nucleation patch starts the event.
enum class NucleationForm {
  weakened,    ///< its friction falls to mu_k for good: Interface::strength_fraction = 1 - B(x)
  forced,      ///< the same in time, from its centre at a speed, see Interface::is_time_weakening
  overstress,  ///< an external traction overstress_Pa B(x) along +x, times the trigger's ramp in time
  unloaded,    ///< the same of unloading_Pa, which parts the bodies
};

/// B(x) of a nucleation patch, r = |x - x_m|, R = half_length_m.
enum class NucleationProfile {
  tapered,  ///< 1 within R, from there to 0 as half a cosine wave over taper_m
  smooth,   ///< exp[r^2/(r^2 - R^2)] within R, 0 beyond: all derivatives are continuous (SCEC TPV101)
};

/// A patch of the interface that starts the event. A forced one reaches r at r/front_speed, and weakens there
/// linearly within weakening_time (Andrews 1985; SCEC TPV16).
struct Nucleation {
  NucleationForm form = NucleationForm::weakened;
  NucleationProfile profile = NucleationProfile::tapered;
  double x_m = 0.05;  ///< centre
  double half_length_m = 5e-3;
  double taper_m = 2.5e-3;
  double overstress_Pa = 1e6;
  double unloading_Pa = 1e6;
  double front_speed_m_per_s = 600;
  double weakening_time_s = 1e-6;

  /// From its centre to where B is 0.
  double reach_m() const {
    return profile == NucleationProfile::smooth ? half_length_m : half_length_m + taper_m;
  }
  /// Over which B is at least one half: that of a step with its strength.
  double length_m() const {
    const double at_half = std::sqrt(std::numbers::ln2 / (1 + std::numbers::ln2));
    return profile == NucleationProfile::smooth ? 2 * at_half * half_length_m : 2 * half_length_m + taper_m;
  }
};

/// r at x; the patch repeats with the plate where its period is not 0.
inline double from_centre_m(const Nucleation& n, double x_m, double period_m = 0) {
  const double along = x_m - n.x_m;
  return std::abs(period_m > 0 ? std::remainder(along, period_m) : along);
}

/// B at x.
inline double nucleation_profile(const Nucleation& n, double x_m, double period_m = 0) {
  const double r_m = from_centre_m(n, x_m, period_m), beyond = r_m - n.half_length_m;
  if (n.profile == NucleationProfile::smooth) {
    const double r2 = r_m * r_m, R2 = n.half_length_m * n.half_length_m;
    return beyond >= 0 ? 0 : std::exp(r2 / (r2 - R2));
  }
  if (beyond <= 0) return 1;
  if (beyond >= n.taper_m) return 0;
  return 0.5 * (1 + std::cos(std::numbers::pi * beyond / n.taper_m));
}

}  // namespace slipfront::interface
