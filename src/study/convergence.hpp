// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "fronts/front.hpp"
#include "input/case.hpp"
#include "study/runs.hpp"
#include "study/sequence.hpp"

namespace slipfront::study {

struct ConvergenceOptions {
  std::vector<double> element_sizes_m;  ///< empty: twice, once and half the case's
  double station_spacing_m = 2e-3;
  double tolerance = 0.02;          ///< relative error that counts as converged
  int threads = 1;                  ///< runs side by side; each result is the same for any number
  std::filesystem::path kept = {};  ///< folder of the runs that are done, see run_cases
};

/// A run of a sequence.
struct Member {
  double value = 0;      ///< of the parameter
  double step_size = 0;  ///< q of sequence.hpp: falls towards the limit; 0 at the limit itself
  input::Case config;
  std::size_t run = 0;  ///< index of its run; sequences share runs
};

/// The case with one numerical parameter changed.
struct Plan {
  std::string parameter;  ///< key of the case file
  double case_value = 0;
  std::vector<Member> members;           ///< in the order of falling step size; a limit itself comes last
  std::array<std::size_t, 3> last = {};  ///< the last three with a step size above 0
  std::size_t own = 0;                   ///< the case's own
};

/// Sequences over plate.element_size_m, over time.interface_substeps (x 1/2, 1, 2, 4; time.step_factor x 1,
/// 1/2, 1/4 where nothing is sub-cycled) and over material.stiffness_damping_s (x 2, 1, 1/2, 0; none where
/// the case has no damping). fronts.l_star_m is raised to the largest element, so that all speeds are taken
/// over the same length.
/// @throws UserError where the element sizes are fewer than three, or leave out the case's.
std::vector<Plan> plan_convergence(const input::Case& config, const ConvergenceOptions& options);

/// Speeds at a station, for the members of a sequence.
struct Station {
  double x_m = 0;
  int direction = 0;                  ///< of the front, +1 or -1 along x
  std::vector<double> v_tip_m_per_s;  ///< [members]; NaN where the front does not pass or has no speed there
  Limit limit;
  std::vector<double> error_m_per_s;  ///< [members], each against the limit: error_of
};

struct Sequence {
  Plan plan;
  std::vector<Station> stations;  ///< those where the case itself has a speed
  Summary both, left, right;      ///< all fronts; direction -1; direction +1
  double relative_difference_at_limit =
      undefined;  ///< median |extrapolated - computed at q = 0| / case's own
};

struct Convergence {
  ConvergenceOptions options;
  double l_star_m = 0;
  std::vector<Sequence> sequences;
  std::vector<std::string> warnings;
  run::Counts counts;
};

/// Runs all sequences and compares V_tip of the main fronts, the longest in each direction, at stations x.
/// V_tip over l* is linear in x between the nodes of a front. Left out are stations within nucleation_m of
/// the start of the case's own front, where the speed diverges, and within a trigger zone and its margin. The
/// run that blew up counts as one without fronts.
/// @throws UserError, Interrupted
Convergence study_convergence(const input::Case& config, const ConvergenceOptions& options,
                              const StudyMonitor& monitor);

/// convergence.csv (a row per sequence, station and value) and convergence.json (verdicts).
void write_convergence(const std::filesystem::path& dir, const input::Case& config,
                       const Convergence& result);

}  // namespace slipfront::study
