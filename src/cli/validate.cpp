// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <memory>
#include <utility>

#include "advice/needs.hpp"
#include "advice/notes.hpp"
#include "advice/outlook.hpp"
#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "setup/meshes.hpp"

namespace slipfront::cli {
namespace {

void validate(const CaseArguments& arguments, bool is_resolved) {
  const auto given = arguments.read();
  const auto problem = problem::make_problem(given.config());
  const auto rupture = given.placing_errors([&] {
    advice::require_memory_fits(problem);
    return advice::rupture_outlook(problem, setup::check(problem));
  });
  if (is_resolved) return print_output(input::to_toml(given.config()));
  std::string text = fmt::format("{}: valid\n", arguments.file);
  auto notes = given.notes();
  const double step_s = advice::estimated_size(problem).step_s;
  for (auto& note : advice::notes_of_case(problem, rupture, step_s)) notes.push_back(std::move(note));
  for (const auto& note : notes) text += fmt::format("note: {}\n", note);
  print_output(text);
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "Check a case file without running it");
  command->group("Cases");
  const auto arguments = add_case_arguments(*command);
  auto is_resolved = std::make_shared<bool>();
  command->add_flag("--resolved", *is_resolved, "Print the case with the value of every key");
  command->callback([arguments, is_resolved] { validate(*arguments, *is_resolved); });
}

}  // namespace slipfront::cli
