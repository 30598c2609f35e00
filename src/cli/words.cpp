// SPDX-License-Identifier: BSD-3-Clause
#include "cli/words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "fronts/fit.hpp"
#include "input/entries.hpp"
#include "run/choices.hpp"

namespace slipfront::cli {
namespace {

std::string body(const mesh::Plate& plate) {
  return fmt::format("{} x {}", engineering(plate.width_m, "m"), engineering(plate.height_m, "m"));
}

std::string material(const solid::Material& m) {
  return fmt::format("E = {}, nu = {:.4g}, rho = {:.4g} kg/m3", engineering(m.youngs_modulus_Pa, "Pa"),
                     m.poissons_ratio, m.density_kg_per_m3);
}

std::string bodies(const input::Case& config) {
  const auto plane = config.material.plane == solid::Plane::stress ? "plane stress" : "plane strain";
  const auto above = fmt::format("{} of {}", body(config.plate), material(config.material));
  if (!input::has_base_body(config)) return fmt::format("{} on a rigid plane, {}", above, plane);
  const auto base = input::base_plate(config);
  const auto of_base = material(input::base_material(config));
  const bool is_same = of_base == material(config.material);
  if (is_same && base.height_m == config.plate.height_m)
    return fmt::format("two bodies, each {}, {}", above, plane);
  return fmt::format("{} on {}{}, {}", above, body(base), is_same ? " of the same" : " of " + of_base, plane);
}

std::string law(const input::Case& config) {
  std::string text;
  for (const auto& entry : input::law_of(config).entries) {
    if (entry.kind != input::Kind::number) continue;
    const double value = std::get<double>(entry.get(config));
    if (value == 0) continue;
    const auto [name, unit] = input::parts_of(entry.key);
    text += fmt::format("{} {} = {}", text.empty() ? ":" : ",", name,
                        unit.empty() ? fmt::format("{:.4g}", value) : engineering(value, unit.c_str()));
  }
  const auto& along_x = config.friction_along_x;
  return fmt::format("{}{}{}", config.friction.name(), text, along_x.varies() ? ", varying along x" : "");
}

std::string trigger(const input::Case& config) {
  const auto& t = config.trigger;
  const auto zone = engineering(t.zone_m, "m");
  switch (t.form) {
    case interface::TriggerForm::added:
      return fmt::format("shear added over {}, {:.4g} times what is missing to the strength", zone, t.amount);
    case interface::TriggerForm::raised:
      return fmt::format("shear raised over {}, to {:.4g} times the strength", zone, t.amount);
    case interface::TriggerForm::weakened:
      return fmt::format("weakened over {}", zone);
  }
  return {};
}

std::string event(const input::Case& config) {
  using interface::EventKind;
  const auto& n = config.nucleation;
  const std::string sequence =
      input::is_sequence(config) ? fmt::format("up to {} events, ", config.sequence.max_events) : "";
  switch (config.event) {
    case EventKind::none:
      return "no trigger";
    case EventKind::spontaneous:
      return sequence + "spontaneous";
    case EventKind::left:
      return "triggered at the left edge: " + trigger(config);
    case EventKind::right:
      return "triggered at the right edge: " + trigger(config);
    case EventKind::nucleation:
      return fmt::format("{} over {} around x = {}",
                         input::is_overstressed(config) ? "overstressed" : input::weakening_form(config),
                         engineering(n.length_m(), "m"), engineering(n.x_m, "m"));
  }
  return {};
}

/// Where a front ends, behind its last place.
const char* at_end(fronts::End end) {
  switch (end) {
    case fronts::End::arrest:
      return "where it arrested";
    case fronts::End::meets_front:
      return "where it met another front";
    case fronts::End::contact_end:
      return "the end of the contact";
    case fronts::End::record_edge:
      return "the edge of the record";
    case fronts::End::record_end:
      return "still running at the end";
  }
  return "";
}

double length_m(const fronts::Front& front) {
  return std::abs(front.points.back().x_m - front.points.front().x_m);
}

}  // namespace

std::string engineering(double value, const char* unit, int digits) {
  const std::string_view of = unit;
  const bool has_large = of == "Pa" || of == "Pa/m" || of == "N/m";
  const bool has_small = of == "m" || of == "s" || of == "m/s";
  static constexpr std::array<const char*, 7> prefixes = {"n", "u", "m", "", "k", "M", "G"};
  // The number as it is shown: 999.96 is 1000.
  const double shown = std::stod(fmt::format("{:.{}e}", value, digits - 1));
  const int thousands =
      value == 0 || !std::isfinite(value) ? 0 : static_cast<int>(std::floor(std::log10(std::abs(shown)) / 3));
  const int taken = std::clamp(thousands, has_small ? -3 : 0, has_large ? 3 : 0);
  return fmt::format("{:.6g} {}{}", shown / std::pow(10, 3 * taken),
                     prefixes[static_cast<std::size_t>(taken + 3)], unit);
}

std::string set_up(const input::Case& config) {
  return fmt::format("{}; {}; {}", bodies(config), law(config), event(config));
}

std::string speed(double m_per_s, const run::WaveSpeeds& speeds) {
  return fmt::format("{} ({:.2f} c_L, {:.2f} c_S)", engineering(m_per_s, "m/s"), m_per_s / speeds.c_L,
                     m_per_s / speeds.c_S);
}

double median_speed_m_per_s(const fronts::Front& front) {
  std::vector<double> v_m_per_s;
  for (const auto& point : front.points) v_m_per_s.push_back(point.v_tip_m_per_s);
  return fronts::median(v_m_per_s);
}

bool is_of_trigger(const fronts::Front& front) {
  return std::ranges::all_of(
      front.points, [](const auto& point) { return point.speed_kind == fronts::SpeedKind::triggered; });
}

double fracture_energy_J_per_m2(const run::Result& result, const fronts::Front& front) {
  const auto& breakdown = result.event.breakdown;
  std::vector<double> work;
  for (const auto& point : front.points) {
    const auto node = static_cast<std::size_t>(point.node);
    if (breakdown.complete[node] != 0) work.push_back(breakdown.work_J_per_m2[node]);
  }
  return fronts::median(work);
}

std::string outcome(const run::Result& result) {
  const fronts::Front* longest = nullptr;
  for (const auto& front : result.fronts)
    if (!is_of_trigger(front) && (longest == nullptr || length_m(front) > length_m(*longest)))
      longest = &front;
  if (longest == nullptr)
    return result.fronts.empty() ? "no front" : "no front left the trigger: slip stopped within it";
  const auto& points = longest->points;
  auto text = fmt::format("a {} ran from x = {} to {}, {}",
                          longest->mode == fronts::SlipMode::mixed ? "front" : fronts::name(longest->mode),
                          engineering(points.front().x_m, "m"), engineering(points.back().x_m, "m"),
                          at_end(longest->end));
  if (const double median = median_speed_m_per_s(*longest); std::isfinite(median))
    text += fmt::format(", at {} in the median", speed(median, result.speeds));
  if (const double gamma = fracture_energy_J_per_m2(result, *longest); gamma > 0)
    text += fmt::format(", Gamma = {:.3g} J/m2", gamma);
  return text;
}

std::string outcome(const std::vector<record::SequenceEvent>& events) {
  if (events.empty()) return "no event";
  const auto n_global = std::ranges::count_if(events, [](const auto& e) { return e.is_global != 0; });
  const auto [least, most] = std::ranges::minmax_element(events, {}, &record::SequenceEvent::mean_slip_m);
  const auto from = engineering(least->mean_slip_m, "m", 3), to = engineering(most->mean_slip_m, "m", 3);
  return fmt::format("{} event{}, {} global, mean slip {}", events.size(), events.size() == 1 ? "" : "s",
                     n_global == 0 ? "none" : fmt::format("{}", n_global),
                     from == to ? from : from + " to " + to);
}

}  // namespace slipfront::cli
