// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/experiment.hpp"
#include "paper/outcome.hpp"

namespace slipfront::paper {

/// A claim of the paper against this program's figure.
struct Claim {
  std::string id;
  std::string claim;
  std::string paper;          ///< where it stands
  std::string measured;       ///< our figure
  std::optional<bool> holds;  ///< none: not tested
  std::string how;            ///< the test
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

}  // namespace slipfront::paper
