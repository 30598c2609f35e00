// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "run/run.hpp"

namespace slipfront::run {

/// The runs of a batch that are done, kept in a folder so that a batch that was interrupted goes on behind
/// them. What is kept of a run serves for the same case and the same program alone; histories and snapshots
/// are not kept.
class FinishedRuns {
 public:
  /// @param dir  made when the first run is kept
  explicit FinishedRuns(std::filesystem::path dir) : dir_(std::move(dir)) {}

  bool has(const Problem& problem) const;
  /// @return whether it was there and intact
  bool take(const Problem& problem, Result& result, InitialState& initial) const;
  /// @throws WriteError
  void keep(const Result& result, const InitialState& initial) const;

 private:
  /// What a kept run is known by: the program and the case.
  static std::string key_of(const Problem& problem);
  std::filesystem::path file_of(const Problem& problem) const;

  std::filesystem::path dir_;
};

}  // namespace slipfront::run
