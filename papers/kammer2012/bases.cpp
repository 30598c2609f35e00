// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/bases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "base/version.hpp"
#include "files/files.hpp"
#include "fronts/fit.hpp"
#include "fronts/measures.hpp"
#include "papers/kammer2012/main_fronts.hpp"
#include "papers/kammer2012/undefined.hpp"
#include "run/batch.hpp"

namespace slipfront::kammer2012 {

namespace {

using Json = nlohmann::ordered_json;

/// The compliance of plate and base in uniform compression, over that of the plate.
double tilt_factor(const input::Case& config) {
  if (!input::has_base_body(config)) return 1;
  const double plate = config.plate.height_m / config.material.youngs_modulus_Pa;
  return 1 + config.base.plate.height_m / config.base.material.youngs_modulus_Pa / plate;
}

std::vector<MainFront> main_fronts_of(std::span<const Outcome> events, bool low_mu_k_only) {
  std::vector<const Outcome*> list;
  for (const auto& o : events)
    if (!low_mu_k_only || interface::kinetic_coefficient(o.config.friction) < 0.9) list.push_back(&o);
  // Main fronts refer to outcomes that outlive this call.
  return main_fronts(list);
}

fronts::Ratio speed_ratio(std::span<const Outcome> events) {
  fronts::Series along, against;
  for (const auto& m : main_fronts_of(events, true))
    for (const auto& p : m.points) {
      auto& series = m.front->direction > 0 ? along : against;
      series.x.push_back(p.t_d_Pa / p.p_d_Pa);
      series.y.push_back(p.v_tip_m_per_s);
    }
  return fronts::ratio_at_equal_x(against, along, criterion_bins);
}

PressureChange pressure_change(std::span<const Outcome> events) {
  std::vector<double> along, against;
  for (const auto& m : main_fronts_of(events, true))
    for (const auto& p : m.points)
      if (std::isfinite(p.p_r_Pa))
        (m.front->direction > 0 ? along : against).push_back(p.p_r_Pa / p.p_s_Pa - 1);
  const auto median = [](std::vector<double>& values) {
    return values.empty() ? nan : fronts::median(values);
  };
  return {median(along), median(against)};
}

double fastest_over_c_L(const Outcome& o) {
  double most = nan;
  for (const auto& front : o.fronts)
    for (const auto& p : front.points)
      if (counts(o, front, p) && !(p.v_tip_m_per_s <= most * o.speeds.c_L))
        if (std::isfinite(p.v_tip_m_per_s)) most = p.v_tip_m_per_s / o.speeds.c_L;
  return most;
}

Json events_json(const OnBase& on) {
  Json list = Json::array();
  for (const auto& o : on.events) {
    Json fronts = Json::array();
    for (const int direction : {-1, 1})
      if (const auto* front = first_front(o, direction))
        fronts.push_back({{"direction", direction},
                          {"length_m", fronts::length_m(*front)},
                          {"mode", fronts::name(front->mode)},
                          {"end", fronts::name(front->end)}});
    list.push_back({{"name", o.name},
                    {"critical_shear_m", number(o.critical_shear_m)},
                    {"peak_x_m", o.peak_x_m},
                    {"fastest_over_c_L", number(fastest_over_c_L(o))},
                    {"main_fronts", fronts}});
  }
  return list;
}

Json fit_json(const Collapse& c) {
  if (!c.fitted) return nullptr;
  Json json;
  for (const auto& [name, e] : {std::pair("a", c.fit.a), std::pair("b", c.fit.b), std::pair("c", c.fit.c)})
    json[name] = number(e);
  json["rms_over_c_L"] = number(c.fit.rms);
  return json;
}

Json base_json(const OnBase& on) {
  Json json = {{"name", on.base.name}, {"rigid", !on.base.material}};
  if (on.base.material) {
    json["youngs_modulus_Pa"] = on.base.material->youngs_modulus_Pa;
    json["poissons_ratio"] = on.base.material->poissons_ratio;
    json["density_kg_per_m3"] = on.base.material->density_kg_per_m3;
  }
  json.update(
      {{"tilt_factor", on.tilt_factor},
       {"speed_ratio",
        {{"median", number(on.speed_ratio.median)},
         {"low", number(on.speed_ratio.low)},
         {"high", number(on.speed_ratio.high)},
         {"n_bins", on.speed_ratio.n_bins}}},
       {"pressure_change",
        {{"along", number(on.pressure_change.along)}, {"against", number(on.pressure_change.against)}}},
       {"share_in_paper_band", number(on.main_fronts.share_in_paper_band)},
       {"n_points", on.main_fronts.n_points},
       {"fit", fit_json(on.main_fronts)},
       {"spread",
        {{"static_ratio", number(on.main_fronts.static_ratio.fronts.median_relative)},
         {"dynamic_ratio", number(on.main_fronts.dynamic_ratio.fronts.median_relative)},
         {"energy_rise", number(on.main_fronts.energy_rise.fronts.median_relative)}}},
       {"events", events_json(on)}});
  return json;
}

std::string points_csv(const BasesResult& result) {
  std::string text =
      "base,event,direction,x_m,v_tip_over_c_L,t_d_over_p_d,energy_rise,p_r_over_p_s,in_tail\n";
  for (const auto& on : result.bases)
    for (const auto& m : main_fronts_of(on.events, false))
      for (const auto& p : m.points)
        fmt::format_to(std::back_inserter(text), "{},{},{},{:.10g},{},{},{},{},{}\n", on.base.name,
                       m.outcome->name, m.front->direction, p.x_m,
                       cell(p.v_tip_m_per_s / m.outcome->speeds.c_L), cell(p.t_d_Pa / p.p_d_Pa),
                       cell(criterion_value(p, Criterion::energy_rise)), cell(p.p_r_Pa / p.p_s_Pa),
                       in_tail(m, p) ? 1 : 0);
  return text;
}

std::string bases_csv(const BasesResult& result) {
  std::string text =
      "base,tilt_factor,speed_ratio,speed_ratio_low,speed_ratio_high,n_bins,pressure_change_along,"
      "pressure_change_against,share_in_paper_band,n_points,spread_static_ratio,spread_dynamic_ratio,"
      "spread_energy_rise\n";
  for (const auto& on : result.bases) {
    const auto& r = on.speed_ratio;
    const auto& m = on.main_fronts;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{},{}\n", on.base.name,
                   cell(on.tilt_factor), cell(r.median), cell(r.low), cell(r.high), r.n_bins,
                   cell(on.pressure_change.along), cell(on.pressure_change.against),
                   cell(m.share_in_paper_band), m.n_points, cell(m.static_ratio.fronts.median_relative),
                   cell(m.dynamic_ratio.fronts.median_relative), cell(m.energy_rise.fronts.median_relative));
  }
  return text;
}

}  // namespace

