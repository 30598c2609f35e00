// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/tip.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/numbers.hpp"
#include "solid/material.hpp"

namespace slipfront::fracture {

namespace {

using std::numbers::pi;

Bodies undamped(Bodies bodies) {
  bodies.above.stiffness_damping_s = 0;
  if (bodies.below) bodies.below->stiffness_damping_s = 0;
  return bodies;
}

/// What speeds beyond a body's waves need to be those of waves that leave the interface.
constexpr double towards_growth = 1e-13;

double lowest_shear_speed_m_per_s(const Bodies& bodies) {
  const double above = solid::shear_speed_m_per_s(bodies.above);
  return bodies.below ? std::min(above, solid::shear_speed_m_per_s(*bodies.below)) : above;
}

/// Slownesses, s/m, at which the moving stiffness is not smooth: of waves and of those along the interface.
std::vector<double> slownesses(const Bodies& bodies) {
  std::vector<double> found = {1 / solid::longitudinal_speed_m_per_s(bodies.above),
                               1 / solid::shear_speed_m_per_s(bodies.above)};
  if (bodies.below) {
    found.push_back(1 / solid::longitudinal_speed_m_per_s(*bodies.below));
    found.push_back(1 / solid::shear_speed_m_per_s(*bodies.below));
  }
  found.push_back(1 / limiting_speed_m_per_s(bodies));
  std::ranges::sort(found);
  // A pole between the slowest shear wave and the end: Stoneley's wave.
  const auto is_negative = [&](double slowness) {
    return stability::compliance(bodies, 1, {0, -1 / slowness}).determinant.real() > 0;
  };
  double low = found[found.size() - 2], high = found.back();
  low += 1e-9 * (high - low);
  high -= 1e-9 * (high - low);
  if (high > low && is_negative(low) != is_negative(high)) {
    const bool first = is_negative(low);
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (is_negative(middle) == first ? low : high) = middle;
    }
    found.insert(found.end() - 1, low);
  }
  return found;
}

}  // namespace

Complex moving_stiffness_Pa(const Bodies& bodies, double speed_m_per_s, double mu, Direction direction) {
  const auto c = stability::compliance(
      undamped(bodies), 1,
      {towards_growth * speed_m_per_s, speed_m_per_s * (direction == Direction::with_slip ? -1 : 1)});
  // u_y = 0: p = -(xy/yy) t.
  const double G = solid::shear_modulus_Pa(bodies.above);
  return -G * (c.yy + mu * c.xy) / c.determinant;
}

double stiffness_Pa(const Bodies& bodies, double speed_m_per_s) {
  if (speed_m_per_s >= lowest_shear_speed_m_per_s(bodies)) return nan;
  return moving_stiffness_Pa(bodies, speed_m_per_s).real();
}

double energy_factor(const Bodies& bodies, double speed_m_per_s) {
  return stiffness_Pa(bodies, 0) / stiffness_Pa(bodies, speed_m_per_s);
}

double energy_release_rate_J_per_m2(const Bodies& bodies, double speed_m_per_s, double K_Pa_sqrt_m) {
  return K_Pa_sqrt_m * K_Pa_sqrt_m / (4 * stiffness_Pa(bodies, speed_m_per_s));
}

double stress_intensity_Pa_sqrt_m(const Bodies& bodies, double speed_m_per_s, double G_J_per_m2) {
  return std::sqrt(4 * stiffness_Pa(bodies, speed_m_per_s) * G_J_per_m2);
}

double slip_squared_per_G_and_distance(const Bodies& bodies, double speed_m_per_s) {
  return 8 / (pi * stiffness_Pa(bodies, speed_m_per_s));
}

double slip_exponent(const Bodies& bodies, double speed_m_per_s, double mu, Direction direction) {
  const double angle = std::arg(moving_stiffness_Pa(bodies, speed_m_per_s, mu, direction));
  return 0.5 - (direction == Direction::with_slip ? angle : -angle) / pi;
}

double limiting_speed_m_per_s(const Bodies& bodies) {
  const double c_S = lowest_shear_speed_m_per_s(bodies);
  if (!bodies.below) return c_S;
  if (stability::are_alike(bodies)) return solid::rayleigh_speed_m_per_s(bodies.above);
  return stability::generalised_rayleigh_speed_m_per_s(bodies.above, *bodies.below).value_or(c_S);
}

double speed_factor(const Bodies& given, double speed_m_per_s) {
  const auto bodies = undamped(given);
  const auto at = slownesses(bodies);
  const double last = at.back(), d = 1 / speed_m_per_s;
  if (!(d > last)) return 0;
  // The kernel over sqrt(last^2 - slowness^2) has factors without zeros and poles; their logarithms are
  // Cauchy integrals of its argument where it is not real.
  double integral = 0;
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    const double middle = 0.5 * (at[k] + at[k + 1]), half = 0.5 * (at[k + 1] - at[k]);
    const auto at_angle = [&](double angle) {  // by which square roots at both ends become smooth
      const double slowness = middle + half * std::sin(angle);
      // Real below the first slowness, where the stiffness is that of waves that leave, -i times a number.
      const double argument = std::arg(Complex(0, 1) * moving_stiffness_Pa(bodies, 1 / slowness));
      return half * std::cos(angle) * argument / (d - slowness);
    };
    integral += boost::math::quadrature::gauss<double, 40>::integrate(at_angle, -0.5 * pi, 0.5 * pi);
  }
  const double k_II = std::sqrt(1 - last / d) * std::exp(integral / pi);
  return energy_factor(bodies, speed_m_per_s) * k_II * k_II;
}

}  // namespace slipfront::fracture
