// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "problem/problem.hpp"
#include "processes/processes.hpp"

namespace slipfront::run {

/// Finishes the fields.vtkhdf of a run with snapshots, which its stream has written. Where the mesh can be
/// made in rows and all ranks see the folder, each writes some of them. Collective.
/// @param dir, state, note  on rank 0: of its files and of what going on needs; receives the reason why the
/// others do not help
/// @throws WriteError; FailedElsewhere on the ranks that have not failed
void write_fields(const std::filesystem::path& dir, const std::filesystem::path& state,
                  const Problem& problem, Processes& processes,
                  const std::function<void(const std::string&)>& note);

}  // namespace slipfront::run
