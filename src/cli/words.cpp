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

namespace slipfront::cli {
namespace {

std::string body(const mesh::Plate& plate) {
  return fmt::format("{} x {}", engineering(plate.width_m, "m"), engineering(plate.height_m, "m"));
}

std::string material(const solid::Material& m) {
  return fmt::format("E = {}, nu = {:.4g}, rho = {:.4g} kg/m3", engineering(m.youngs_modulus_Pa, "Pa"),
                     m.poissons_ratio, m.density_kg_per_m3);
}

std::string bodies(const Problem& problem) {
  const auto& [plate, of_plate, machine] = problem.above();
  const auto plane = of_plate.plane == solid::Plane::stress ? "plane stress" : "plane strain";
  const auto above = fmt::format("{} of {}", body(plate), material(of_plate));
  if (!problem.has_below()) return fmt::format("{} on a rigid plane, {}", above, plane);
  const auto& base = problem.below();
  const auto of_base = material(base.material);
  const bool is_same = of_base == material(of_plate);
  if (is_same && base.plate.height_m == plate.height_m)
    return fmt::format("two bodies, each {}, {}", above, plane);
  return fmt::format("{} on {}{}, {}", above, body(base.plate), is_same ? " of the same" : " of " + of_base,
                     plane);
}

std::string law(const Problem& problem) {
  const auto& law = problem.friction.law;
  std::string text;
  const auto add = [&](const char* key, double value) {
    if (value == 0) return;
    const auto [name, unit] = input::parts_of(key);
    text += fmt::format("{} {} = {}", text.empty() ? ":" : ",", name,
                        unit.empty() ? fmt::format("{:.4g}", value) : engineering(value, unit.c_str()));
  };
  for (const auto& parameter : description_of(law).parameters)
    add(parameter.key, law.parameter(parameter.key));
  return fmt::format("{}{}{}", law.name(), text,
                     problem.friction.along_x.varies() ? ", varying along x" : "");
}

std::string trigger(const Problem& problem) {
  const auto& t = problem.start.trigger;
  const auto zone = engineering(t.zone_m, "m");
  switch (t.form) {
    case interface::TriggerForm::added:
      return fmt::format("shear added over {}, {:.4g} times what is missing to the strength", zone, t.amount);
    case interface::TriggerForm::raised:
      return fmt::format("shear raised over {}, to {:.4g} times the strength", zone, t.amount);
    case interface::TriggerForm::weakened:
      return fmt::format("weakened over {}", zone);
    case interface::TriggerForm::unloaded:
      return fmt::format("{:.4g} of the pressure taken away over {}", t.amount, zone);
  }
  return {};
}

std::string event(const Problem& problem) {
  using interface::EventKind;
  const auto& n = problem.start.nucleation;
  const std::string sequence =
      problem.is_sequence() ? fmt::format("up to {} events, ", problem.sequence.max_events) : "";
  switch (problem.start.kind) {
    case EventKind::none:
      return "no trigger";
    case EventKind::spontaneous:
      return sequence + "spontaneous";
    case EventKind::left:
      return "triggered at the left edge: " + trigger(problem);
    case EventKind::right:
      return "triggered at the right edge: " + trigger(problem);
    case EventKind::nucleation:
      return fmt::format("{} over {} around x = {}",
                         problem.start.overstresses()    ? "overstressed"
                         : problem.start.unloads_patch() ? "unloaded"
                                                         : problem.start.weakening_form(),
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

std::string set_up(const Problem& problem) {
  return fmt::format("{}; pressed by {}; {}; {}", bodies(problem),
                     engineering(nominal_pressure_Pa(problem), "Pa", 3), law(problem), event(problem));
}

std::string speed(double m_per_s, const solid::WaveSpeeds& speeds) {
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

std::string lines_of(const input::CaseFile& given, const Diagnostics& notes) {
  std::string lines;
  for (const auto& note : given.notes()) lines += fmt::format("note: {}\n", note);
  for (const auto& note : notes) lines += fmt::format("note: {}\n", note.text);
  return lines;
}

}  // namespace slipfront::cli
