// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "papers/kammer2012/scorecard.hpp"
#include "run/batch.hpp"

namespace slipfront::kammer2012 {

struct ReproduceOptions {
  std::filesystem::path dir;
  bool quick = false;                  ///< elements of 2 mm, friction and mesh studies alone
  bool regularised = false;            ///< regularised_studies in place of the paper's
  bool sensitivity = false;            ///< add the variations to the scorecard
  bool overwrite = false;              ///< replace the results of an earlier reproduction in `dir`
  std::filesystem::path experiment;    ///< CSV file of measured points (input::read_experiment); empty: none
  std::filesystem::path open_choices;  ///< folder of a study of the open choices, for C11b; empty: none
  int threads = 2;                     ///< runs side by side; each result is the same for any number
};

/// Wall time of one part of the reproduction.
struct Timing {
  std::string part;
  double wall_s = 0;
};

struct ReproduceReport {
  std::vector<Claim> claims;
  std::vector<Timing> timings;
  std::vector<std::string> warnings;
  run::Counts counts;
};

/// Told of every run that is done; returns false to interrupt the reproduction.
using RunMonitor = std::function<bool(std::size_t done, std::size_t total, const std::string& name)>;

/// Runs everything behind the paper: the four events, the studies, the analysis, and the variations where
/// wanted. Writes a folder per run, scorecard.json, analysis.json and timings.json.
/// @pre not both `regularised` and `sensitivity`: the scorecard's studies are those of the paper's friction
/// @throws UserError for the folder; BlowUp where one of the four events blew up (all else is written first);
/// Interrupted.
ReproduceReport reproduce(const ReproduceOptions& options, const RunMonitor& monitor);

}  // namespace slipfront::kammer2012
