// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "problem/problem.hpp"
#include "processes/processes.hpp"

// The case that a run's folder has, and that its ranks tell each other.
namespace slipfront::problem {

inline constexpr const char* case_file = "case.resolved.toml";
/// The tables of prescribed tractions and of friction as they were read, where there are any.
inline constexpr const char* prestress_file = "prestress.csv";
inline constexpr const char* friction_file = "friction.csv";

/// The texts of a case.
Source source_of(const input::Case& config);

/// Writes them, the case last, for those who go on with the work. @throws WriteError
void write_case(const std::filesystem::path& dir, const Source& source);
/// The problem of a folder's case. @throws UserError as input::read_case
Problem read_problem(const std::filesystem::path& dir);

/// @param name  of what is wanted, for messages
/// @throws UserError where two cases differ in their keys
void require_same_keys(const Source& wanted, const Source& begun, const std::string& name);
/// @throws UserError where they differ in their keys, or in the contents of their tables
void require_same_case(const Source& wanted, const Source& begun);

/// Whether a problem is a sequence that goes on where another one has ended: the two differ at most in what
/// ends them, which comes no sooner, and its loading begins as that of the other.
bool is_continuation(const Problem& problem, const Problem& done);

/// All of a problem's case but the prescribed tractions, which rank 0 alone needs.
void pack_case(const Problem& problem, MessageBuffer& to);
Problem unpack_case(MessageBuffer& from);

}  // namespace slipfront::problem
