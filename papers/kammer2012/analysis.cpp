// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/analysis.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "files/files.hpp"
#include "fronts/measures.hpp"
#include "papers/kammer2012/undefined.hpp"

namespace slipfront::kammer2012 {

namespace {

using Json = nlohmann::ordered_json;

/// A fitted curve with its interval; empty where there is no fit.
Json curve_json(const std::vector<fronts::CurvePoint>& curve) {
  Json json = Json::array();
  for (const auto& [x, y] : curve)
    json.push_back({{"x", x}, {"value", number(y.value)}, {"low", number(y.low)}, {"high", number(y.high)}});
  return json;
}

/// The entries that tell how well the criteria order the speeds.
Json collapse_json(const Collapse& c) {
  Json json;
  json["fit"] = nullptr;
  if (c.fitted)
    json["fit"] = {{"a", number(c.fit.a)},
                   {"b", number(c.fit.b)},
                   {"c", number(c.fit.c)},
                   {"rms_over_c_L", c.fit.rms},
                   {"n_points", c.fit.n_points}};
  json["share_in_paper_band"] = number(c.share_in_paper_band);
  json["n_points"] = c.n_points;
  const auto spread = [&](auto value) {
    return Json{{"t_s_over_p_s", number(value(c.static_ratio))},
                {"t_d_over_p_d", number(value(c.dynamic_ratio))},
                {"energy", number(value(c.energy_rise))}};
  };
  json["spread"] = spread([](const Collapse::Spreads& s) { return s.cases.median_relative; });
  json["spread_of_fronts"] = spread([](const Collapse::Spreads& s) { return s.fronts.median_relative; });
  json["spread_rms"] = spread([](const Collapse::Spreads& s) { return s.cases.rms_relative; });
  return json;
}

Json outcome_json(const Outcome& o, const Outcome* reference) {
  Json fronts = Json::array();
  for (const auto& front : o.fronts) {
    fronts::Front counted = front;
    std::erase_if(counted.points, [&](const fronts::FrontPoint& p) { return !counts(o, front, p, 5e-3); });
    const auto speeds = fronts::speed_summary(counted, 0);
    fronts.push_back({{"direction", front.direction},
                      {"start_x_m", front.points.front().x_m},
                      {"end_x_m", front.points.back().x_m},
                      {"end", fronts::name(front.end)},
                      {"mode", fronts::name(front.mode)},
                      {"mean_v_over_c_L", number(speeds.mean_m_per_s / o.speeds.c_L)},
                      {"max_v_over_c_L", number(speeds.max_m_per_s / o.speeds.c_L)},
                      {"x_of_max_m", number(speeds.x_of_max_m)}});
  }
  Json json = {{"event", o.name},
               {"critical_shear_m", o.critical_shear_m},
               {"peak_x_m", o.peak_x_m},
               {"fronts", fronts}};
  if (std::isfinite(o.ramp_critical_shear_m)) {
    json["ramp_critical_shear_m"] = o.ramp_critical_shear_m;
    json["ramp_onsets_at_edges"] = o.ramp_onsets;
  }
  if (reference != nullptr) {
    const auto change = speed_change(o, *reference);
    json["speed_change"] = {{"median", number(change.median)},
                            {"median_absolute", number(change.median_absolute)},
                            {"largest", number(change.largest)},
                            {"n_points", change.n_points}};
  }
  return json;
}

/// The run of the same event that a study's changes are counted from.
const Outcome* reference_of(const Outcome& o, const StudyOutcome& study, const Reproduction& runs) {
  if (study.study.own_reference) {
    for (const auto& first : study.outcomes.front())
      if (first.config.event == o.config.event) return &first;
    return nullptr;
  }
  switch (o.config.event) {
    case interface::EventKind::left:
      return &runs.left;
    case interface::EventKind::right:
      return &runs.right;
    default:
      return &runs.spontaneous;
  }
}

}  // namespace

void write_scorecard(const std::filesystem::path& file, const std::vector<Claim>& claims) {
  Json list = Json::array();
  const auto verdict = [](std::optional<bool> holds) { return holds ? Json(*holds) : Json(nullptr); };
  for (const auto& c : claims) {
    Json row = {{"id", c.id},
                {"claim", c.claim},
                {"paper", c.paper},
                {"measured", c.measured},
                {"holds", verdict(c.holds)},
                {"how", c.how},
                {"counts", c.counts}};
    if (c.used_to_choose) row["used_to_choose"] = true;
    if (!c.second_test_of.empty()) {
      row["second_test_of"] = c.second_test_of;
      row["why"] = c.why;
    }
    row["figures"] = Json::array();
    for (const auto& f : c.figures)
      row["figures"].push_back({{"name", f.name}, {"value", number(f.value)}, {"unit", f.unit}});
    for (const auto& v : c.variations) {
      Json differences = Json::array();
      for (const double d : v.differences) differences.push_back(number(d));
      row[v.name + "_variation"] = {{"parameter", v.key},         {"value", v.value},
                                    {"measured", v.measured},     {"holds", verdict(v.holds)},
                                    {"differences", differences}, {"moves", describe(c, v)}};
    }
    list.push_back(std::move(row));
  }
  files::write_text(file, list.dump(2) + "\n");
}

void write_analysis(const std::filesystem::path& file, const Reproduction& runs) {
  const std::vector<const Outcome*> three = {&runs.spontaneous, &runs.left, &runs.right};
  const Collapse own = collapse(three);
  Json json = collapse_json(own);
  json["fit_curve"] = curve_json(own.fit.curve);
  const PaperFit paper;
  json["paper_fit"] = {{"a", paper.a}, {"a_band", paper.band}, {"b", paper.b}, {"c", paper.c}};
  Json studies = Json::array();
  for (const auto& study : runs.studies) {
    Json points = Json::array();
    for (std::size_t k = 0; k < study.outcomes.size(); ++k) {
      std::vector<const Outcome*> all;
      Json events = Json::array();
      for (const auto& o : study.outcomes[k]) {
        all.push_back(&o);
        events.push_back(outcome_json(o, reference_of(o, study, runs)));
      }
      Json point = {{"value", study.study.points[k].value},
                    {"number", number(study.study.points[k].number)},
                    {"events", events}};
      point.update(collapse_json(collapse(all)));
      points.push_back(std::move(point));
    }
    studies.push_back({{"name", study.study.name},
                       {"parameter", study.study.key},
                       {"why", study.study.why},
                       {"points", points}});
  }
  json["studies"] = std::move(studies);
  files::write_text(file, json.dump(2) + "\n");
}

}  // namespace slipfront::kammer2012
