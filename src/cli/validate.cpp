// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "run/run.hpp"
#include "run/warnings.hpp"

namespace slipfront::cli {
namespace {

void validate(const CaseArguments& arguments) {
  const io::Case& config = arguments.read();
  try {
    run::check(config);
  } catch (const UserError& error) {
    throw UserError(arguments.with_place(error.what()));
  }
  std::string text = fmt::format("{}: valid\n", arguments.file);
  for (const auto& warning : run::warnings_of_case(config)) text += fmt::format("note: {}\n", warning);
  print_output(text);
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "Check a case file without running it");
  const auto arguments = add_case_arguments(*command);
  command->callback([arguments] { validate(*arguments); });
}

}  // namespace slipfront::cli
