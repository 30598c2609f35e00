// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "files/files.hpp"
#include "setup/initial_state.hpp"

namespace slipfront::run {

/// Initial states in a folder that runs share: what one has solved, another takes, if it is the same program
/// and the cases have the same initial_state_key. Several processes may use the folder at once; of two that
/// solve the same state at the same time each does so for itself.
class SharedStates {
 public:
  /// @param dir  made where it is missing
  /// @throws UserError where it cannot be used
  explicit SharedStates(std::filesystem::path dir);

  /// The saved state of a case, with its mesh, if there is one. `note` receives a message for a file that is
  /// damaged or of another case.
  std::optional<InitialState> take(const Problem& problem,
                                   const std::function<void(const std::string&)>& note) const;
  /// Complete under its name, or not there.
  /// @throws WriteError
  void keep(const Problem& problem, InitialState& initial) const;

 private:
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path dir_;
};

}  // namespace slipfront::run
