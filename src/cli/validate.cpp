// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "run/run.hpp"

namespace slipfront::cli {
namespace {

void validate(const CaseArguments& arguments) {
  const io::Case config = arguments.read();
  try {
    run::check(config);
  } catch (const UserError& error) {
    throw UserError(arguments.with_place(error.what()));
  }
  fmt::print("{}: valid\n", arguments.file);
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "Check a case file without running it");
  const auto arguments = add_case_arguments(*command);
  command->callback([arguments] { validate(*arguments); });
}

}  // namespace slipfront::cli
