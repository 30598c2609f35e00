// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

namespace slipfront::interface {

/// How a nucleation patch starts the event.
enum class NucleationForm {
  weakened,    ///< its friction falls to mu_k for good: Interface::intact = 1 - B(x)
  overstress,  ///< an external traction overstress_Pa B(x) along +x, times the trigger's ramp in time
};

/// A patch of the interface that starts the event. Its profile B(x) is 1 within half_length_m of x_m, falls
/// as half a cosine wave over taper_m and is 0 beyond.
struct Nucleation {
  NucleationForm form = NucleationForm::weakened;
  double x_m = 0.1;  ///< centre
  double half_length_m = 10e-3;
  double taper_m = 5e-3;
  double overstress_Pa = 1e6;
};

/// B at x; the patch repeats with the plate where its period is not 0.
inline double nucleation_profile(const Nucleation& n, double x_m, double period_m = 0) {
  const double along = x_m - n.x_m;
  const double beyond = std::abs(period_m > 0 ? std::remainder(along, period_m) : along) - n.half_length_m;
  if (beyond <= 0) return 1;
  if (beyond >= n.taper_m) return 0;
  return 0.5 * (1 + std::cos(std::numbers::pi * beyond / n.taper_m));
}

}  // namespace slipfront::interface
