// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/version.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"
#include "files/text.hpp"
#include "papers/kammer2012/open_choices.hpp"
#include "papers/kammer2012/undefined.hpp"
#include "results/folder.hpp"

namespace slipfront::kammer2012 {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* summary_file = "open_choices.json";

/// Numbers as they are, infinity as in case files.
Json value_json(const OpenChoice& choice, double value) {
  if (!choice.words.empty() || std::isinf(value)) return choice.text(value);
  return value;
}

std::string verdict_text(std::optional<bool> holds) {
  return holds ? (*holds ? "holds" : "does not") : "";
}

double circle_value(const SampleOutcome& o, double Circle::*member) {
  return o.circle ? (*o.circle).*member : nan;
}

std::string csv(const OpenChoicesResult& result) {
  std::string text = "set";
  for (const auto& choice : result.choices) text += fmt::format(",{}", choice.name);
  text +=
      ",constraints,constraints_but_C25,distance,share_in_band,a,a_low,a_high,b,b_low,b_high,c,c_low,c_high,"
      "rms_over_c_L,spread_at_energy_rise,spread_at_t_d_over_p_d,spread_at_t_s_over_p_s,"
      "difference_of_kinds_over_c_L,left_max_over_c_L,spontaneous_max_over_c_L,right_max_over_c_L,"
      "left_work_J_per_m,circle_peak_m_per_s,circle_gap";
  for (const auto& id : result.claims) text += fmt::format(",{}", id);
  text += "\n";
  for (const auto& o : result.outcomes) {
    text += name(o.sample.set);
    for (std::size_t k = 0; k < result.choices.size(); ++k)
      text += fmt::format(",{}", result.choices[k].text(o.sample.values[k]));
    text += fmt::format(",{},{},{},{}", o.is_constrained() ? "hold" : "do not",
                        o.others_hold ? "hold" : "do not", cell(o.distance), cell(o.share_in_band));
    const auto fit = o.fit.value_or(fronts::ExponentialFit{});
    for (const auto* e : {&fit.a, &fit.b, &fit.c})
      for (const double value : {e->value, e->low, e->high})
        text += fmt::format(",{}", o.fit ? cell(value) : "");
    text += fmt::format(",{}", o.fit ? cell(fit.rms) : "");
    for (const double value :
         {o.spread_at_energy_rise, o.spread_at_dynamic_ratio, o.spread_at_static_ratio, o.difference_of_kinds,
          o.left_max, o.spontaneous_max, o.right_max, o.left_work_J_per_m,
          circle_value(o, &Circle::peak_m_per_s), circle_value(o, &Circle::gap)})
      text += fmt::format(",{}", cell(value));
    for (const auto holds : o.holds) text += fmt::format(",{}", verdict_text(holds));
    text += "\n";
  }
  return text;
}

Json choices_json(const OpenChoicesResult& result) {
  Json list = Json::array();
  for (const auto& choice : result.choices) {
    Json levels = Json::array();
    for (const double level : choice.levels) levels.push_back(value_json(choice, level));
    list.push_back({{"name", choice.name},
                    {"key", choice.key},
                    {"why", choice.why},
                    {"levels", levels},
                    {"standard", value_json(choice, choice.standard)},
                    {"decided_by", choice.decided_by},
                    {"counts_with", choice.counts_with}});
  }
  return list;
}

/// Whether both triggers start a front.
bool starts_fronts(const SampleOutcome& o) {
  return o.left_max > 0 && o.right_max > 0;
}

/// Samples of a set for which a claim holds, over those for which it is tested.
Json share_json(const OpenChoicesResult& result, Sample::Set set, std::size_t claim, bool with_fronts_only) {
  std::size_t tested = 0, holding = 0;
  for (const auto& o : result.outcomes) {
    if (o.sample.set != set || !o.holds[claim] || (with_fronts_only && !starts_fronts(o))) continue;
    ++tested;
    holding += *o.holds[claim] ? 1 : 0;
  }
  return tested == 0 ? Json(nullptr) : Json(static_cast<double>(holding) / static_cast<double>(tested));
}

/// The choice that a sample of one other level changes. An amount comes with its form, which stands before
/// it.
std::size_t changed_choice(const Sample& sample, const Sample& standard) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k < sample.values.size(); ++k)
    if (sample.values[k] != standard.values[k]) changed = k;
  return changed;
}

