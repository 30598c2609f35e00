// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <utility>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "run/needs.hpp"
#include "run/run.hpp"
#include "run/snapshot_plan.hpp"
#include "run/warnings.hpp"

namespace slipfront::cli {
namespace {

void validate(const CaseArguments& arguments) {
  const input::Case& config = arguments.read();
  run::RuptureOutlook rupture;
  try {
    rupture = run::rupture_outlook(config, run::check(config));
  } catch (const UserError& error) {
    throw arguments.with_place(error);
  }
  std::string text = fmt::format("{}: valid\n", arguments.file);
  auto notes = arguments.notes();
  for (auto& note : run::warnings_of_case(config)) notes.push_back(std::move(note));
  for (auto& doubt : rupture.doubts) notes.push_back(std::move(doubt));
  if (!rupture.unresolved.empty()) notes.push_back(rupture.unresolved);
  for (auto& note : run::snapshot_plan(config, run::estimated_size(config).step_s).notes)
    notes.push_back(std::move(note));
  for (const auto& note : notes) text += fmt::format("note: {}\n", note);
  print_output(text);
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "Check a case file without running it");
  const auto arguments = add_case_arguments(*command);
  command->callback([arguments] { validate(*arguments); });
}

}  // namespace slipfront::cli
