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

using interface::EventKind;
using interface::TriggerForm;

constexpr double plate_width_m = 0.2;
constexpr double quick_element_m = 4e-3;
constexpr std::size_t n_triggers = 512, n_more = 1024, n_all = 256, n_quick = 4;
constexpr std::size_t n_thin = 50;           ///< a region with fewer triggers gets more samples
constexpr double longest_trigger_s = 15e-6;  ///< that is taken away

/// Choices of the trigger at one edge.
void add_trigger(std::vector<OpenChoice>& list, EventKind event, const std::string& edge) {
  const interface::Trigger standard;
  constexpr double short_s = 5e-6;
  const auto name = [&](const char* choice) { return edge + "_" + choice; };
  list.push_back(
      {.name = name("form"),
       .key = "event.trigger_form",
       .event = event,
       .why =
           "the traction is \"increased manually\": by an amount, to a level, or against a lowered strength",
       .levels = {0, 1, 2},
       .words = {"added", "raised", "weakened"},
       .standard = 0,
       .set = [](input::Case& c, double v) { c.trigger.form = static_cast<TriggerForm>(std::lround(v)); }});
  list.push_back({.name = name("zone_m"),
                  .key = "event.trigger_zone_m",
                  .event = event,
                  .why = "\"small\": 1 to 10 % of the interface; 2 mm are 3 elements",
                  .levels = {2e-3, 5e-3, 10e-3, 15e-3, 20e-3},
                  .words = {},
                  .is_continuous = true,
                  .standard = standard.zone_m,
                  .set = [](input::Case& c, double v) { c.trigger.zone_m = v; }});
  const auto add_amount = [&](const char* form, const char* why, std::vector<double> levels, double usual) {
    list.push_back({.name = name(form),
                    .key = "event.trigger_amount",
                    .event = event,
                    .why = why,
                    .levels = std::move(levels),
                    .words = {},
                    .is_continuous = true,
                    .standard = usual,
                    .set = [](input::Case& c, double v) { c.trigger.amount = v; },
                    .decided_by = name("form"),
                    .counts_with = {form}});
  };
  add_amount("added", "from just enough for a front, to 80 times what is missing to the strength",
             {2, 5, 10, 20, 40, 80}, standard.amount);
  add_amount("raised", "from just above the strength to 80 times it", {1.05, 2, 5, 10, 20, 40, 80}, 2);
  list.push_back({.name = name("end"),
                  .key = "event.trigger_duration_s",
                  .event = event,
                  .why = "nothing is said of its end",
                  .levels = {0, 1},
                  .words = {"taken away", "held"},
                  .standard = 1,
                  .set = [](input::Case& c, double v) { c.trigger.duration_s = v == 0 ? short_s : infinity; },
                  .decided_by = name("form"),
                  .counts_with = {"added", "raised"}});
  list.push_back({.name = name("duration_s"),
                  .key = "event.trigger_duration_s",
                  .event = event,
                  .why = "brief: a wave crosses 1 to 24 mm meanwhile, an eighth of the plate at most",
                  .levels = {0.5e-6, 1.5e-6, 5e-6, longest_trigger_s},
                  .words = {},
                  .is_continuous = true,
                  .standard = short_s,
                  .set = [](input::Case& c, double v) { c.trigger.duration_s = v; },
                  .decided_by = name("end"),
                  .counts_with = {"taken away"}});
  list.push_back({.name = name("ramp_s"),
                  .key = "event.trigger_ramp_s",
                  .event = event,
                  .why = "from within a step, up to the duration",
                  .levels = {0.1e-6, 0.5e-6, 1.5e-6, 5e-6, longest_trigger_s},
                  .words = {},
                  .is_continuous = true,
                  .standard = standard.ramp_s,
                  .set = [](input::Case& c, double v) { c.trigger.ramp_s = v; },
                  .decided_by = name("form"),
                  .counts_with = {"added", "raised"},
                  .at_most = name("duration_s")});
}