/// For each claim: its verdict with the chosen triggers, how often it holds, and the levels of single choices
/// at which the verdict changes.
Json matrix_json(const OpenChoicesResult& result) {
  Json list = Json::array();
  const auto& centre = result.outcomes[result.chosen().value_or(0)];
  for (std::size_t claim = 0; claim < result.claims.size(); ++claim) {
    if (!result.outcomes.front().holds[claim]) continue;  // those that need studies
    Json turns = Json::array();
    for (const auto& o : result.outcomes) {
      if (o.sample.set != Sample::Set::about_chosen || o.holds[claim] == centre.holds[claim]) continue;
      const auto k = changed_choice(o.sample, centre.sample);
      turns.push_back(
          {{"choice", result.choices[k].name}, {"level", value_json(result.choices[k], o.sample.values[k])}});
    }
    list.push_back(
        {{"id", result.claims[claim]},
         {"holds", centre.holds[claim].value_or(false)},
         {"share_of_triggers", share_json(result, Sample::Set::left_trigger, claim, false)},
         {"share_of_triggers_with_fronts", share_json(result, Sample::Set::left_trigger, claim, true)},
         {"share_of_all", share_json(result, Sample::Set::all, claim, false)},
         {"turns", turns}});
  }
  return list;
}

Json outcome_json(const OpenChoicesResult& result, const SampleOutcome& o) {
  Json values;
  for (std::size_t k = 0; k < result.choices.size(); ++k)
    values[result.choices[k].name] = value_json(result.choices[k], o.sample.values[k]);
  Json claims;
  for (std::size_t k = 0; k < result.claims.size(); ++k)
    claims[result.claims[k]] = o.holds[k] ? Json(*o.holds[k]) : Json(nullptr);
  Json json = {{"set", name(o.sample.set)},
               {"values", values},
               {"constraints_hold", o.is_constrained()},
               {"claims", claims},
               {"left_max_over_c_L", number(o.left_max)},
               {"spontaneous_max_over_c_L", number(o.spontaneous_max)},
               {"right_max_over_c_L", number(o.right_max)},
               {"left_work_J_per_m", number(o.left_work_J_per_m)},
               {"circle_peak_m_per_s", number(circle_value(o, &Circle::peak_m_per_s))},
               {"circle_gap", number(circle_value(o, &Circle::gap))},
               {"spread_at_energy_rise", number(o.spread_at_energy_rise)},
               {"spread_at_t_d_over_p_d", number(o.spread_at_dynamic_ratio)},
               {"spread_at_t_s_over_p_s", number(o.spread_at_static_ratio)},
               {"difference_of_kinds_over_c_L", number(o.difference_of_kinds)},
               {"distance", number(o.distance)},
               {"share_in_band", number(o.share_in_band)},
               {"fit", nullptr}};
  if (o.fit)
    json["fit"] = {{"a", number(o.fit->a)},
                   {"b", number(o.fit->b)},
                   {"c", number(o.fit->c)},
                   {"rms_over_c_L", o.fit->rms}};
  return json;
}

Json outcomes_json(const OpenChoicesResult& result, Sample::Set set) {
  Json list = Json::array();
  for (const auto& o : result.outcomes)
    if (o.sample.set == set) list.push_back(outcome_json(result, o));
  return list;
}

Json evidence_json(const OpenChoicesResult& result) {
  const auto range = [](const Evidence::Range& r) -> Json {
    return {number(r.least), number(r.median), number(r.largest)};
  };
  Json json = Json::array();
  for (const auto& e : evidence(result)) {
    Json holding = Json::object();
    for (const auto& share : e.shares)
      holding[share.claim] = {{"n", share.n_tested}, {"n_holding", share.n_holding}};
    json.push_back({{"samples", e.name},
                    {"n", e.n},
                    {"n_paper_fit_in_intervals", e.n_paper_fit_in_intervals},
                    {"claims", holding},
                    {"spread_at_energy_rise", range(e.spread_at_energy_rise)},
                    {"spread_at_t_d_over_p_d", range(e.spread_at_dynamic_ratio)},
                    {"spread_at_t_s_over_p_s", range(e.spread_at_static_ratio)},
                    {"difference_of_kinds_over_c_L", range(e.difference_of_kinds)},
                    {"a", range(e.a)},
                    {"b", range(e.b)},
                    {"c", range(e.c)},
                    {"share_in_band", range(e.share_in_band)}});
  }
  return json;
}

