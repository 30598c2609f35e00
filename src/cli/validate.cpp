// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <memory>
#include <utility>

#include "advice/notes.hpp"
#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/words.hpp"

namespace slipfront::cli {
namespace {

void validate(const CaseArguments& arguments, bool is_resolved) {
  const auto given = arguments.read();
  const auto problem = problem::make_problem(given.config());
  const auto notes = given.placing_errors([&] { return advice::notes_of_case(problem); });
  arguments.require_none_refused(notes);
  if (is_resolved) return print_output(input::to_toml(given.config()));
  print_output(fmt::format("{}: valid\n{}", arguments.file, lines_of(given, notes)));
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "Check a case file without running it");
  command->group("Cases");
  const auto arguments = add_case_arguments(*command);
  add_strict(*command, *arguments);
  auto is_resolved = std::make_shared<bool>();
  command->add_flag("--resolved", *is_resolved, "Print the case with the value of every key");
  command->callback([arguments, is_resolved] { validate(*arguments, *is_resolved); });
}

}  // namespace slipfront::cli
