// SPDX-License-Identifier: BSD-3-Clause
#include "study/interface_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "base/error.hpp"
#include "base/version.hpp"
#include "files/files.hpp"
#include "fronts/fit.hpp"
#include "input/schema.hpp"
#include "study/sequence.hpp"

namespace slipfront::study {

namespace {

constexpr std::array reference_divisors = {16, 32, 64};
constexpr std::array plain_divisors = {1, 2, 4, 8};

void set_errors(Stepping& s, const std::vector<double>& limit_m_per_s) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < limit_m_per_s.size(); ++k) {
    const double error = std::abs(s.v_tip_m_per_s[k] / limit_m_per_s[k] - 1);
    if (std::isfinite(error)) errors.push_back(error);
  }
  s.n_stations = static_cast<int>(errors.size());
  s.median_error = fronts::median(errors);
  std::ranges::sort(errors);
  // At least nine tenths of the stations are within it.
  s.p90_error = errors.empty() ? undefined : errors[(9 * errors.size() + 9) / 10 - 1];
}

const char* name(Stepping::Kind kind) {
  switch (kind) {
    case Stepping::Kind::plain:
      return "plain";
    case Stepping::Kind::layer:
      return "layer";
    case Stepping::Kind::extrapolated:
      return "extrapolated";
  }
  SLIPFRONT_ASSERT(false, "unknown kind of stepping");
  return "";
}

constexpr std::size_t first_compared = reference_divisors.size();  ///< of the cases, the plain ones first

/// All cases, those of the reference first, smallest step first; what is compared goes to result.all.
std::vector<input::Case> cases_of(const input::Case& base, InterfaceStep& result) {
  std::vector<input::Case> cases;
  const double factor = base.time.step_factor;
  const auto add = [&](double step_factor, int rows, int substeps) {
    auto& c = cases.emplace_back(base);
    c.time.step_factor = step_factor;
    c.time.interface_rows = rows;
    c.time.interface_substeps = substeps;
  };
  for (auto it = reference_divisors.rbegin(); it != reference_divisors.rend(); ++it) add(factor / *it, 1, 1);
  for (const int divisor : plain_divisors) {
    add(factor / divisor, 1, 1);
    result.all.push_back({.kind = Stepping::Kind::plain, .step_factor = factor / divisor});
  }
  const double height_rows = base.plate.height_m / base.plate.element_size_m;
  for (const int rows : result.options.rows)
    for (const int substeps : result.options.substeps) {
      if (rows >= height_rows) continue;
      add(factor, rows, substeps);
      result.all.push_back(
          {.kind = Stepping::Kind::layer, .step_factor = factor, .rows = rows, .substeps = substeps});
    }
  return cases;
}

/// Stations and the speeds there at the limit of small steps.
void find_limits(std::span<const Run> runs, InterfaceStep& result) {
  std::array<double, 3> q{}, f{};
  std::vector<double> orders;
  for (const auto& place : stations(runs[0].main, result.options.station_spacing_m)) {
    for (std::size_t k = 0; k < 3; ++k) {
      q[k] = 1.0 / reference_divisors[k];
      f[k] = speed_at(runs[2 - k].main, place);
    }
    const Limit limit = extrapolate(q, f);
    if (!std::isfinite(limit.value)) continue;
    result.stations.push_back(place);
    result.v_tip_m_per_s.push_back(limit.value);
    if (std::isfinite(limit.order)) orders.push_back(limit.order);
  }
  result.median_order = fronts::median(orders);
  if (result.stations.size() < static_cast<std::size_t>(fewest_stations))
    result.warnings.push_back(
        fmt::format("only {} stations have a speed with a limit at small steps", result.stations.size()));
}

void compare(std::span<const Run> compared, InterfaceStep& result) {
  for (std::size_t k = 0; k < compared.size(); ++k) {
    auto& s = result.all[k];
    // Runs end at different times: cost per simulated time.
    s.cost = compared[k].node_updates_per_s / compared.front().node_updates_per_s;
    s.time_s = compared[k].stepping_wall_s;
    for (const auto& place : result.stations) s.v_tip_m_per_s.push_back(speed_at(compared[k].main, place));
    set_errors(s, result.v_tip_m_per_s);
  }
}

