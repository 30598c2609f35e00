// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fronts/fit.hpp"
#include "input/case.hpp"
#include "papers/kammer2012/circle.hpp"
#include "papers/kammer2012/scorecard.hpp"
#include "run/batch.hpp"

namespace slipfront::kammer2012 {

/// A choice that the paper leaves open.
struct OpenChoice {
  std::string name;                           ///< column of the tables
  std::string key;                            ///< of the case file
  std::optional<interface::EventKind> event;  ///< the only event that it concerns
  std::string why;                            ///< reason of the range
  std::vector<double> levels;                 ///< values tried by themselves, ascending; indices of the words
  std::vector<std::string> words;             ///< of the levels where they are no numbers
  bool is_continuous = false;                 ///< between the levels, by logarithms; else the levels alone
  double standard = 0;                        ///< of this program
  std::function<void(input::Case&, double)> set;
  /// The choice whose value decides whether this one counts, and the words with which it does; none: always.
  std::string decided_by = {};
  std::vector<std::string> counts_with = {};
  std::string at_most = {};  ///< the choice whose value, where it counts, ends the range

  /// The value at a share of the range, 0 to 1.
  double at(double share) const;
  /// The share of the range at which a value lies.
  double share_of(double value) const;
  /// As it stands in tables.
  std::string text(double value) const;
};

/// All of them, in the order in which they are set.
/// @param quick  with elements of 4 mm alone
std::vector<OpenChoice> open_choices(bool quick = false);

/// Whether a choice has a part among such values: an amount counts with its form of trigger alone, and a
/// weakened zone has neither ramp nor end.
bool is_in_use(const std::vector<OpenChoice>& choices, std::size_t choice, const std::vector<double>& values);

/// What is chosen: a value for each open choice.
struct Sample {
  enum class Set {
    standard,       ///< this program's default triggers
    known,          ///< left triggers by which the rule of choice was found, see open-choices.md
    left_trigger,   ///< space-filling over left triggers
    right_trigger,  ///< the same of right ones
    about_chosen,   ///< one other level of one choice, about the chosen triggers
    finer,          ///< the chosen triggers with smaller elements
    all,            ///< space-filling over all choices
  };
  Set set = Set::standard;
  std::vector<double> values;  ///< [choices]
};
std::string_view name(Sample::Set set);

struct OpenChoicesOptions {
  bool quick = false;               ///< few samples with elements of 4 mm, to try the command
  int threads = 1;                  ///< runs side by side
  std::filesystem::path kept = {};  ///< folder of the runs that are done
};

/// Points of Sobol's sequence, counted from the one behind the origin.
struct SobolPoints {
  std::size_t first = 0, n = 0;
};

/// Triggers at an edge, the other choices as given: points of Sobol's sequence over their ranges, two digits
/// each, so that a case file can state what is chosen.
std::vector<Sample> trigger_samples(const std::vector<OpenChoice>& choices, interface::EventKind edge,
                                    SobolPoints points, const std::vector<double>& others);
/// One other level of one choice at a time, about the chosen triggers.
std::vector<Sample> samples_about(const std::vector<OpenChoice>& choices, const std::vector<double>& chosen);
/// Points of Sobol's sequence over all choices.
std::vector<Sample> samples_of_all(const std::vector<OpenChoice>& choices, std::size_t n);

/// What comes out for one sample.
struct SampleOutcome {
  Sample sample;
  std::vector<std::optional<bool>> holds;                   ///< [claims]
  double left_max = 0, right_max = 0, spontaneous_max = 0;  ///< V_tip/c_L, see C11
  double left_work_J_per_m = 0;                             ///< of the left trigger
  std::optional<Circle> circle;
  std::optional<fronts::ExponentialFit> fit;  ///< of the main fronts without their tails, see C18b
  double share_in_band = 0;                   ///< of their points within the paper's band
  /// Median relative spread between them at equal energy rise, t_d/p_d and t_s/p_s, see C18c.
  double spread_at_energy_rise = 0, spread_at_dynamic_ratio = 0, spread_at_static_ratio = 0;
  double difference_of_kinds = 0;  ///< V_tip/c_L, see C21+; NaN where it was not tested
  /// Largest distance of a, b and c from the paper's in units of our interval on that side: at most 1 where
  /// the paper's lie inside our intervals; NaN without a fit.
  double distance = 0;
  bool others_hold = false;  ///< all constraining_claims but C25
  /// All of them: C25 is tested where the others hold.
  bool is_constrained() const { return others_hold && circle && circle->holds(); }
};

/// Claims that decide which triggers are possible: statements about the fronts, and C25 about the wave ahead
/// of one. The paper's conclusions, C12 and C14 to C22, are none.
const std::vector<std::string>& constraining_claims();

/// The triggers at an edge for which the constraining claims hold, and what is chosen of them.
struct TriggerRegion {
  std::vector<std::size_t> all;  ///< of the outcomes
  /// At the left those of the most frequent form and end, of several the first; at the right those of the
  /// left trigger's.
  std::vector<std::size_t> alike;
  /// Of these the one nearest to their middle, the medians of the logarithms, in shares of the ranges;
  /// none: there are none.
  std::optional<std::size_t> nearest_to_middle;
};
TriggerRegion region_of(const std::vector<OpenChoice>& choices, const std::vector<SampleOutcome>& outcomes,
                        interface::EventKind edge);

struct OpenChoicesResult {
  bool quick = false;
  std::vector<OpenChoice> choices;
  std::vector<std::string> claims;      ///< their ids
  std::vector<SampleOutcome> outcomes;  ///< the standard one first
  TriggerRegion left, right;
  std::optional<std::size_t> chosen() const { return left.nearest_to_middle; }
  /// C11b: of the first left triggers, those for which C1 to C11 hold.
  TriggerSample triggers;
  std::size_t n_impossible = 0;  ///< samples left out: fillets too small for their elements
  run::Counts counts;
};

/// What was not used to choose, of some of the samples.
struct Evidence {
  struct Share {
    std::string claim;
    std::size_t n_tested = 0, n_holding = 0;
  };
  struct Range {
    double least = 0, median = 0, largest = 0;  ///< NaN without samples
  };
  std::string name;
  std::size_t n = 0;
  std::size_t n_paper_fit_in_intervals = 0;  ///< the paper's a, b and c lie inside ours
  std::vector<Share> shares;                 ///< of the claims that were tested for any of them
  Range spread_at_energy_rise, spread_at_dynamic_ratio, spread_at_static_ratio;  ///< see SampleOutcome
  Range difference_of_kinds;                                                     ///< V_tip/c_L, see C21+
  Range a, b, c, share_in_band;                                                  ///< see C18b
};

/// For the region of left triggers, and for held ones for which the constraining claims but C25 hold.
std::vector<Evidence> evidence(const OpenChoicesResult& result);

/// Runs the four events of every sample (equal ones once) and judges them; the samples of `evidence` by the
/// kinds of slip over mu_k (C20, C21), too.
/// @throws UserError, Interrupted
OpenChoicesResult study_open_choices(const OpenChoicesOptions& options,
                                     const std::function<bool(std::size_t done, std::size_t total)>& monitor);

/// open_choices.csv, a row per sample, and open_choices.json: choices with ranges and reasons, rule, matrix
/// of claims and choices, region, chosen values.
void write_open_choices(const std::filesystem::path& dir, const OpenChoicesResult& result);

/// What the folder of such a study says of its triggers, for C11b.
/// @param quick  whether a quick study is wanted
/// @throws UserError where it is no such folder, is of the other kind, or was changed
TriggerSample read_trigger_sample(const std::filesystem::path& dir, bool quick);

}  // namespace slipfront::kammer2012