const std::vector<BaseOption>& base_options() {
  static const std::vector<BaseOption> options = [] {
    const auto of = [](double E_Pa, double nu, double rho_kg_per_m3) {
      solid::Material m;
      m.youngs_modulus_Pa = E_Pa;
      m.poissons_ratio = nu;
      m.density_kg_per_m3 = rho_kg_per_m3;
      return m;
    };
    return std::vector<BaseOption>{{"PMMA", solid::Material{}},
                                   {"aluminium", of(70e9, 0.33, 2700)},
                                   {"steel", of(210e9, 0.30, 7850)},
                                   {"rigid", {}}};
  }();
  return options;
}

std::vector<NamedCase> cases_on(const BaseOption& base, bool quick) {
  auto cases = paper_cases(quick);
  for (auto& [name, c] : cases) {
    c.title = fmt::format("{} on {}", name, base.name);
    c.output.snapshot_times_s.clear();
    c.output.history_interval_s = c.output.energy_interval_s = 1e-5;
    // Held ones: the brief left one of the plate on the plane tears it off a base of PMMA.
    c.trigger = {};
    if (c.event == interface::EventKind::left) c.trigger.zone_m = 20e-3, c.trigger.amount = 20;
    if (!base.material) continue;
    c.base.kind = input::BaseKind::body;
    c.base.material = *base.material;
    const double factor = tilt_factor(c);
    c.loading.tilt_left_m *= factor;
    c.loading.tilt_right_m *= factor;
  }
  return cases;
}

BasesResult study_bases(const BasesOptions& options, const BasesMonitor& monitor) {
  BasesResult result;
  result.quick = options.quick;
  std::vector<NamedCase> cases;
  for (const auto& base : base_options()) {
    const auto own = cases_on(base, options.quick);
    result.bases.push_back({base, tilt_factor(own.front().config), {}, {}, {}, {}});
    cases.insert(cases.end(), own.begin(), own.end());
  }
  std::vector<input::Case> configs;
  for (const auto& c : cases) configs.push_back(c.config);
  std::vector<Outcome> outcomes(cases.size());
  std::size_t done = 0;
  run::Batch batch(
      options.threads, [&] { return monitor(done, cases.size()); }, "interrupted in the study of bases",
      options.kept);
  batch.run(configs, [&](std::size_t k, const run::Result& run, const run::InitialState& initial, bool) {
    outcomes[k] = make_outcome(cases[k].name, run, initial);
    if (run.event.end == motion::EventEnd::blow_up)
      result.warnings.push_back(cases[k].config.title + ": " + run.event.reason);
    monitor(++done, cases.size());
  });
  result.counts = batch.counts();
  auto next = std::make_move_iterator(outcomes.begin());
  const auto n_events = static_cast<std::ptrdiff_t>(cases.size() / result.bases.size());
  for (auto& on : result.bases) {
    on.events.assign(next, next + n_events);
    next += n_events;
    on.speed_ratio = speed_ratio(on.events);
    on.pressure_change = pressure_change(on.events);
    on.main_fronts = collapse_without_tails(main_fronts_of(on.events, false));
  }
  return result;
}

void write_bases(const std::filesystem::path& dir, const BasesResult& result) {
  Json json = {{"version", version_line()},
               {"quick", result.quick},
               {"n_runs", result.counts.n_runs},
               {"n_quiet", result.counts.n_quiet},
               {"warnings", result.warnings}};
  for (const auto& on : result.bases) json["bases"].push_back(base_json(on));
  files::write_text(dir / "bases.csv", bases_csv(result));
  files::write_text(dir / "bases_points.csv", points_csv(result));
  files::write_text(dir / "bases.json", json.dump(2) + "\n");
}

}  // namespace slipfront::kammer2012
