// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/experiment.hpp"
#include "paper/outcome.hpp"

namespace slipfront::paper {

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
};

/// The runs of one study.
struct StudyOutcome {
  Study study;
  std::vector<std::vector<Outcome>> outcomes;  ///< [points][cases]
};

/// All runs of a reproduction.
struct Reproduction {
  Outcome spontaneous, left, right, spontaneous_mu_k_1;
  std::vector<StudyOutcome> studies;
  std::optional<io::Experiment> experiment;  ///< measured points, where the user has a file of them
};

/// Tests every claim; each row says how. Rows whose id ends in + are further tests beside the first one.
std::vector<Claim> scorecard(const Reproduction& runs);

/// Tells each claim by how much its figures differ from those of the same claim in the variation's runs. Rows
/// are matched by id, figures by name.
void add_variation(std::vector<Claim>& claims, const Variation& variation, std::span<const Claim> varied);

/// How far a row moves, for people: the differences with their units, and the verdict where it is another.
std::string describe(const Claim& claim, const ClaimVariation& variation);

}  // namespace slipfront::paper
