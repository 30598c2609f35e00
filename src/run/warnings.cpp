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

constexpr double max_strain = 0.03;  ///< of linear elasticity

using Warnings = std::vector<std::string>;

/// Numbers that may be in another unit than the key's.
void add_odd_units(const input::Case& config, Warnings& warnings) {
  const auto& m = config.material;
  const auto add = [&](const char* key, double value, const char* question) {
    warnings.push_back(fmt::format("{} = {:g}: {}", key, value, question));
  };
  if (m.youngs_modulus_Pa < 1e4 || m.youngs_modulus_Pa > 2e12)
    add("material.youngs_modulus_Pa", m.youngs_modulus_Pa, "no solid has this stiffness; is it in Pa?");
  if (m.density_kg_per_m3 < 10 || m.density_kg_per_m3 > 3e4)
    add("material.density_kg_per_m3", m.density_kg_per_m3, "no solid has this density; is it in kg/m3?");
  for (const auto& parameter : description_of(config.friction).parameters) {
    const std::string key = std::string("friction.") + parameter.key;
    const double value = config.friction.parameter(parameter.key);
    if (key.starts_with("friction.mu") && value > 5)
      add(key.c_str(), value, "hardly any pair of solids has such friction; is it in per cent?");
    if (key == "friction.d_c_m" && value > 1e-3 * config.plate.width_m)
      add(key.c_str(), value, "more than a thousandth of plate.width_m; is it in m?");
  }
  if (is_prestressed(config) && config.prestress.file.empty() &&
      config.prestress.p_Pa > max_strain * m.youngs_modulus_Pa)
    add("prestress.p_Pa", config.prestress.p_Pa, "beyond small strains of the plate; is it in Pa?");
}

/// Lengths that do not suit the plate or its elements.
void add_lengths(const input::Case& config, Warnings& warnings) {
  constexpr double fewest_elements = 2;
  const double min_m = fewest_elements * config.plate.element_size_m;
  const auto add_short = [&](const char* key, double length_m) {
    if (length_m < (1 - 1e-9) * min_m)
      warnings.push_back(
          fmt::format("{} = {:.4g} m is less than two elements, {:.4g} m: the mesh does not "
                      "resolve it",
                      key, length_m, min_m));
  };
  if (interface::is_at_edge(config.event)) add_short("event.trigger_zone_m", config.trigger.zone_m);
  if (config.event == interface::EventKind::nucleation)
    add_short("2 nucleation.half_length_m + taper_m",
              2 * config.nucleation.half_length_m + config.nucleation.taper_m);
  const double zone_m = interface::is_at_edge(config.event) ? config.trigger.zone_m : 0;
  if (zone_m + config.fronts.trigger_margin_m > 0.5 * config.plate.width_m)
    warnings.push_back(
        fmt::format("fronts.trigger_margin_m = {:.4g} m leaves less than half of the interface "
                    "to t_d and p_d",
                    config.fronts.trigger_margin_m));
}

/// Times that do not suit the plate.
void add_times(const input::Case& config, Warnings& warnings) {
  // From a patch to the end of the interface that is farther off; where else an event begins only its run
  // tells.
  const double width_m = config.plate.width_m, x_m = config.nucleation.x_m;
  const double way_m =
      config.event == interface::EventKind::nucleation ? std::max(x_m, width_m - x_m) : width_m;
  const double arrival_s = way_m / solid::shear_speed_m_per_s(config.material);
  if (config.time.end_s < arrival_s)
    warnings.push_back(fmt::format(
        "time.end_s = {:.4g} s is before a shear wave {}, at {:.4g} s", config.time.end_s,
        way_m < width_m ? "from the patch has reached both ends of the interface" : "has crossed the plate",
        arrival_s));
  const bool ramps = interface::is_at_edge(config.event) || config.event == interface::EventKind::nucleation;
  if (ramps && config.trigger.ramp_s > config.time.end_s)
    warnings.push_back(fmt::format("event.trigger_ramp_s = {:.4g} s is longer than the event, {:.4g} s",
                                   config.trigger.ramp_s, config.time.end_s));
}

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
                    "does not resolve the field",
                    along_x.random_correlation_length_m));
  if (!is_prestressed(config)) {
    const double strain = nominal_pressure_Pa(config) / config.material.youngs_modulus_Pa;
    if (strain > max_strain)
      warnings.push_back(
          fmt::format("the tilt presses the plate by {:.3g} of Young's modulus, beyond small strains: are "
                      "loading.tilt_left_m and loading.tilt_right_m in m?",
                      strain));
  }
  if (config.fronts.l_star_m < 0.99 * config.plate.element_size_m)
    warnings.push_back(fmt::format(
        "fronts.l_star_m = {:.4g} m is below the element size: one element is used", config.fronts.l_star_m));
  add_odd_units(config, warnings);
  add_lengths(config, warnings);
  add_times(config, warnings);
  if (config.time.step_factor > 1)
    warnings.emplace_back("the step is above the largest stable one (time.allow_unstable)");
  return warnings;
}

}  // namespace slipfront::run
