// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/open_choices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fronts/measures.hpp"
#include "input/schema.hpp"
#include "papers/kammer2012/main_fronts.hpp"
#include "run/batch.hpp"

namespace slipfront::kammer2012 {

namespace {

using Between = OpenChoice::Between;
using interface::EventKind;
using interface::TriggerForm;

constexpr double plate_width_m = 0.2;
constexpr double quick_element_m = 4e-3;
constexpr std::size_t n_triggers = 512, n_all = 256, n_left_trigger = 256, n_quick = 4;

/// Choices of the trigger at one edge.
void add_trigger(std::vector<OpenChoice>& list, EventKind event, const std::string& edge) {
  const interface::Trigger standard;
  const auto add = [&](const char* name, const char* key, const char* why, std::vector<double> levels,
                       Between between, double standard_value, std::function<void(input::Case&, double)> set,
                       std::vector<std::string> forms = {}) {
    list.push_back({edge + "_" + name,
                    key,
                    event,
                    why,
                    std::move(levels),
                    {},
                    between,
                    standard_value,
                    std::move(set),
                    forms.empty() ? "" : edge + "_form",
                    std::move(forms)});
  };
  const auto set_amount = [](input::Case& c, double v) { c.trigger.amount = v; };
  list.push_back(
      {edge + "_form",
       "event.trigger_form",
       event,
       "the traction is \"increased manually\": by an amount, to a level, or against a lowered "
       "strength",
       {0, 1, 2},
       {"added", "raised", "weakened"},
       Between::nothing,
       0,
       [](input::Case& c, double v) { c.trigger.form = static_cast<TriggerForm>(std::lround(v)); }});
  add("zone_m", "event.trigger_zone_m", "\"small\": 1 to 10 % of the interface; 2 mm are 3 elements",
      {2e-3, 5e-3, 10e-3, 15e-3, 20e-3}, Between::logarithmic, standard.zone_m,
      [](input::Case& c, double v) { c.trigger.zone_m = v; });
  add("added", "event.trigger_amount",
      "from just enough for a front, to 40 times what is missing to the strength", {2, 3.5, 5, 10, 20, 40},
      Between::logarithmic, standard.amount, set_amount, {"added"});
  add("raised", "event.trigger_amount", "from just above the strength to four times it", {1.05, 1.5, 2, 4},
      Between::logarithmic, 1.5, set_amount, {"raised"});
  add("ramp_s", "event.trigger_ramp_s",
      "from within one step to the time that a longitudinal wave takes for 16 mm",
      {0.1e-6, 1e-6, 5e-6, 10e-6}, Between::logarithmic, standard.ramp_s,
      [](input::Case& c, double v) { c.trigger.ramp_s = v; }, {"added", "raised"});
  add("duration_s", "event.trigger_duration_s", "taken away behind the front, or held",
      {15e-6, 30e-6, 60e-6, infinity}, Between::nothing, standard.duration_s,
      [](input::Case& c, double v) { c.trigger.duration_s = v; }, {"added", "raised"});
}

void add_plate_and_loading(std::vector<OpenChoice>& list, bool quick) {
  list.push_back({"top",
                  "loading.top_during_tilt",
                  {},
                  "a vertical displacement is imposed; nothing is said of the horizontal one",
                  {0, 1},
                  {"held", "free"},
                  Between::nothing,
                  0,
                  [](input::Case& c, double v) {
                    c.loading.top_during_tilt = v == 0 ? statics::TopEdge::held : statics::TopEdge::free;
                  }});
  list.push_back(
      {"corner",
       "plate.corner",
       {},
       "rounded, without a radius; the relief is this program's standard, right angles a limit",
       {0, 1, 2, 3, 4},
       {"none", "relief", "fillet 2 mm", "fillet 5 mm", "fillet 10 mm"},
       Between::nothing,
       1,
       [](input::Case& c, double v) {
         constexpr std::array radii_m = {2e-3, 5e-3, 10e-3};
         const auto k = std::lround(v);
         c.plate.corner = k == 0 ? mesh::Corner::none : k == 1 ? mesh::Corner::relief : mesh::Corner::fillet;
         if (k >= 2) c.plate.fillet_radius_m = radii_m[k - 2];
       }});
  list.push_back({"element_size_m",
                  "plate.element_size_m",
                  {},
                  "the paper's meshes have 0.67 to 2 mm; which figure has which is not said",
                  quick ? std::vector{quick_element_m}
                        : std::vector{plate_width_m / 300, plate_width_m / 200, plate_width_m / 150,
                                      plate_width_m / 100},
                  {},
                  Between::nothing,
                  quick ? quick_element_m : plate_width_m / 300,
                  [](input::Case& c, double v) { c.plate.element_size_m = v; }});
}

void add_numerics(std::vector<OpenChoice>& list) {
  list.push_back({"step_factor",
                  "time.step_factor",
                  {},
                  "the step is not given; the velocity on which the damping acts is half a step old, so this "
                  "choice holds that one as well",
                  {0.225, 0.45, 0.9},
                  {},
                  Between::logarithmic,
                  0.9,
                  [](input::Case& c, double v) { c.time.step_factor = v; }});
  list.push_back(
      {"substeps",
       "time.interface_substeps",
       {},
       "the paper's scheme has one step; this program's resolves the change of friction",
       {1, 3, 9, 18},
       {},
       Between::nothing,
       18,
       [](input::Case& c, double v) { c.time.interface_substeps = static_cast<int>(std::lround(v)); }});
  list.push_back({"contact",
                  "contact.algorithm",
                  {},
                  "an energy conserving algorithm, of which there are several",
                  {0, 1},
                  {"direct", "predictor_corrector"},
                  Between::nothing,
                  0,
                  [](input::Case& c, double v) {
                    c.contact = v == 0 ? interface::ContactAlgorithm::direct
                                       : interface::ContactAlgorithm::predictor_corrector;
                  }});
  list.push_back({"speed_interval",
                  "fronts.speed_interval",
                  {},
                  "V_tip belongs to the advance over l* or to the node at its end",
                  {0, 1},
                  {"centred", "approach"},
                  Between::nothing,
                  0,
                  [](input::Case& c, double v) {
                    c.fronts.speed_interval =
                        v == 0 ? fronts::SpeedInterval::centred : fronts::SpeedInterval::approach;
                  }});
}

std::size_t index_of(const std::vector<OpenChoice>& choices, std::string_view name) {
  const auto found = std::ranges::find(choices, name, &OpenChoice::name);
  SLIPFRONT_ASSERT(found != choices.end(), "no such choice");
  return static_cast<std::size_t>(found - choices.begin());
}

std::vector<double> standard_values(const std::vector<OpenChoice>& choices) {
  std::vector<double> values;
  for (const auto& choice : choices) values.push_back(choice.standard);
  return values;
}

/// Where two choices act together: how much and over which length or time an edge is pushed; mesh and step.
void add_pairs(const std::vector<OpenChoice>& choices, std::vector<Sample>& list) {
  const std::array<std::pair<const char*, const char*>, 5> pairs = {{{"left_zone_m", "left_added"},
                                                                     {"left_ramp_s", "left_added"},
                                                                     {"right_zone_m", "right_added"},
                                                                     {"right_ramp_s", "right_added"},
                                                                     {"element_size_m", "substeps"}}};
  for (const auto& [first, second] : pairs) {
    const auto i = index_of(choices, first), j = index_of(choices, second);
    for (const double a : choices[i].levels)
      for (const double b : choices[j].levels) {
        if (a == choices[i].standard || b == choices[j].standard) continue;  // one at a time
        Sample sample{Sample::Set::pairs, standard_values(choices)};
        sample.values[i] = a;
        sample.values[j] = b;
        list.push_back(std::move(sample));
      }
  }
}

/// Points of Sobol's sequence, from its first one behind the origin on.
/// @param sampled  the choices, each with the range in which it is sampled
/// @param varied   those of them that are
void add_space_filling(const std::vector<OpenChoice>& sampled,
                       const std::function<bool(const OpenChoice&)>& varied, Sample::Set set, std::size_t n,
                       std::vector<Sample>& list) {
  const auto dimensions = static_cast<std::size_t>(std::ranges::count_if(sampled, varied));
  boost::random::sobol sequence(dimensions);
  constexpr double range = 1 + static_cast<double>(boost::random::sobol::max());
  for (std::size_t point = 0; point < n; ++point) {
    Sample sample{set, standard_values(sampled)};
    for (std::size_t k = 0; k < sampled.size(); ++k)
      if (varied(sampled[k])) sample.values[k] = sampled[k].at(static_cast<double>(sequence()) / range);
    list.push_back(std::move(sample));
  }
}

double two_digits(double value) {
  return std::stod(fmt::format("{:.2g}", value));
}

/// Left triggers about those that agree with Fig. 6 in the other sets: wide, strong, not weakened. Two
/// digits, so that a case file can state what is chosen.
void add_left_triggers(std::vector<OpenChoice> choices, std::size_t n, std::vector<Sample>& list) {
  const std::map<std::string, std::vector<double>> ranges = {{"left_form", {0, 1}},
                                                             {"left_zone_m", {10e-3, 20e-3}},
                                                             {"left_added", {5, 40}},
                                                             {"left_raised", {2, 4}}};
  for (auto& choice : choices)
    if (const auto found = ranges.find(choice.name); found != ranges.end()) choice.levels = found->second;
  const auto varied = [](const OpenChoice& choice) { return choice.event == EventKind::left; };
  const std::size_t first = list.size();
  add_space_filling(choices, varied, Sample::Set::left_trigger, n, list);
  for (auto& sample : std::span(list).subspan(first))
    for (std::size_t k = 0; k < choices.size(); ++k)
      if (varied(choices[k])) sample.values[k] = two_digits(sample.values[k]);
}

/// The four events of a sample.
std::array<input::Case, 4> cases_of(const std::vector<OpenChoice>& choices, const Sample& sample) {
  auto named = paper_cases(false);
  std::array<input::Case, 4> cases;
  for (std::size_t e = 0; e < cases.size(); ++e) {
    auto& c = cases[e] = std::move(named[e].config);
    c.title.clear();
    c.output.snapshot_times_s.clear();
    c.output.history_interval_s = c.output.energy_interval_s = 1e-5;
    for (std::size_t k = 0; k < choices.size(); ++k)
      if ((!choices[k].event || choices[k].event == c.event) && is_in_use(choices, k, sample.values))
        choices[k].set(c, sample.values[k]);
  }
  return cases;
}

/// Runs events, by the text of their case each once, and keeps what analysis needs of them.
class Events {
 public:
  Events(const OpenChoicesOptions& options,
         const std::function<bool(std::size_t done, std::size_t total)>& monitor)
      : batch_(
            options.threads, [this, &monitor] { return monitor(done_, cases_.size()); },
            "interrupted; completed runs are saved: repeat the command to continue", options.kept) {}

