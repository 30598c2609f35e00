// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "input/case.hpp"

namespace slipfront::kammer2012 {

/// A run of the reproduction.
struct NamedCase {
  std::string name;  ///< its folder below the output folder
  input::Case config;
};

/// The paper's four events: spontaneous, left, right (mu_k = 0.6) and spontaneous_mu_k_1.0. The same as the
/// files of papers/kammer2012. `quick`: elements of 2 mm.
std::vector<NamedCase> paper_cases(bool quick);

/// The paper's plate with both values of mu_k, loaded on until all nodes inside have slipped in one event:
/// mu_k_0.6, mu_k_1.0.
std::vector<NamedCase> sequences(bool quick);

/// One value of a study's parameter, with its runs.
struct StudyPoint {
  std::string value;             ///< as it stands in the case file
  double number = 0;             ///< NaN for words
  std::vector<NamedCase> cases;  ///< named by their event: spontaneous, left, right
};

/// Runs that differ from the paper's in one parameter.
struct Study {
  std::string name;
  std::string key;  ///< of the case file
  std::string why;
  std::vector<StudyPoint> points;
  bool own_reference = false;  ///< changes are counted from the first point instead of the paper's runs
};

/// All studies: friction (mu_k, alpha), mesh, time step, damping, corner, top edge, trigger, l*, loading
/// method. `quick`: the friction and mesh studies alone, with elements of 2 mm and, for the mesh, 4 and 2 mm.
std::vector<Study> studies(bool quick);

/// The studies that the scorecard reads.
inline constexpr std::array<std::string_view, 2> scorecard_studies = {"mu_k", "alpha"};

/// The runs of the scorecard at another value of a numerical parameter.
struct Variation {
  std::string name;  ///< its folder in variations/
  std::string key;   ///< of the case file
  double value = 0;
  std::vector<NamedCase> events;  ///< those of paper_cases
  std::vector<Study> studies;     ///< scorecard_studies
};

/// "mesh": elements of 1 mm; "step": half the sub-steps. Both are coarser than the paper's runs, so that they
/// take less time. `quick`: elements of 4 mm.
std::vector<Variation> variations(bool quick);

/// What becomes of the paper's events when friction responds to pressure with a delay: over the element size
/// without and with it, over the relaxation time and length. Changes are counted from each study's first
/// point: the finest mesh, the shortest delay.
std::vector<Study> regularised_studies();

}  // namespace slipfront::kammer2012
