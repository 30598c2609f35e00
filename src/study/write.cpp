// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/version.hpp"
#include "files/files.hpp"
#include "run/run.hpp"
#include "study/convergence.hpp"

namespace slipfront::study {

namespace {

using nlohmann::ordered_json;

/// Empty where undefined.
std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.10g}", value) : std::string();
}

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json entry(const Summary& s) {
  return {{"verdict", name(s.verdict)},
          {"median_relative_error", number(s.median_relative_error)},
          {"median_order", number(s.median_order)},
          {"growth", number(s.growth)},
          {"n_stations", s.n_stations},
          {"n_stations_of_case", s.n_wanted}};
}

std::string csv(const Convergence& result) {
  std::string text = "x_m,direction,parameter,value,v_tip_m_per_s,extrapolated_m_per_s,error_m_per_s,order\n";
  auto out = std::back_inserter(text);
  for (const auto& sequence : result.sequences)
    for (const auto& s : sequence.stations)
      for (std::size_t k = 0; k < s.v_tip_m_per_s.size(); ++k)
        fmt::format_to(out, "{},{},{},{},{},{},{},{}\n", cell(s.x_m), s.direction, sequence.plan.parameter,
                       cell(sequence.plan.members[k].value), cell(s.v_tip_m_per_s[k]), cell(s.limit.value),
                       cell(s.error_m_per_s[k]), cell(s.limit.order));
  return text;
}

}  // namespace

void write_convergence(const std::filesystem::path& dir, const input::Case& config,
                       const Convergence& result) {
  ordered_json sequences = ordered_json::array();
  for (const auto& s : result.sequences) {
    ordered_json values = ordered_json::array(), used = ordered_json::array();
    for (const auto& member : s.plan.members) values.push_back(member.value);
    for (const auto k : s.plan.last) used.push_back(s.plan.members[k].value);
    auto e = ordered_json{{"parameter", s.plan.parameter},
                          {"values", values},
                          {"case_value", s.plan.case_value},
                          {"extrapolated_from", used}};
    e.update(entry(s.both));
    e["relative_difference_at_limit"] = number(s.relative_difference_at_limit);
    e["direction_-1"] = entry(s.left);
    e["direction_+1"] = entry(s.right);
    sequences.push_back(std::move(e));
  }
  const ordered_json summary = {{"version", version_line()},
                                {"title", config.title},
                                {"tolerance", result.options.tolerance},
                                {"station_spacing_m", result.options.station_spacing_m},
                                {"l_star_m", result.l_star_m},
                                {"c_L_m_per_s", run::wave_speeds(config.material).c_L},
                                {"n_runs", result.counts.n_runs},
                                {"n_quiet", result.counts.n_quiet},
                                {"sequences", sequences},
                                {"warnings", result.warnings}};
  files::write_text(dir / "convergence.csv", csv(result));
  files::write_text(dir / "convergence.json", summary.dump(2) + "\n");
}

}  // namespace slipfront::study
