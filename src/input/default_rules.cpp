// SPDX-License-Identifier: BSD-3-Clause
#include "input/default_rules.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "input/entries.hpp"
#include "solid/material.hpp"

namespace slipfront::input {
namespace {

/// What a default is a multiple of.
struct Scale {
  std::string name;
  std::function<double(const Case&)> of;
};

/// The multiple is the member's default over the scale of the default case, which itself has that default.
DefaultRule multiple_of(const Scale& scale, const std::string& key) {
  const Case by_default;
  const double value = std::get<double>(entry_of(key).get(by_default));
  const double default_scale = scale.of(by_default);
  return {key, fmt::format("{:.4g} {}", value / default_scale, scale.name), [=](const Case& config) -> Value {
            const double of_case = scale.of(config);
            return of_case == default_scale ? value : value * of_case / default_scale;
          }};
}

/// Shear speed of the slower of two bodies, whose waves take longest.
double c_S_m_per_s(const Case& config) {
  const double of_plate = solid::shear_speed_m_per_s(config.material);
  if (!has_base_body(config)) return of_plate;
  return std::min(of_plate, solid::shear_speed_m_per_s(base_material(config)));
}

/// Prescribed tractions are all the load there is. In a sequence the edge hardly moves during an event.
DefaultRule shear_speed_rule() {
  constexpr double slower = 1e-3;
  const Scale c_L = {"c_L", [](const Case& c) { return solid::longitudinal_speed_m_per_s(c.material); }};
  auto rule = multiple_of(c_L, "loading.shear_speed_m_per_s");
  rule.text += "; `0` with loading.method = prestress; a thousandth of it in a sequence";
  rule.value = [share = rule.value](const Case& c) -> Value {
    if (is_sequence(c)) return slower * std::get<double>(share(c));
    return is_prestressed(c) ? Value(0.0) : share(c);
  };
  return rule;
}

DefaultRule element_size_rule(const Scale& width) {
  auto rule = multiple_of(width, "plate.element_size_m");
  rule.text = "width_m / 300";
  return rule;
}

/// Between equal bodies damping only calms the shortest waves: it stays below 2 % of a process zone of three
/// elements, beyond which it would change speeds. Elsewhere waves of some elements could grow without it.
DefaultRule damping_rule() {
  constexpr double of_unlike = 0.1;
  const Scale crossing = {"element_size_m / c_L", [](const Case& c) {
                            return c.plate.element_size_m / solid::longitudinal_speed_m_per_s(c.material);
                          }};
  auto rule = multiple_of(crossing, "material.stiffness_damping_s");
  rule.text += " between equal bodies; else 0.1 element_size_m / c_S";
  rule.value = [share = rule.value](const Case& c) -> Value {
    const auto base = base_material(c);
    const bool are_alike = has_base_body(c) && base.youngs_modulus_Pa == c.material.youngs_modulus_Pa &&
                           base.poissons_ratio == c.material.poissons_ratio &&
                           base.density_kg_per_m3 == c.material.density_kg_per_m3;
    return are_alike ? share(c) : Value(of_unlike * c.plate.element_size_m / c_S_m_per_s(c));
  };
  return rule;
}

/// An event of a sequence has to come to rest.
DefaultRule end_rule(const Scale& crossing) {
  constexpr double longer = 10;
  auto rule = multiple_of(crossing, "time.end_s");
  rule.text += "; ten times that in a sequence";
  rule.value = [share = rule.value](const Case& c) -> Value {
    return (is_sequence(c) ? longer : 1) * std::get<double>(share(c));
  };
  return rule;
}

/// An element where that is longer: no speed is taken over less.
DefaultRule l_star_rule(const Scale& width) {
  auto rule = multiple_of(width, "fronts.l_star_m");
  rule.text += ", or element_size_m where that is larger";
  rule.value = [share = rule.value](const Case& c) -> Value {
    return std::max(std::get<double>(share(c)), c.plate.element_size_m);
  };
  return rule;
}

/// Longest period of shear waves that stand between the interface and the edge that is held, or of the
/// machine's mass on the block while that sticks.
double longest_period_s(const Case& config) {
  constexpr double quarter_waves = 4;
  double height_m = config.plate.height_m;
  const double stiffness_Pa_per_m = solid::shear_modulus_Pa(config.material) / height_m;
  const double swing_s = 2 * std::numbers::pi * std::sqrt(config.machine.mass_kg_per_m2 / stiffness_Pa_per_m);
  if (has_base_body(config)) height_m = std::max(height_m, config.base.plate.height_m);
  return std::max(quarter_waves * height_m / c_S_m_per_s(config), swing_s);
}

/// Under a law that never sticks slip may speed up for long before a front begins, and where friction rises
/// with the slip rate it may go on slowly. In a sequence slip could come back as long as waves come back that
/// have not met the interface in all their phases.
DefaultRule quiet_time_rule(const Scale& crossing) {
  auto rule = multiple_of(crossing, "time.quiet_s");
  rule.text +=
      "; `inf` under a friction law with a state or that rises with the slip rate; in a sequence "
      "4 height_m / c_S, with the higher body's height, or the longer period of the machine's mass on a "
      "block "
      "that sticks";
  rule.value = [share = rule.value](const Case& c) -> Value {
    if (is_sequence(c)) return longest_period_s(c);
    return c.friction.never_sticks() || strengthens(c.friction) ? Value(infinity) : share(c);
  };
  return rule;
}

/// The base's is the plate's.
DefaultRule same_as(const std::string& plates_key, const std::string& key) {
  return {key, fmt::format("that of `{}`", plates_key),
          [&of = entry_of(plates_key)](const Case& c) { return of.get(c); }};
}

/// The plate's upper edge is loaded where the base's lower one is held.
DefaultRule bottom_rule() {
  return {"base.bottom", "as `plate.top`, `held` where that is loaded", [](const Case& c) {
            Case with_bottom = c;
            with_bottom.base.plate.top = c.plate.top;
            return entry_of("base.bottom").get(with_bottom);
          }};
}

std::vector<DefaultRule> make_default_rules() {
  const Scale width = {"width_m", [](const Case& c) { return c.plate.width_m; }};
  const Scale height = {"height_m", [](const Case& c) { return c.plate.height_m; }};
  const Scale base_height = {"base.height_m", [](const Case& c) { return c.base.plate.height_m; }};
  const Scale crossing = {"width_m / c_S", [](const Case& c) { return c.plate.width_m / c_S_m_per_s(c); }};
  // A base is like the plate unless it is said otherwise: no default makes the two sides differ.
  std::vector<DefaultRule> rules;
  for (const auto& [of_plate, of_base] : {std::pair{"plate.height_m", "base.height_m"},
                                          {"plate.sides", "base.sides"},
                                          {"material.youngs_modulus_Pa", "base.youngs_modulus_Pa"},
                                          {"material.poissons_ratio", "base.poissons_ratio"},
                                          {"material.density_kg_per_m3", "base.density_kg_per_m3"}})
    rules.push_back(same_as(of_plate, of_base));
  rules.push_back(element_size_rule(width));
  rules.push_back(damping_rule());
  rules.push_back(shear_speed_rule());
  const auto add = [&](const Scale& scale, std::initializer_list<const char*> keys) {
    for (const char* key : keys) rules.push_back(multiple_of(scale, key));
  };
  add(width,
      {"plate.relief_length_m", "plate.relief_height_m", "plate.fillet_radius_m", "loading.edge_margin_m",
       "friction.random_correlation_length_m", "event.trigger_zone_m", "nucleation.x_m",
       "nucleation.half_length_m", "nucleation.taper_m", "fronts.min_length_m", "fronts.trigger_margin_m"});
  add(height, {"plate.fine_height_m", "plate.relief_depth_m"});
  add(base_height, {"base.fine_height_m"});
  add(crossing, {"event.trigger_ramp_s", "fronts.arrest_time_s", "output.history_interval_s",
                 "output.energy_interval_s"});
  rules.push_back(l_star_rule(width));
  rules.push_back(end_rule(crossing));
  rules.push_back(quiet_time_rule(crossing));
  rules.push_back(bottom_rule());
  rules.push_back(same_as("material.stiffness_damping_s", "base.stiffness_damping_s"));
  return rules;
}

}  // namespace

const std::vector<DefaultRule>& default_rules() {
  static const std::vector<DefaultRule> rules = make_default_rules();
  return rules;
}

const DefaultRule* default_rule_of(const std::string& key) {
  const auto found = std::ranges::find(default_rules(), key, &DefaultRule::key);
  return found == default_rules().end() ? nullptr : &*found;
}

void set_defaults_by_rule(const Document& document, Case& config) {
  for (const auto& rule : default_rules()) {
    const Entry& entry = entry_of(rule.key);
    if (applies(entry, config) && !document.find(rule.key)) entry.set(config, rule.value(config));
  }
  const auto& prestress = config.prestress;
  if (prestress.t_Pa && !document.find("friction.V_i_m_per_s"))
    set_initial_slip_rate(config.friction, *prestress.t_Pa, prestress.p_Pa);
}

}  // namespace slipfront::input
