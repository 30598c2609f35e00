// SPDX-License-Identifier: BSD-3-Clause
#include "run/warnings.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "run/choices.hpp"

namespace slipfront::run {
namespace {

/// A table that reaches beyond the plate may have its positions in another unit; empty where it does not.
std::string table_warning(const char* key, const std::vector<double>& x_m, double width_m) {
  const double tolerance_m = 1e-6 * width_m;
  const auto is_beyond = [&](double x) { return x < -tolerance_m || x > width_m + tolerance_m; };
  const auto n_beyond = std::ranges::count_if(x_m, is_beyond);
  if (n_beyond == 0) return {};
  return fmt::format(
      "the table of {} reaches from x = {:.6g} to {:.6g} m, the plate from 0 to {:.6g} m: {} of "
      "its {} rows lie beyond it; are its positions in m?",
      key, x_m.front(), x_m.back(), width_m, n_beyond, x_m.size());
}

constexpr double most_strain = 0.03;  ///< of linear elasticity

}  // namespace

std::vector<std::string> warnings_of_case(const input::Case& config) {
  std::vector<std::string> warnings;
  const auto add_table_warning = [&](const char* key, const std::vector<double>& x_m) {
    if (auto warning = table_warning(key, x_m, config.plate.width_m); !warning.empty())
      warnings.push_back(std::move(warning));
  };
  add_table_warning("prestress.file", config.prestress.table.rows.x_m);
  add_table_warning("friction.file", config.friction_along_x.table.x_m);
  const auto& along_x = config.friction_along_x;
  if (along_x.random_key != "none" && along_x.random_correlation_length_m < config.plate.element_size_m)
    warnings.push_back(
        fmt::format("friction.random_correlation_length_m = {:.4g} m is below the element size: the mesh "
                    "does not resolve "
                    "the field",
                    along_x.random_correlation_length_m));
  if (!is_prestressed(config)) {
    const double strain = nominal_pressure_Pa(config) / config.material.youngs_modulus_Pa;
    if (strain > most_strain)
      warnings.push_back(
          fmt::format("the tilt presses the plate by {:.3g} of Young's modulus, beyond small strains: are "
                      "loading.tilt_left_m and loading.tilt_right_m in m?",
                      strain));
  }
  if (config.fronts.l_star_m < 0.99 * config.plate.element_size_m)
    warnings.push_back(fmt::format(
        "fronts.l_star_m = {:.4g} m is below the element size: one element is used", config.fronts.l_star_m));
  if (config.time.step_factor > 1)
    warnings.emplace_back("the step is above the largest stable one (time.allow_unstable)");
  return warnings;
}

}  // namespace slipfront::run