/// Least and largest value in use of each choice of a trigger in its region, numbers only; words that occur.
Json region_json(const OpenChoicesResult& result) {
  Json json = Json::object();
  for (std::size_t k = 0; k < result.choices.size(); ++k) {
    if (!result.choices[k].event) continue;
    const auto& region = *result.choices[k].event == interface::EventKind::left ? result.left : result.right;
    std::vector<double> values;
    for (const auto place : region.all) {
      const auto& sample = result.outcomes[place].sample;
      if (is_in_use(result.choices, k, sample.values)) values.push_back(sample.values[k]);
    }
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    Json list = Json::array();
    const bool as_range = result.choices[k].words.empty() && values.size() > 2;
    if (as_range) values = {values.front(), values.back()};
    for (const double value : values) list.push_back(value_json(result.choices[k], value));
    json[result.choices[k].name] = list;
  }
  return json;
}

}  // namespace

void write_open_choices(const std::filesystem::path& dir, const OpenChoicesResult& result) {
  const auto count = [&](auto&& condition) { return std::ranges::count_if(result.outcomes, condition); };
  Json json = {
      {"version", version_line()},
      {"quick", result.quick},
      {"n_runs", result.counts.n_runs},
      {"n_quiet", result.counts.n_quiet},
      {"n_samples", result.outcomes.size()},
      {"n_impossible", result.n_impossible},
      {"constraints", constraining_claims()},
      {"wanted_share_in_band", wanted_share_in_band},
      {"choices", choices_json(result)},
      {"matrix", matrix_json(result)},
      {"n_triggers", result.triggers.n_triggers},
      {"n_triggers_slow_left", result.triggers.n_holding},
      {"n_left", count([](const SampleOutcome& o) { return o.sample.set == Sample::Set::left_trigger; })},
      {"n_left_with_fronts", count([](const SampleOutcome& o) {
         return o.sample.set == Sample::Set::left_trigger && o.left_max > 0;
       })},
      {"n_left_others_hold", count([](const SampleOutcome& o) {
         return o.sample.set == Sample::Set::left_trigger && o.others_hold;
       })},
      {"n_left_region", result.left.all.size()},
      {"n_left_alike", result.left.alike.size()},
      {"n_right", count([](const SampleOutcome& o) { return o.sample.set == Sample::Set::right_trigger; })},
      {"n_right_region", result.right.all.size()},
      {"n_right_alike", result.right.alike.size()},
      {"evidence", evidence_json(result)},
      {"region", region_json(result)},
      {"standard", outcome_json(result, result.outcomes.front())},
      {"known", outcomes_json(result, Sample::Set::known)},
      {"finer", outcomes_json(result, Sample::Set::finer)},
      {"about", outcomes_json(result, Sample::Set::about_chosen)},
      {"chosen", nullptr}};
  if (result.chosen()) json["chosen"] = outcome_json(result, result.outcomes[*result.chosen()]);
  files::write_text(dir / "open_choices.csv", csv(result));
  files::write_text(dir / summary_file, json.dump(2) + "\n");
}

TriggerSample read_trigger_sample(const std::filesystem::path& dir, bool quick) {
  const auto file = dir / summary_file;
  if (!files::is_there(results::published(dir, summary_file)))
    throw UserError("{}: holds no {}; give the folder of slipfront study open-choices", dir.string(),
                    summary_file);
  if (!files::is_there(results::published(dir, files::checksum_list)))
    throw UserError("{}: holds no {}; create it again with slipfront study open-choices", dir.string(),
                    files::checksum_list);
  if (results::published(dir, files::checksum_list) != dir / files::checksum_list)
    throw UserError(
        "{}: its results are still on their way into it; slipfront study open-choices -o {} ends that",
        dir.string(), dir.string());
  files::require_listed(file);
  files::require_intact(dir);
  constexpr std::size_t max_bytes = 64U << 20U;
  const auto json =
      Json::parse(files::read_text(file, file.string(), "summary of the study", max_bytes), nullptr, false);
  if (json.is_object() && json.contains("quick") && json["quick"].is_boolean() && json["quick"] != quick)
    throw UserError("{}: is a {} study, which does not suit a {} reproduction; give one made {}--quick",
                    dir.string(), quick ? "full" : "quick", quick ? "quick" : "full",
                    quick ? "with " : "without ");
  const auto count = [&](const char* key) -> int {
    if (!json.is_object() || !json.contains(key) || !json[key].is_number_unsigned() || json[key] > 1000000000)
      throw UserError("{}: has no count \"{}\"; create it again with slipfront study open-choices",
                      file.string(), key);
    return json[key];
  };
  const TriggerSample sample{count("n_triggers"), count("n_triggers_slow_left")};
  if (sample.n_triggers == 0 || sample.n_holding > sample.n_triggers)
    throw UserError("{}: {} of {} triggers cannot be; create it again with slipfront study open-choices",
                    file.string(), sample.n_holding, sample.n_triggers);
  return sample;
}

}  // namespace slipfront::kammer2012
