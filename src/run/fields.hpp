// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "results/folder.hpp"

namespace slipfront::run {

/// Finishes the fields.vtkhdf of a run with snapshots, which its stream has written. Where the mesh can be
/// made in rows and all ranks see the folder, each writes some of them. Collective.
/// @param folder, note  on rank 0: of the run; receives the reason why the others do not help
/// @throws WriteError; FailedElsewhere on the ranks that have not failed
void write_fields(const results::ResultFolder* folder, const Problem& problem, Processes& processes,
                  const std::function<void(const std::string&)>& note);

}  // namespace slipfront::run
