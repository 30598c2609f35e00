// SPDX-License-Identifier: BSD-3-Clause
// Reflection from the absorbing edge over the angle of incidence, in theory and measured: CSV on stdout.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "motion/reflection.hpp"

using namespace slipfront;
using namespace slipfront::motion::test;

int main() {
  const solid::Material material{.stiffness_damping_s = 0};
  const double ratio = solid::longitudinal_speed_m_per_s(material) / solid::shear_speed_m_per_s(material);
  fmt::print("incident,source,angle_deg,longitudinal,shear,energy\n");
  for (const auto incident : {PlaneWave::longitudinal, PlaneWave::shear}) {
    const bool shear = incident == PlaneWave::shear;
    const auto row = [&](const char* source, double sine, double l, double s) {
      // Flux of energy along y, over that of the incident wave: amplitudes squared, c, and the cosine.
      const double sin_p = shear ? sine * ratio : sine, sin_s = shear ? sine : sine / ratio;
      const double flux_p = sin_p < 1 ? ratio * std::sqrt(1 - sin_p * sin_p) : 0;
      const double flux_s = std::sqrt(1 - sin_s * sin_s);
      const double energy = (l * l * flux_p + s * s * flux_s) / (shear ? flux_s : flux_p);
      fmt::print("{},{},{:.4f},{:.6f},{:.6f},{:.6f}\n", shear ? "shear" : "longitudinal", source,
                 std::asin(sine) * 180 / std::numbers::pi, l, s, energy);
    };
    for (int k = 0; k < 180; ++k) {
      const double sine = std::sin(0.5 * k * std::numbers::pi / 180);
      const auto [l, s] = theory(incident, sine, ratio);
      // A longitudinal wave beyond the critical angle clings to the edge: no reflection.
      row("theory", sine, shear && sine * ratio > 1 ? 0 : std::abs(l), std::abs(s));
    }
    for (const int columns : {0, 115, 77, 58, 47, 40, 35, 31, 28, 26, 24, 23, 22, 21}) {
      const auto m = measure(incident, columns, 20, material);
      row("measured", m.sine, m.longitudinal, m.shear);
    }
  }
}