/// Of each two layers of which one has twice the sub-steps.
void add_extrapolated(InterfaceStep& result) {
  const std::size_t n_run = result.all.size();
  for (std::size_t a = 0; a < n_run; ++a)
    for (std::size_t b = 0; b < n_run; ++b) {
      const auto &coarse = result.all[a], &fine = result.all[b];
      if (coarse.kind != Stepping::Kind::layer || fine.rows != coarse.rows ||
          fine.substeps != 2 * coarse.substeps)
        continue;
      Stepping s{.kind = Stepping::Kind::extrapolated,
                 .step_factor = coarse.step_factor,
                 .rows = coarse.rows,
                 .substeps = fine.substeps,
                 .cost = coarse.cost + fine.cost,
                 .time_s = coarse.time_s + fine.time_s};
      for (std::size_t k = 0; k < result.stations.size(); ++k)
        s.v_tip_m_per_s.push_back(2 * fine.v_tip_m_per_s[k] - coarse.v_tip_m_per_s[k]);
      set_errors(s, result.v_tip_m_per_s);
      result.all.push_back(std::move(s));
    }
}

}  // namespace

int cheapest(const InterfaceStep& result) {
  int chosen = -1;
  const auto within = [&](const Stepping& s) {
    return s.kind != Stepping::Kind::extrapolated && s.p90_error <= result.options.tolerance &&
           10 * static_cast<std::size_t>(s.n_stations) >= 9 * result.stations.size();
  };
  for (std::size_t k = 0; k < result.all.size(); ++k)
    if (within(result.all[k]) && (chosen < 0 || result.all[k].cost < result.all[chosen].cost))
      chosen = static_cast<int>(k);
  return chosen;
}

InterfaceStep study_interface_step(const input::Case& config, const InterfaceStepOptions& options,
                                   const StudyMonitor& monitor) {
  InterfaceStep result;
  result.options = options;
  const auto cases = cases_of(for_study(config), result);
  const auto runs = run_cases(cases, options.threads, monitor, options.kept);
  result.counts = counts_of(runs);
  find_limits(runs, result);
  compare(std::span(runs).subspan(first_compared), result);
  add_extrapolated(result);
  result.chosen = cheapest(result);
  for (std::size_t k = 0; k < cases.size(); ++k)
    if (!runs[k].blow_up.empty())
      result.warnings.push_back(fmt::format("step_factor {:.3g}, {} rows, {} sub-steps: {}",
                                            cases[k].time.step_factor, cases[k].time.interface_rows,
                                            cases[k].time.interface_substeps, runs[k].blow_up));
  return result;
}

void write_interface_step(const std::filesystem::path& dir, const input::Case& config,
                          const InterfaceStep& result) {
  using nlohmann::ordered_json;
  const auto number = [](double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json();
  };
  std::string csv =
      "kind,step_factor,interface_rows,interface_substeps,cost_over_plain,time_s,median_error,p90_error,"
      "n_stations\n";
  for (const auto& s : result.all)
    fmt::format_to(std::back_inserter(csv), "{},{:.10g},{},{},{:.6g},{:.4g},{:.6g},{:.6g},{}\n", name(s.kind),
                   s.step_factor, s.rows, s.substeps, s.cost, s.time_s, s.median_error, s.p90_error,
                   s.n_stations);
  files::write_text(dir / "interface_step.csv", csv);
  ordered_json summary = {{"version", version_line()},
                          {"title", config.title},
                          {"tolerance", result.options.tolerance},
                          {"station_spacing_m", result.options.station_spacing_m},
                          {"n_stations", result.stations.size()},
                          {"median_order_of_reference", number(result.median_order)},
                          {"n_runs", result.counts.n_runs},
                          {"n_quiet", result.counts.n_quiet},
                          {"warnings", result.warnings},
                          {"chosen", nullptr}};
  files::remove_file(dir / "chosen.toml");  // of an earlier study
  if (result.chosen >= 0) {
    const auto& s = result.all[result.chosen];
    summary["chosen"] = {{"step_factor", s.step_factor},
                         {"interface_rows", s.rows},
                         {"interface_substeps", s.substeps},
                         {"cost_over_plain", s.cost},
                         {"p90_error", s.p90_error}};
    input::Case chosen = config;
    chosen.time.step_factor = s.step_factor;
    chosen.time.interface_substeps = s.substeps;
    if (s.kind == Stepping::Kind::layer) chosen.time.interface_rows = s.rows;
    files::write_text(dir / "chosen.toml", input::to_toml(chosen));
  }
  files::write_text(dir / "interface_step.json", summary.dump(2) + "\n");
}

}  // namespace slipfront::study