  std::size_t place(const input::Case& config) {
    const auto [found, is_new] = places_.try_emplace(input::to_toml(config), cases_.size());
    if (is_new) cases_.push_back(config);
    return found->second;
  }

  /// Runs those placed since the last call. Outcomes of earlier ones move.
  void run() {
    const std::size_t first = outcomes_.size();
    outcomes_.resize(cases_.size());
    batch_.run(std::span(cases_).subspan(first),
               [&](std::size_t k, const run::Result& r, const run::InitialState& initial, bool) {
                 auto& outcome = outcomes_[first + k] = make_outcome("", r, initial);
                 if (r.event.end == motion::EventEnd::blow_up) outcome.fronts.clear();
                 ++done_;
               });
  }

  const Outcome& at(std::size_t place) const { return outcomes_[place]; }
  const run::Counts& counts() const { return batch_.counts(); }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<input::Case> cases_;
  std::vector<Outcome> outcomes_;
  std::atomic<std::size_t> done_ = 0;
  run::Batch batch_;
};

/// Whether a sample's plate can be meshed: small fillets need small elements.
class Possible {
 public:
  bool operator()(const std::array<input::Case, 4>& cases) {
    return std::ranges::all_of(cases, [this](const input::Case& c) {
      const auto [found, is_new] = known_.try_emplace(run::initial_state_key(c), true);
      if (is_new) found->second = can_be_meshed(c);
      return found->second;
    });
  }

