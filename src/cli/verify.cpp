// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/print.hpp"
#include "results/archive.hpp"
#include "results/folder.hpp"
#include "run/checkpoint.hpp"
#include "verification/verification.hpp"

namespace slipfront::cli {
namespace {

struct VerifyArguments {
  std::vector<std::string> names;
  std::string dir;
  bool quick = false, list = false;
};

std::vector<verification::Verification> chosen(const std::vector<std::string>& names) {
  const auto all = verification::verifications();
  if (names.empty()) return {all.begin(), all.end()};
  std::vector<verification::Verification> some;
  for (const auto& name : names) {
    const auto found = std::ranges::find(all, name, &verification::Verification::name);
    if (found == all.end())
      throw UserError("slipfront: no verification named {}; see slipfront verify --list", name);
    some.push_back(*found);
  }
  return some;
}

/// The outcome of a problem, or what an interrupted verification has found of it.
/// @param folder  where outcomes are kept, or null
verification::Outcome outcome_of(const verification::Verification& problem, verification::Effort effort,
                                 const results::ResultFolder* folder) {
  if (folder == nullptr) return problem.run(effort);
  const auto file = folder->state() / (problem.name + ".bin");
  verification::Outcome outcome;
  if (files::is_there(file)) {
    results::InputArchive archive(file);
    archive(outcome);
    archive.close();
    return outcome;
  }
  outcome = problem.run(effort);
  verification::write_outcome(folder->unfinished(), problem, effort, outcome);
  results::OutputArchive archive(file);
  archive(outcome);
  archive.close();
  return outcome;
}

void run_verifications(const VerifyArguments& arguments) {
  const auto some = chosen(arguments.names);
  if (arguments.list) {
    for (const auto& v : some) print("{:<22}{}\n", v.name, v.title);
    return;
  }
  std::optional<results::ResultFolder> folder;
  if (!arguments.dir.empty()) {
    folder.emplace(arguments.dir, fmt::format("verify{} {} with {}", arguments.quick ? " --quick" : "",
                                              fmt::join(arguments.names, " "), run::program_identity()));
    folder->begin_or_resume();
    catch_interrupts();
  }
  const auto effort = arguments.quick ? verification::Effort::quick : verification::Effort::full;
  std::size_t n_checks = 0, n_failed = 0;
  for (const auto& v : some) {
    print("{}: {}\n", v.name, v.title);
    const auto outcome = outcome_of(v, effort, folder ? &*folder : nullptr);
    for (const auto& c : outcome.checks) {
      print("  {} {}\n           {:.8g}{}{}, expected {:.8g} +- {:.2g}\n", c.holds() ? "  ok  " : "FAILED",
            c.quantity, c.measured, c.unit.empty() ? "" : " ", c.unit, c.expected, c.tolerance);
      ++n_checks;
      n_failed += c.holds() ? 0 : 1;
    }
    std::fflush(stdout);
    if (interrupt_wanted())
      throw Interrupted(fmt::format("interrupted; solved problems are in {}: repeat the command to continue",
                                    folder->unfinished().string()));
  }
  if (folder) folder->publish(true);
  if (n_failed > 0) throw VerificationFailed(fmt::format("{} of {} checks do not hold", n_failed, n_checks));
  print("all {} checks hold\n", n_checks);
}

}  // namespace

void add_verify(CLI::App& app) {
  CLI::App* command = app.add_subcommand("verify", "Solve problems with known answers, compare");
  command->group("The program itself");
  auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("names", arguments->names, "Which ones; by default all")->type_name("NAME");
  command->add_option("-o,--output", arguments->dir, "Folder for the numbers and curves, a file each")
      ->type_name("DIR");
  command->add_flag("--quick", arguments->quick, "Coarser, in seconds");
  command->add_flag("--list", arguments->list, "Name them and stop");
  command->callback([arguments] { run_verifications(*arguments); });
}

}  // namespace slipfront::cli
