// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fronts/fit.hpp"
#include "input/case.hpp"
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
  enum class Between { nothing, linear, logarithmic } between = Between::nothing;  ///< values between levels
  double standard = 0;  ///< about which the others are varied
  std::function<void(input::Case&, double)> set;
  /// The choice whose value decides whether this one counts, and the words with which it does; none: always.
  std::string decided_by = {};
  std::vector<std::string> counts_with = {};

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
    standard,       ///< the choices of the paper's cases of this program
    one_at_a_time,  ///< one other level of one choice
    pairs,          ///< two of them
    triggers,       ///< space-filling over the choices of the edge triggers
    all,            ///< space-filling over all choices
    left_trigger,   ///< space-filling over strong left triggers, two digits each
    about_chosen,   ///< one other level of one choice, about the chosen sample
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

/// All but those about the chosen one.
std::vector<Sample> samples(const std::vector<OpenChoice>& choices, bool quick);
/// One other level of one choice at a time, about a sample.
std::vector<Sample> samples_about(const std::vector<OpenChoice>& choices, Sample::Set set,
                                  const std::vector<double>& values);

/// What comes out for one sample.
struct SampleOutcome {
  Sample sample;
  std::vector<std::optional<bool>> holds;                   ///< [claims]
  double left_max = 0, right_max = 0, spontaneous_max = 0;  ///< V_tip/c_L, see C11
  std::optional<fronts::ExponentialFit> fit;  ///< of the main fronts without their tails, see C18b
  double share_in_band = 0;                   ///< of their points within the paper's band
  /// Median relative spread between them at equal energy rise, t_d/p_d and t_s/p_s, see C18c.
  double spread_at_energy_rise = 0, spread_at_dynamic_ratio = 0, spread_at_static_ratio = 0;
  double difference_of_kinds = 0;  ///< V_tip/c_L, see C21+; NaN where it was not tested
  /// Largest distance of a, b and c from the paper's in units of our interval on that side: at most 1 where
  /// the paper's lie inside our intervals; NaN without a fit.
  double distance = 0;
  bool is_constrained = false;    ///< all constraining_claims hold
  bool agrees_with_fig6 = false;  ///< so do (a) and (b) of C18b
  double extremity = 0;  ///< largest distance of a choice in use from the standard, in shares of its range
};

/// Claims that decide which choices are possible: statements about the fronts that a choice can turn. The
/// paper's conclusions, C14 to C22, are none; of C18b the two numbers that the text gives decide, too.
const std::vector<std::string>& constraining_claims();

/// The outcomes whose constraining claims hold; where some of them agree with Fig. 6, these.
std::vector<std::size_t> region_of(const std::vector<SampleOutcome>& outcomes);

/// The first of the least extreme outcomes of the region; -1: it is empty.
int min_extreme(const std::vector<SampleOutcome>& outcomes);

struct OpenChoicesResult {
  bool quick = false;
  std::vector<OpenChoice> choices;
  std::vector<std::string> claims;      ///< their ids
  std::vector<SampleOutcome> outcomes;  ///< the standard one first
  std::vector<std::size_t> region;
  int chosen = -1;  ///< min_extreme, before the samples about it were added
  /// C11b: of the trigger samples, those for which C1 to C11 hold.
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
};

/// For the samples whose constraining claims hold and that agree with Fig. 6; for all whose constraining
/// claims hold; and for those of the former with the left trigger held and taken away.
std::vector<Evidence> evidence(const OpenChoicesResult& result);

/// Runs the four events of every sample (equal ones once) and judges them; those for which all constraining
/// claims hold by the kinds of slip over mu_k (C20, C21), too.
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
