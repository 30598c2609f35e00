// SPDX-License-Identifier: BSD-3-Clause
#include "input/pressure.hpp"

#include <cstddef>

namespace slipfront::input {

double nominal_pressure_Pa(const Case& config) {
  if (is_prestressed(config)) {
    const auto& [x_m, t_Pa, p_Pa] = config.prestress.table.rows;
    if (x_m.empty()) return config.prestress.p_Pa;
    double force_N_per_m = 0;
    for (std::size_t k = 1; k < x_m.size(); ++k)
      force_N_per_m += 0.5 * (p_Pa[k - 1] + p_Pa[k]) * (x_m[k] - x_m[k - 1]);
    return x_m.size() == 1 ? p_Pa.front() : force_N_per_m / (x_m.back() - x_m.front());
  }
  const double width_m = config.plate.width_m;
  if (const auto force = statics::normal_force_N_per_m(config.loading, width_m)) return *force / width_m;
  const double compression_m = 0.5 * (config.loading.tilt_left_m + config.loading.tilt_right_m);
  const auto per_compression = [](const solid::Material& material, double height_m) {
    return solid::uniaxial_modulus_Pa(material) / height_m;
  };
  double stiffness = per_compression(config.material, config.plate.height_m);
  if (has_base_body(config)) {
    const double of_base = per_compression(base_material(config), config.base.plate.height_m);
    stiffness *= of_base / (stiffness + of_base);
  }
  return compression_m * stiffness;
}

}  // namespace slipfront::input