 private:
  static bool can_be_meshed(const input::Case& config) {
    try {
      run::check(config);
      return true;
    } catch (const UserError&) {
      return false;
    }
  }

  std::map<std::string, bool> known_;
};

double figure(const std::vector<Claim>& claims, const char* id, const char* name) {
  const auto claim = std::ranges::find(claims, id, &Claim::id);
  if (claim == claims.end()) return nan;
  const auto found = std::ranges::find(claim->figures, name, &Figure::name);
  return found == claim->figures.end() ? nan : found->value;
}

double distance_from_paper(const fronts::ExponentialFit& fit) {
  const PaperFit paper;
  const auto units = [](const fronts::Estimate& ours, double theirs) {
    const double interval = theirs > ours.value ? ours.high - ours.value : ours.value - ours.low;
    return interval > 0 ? std::abs(theirs - ours.value) / interval : nan;
  };
  return std::max({units(fit.a, paper.a), units(fit.b, paper.b), units(fit.c, paper.c)});
}

double extremity(const std::vector<OpenChoice>& choices, const Sample& sample) {
  double largest = 0;
  for (std::size_t k = 0; k < choices.size(); ++k)
    if (is_in_use(choices, k, sample.values))
      largest = std::max(largest, std::abs(choices[k].share_of(sample.values[k]) -
                                           choices[k].share_of(choices[k].standard)));
  return largest;
}

std::optional<bool> verdict(const std::vector<Claim>& claims, const std::string& id) {
  const auto found = std::ranges::find(claims, id, &Claim::id);
  return found == claims.end() ? std::nullopt : found->holds;
}

SampleOutcome judge(const std::vector<OpenChoice>& choices, const Sample& sample,
                    std::span<const Outcome* const, 3> three, const std::vector<Claim>& claims) {
  SampleOutcome o;
  o.sample = sample;
  o.extremity = extremity(choices, sample);
  for (const auto& claim : claims) o.holds.push_back(claim.holds);
  o.left_max = figure(claims, "C11", "left");
  o.right_max = figure(claims, "C11", "right");
  o.spontaneous_max = figure(claims, "C11", "spontaneous");
  o.is_constrained = std::ranges::all_of(constraining_claims(), [&](const std::string& id) {
    return verdict(claims, id) == std::optional(true);
  });
  o.agrees_with_fig6 = verdict(claims, "C18b") == std::optional(true);
  const auto main = collapse_without_tails(main_fronts(three));
  o.share_in_band = main.share_in_paper_band;
  if (main.fitted) o.fit = main.fit;
  o.distance = main.fitted ? distance_from_paper(main.fit) : nan;
  o.spread_at_energy_rise = main.energy_rise.fronts.median_relative;
  o.spread_at_dynamic_ratio = main.dynamic_ratio.fronts.median_relative;
  o.spread_at_static_ratio = main.static_ratio.fronts.median_relative;
  o.difference_of_kinds = nan;
  return o;
}

/// C1 to C11.
bool has_slow_left(const SampleOutcome& o, const std::vector<std::string>& ids) {
  for (int k = 1; k <= 11; ++k) {
    const auto place = std::ranges::find(ids, fmt::format("C{}", k)) - ids.begin();
    if (o.holds[place] != std::optional(true)) return false;
  }
  return true;
}

/// The scorecard's study of mu_k with a sample's choices.
Study mu_k_study(const std::vector<OpenChoice>& choices, const Sample& sample) {
  const auto all = studies(false);
  Study study = *std::ranges::find(all, "mu_k", &Study::name);
  for (auto& point : study.points) {
    const auto cases = cases_of(choices, sample);
    for (std::size_t e = 0; e < point.cases.size(); ++e) {
      point.cases[e].config = cases[e];
      point.cases[e].config.friction.parameter("mu_k") = point.number;
    }
  }
  return study;
}

/// The kinds of slip over mu_k (C20, C21) of the samples whose constraining claims hold.
void judge_kinds_of_slip(OpenChoicesResult& result, Events& events) {
  struct Judged {
    std::size_t outcome;
    Study study;
    std::array<std::size_t, 4> places;               ///< of the sample's four events
    std::vector<std::array<std::size_t, 3>> points;  ///< of the study's events
  };
  std::vector<Judged> list;
  for (std::size_t k = 0; k < result.outcomes.size(); ++k) {
    const auto& o = result.outcomes[k];
    if (!o.is_constrained) continue;
    Judged judged{k, mu_k_study(result.choices, o.sample), {}, {}};
    std::ranges::transform(cases_of(result.choices, o.sample), judged.places.begin(),
                           [&](const input::Case& c) { return events.place(c); });
    for (const auto& point : judged.study.points)
      std::ranges::transform(point.cases, judged.points.emplace_back().begin(),
                             [&](const NamedCase& c) { return events.place(c.config); });
    list.push_back(std::move(judged));
  }
  events.run();
  for (const char* id : {"C20+", "C21+"}) {  // rows that only this study has
    result.claims.emplace_back(id);
    for (auto& o : result.outcomes) o.holds.emplace_back();
  }
  for (auto& judged : list) {
    StudyOutcome study{std::move(judged.study), {}};
    for (const auto& point : judged.points) {
      auto& outcomes = study.outcomes.emplace_back();
      for (const auto place : point) outcomes.push_back(events.at(place));
    }
    const auto& [spontaneous, left, right, mu_k_1] = judged.places;
    const auto claims = scorecard(
        {events.at(spontaneous), events.at(left), events.at(right), events.at(mu_k_1), {study}, {}, {}});
    auto& o = result.outcomes[judged.outcome];
    for (std::size_t k = 0; k < result.claims.size(); ++k) o.holds[k] = verdict(claims, result.claims[k]);
    o.difference_of_kinds = figure(claims, "C21+", "difference");
  }
}

}  // namespace

double OpenChoice::at(double share) const {
  const auto n = static_cast<double>(levels.size());
  const double low = levels.front(), high = levels.back();
  switch (between) {
    case Between::nothing:
      return levels[static_cast<std::size_t>(std::min(share * n, n - 1))];
    case Between::linear:
      return low + share * (high - low);
    case Between::logarithmic:
      return low * std::pow(high / low, share);
  }
  return nan;
}

double OpenChoice::share_of(double value) const {
  const double low = levels.front(), high = levels.back();
  if (levels.size() == 1) return 0;
  switch (between) {
    case Between::nothing:
      return static_cast<double>(std::ranges::find(levels, value) - levels.begin()) /
             static_cast<double>(levels.size() - 1);
    case Between::linear:
      return (value - low) / (high - low);
    case Between::logarithmic:
      return std::log(value / low) / std::log(high / low);
  }
  return nan;
}

std::string OpenChoice::text(double value) const {
  return words.empty() ? fmt::format("{}", value) : words[static_cast<std::size_t>(std::lround(value))];
}

bool is_in_use(const std::vector<OpenChoice>& choices, std::size_t choice,
               const std::vector<double>& values) {
  const auto& c = choices[choice];
  if (c.decided_by.empty()) return true;
  const auto decider = index_of(choices, c.decided_by);
  return std::ranges::count(c.counts_with, choices[decider].text(values[decider])) > 0;
}

std::string_view name(Sample::Set set) {
  switch (set) {
    case Sample::Set::standard:
      return "standard";
    case Sample::Set::one_at_a_time:
      return "one at a time";
    case Sample::Set::pairs:
      return "pairs";
    case Sample::Set::triggers:
      return "triggers";
    case Sample::Set::all:
      return "all";
    case Sample::Set::left_trigger:
      return "left trigger";
    case Sample::Set::about_chosen:
      return "about the chosen";
  }
  return "";
}

const std::vector<std::string>& constraining_claims() {
  static const std::vector<std::string> ids = {"C2", "C3",  "C4",  "C5",  "C6",  "C7", "C8",
                                               "C9", "C10", "C11", "C12", "C13", "C23"};
  return ids;
}

std::vector<OpenChoice> open_choices(bool quick) {
  std::vector<OpenChoice> list;
  add_trigger(list, EventKind::left, "left");
  add_trigger(list, EventKind::right, "right");
  add_plate_and_loading(list, quick);
  add_numerics(list);
  return list;
}

std::vector<Sample> samples_about(const std::vector<OpenChoice>& choices, Sample::Set set,
                                  const std::vector<double>& values) {
  std::vector<Sample> list;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    for (const double level : choices[k].levels) {
      if (level == values[k]) continue;
      Sample sample{set, values};
      sample.values[k] = level;
      if (!is_in_use(choices, k, values)) {  // it comes with one that lets it count
        const auto decider = index_of(choices, choices[k].decided_by);
        const auto& words = choices[decider].words;
        sample.values[decider] =
            static_cast<double>(std::ranges::find(words, choices[k].counts_with.front()) - words.begin());
      }
      list.push_back(std::move(sample));
    }
  }
  return list;
}