void add_plate_and_loading(std::vector<OpenChoice>& list, bool quick) {
  list.push_back({"top",
                  "loading.top_during_tilt",
                  {},
                  "a vertical displacement is imposed; nothing is said of the horizontal one",
                  {0, 1},
                  {"held", "free"},
                  false,
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
       false,
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
                  false,
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
                  true,
                  0.9,
                  [](input::Case& c, double v) { c.time.step_factor = v; }});
  list.push_back(
      {"substeps",
       "time.interface_substeps",
       {},
       "the paper's scheme has one step; this program's resolves the change of friction",
       {1, 3, 9, 18},
       {},
       false,
       18,
       [](input::Case& c, double v) { c.time.interface_substeps = static_cast<int>(std::lround(v)); }});
  list.push_back({"contact",
                  "contact.algorithm",
                  {},
                  "an energy conserving algorithm, of which there are several",
                  {0, 1},
                  {"direct", "predictor_corrector"},
                  false,
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
                  false,
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

/// Points of Sobol's sequence, from its first one behind the origin on.
/// @param sampled  the choices, each with the range in which it is sampled
/// @param varied   those of them that are; the others are as given
std::vector<Sample> space_filling(const std::vector<OpenChoice>& sampled,
                                  const std::function<bool(const OpenChoice&)>& varied, Sample::Set set,
                                  SobolPoints points, const std::vector<double>& others) {
  const auto dimensions = static_cast<std::size_t>(std::ranges::count_if(sampled, varied));
  boost::random::sobol sequence(dimensions);
  sequence.discard(points.first * dimensions);
  constexpr double range = 1 + static_cast<double>(boost::random::sobol::max());
  std::vector<Sample> list;
  for (std::size_t point = 0; point < points.n; ++point) {
    Sample& sample = list.emplace_back(Sample{set, others});
    for (std::size_t k = 0; k < sampled.size(); ++k) {
      if (!varied(sampled[k])) continue;
      OpenChoice choice = sampled[k];
      double limit = infinity;
      if (!choice.at_most.empty())
        if (const auto other = index_of(sampled, choice.at_most); is_in_use(sampled, other, sample.values))
          limit = sample.values[other];
      choice.levels.back() = std::min(choice.levels.back(), limit);
      sample.values[k] = std::min(choice.at(static_cast<double>(sequence()) / range), limit);
    }
  }
  return list;
}

double two_digits(double value) {
  return std::stod(fmt::format("{:.2g}", value));
}

/// The choices, those of an edge's trigger that are words with the word of a sample alone.
std::vector<OpenChoice> with_words_of(const std::vector<OpenChoice>& choices, const Sample& sample,
                                      EventKind edge) {
  auto alike = choices;
  for (std::size_t k = 0; k < choices.size(); ++k)
    if (choices[k].event == edge && !choices[k].is_continuous) alike[k].levels = {sample.values[k]};
  return alike;
}

/// A trigger's words that are in use.
std::string words_of(const std::vector<OpenChoice>& choices, const std::vector<double>& values,
                     EventKind edge) {
  std::string words;
  for (std::size_t k = 0; k < choices.size(); ++k)
    if (choices[k].event == edge && !choices[k].is_continuous && is_in_use(choices, k, values))
      words += choices[k].text(values[k]) + " ";
  return words;
}

/// Left triggers by which it was found what to ask for, added over 0.1 us.
std::vector<Sample> known_samples(const std::vector<OpenChoice>& choices) {
  struct Known {
    double zone_m, added, duration_s;
  };
  std::vector<Sample> list;
  for (const auto& known : {Known{20e-3, 20, infinity},
                            {15e-3, 10, infinity},
                            {15e-3, 20, 5e-6},
                            {10e-3, 40, 4e-6},
                            {10e-3, 20, 5e-6},
                            {20e-3, 10, 5e-6}}) {
    auto& values = list.emplace_back(Sample{Sample::Set::known, standard_values(choices)}).values;
    values[index_of(choices, "left_zone_m")] = known.zone_m;
    values[index_of(choices, "left_added")] = known.added;
    values[index_of(choices, "left_ramp_s")] = 0.1e-6;
    values[index_of(choices, "left_end")] = std::isinf(known.duration_s) ? 1 : 0;
    if (!std::isinf(known.duration_s)) values[index_of(choices, "left_duration_s")] = known.duration_s;
  }
  return list;
}

/// The chosen triggers on meshes that are finer than the paper's.
std::vector<Sample> finer_samples(const std::vector<OpenChoice>& choices, const std::vector<double>& chosen) {
  std::vector<Sample> list;
  for (const int columns : {400, 600}) {
    list.push_back({Sample::Set::finer, chosen});
    list.back().values[index_of(choices, "element_size_m")] = plate_width_m / columns;
  }
  return list;
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
    batch_.run(
        std::span(cases_).subspan(first),
        [&](std::size_t k, const run::Result& r, const run::InitialState& initial, bool) {
          auto& outcome = outcomes_[first + k] = make_outcome("", r, initial);
          if (r.event.end == motion::EventEnd::blow_up) outcome.fronts.clear();
          ++done_;
        },
        // Snapshots are not kept.
        [&](std::size_t k) { return cases_[first + k].output.snapshot_times_s.empty(); });
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

std::optional<bool> verdict(const std::vector<Claim>& claims, const std::string& id) {
  const auto found = std::ranges::find(claims, id, &Claim::id);
  return found == claims.end() ? std::nullopt : found->holds;
}

SampleOutcome judge(const Sample& sample, std::span<const Outcome* const, 3> three,
                    const std::vector<Claim>& claims) {
  SampleOutcome o;
  o.sample = sample;
  for (const auto& claim : claims) o.holds.push_back(claim.holds);
  o.left_max = figure(claims, "C11", "left");
  o.right_max = figure(claims, "C11", "right");
  o.spontaneous_max = figure(claims, "C11", "spontaneous");
  o.left_work_J_per_m = three[1]->trigger_work_J_per_m;
  o.circle = circle(*three[1]);
  o.others_hold = std::ranges::all_of(constraining_claims(), [&](const std::string& id) {
    return id == "C25" || verdict(claims, id) == std::optional(true);
  });
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

/// The samples of triggers at an edge.
Sample::Set set_of(EventKind edge) {
  return edge == EventKind::left ? Sample::Set::left_trigger : Sample::Set::right_trigger;
}

bool is_of_region(const SampleOutcome& o) {
  return o.sample.set == Sample::Set::left_trigger && o.is_constrained();
}

/// Whether a left trigger is held, for which the constraining claims but C25 hold.
bool is_held(const std::vector<OpenChoice>& choices, const SampleOutcome& o) {
  const auto end = index_of(choices, "left_end");
  return o.sample.set == Sample::Set::left_trigger && o.others_hold &&
         is_in_use(choices, end, o.sample.values) && choices[end].text(o.sample.values[end]) == "held";
}

/// Whether a ramp would last longer than its trigger.
bool exceeds_a_limit(const std::vector<OpenChoice>& choices, const std::vector<double>& values) {
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (choices[k].at_most.empty() || !is_in_use(choices, k, values)) continue;
    const auto limit = index_of(choices, choices[k].at_most);
    if (is_in_use(choices, limit, values) && values[k] > values[limit]) return true;
  }
  return false;
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

/// The kinds of slip over mu_k (C20, C21) of the samples that give evidence.
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
    if (!is_of_region(o) && !is_held(result.choices, o)) continue;
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
    for (std::size_t k = 0; k < result.claims.size(); ++k)
      if (const auto holds = verdict(claims, result.claims[k])) o.holds[k] = holds;
    o.difference_of_kinds = figure(claims, "C21+", "difference");
  }
}

class OpenChoicesStudy {
 public:
  OpenChoicesStudy(const OpenChoicesOptions& options,
                   const std::function<bool(std::size_t done, std::size_t total)>& monitor)
      : quick_(options.quick), events_(options, monitor) {
    result_.quick = options.quick;
    result_.choices = open_choices(options.quick);
  }

  OpenChoicesResult run() {
    const auto standard = standard_values(result_.choices);
    const auto lefts = sampled(EventKind::left, standard);
    const auto rights = sampled(EventKind::right, chosen_of(lefts, EventKind::left, standard));
    const auto with_right = chosen_of(rights, EventKind::right, standard);
    const auto add = [&](const std::vector<Sample>& list, bool with_every_circle) {
      std::ranges::move(judged(list, with_every_circle), std::back_inserter(result_.outcomes));
    };
    add(with_trigger(EventKind::right, with_right, {{Sample::Set::standard, standard}}), true);
    if (!quick_) add(with_trigger(EventKind::right, with_right, known_samples(result_.choices)), true);
    add(with_trigger(EventKind::right, with_right, samples_of(lefts)), false);
    result_.left = region_of(result_.choices, result_.outcomes, EventKind::left);
    std::ranges::copy(rights, std::back_inserter(result_.outcomes));
    result_.right = region_of(result_.choices, result_.outcomes, EventKind::right);
    count_slow_lefts();
    if (result_.chosen()) {
      const auto values = result_.outcomes[*result_.chosen()].sample.values;
      add(samples_about(result_.choices, values), true);
      if (!quick_) add(finer_samples(result_.choices, values), true);
    }
    add(samples_of_all(result_.choices, quick_ ? n_quick : n_all), false);
    judge_kinds_of_slip(result_, events_);
    result_.counts = events_.counts();
    return std::move(result_);
  }

 private:
  /// Triggers at an edge over their ranges; where few of them are possible, more that are like most of these.
  std::vector<SampleOutcome> sampled(EventKind edge, const std::vector<double>& others) {
    auto outcomes = judged(trigger_samples(result_.choices, edge, {0, n_first()}, others), false);
    const auto region = region_of(result_.choices, outcomes, edge);
    if (region.alike.empty() || region.all.size() >= n_thin) return outcomes;
    const auto alike = with_words_of(result_.choices, outcomes[region.alike.front()].sample, edge);
    std::ranges::move(
        judged(trigger_samples(alike, edge, {n_first(), quick_ ? n_quick : n_more}, others), false),
        std::back_inserter(outcomes));
    return outcomes;
  }

  /// The values of the sample in the middle of an edge's region; `otherwise` where the region is empty.
  std::vector<double> chosen_of(const std::vector<SampleOutcome>& outcomes, EventKind edge,
                                const std::vector<double>& otherwise) const {
    const auto place = region_of(result_.choices, outcomes, edge).nearest_to_middle;
    return place ? outcomes[*place].sample.values : otherwise;
  }

  static std::vector<Sample> samples_of(const std::vector<SampleOutcome>& outcomes) {
    std::vector<Sample> list;
    for (const auto& o : outcomes) list.push_back(o.sample);
    return list;
  }

  /// The samples with the trigger at an edge from `values`.
  std::vector<Sample> with_trigger(EventKind edge, const std::vector<double>& values,
                                   std::vector<Sample> list) const {
    for (auto& sample : list)
      for (std::size_t k = 0; k < values.size(); ++k)
        if (result_.choices[k].event == edge) sample.values[k] = values[k];
    return list;
  }

  /// Runs the events of samples and judges them.
  /// @param with_every_circle  C25 is tested for all of them, else where the other constraining claims hold
  std::vector<SampleOutcome> judged(const std::vector<Sample>& list, bool with_every_circle) {
    std::vector<Sample> possible;
    std::vector<std::array<std::size_t, 4>> places;
    for (const auto& sample : list) {
      const auto cases = cases_of(result_.choices, sample);
      if (!is_possible_(cases)) {
        ++result_.n_impossible;
        continue;
      }
      possible.push_back(sample);
      auto& of_sample = places.emplace_back();
      std::ranges::transform(cases, of_sample.begin(),
                             [this](const input::Case& c) { return events_.place(c); });
    }
    events_.run();
    std::vector<SampleOutcome> outcomes;
    for (std::size_t k = 0; k < possible.size(); ++k)
      outcomes.push_back(judged_sample(possible[k], places[k]));
    std::vector<std::size_t> with_circle;
    for (std::size_t k = 0; k < possible.size(); ++k) {
      if (!with_every_circle && !outcomes[k].others_hold) continue;
      auto& left = places[k][1];
      auto config = events_.at(left).config;
      config.output.snapshot_times_s = wave_times_s(events_.at(left));
      if (config.output.snapshot_times_s.empty()) continue;
      left = events_.place(config);
      with_circle.push_back(k);
    }
    events_.run();
    for (const auto k : with_circle) outcomes[k] = judged_sample(possible[k], places[k]);
    return outcomes;
  }

  SampleOutcome judged_sample(const Sample& sample, const std::array<std::size_t, 4>& places) {
    const auto& [spontaneous, left, right, mu_k_1] = places;
    const std::array three = {&events_.at(spontaneous), &events_.at(left), &events_.at(right)};
    const auto claims = scorecard({*three[0], *three[1], *three[2], events_.at(mu_k_1), {}, {}, {}});
    if (result_.claims.empty())
      std::ranges::transform(claims, std::back_inserter(result_.claims), &Claim::id);
    return judge(sample, three, claims);
  }

  std::size_t n_first() const { return quick_ ? n_quick : n_triggers; }

  /// C11b, of the left triggers over their whole ranges, which come first.
  void count_slow_lefts() {
    const auto n = static_cast<int>(n_first());
    for (const auto& o : result_.outcomes) {
      if (o.sample.set != Sample::Set::left_trigger || result_.triggers.n_triggers == n) continue;
      ++result_.triggers.n_triggers;
      result_.triggers.n_holding += has_slow_left(o, result_.claims) ? 1 : 0;
    }
  }

  bool quick_;
  OpenChoicesResult result_;
  Events events_;
  Possible is_possible_;
};

}  // namespace

double OpenChoice::at(double share) const {
  if (is_continuous) return levels.front() * std::pow(levels.back() / levels.front(), share);
  const auto n = static_cast<double>(levels.size());
  return levels[static_cast<std::size_t>(std::min(share * n, n - 1))];
}

double OpenChoice::share_of(double value) const {
  if (levels.size() == 1) return 0;
  if (is_continuous) return std::log(value / levels.front()) / std::log(levels.back() / levels.front());
  return static_cast<double>(std::ranges::find(levels, value) - levels.begin()) /
         static_cast<double>(levels.size() - 1);
}

std::string OpenChoice::text(double value) const {
  return words.empty() ? fmt::format("{}", value) : words[static_cast<std::size_t>(std::lround(value))];
}

bool is_in_use(const std::vector<OpenChoice>& choices, std::size_t choice,
               const std::vector<double>& values) {
  const auto& c = choices[choice];
  if (c.decided_by.empty()) return true;
  const auto decider = index_of(choices, c.decided_by);
  return is_in_use(choices, decider, values) &&
         std::ranges::count(c.counts_with, choices[decider].text(values[decider])) > 0;
}

std::string_view name(Sample::Set set) {
  switch (set) {
    case Sample::Set::standard:
      return "standard";
    case Sample::Set::known:
      return "known";
    case Sample::Set::left_trigger:
      return "left trigger";
    case Sample::Set::right_trigger:
      return "right trigger";
    case Sample::Set::about_chosen:
      return "about the chosen";
    case Sample::Set::finer:
      return "finer";
    case Sample::Set::all:
      return "all";
  }
  return "";
}

const std::vector<std::string>& constraining_claims() {
  static const std::vector<std::string> ids = {"C2", "C3",  "C4",  "C5",  "C6",  "C7", "C8",
                                               "C9", "C10", "C11", "C13", "C23", "C25"};
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

std::vector<Sample> trigger_samples(const std::vector<OpenChoice>& choices, EventKind edge,
                                    SobolPoints points, const std::vector<double>& others) {
  const auto varied = [edge](const OpenChoice& choice) { return choice.event == edge; };
  auto list = space_filling(choices, varied, set_of(edge), points, others);
  for (auto& sample : list)
    for (std::size_t k = 0; k < choices.size(); ++k)
      if (varied(choices[k])) sample.values[k] = two_digits(sample.values[k]);
  return list;
}

std::vector<Sample> samples_of_all(const std::vector<OpenChoice>& choices, std::size_t n) {
  return space_filling(
      choices, [](const OpenChoice&) { return true; }, Sample::Set::all, {0, n}, standard_values(choices));
}

std::vector<Sample> samples_about(const std::vector<OpenChoice>& choices, const std::vector<double>& chosen) {
  std::vector<Sample> list;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    for (const double level : choices[k].levels) {
      if (level == chosen[k] && is_in_use(choices, k, chosen)) continue;
      Sample sample{Sample::Set::about_chosen, chosen};
      sample.values[k] = level;
      if (!is_in_use(choices, k, chosen)) {  // it comes with one that lets it count
        const auto decider = index_of(choices, choices[k].decided_by);
        const auto& words = choices[decider].words;
        sample.values[decider] =
            static_cast<double>(std::ranges::find(words, choices[k].counts_with.front()) - words.begin());
      }
      if (is_in_use(choices, k, sample.values) && !exceeds_a_limit(choices, sample.values))
        list.push_back(std::move(sample));
    }
  }
  return list;
}

TriggerRegion region_of(const std::vector<OpenChoice>& choices, const std::vector<SampleOutcome>& outcomes,
                        EventKind edge) {
  TriggerRegion region;
  for (std::size_t place = 0; place < outcomes.size(); ++place)
    if (outcomes[place].sample.set == set_of(edge) && outcomes[place].is_constrained())
      region.all.push_back(place);
  const auto words = [&](std::size_t place, EventKind of) {
    return words_of(choices, outcomes[place].sample.values, of);
  };
  const auto with_words = [&](const std::string& wanted) {
    std::vector<std::size_t> alike;
    std::ranges::copy_if(region.all, std::back_inserter(alike),
                         [&](std::size_t place) { return words(place, edge) == wanted; });
    return alike;
  };
  if (region.all.empty()) return region;
  if (edge == EventKind::right) {
    region.alike = with_words(words(region.all.front(), EventKind::left));
  } else {
    for (const auto first : region.all)
      if (auto alike = with_words(words(first, edge)); alike.size() > region.alike.size())
        region.alike = std::move(alike);
  }
  if (region.alike.empty()) return region;
  std::vector<double> distances(region.alike.size(), 0);
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (choices[k].event != edge || !choices[k].is_continuous ||
        !is_in_use(choices, k, outcomes[region.alike.front()].sample.values))
      continue;
    std::vector<double> shares;
    for (const auto place : region.alike)
      shares.push_back(choices[k].share_of(outcomes[place].sample.values[k]));
    const double middle = fronts::median(shares);
    for (std::size_t j = 0; j < shares.size(); ++j)
      distances[j] += (shares[j] - middle) * (shares[j] - middle);
  }
  region.nearest_to_middle =
      region.alike[static_cast<std::size_t>(std::ranges::min_element(distances) - distances.begin())];
  return region;
}

std::vector<Evidence> evidence(const OpenChoicesResult& result) {
  const auto gather = [&](const std::string& name, const std::function<bool(const SampleOutcome&)>& picked) {
    std::vector<const SampleOutcome*> list;
    for (const auto& o : result.outcomes)
      if (picked(o)) list.push_back(&o);
    const auto count = [&](const std::function<bool(const SampleOutcome&)>& predicate) {
      return static_cast<std::size_t>(
          std::ranges::count_if(list, [&](const auto* o) { return predicate(*o); }));
    };
    const auto range = [&](const std::function<double(const SampleOutcome&)>& value) -> Evidence::Range {
      std::vector<double> values;
      for (const auto* o : list)
        if (std::isfinite(value(*o))) values.push_back(value(*o));
      if (values.empty()) return {nan, nan, nan};
      return {std::ranges::min(values), fronts::median(values), std::ranges::max(values)};
    };
    const auto fitted = [](fronts::Estimate fronts::ExponentialFit::*member) {
      return [member](const SampleOutcome& o) { return o.fit ? ((*o.fit).*member).value : nan; };
    };
    Evidence e{.name = name,
               .n = list.size(),
               .n_paper_fit_in_intervals = count([](const auto& o) { return o.distance <= 1; }),
               .shares = {},
               .spread_at_energy_rise = range(std::mem_fn(&SampleOutcome::spread_at_energy_rise)),
               .spread_at_dynamic_ratio = range(std::mem_fn(&SampleOutcome::spread_at_dynamic_ratio)),
               .spread_at_static_ratio = range(std::mem_fn(&SampleOutcome::spread_at_static_ratio)),
               .difference_of_kinds = range(std::mem_fn(&SampleOutcome::difference_of_kinds)),
               .a = range(fitted(&fronts::ExponentialFit::a)),
               .b = range(fitted(&fronts::ExponentialFit::b)),
               .c = range(fitted(&fronts::ExponentialFit::c)),
               .share_in_band = range(std::mem_fn(&SampleOutcome::share_in_band))};
    for (std::size_t claim = 0; claim < result.claims.size(); ++claim) {
      const auto tested = count([&](const auto& o) { return o.holds[claim].has_value(); });
      const auto holding = count([&](const auto& o) { return o.holds[claim].value_or(false); });
      if (tested > 0) e.shares.push_back({result.claims[claim], tested, holding});
    }
    return e;
  };
  return {gather("the region", [](const auto& o) { return is_of_region(o); }),
          gather("held, all constraints but C25", [&](const auto& o) { return is_held(result.choices, o); })};
}

OpenChoicesResult study_open_choices(
    const OpenChoicesOptions& options,
    const std::function<bool(std::size_t done, std::size_t total)>& monitor) {
  return OpenChoicesStudy(options, monitor).run();
}

}  // namespace slipfront::kammer2012
