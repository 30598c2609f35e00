// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "advice/outlook.hpp"
#include "base/diagnostic.hpp"
#include "base/error.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"

namespace slipfront::advice {

/// What is allowed in a case but is hardly meant, decides physics unasked, or keeps it from a rupture, a line
/// each.
/// @param step_s  of the run, or as estimated_size gives it
Diagnostics notes_of_case(const Problem& problem, const RuptureOutlook& rupture, double step_s);

/// Those before the statics are solved. @param processes  the ranks that share the run
/// @throws UserError as require_memory_fits and setup::check
Diagnostics notes_of_case(const Problem& problem, const Processes& processes = one_process());

/// Why a sequence under a law with a state, whose run needs none, has no static state to predict from.
std::string no_static_state(const UserError& error);

}  // namespace slipfront::advice