std::vector<Sample> samples(const std::vector<OpenChoice>& choices, bool quick) {
  std::vector<Sample> list = {{Sample::Set::standard, standard_values(choices)}};
  if (!quick) {
    const auto one_at_a_time = samples_about(choices, Sample::Set::one_at_a_time, standard_values(choices));
    list.insert(list.end(), one_at_a_time.begin(), one_at_a_time.end());
    add_pairs(choices, list);
  }
  add_space_filling(
      choices, [](const OpenChoice& choice) { return choice.event.has_value(); }, Sample::Set::triggers,
      quick ? n_quick : n_triggers, list);
  add_space_filling(
      choices, [](const OpenChoice&) { return true; }, Sample::Set::all, quick ? n_quick : n_all, list);
  add_left_triggers(choices, quick ? n_quick : n_left_trigger, list);
  return list;
}

std::vector<std::size_t> region_of(const std::vector<SampleOutcome>& outcomes) {
  std::vector<std::size_t> constrained, agreeing;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    if (!outcomes[k].is_constrained) continue;
    constrained.push_back(k);
    if (outcomes[k].agrees_with_fig6) agreeing.push_back(k);
  }
  return agreeing.empty() ? constrained : agreeing;
}

int min_extreme(const std::vector<SampleOutcome>& outcomes) {
  const auto region = region_of(outcomes);
  const auto least =
      std::ranges::min_element(region, {}, [&](std::size_t k) { return outcomes[k].extremity; });
  return least == region.end() ? -1 : static_cast<int>(*least);
}

