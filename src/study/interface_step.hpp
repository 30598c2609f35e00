// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "input/case.hpp"
#include "study/runs.hpp"

namespace slipfront::study {

struct InterfaceStepOptions {
  std::vector<int> rows = {1, 2, 4, 8};
  std::vector<int> substeps = {2, 4, 9, 18, 36};
  double station_spacing_m = 2e-3;
  double tolerance = 0.01;          ///< of the 90th percentile of the relative errors
  int threads = 1;                  ///< runs side by side; more than one falsifies the times, nothing else
  std::filesystem::path kept = {};  ///< folder of the runs that are done, see run_cases
};

/// A way of stepping, its cost, and how far its speeds are from the limit of small steps.
struct Stepping {
  enum class Kind {
    plain,         ///< the whole plate with one step
    layer,         ///< rows of cells at the interface sub-cycled
    extrapolated,  ///< 2 V(2 n) - V(n) of two layers' runs, linear in the sub-step
  };
  Kind kind = Kind::plain;
  double step_factor = 0;
  int rows = 0, substeps = 1;
  double cost = 0;    ///< node updates over those of the case's step_factor with one step
  double time_s = 0;  ///< of the steps, on this machine
  double median_error = 0, p90_error = 0;
  int n_stations = 0;  ///< where both have a speed

  std::vector<double> v_tip_m_per_s = {};  ///< [stations]
};

struct InterfaceStep {
  InterfaceStepOptions options;
  std::vector<Place> stations;        ///< of the reference, where a limit was seen
  std::vector<double> v_tip_m_per_s;  ///< at the limit. [stations]
  double median_order = 0;            ///< with which the reference approaches it
  std::vector<Stepping> all;
  int chosen = -1;  ///< the cheapest within the tolerance, without extrapolation; -1: none
  std::vector<std::string> warnings;
  run::Counts counts;
};

/// The reference is the whole plate with the case's step_factor over 16, 32 and 64, extrapolated to 0 at each
/// station (sequence.hpp); compared with it are the plain scheme at the step_factor over 1, 2, 4, 8 and all
/// pairs of rows and sub-steps that fit.
/// @throws UserError, Interrupted
InterfaceStep study_interface_step(const input::Case& config, const InterfaceStepOptions& options,
                                   const StudyMonitor& monitor);

/// Place in `all` of the cheapest way within the tolerance at nine tenths of the stations or more, without
/// extrapolation; -1: none.
int cheapest(const InterfaceStep& result);

/// interface_step.csv (a row per way of stepping), interface_step.json, and chosen.toml, the case with the
/// chosen rows and sub-steps, where one is within the tolerance.
void write_interface_step(const std::filesystem::path& dir, const input::Case& config,
                          const InterfaceStep& result);

}  // namespace slipfront::study
