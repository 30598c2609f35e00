// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/program.hpp"

/// Subcommands that are modules of the Python package slipfront. The program becomes the interpreter (exec),
/// so that signals and exit codes are the module's own; only the module knows its arguments.
namespace slipfront::cli {

/// Registers them for the help, behind the groups that some belong to. Their work is `become_python_command`,
/// before the command line is parsed.
void add_python_commands(CLI::App& app);

/// Does not return where the first arguments name such a subcommand: they and all behind go to `python -m
/// slipfront NAME`. The interpreter is $SLIPFRONT_PYTHON; else .venv/bin/python of the source tree that the
/// program was built in; else python3 of the PATH. In a source tree the package is the tree's own.
/// @throws UserError where no interpreter can be started
void become_python_command(int argc, char** argv);

}  // namespace slipfront::cli
