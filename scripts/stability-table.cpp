// SPDX-License-Identifier: BSD-3-Clause
// Prints the table that scripts/stability-figure.py draws: the fastest growth against k, in units of c_S and
// the layer's height.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "stability/modes.hpp"

using namespace slipfront;

int main() {
  const double height_m = 0.1;
  const solid::Material standard;
  const double rate_per_s = solid::shear_speed_m_per_s(standard) / height_m;
  // A slope of 1 s/m at this pressure is the radiation damping.
  const double pressure_Pa = solid::shear_modulus_Pa(standard) / solid::shear_speed_m_per_s(standard);
  const struct {
    const char* label;
    double mu, slope, damping_s, rate_per_s;
    interface::Relaxed relaxed;
  } laws[] = {{"mu = 1.3", 1.3, 0, 0, 0, interface::Relaxed::none},
              {"mu = 1.3, damped", 1.3, 0, 1e-7, 0, interface::Relaxed::none},
              {"mu = 1.3, strength delayed 2 us", 1.3, 0, 0, 5e5, interface::Relaxed::strength},
              {"mu = 1.3, pressure delayed 2 us", 1.3, 0, 0, 5e5, interface::Relaxed::pressure},
              {"mu = 0.6, weakening m = 2", 0.6, -2, 0, 0, interface::Relaxed::none},
              {"mu = 0.6, m = 2, strength delayed 2 us", 0.6, -2, 0, 5e5, interface::Relaxed::strength},
              {"mu = 0.6, m = 2, damped", 0.6, -2, 1e-7, 0, interface::Relaxed::none}};
  fmt::print("body,law,kH,growth_H_over_c_S,velocity_over_c_S\n");
  for (const auto& law : laws) {
    solid::Material material;
    material.stiffness_damping_s = law.damping_s;
    const stability::Sliding sliding{law.mu, law.slope, 0, pressure_Pa, law.rate_per_s, law.relaxed};
    const auto row = [&](const char* body, double kH, const stability::Mode& mode) {
      fmt::print("{},\"{}\",{:.6g},{:.6g},{:.6g}\n", body, law.label, kH, mode.growth_per_s() / rate_per_s,
                 mode.velocity_m_per_s(kH / height_m) / (rate_per_s * height_m));
    };
    for (double kH = 0.3; kH < 3e4; kH *= 1.1)
      if (const auto mode = stability::fastest_growing_mode(material, sliding, kH / height_m))
        row("half-space", kH, *mode);
    // Growth near (m^2 - 1)/beta_R is far above any rate the layer's modes can be sought to.
    if (law.slope != 0 && law.damping_s > 0) continue;
    for (double kH = 0.3; kH < 60; kH *= 1.05) {
      const auto modes = stability::growing_layer_modes(material, sliding, kH / height_m, height_m,
                                                        rate_per_s * std::max(4 * kH, 80.0));
      if (!modes.empty()) row("layer", kH, modes.front());
    }
  }
}