std::vector<Evidence> evidence(const OpenChoicesResult& result) {
  const auto duration = static_cast<std::size_t>(
      std::ranges::find(result.choices, "left_duration_s", &OpenChoice::name) - result.choices.begin());
  const auto is_held = [&](const SampleOutcome& o) { return std::isinf(o.sample.values[duration]); };
  const auto gather = [&](const std::string& name, const std::function<bool(const SampleOutcome&)>& picked) {
    std::vector<const SampleOutcome*> list;
    for (const auto& o : result.outcomes)
      if (o.is_constrained && picked(o)) list.push_back(&o);
    const auto count = [&](const std::function<bool(const SampleOutcome&)>& predicate) {
      return static_cast<std::size_t>(
          std::ranges::count_if(list, [&](const auto* o) { return predicate(*o); }));
    };
    const auto range = [&](double SampleOutcome::*member) -> Evidence::Range {
      std::vector<double> values;
      for (const auto* o : list)
        if (std::isfinite(o->*member)) values.push_back(o->*member);
      if (values.empty()) return {nan, nan, nan};
      return {std::ranges::min(values), fronts::median(values), std::ranges::max(values)};
    };
    Evidence e{.name = name,
               .n = list.size(),
               .n_paper_fit_in_intervals = count([](const auto& o) { return o.distance <= 1; }),
               .shares = {},
               .spread_at_energy_rise = range(&SampleOutcome::spread_at_energy_rise),
               .spread_at_dynamic_ratio = range(&SampleOutcome::spread_at_dynamic_ratio),
               .spread_at_static_ratio = range(&SampleOutcome::spread_at_static_ratio),
               .difference_of_kinds = range(&SampleOutcome::difference_of_kinds)};
    for (std::size_t claim = 0; claim < result.claims.size(); ++claim) {
      const auto tested = count([&](const auto& o) { return o.holds[claim].has_value(); });
      const auto holding = count([&](const auto& o) { return o.holds[claim].value_or(false); });
      if (tested > 0) e.shares.push_back({result.claims[claim], tested, holding});
    }
    return e;
  };
  const auto agrees = [](const SampleOutcome& o) { return o.agrees_with_fig6; };
  return {gather("constraints and Fig. 6", agrees),
          gather("constraints alone", [](const SampleOutcome&) { return true; }),
          gather("constraints and Fig. 6, left trigger held",
                 [&](const auto& o) { return agrees(o) && is_held(o); }),
          gather("constraints and Fig. 6, left trigger taken away",
                 [&](const auto& o) { return agrees(o) && !is_held(o); })};
}

