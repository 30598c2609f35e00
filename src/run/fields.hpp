// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "input/case.hpp"
#include "processes/processes.hpp"
#include "results/folder.hpp"
#include "run/initial_state.hpp"

namespace slipfront::run {

/// Makes fields.vtkhdf of a run's snapshots, which its stream has written. Where the mesh can be made in rows
/// and all processes see the folder, each writes some of them.
/// @param bodies     of the run; of their meshes the grids are looked at
/// @param processes  of which this one leads; null for this one alone
/// @param note       receives the reason why the others do not help
/// @throws WriteError
void write_fields(const results::ResultFolder& folder, const input::Case& config, const InitialState& bodies,
                  Processes* processes, const std::function<void(const std::string&)>& note);

/// What another process does for it, after the command.
void carry_out_fields(Processes& processes, MessageBuffer& given);

}  // namespace slipfront::run
