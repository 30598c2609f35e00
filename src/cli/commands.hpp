// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "cli/program.hpp"
#include "input/schema.hpp"
#include "processes/processes.hpp"

/// The subcommands, one file each. `add_<name>` registers its options and, as its callback, its work; the
/// work reports failure by the exceptions of base/error.hpp, which main turns into one line and an exit code.
namespace slipfront::cli {

/// @param processes  that share a run with this one; null where it is alone
void add_run(CLI::App& app, Processes& processes);
void add_info(CLI::App& app);
void add_fracture(CLI::App& app);
void add_bench(CLI::App& app);
void add_validate(CLI::App& app);
void add_new(CLI::App& app);
void add_keys(CLI::App& app);
/// Hidden: prints what the installation takes from the program. @param program  with all its subcommands
void add_page(CLI::App& app, const Program& program);

/// What --version prints: the version line and how the program was built.
std::string version_text();

/// The arguments of every subcommand that works on a case: CASE.toml [--set key=value]...
struct CaseArguments {
  std::string file;
  std::vector<std::string> set;
  bool strict = false;

  input::CaseFile read() const;
  /// @throws UserError where the command is strict and a note is of units or resolution
  void require_none_refused(const Diagnostics& notes) const;
};

/// Adds them to a subcommand; filled when the command line is parsed. The subcommand's callback must keep the
/// result alive by capturing it.
std::shared_ptr<CaseArguments> add_case_arguments(CLI::App& command);
/// Adds --strict to a subcommand that tells the notes of a case.
void add_strict(CLI::App& command, CaseArguments& arguments);

}  // namespace slipfront::cli
