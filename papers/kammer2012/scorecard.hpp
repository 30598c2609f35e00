// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "input/experiment.hpp"
#include "papers/kammer2012/outcome.hpp"

namespace slipfront::kammer2012 {

/// A number that a row states.
struct Figure {
  std::string name;  ///< distinct within its row
  double value = 0;  ///< in the unit given; NaN where undefined
  std::string unit;  ///< m/s, mm, %, c_L; empty: none
};

/// A row at another value of a numerical parameter.
struct ClaimVariation {
  std::string name;  ///< of the Variation
  std::string key;   ///< of the case file
  double value = 0;
  std::string measured;             ///< there
  std::optional<bool> holds;        ///< there
  std::vector<double> differences;  ///< |difference| of each figure of the row; NaN where undefined
};

/// A claim of the paper against this program's figure.
struct Claim {
  std::string id;
  std::string claim;
  std::string paper;            ///< where it stands
  std::string measured;         ///< our figure
  std::optional<bool> holds;    ///< none: not tested
  std::string how;              ///< the test
  std::vector<Figure> figures;  ///< the numbers of `measured`; none where not tested
  std::vector<ClaimVariation> variations;
  std::string second_test_of = {};  ///< id of the row whose test this one corrects; empty: no second test
  std::string why = {};             ///< that row's test misjudges the claim; only with second_test_of
  bool used_to_choose = false;      ///< the paper's cases were chosen so that it holds, see open_choices.hpp
  bool counts = true;               ///< whether the verdict is the claim's, see choose_verdicts
};

// What tests of claims ask for where more than one test does.
inline constexpr double min_correlation = 0.8;  ///< rank correlation that is a tendency
inline constexpr double most_left_over_others =
    0.6;  ///< C11: left-triggered maximum of speed over the others'
inline constexpr double wanted_share_in_band = 0.8;   ///< C18: of the points, in the paper's band
inline constexpr double wanted_share_near_end = 0.7;  ///< C19: of the points outside, before a front's end

/// The runs of one study.
struct StudyOutcome {
  Study study;
  std::vector<std::vector<Outcome>> outcomes;  ///< [points][cases]
};

/// How many of the triggers that were sampled within the ranges the paper leaves open let C1 to C10 hold and
/// keep the left-triggered maximum at most at 60 % of the other two.
struct TriggerSample {
  int n_triggers = 0;
  int n_holding = 0;
};

/// The plate loaded on until all of it has slipped in one event.
struct LoadedOn {
  double mu_s = 0, mu_k = 0;
  double largest_friction = 0;  ///< F_S/F_N
  std::size_t n_events = 0;
};

/// All runs of a reproduction.
struct Reproduction {
  Outcome spontaneous, left, right, spontaneous_mu_k_1;
  std::vector<StudyOutcome> studies;
  std::optional<input::Experiment> experiment;  ///< measured points, where the user has a file of them
  std::optional<TriggerSample> triggers = {};   ///< where the open choices were studied
  std::vector<LoadedOn> loaded_on = {};         ///< of both mu_k, where all of it slipped; else none
};

/// Tests every claim; each row says how. Rows whose id ends in + are further tests beside the first one, rows
/// that end in b second tests; second tests (C21+ is one, too) say why the first one misjudges its claim.
std::vector<Claim> scorecard(const Reproduction& runs);

/// Tells each claim by how much its figures differ from those of the same claim in the variation's runs. Rows
/// are matched by id, figures by name.
void add_variation(std::vector<Claim>& claims, const Variation& variation, std::span<const Claim> varied);

/// How many of the paper's claims hold, do not, and are not tested: by the rows that count, and by the first
/// tests alone. For people. Without the comparison with experiments (E1).
std::string summary(std::span<const Claim> claims);

/// "holds", "does not hold", "not tested", or "used to choose" where holding confirms nothing.
std::string_view verdict(const Claim& claim);

/// How far a row moves, for people: the differences with their units, and the verdict where it is another.
std::string describe(const Claim& claim, const ClaimVariation& variation);

}  // namespace slipfront::kammer2012