OpenChoicesResult study_open_choices(
    const OpenChoicesOptions& options,
    const std::function<bool(std::size_t done, std::size_t total)>& monitor) {
  OpenChoicesResult result;
  result.quick = options.quick;
  result.choices = open_choices(options.quick);
  Events events(options, monitor);
  Possible is_possible;
  const auto run_and_judge = [&](const std::vector<Sample>& list) {
    std::vector<std::pair<Sample, std::array<std::size_t, 4>>> possible;
    for (const auto& sample : list) {
      const auto cases = cases_of(result.choices, sample);
      if (!is_possible(cases)) {
        ++result.n_impossible;
        continue;
      }
      auto& [kept, places] = possible.emplace_back(sample, std::array<std::size_t, 4>{});
      for (std::size_t e = 0; e < cases.size(); ++e) places[e] = events.place(cases[e]);
    }
    events.run();
    for (const auto& [sample, places] : possible) {
      const auto& [spontaneous, left, right, mu_k_1] = places;
      const std::array three = {&events.at(spontaneous), &events.at(left), &events.at(right)};
      const auto claims = scorecard({*three[0], *three[1], *three[2], events.at(mu_k_1), {}, {}, {}});
      if (result.claims.empty())
        std::ranges::transform(claims, std::back_inserter(result.claims), &Claim::id);
      result.outcomes.push_back(judge(result.choices, sample, three, claims));
      if (sample.set != Sample::Set::triggers) continue;
      ++result.triggers.n_triggers;
      result.triggers.n_holding += has_slow_left(result.outcomes.back(), result.claims) ? 1 : 0;
    }
  };
  run_and_judge(samples(result.choices, options.quick));
  result.chosen = min_extreme(result.outcomes);
  if (result.chosen >= 0)
    run_and_judge(samples_about(result.choices, Sample::Set::about_chosen,
                                result.outcomes[result.chosen].sample.values));
  result.region = region_of(result.outcomes);
  judge_kinds_of_slip(result, events);
  result.counts = events.counts();
  return result;
}

}  // namespace slipfront::kammer2012
