// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "input/case.hpp"
#include "run/batch.hpp"
#include "study/speeds.hpp"

namespace slipfront::study {

/// Told often how many runs are done; returns false to interrupt.
using StudyMonitor = std::function<bool(std::size_t done, std::size_t total)>;

/// What a study keeps of a run. One that blew up counts as one without fronts.
struct Run {
  MainFronts main;
  double node_updates_per_s = 0;  ///< per simulated time
  double stepping_wall_s = 0;
  motion::EventEnd end = motion::EventEnd::end_time;
  std::string blow_up;  ///< empty, or what happened
};

/// The case without the records that studies do not read.
input::Case for_study(input::Case config);

/// Runs all cases; the results do not depend on the number of threads.
/// @param kept  folder of the runs that are done, see run::FinishedRuns; empty for none
/// @throws UserError, Interrupted
std::vector<Run> run_cases(std::span<const input::Case> cases, int threads, const StudyMonitor& monitor,
                           const std::filesystem::path& kept = {});

run::Counts counts_of(std::span<const Run> runs);

}  // namespace slipfront::study
