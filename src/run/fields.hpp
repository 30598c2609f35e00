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
/// and all ranks see the folder, each writes some of them. Collective.
/// @param folder, bodies, note  on rank 0: of the run; of its meshes the grids are looked at; receives the
///                              reason why the others do not help
/// @throws WriteError; FailedElsewhere on the ranks that have not failed
void write_fields(const results::ResultFolder* folder, const input::Case& config, const InitialState& bodies,
                  Processes& processes, const std::function<void(const std::string&)>& note);

}  // namespace slipfront::run
