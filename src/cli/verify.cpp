// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "io/results.hpp"
#include "verify/verification.hpp"

namespace slipfront::cli {
namespace {

struct VerifyArguments {
  std::vector<std::string> names;
  std::string dir;
  bool quick = false, list = false;
};

std::vector<verify::Verification> chosen(const std::vector<std::string>& names) {
  const auto all = verify::verifications();
  if (names.empty()) return {all.begin(), all.end()};
  std::vector<verify::Verification> some;
  for (const auto& name : names) {
    const auto found = std::ranges::find(all, name, &verify::Verification::name);
    if (found == all.end())
      throw UserError("slipfront: no verification named {}; see slipfront verify --list", name);
    some.push_back(*found);
  }
  return some;
}

void run_verifications(const VerifyArguments& arguments) {
  const auto some = chosen(arguments.names);
  if (arguments.list) {
    for (const auto& v : some) fmt::print("{:<22}{}\n", v.name, v.title);
    return;
  }
  if (!arguments.dir.empty()) std::filesystem::create_directories(arguments.dir);
  const auto effort = arguments.quick ? verify::Effort::quick : verify::Effort::full;
  std::size_t n_checks = 0, n_failed = 0;
  for (const auto& v : some) {
    fmt::print("{}: {}\n", v.name, v.title);
    const auto outcome = v.run(effort);
    for (const auto& c : outcome.checks) {
      fmt::print("  {} {}\n           {:.8g}{}{}, expected {:.8g} +- {:.2g}\n",
                 c.holds() ? "  ok  " : "FAILED", c.quantity, c.measured, c.unit.empty() ? "" : " ", c.unit,
                 c.expected, c.tolerance);
      ++n_checks;
      n_failed += c.holds() ? 0 : 1;
    }
    std::fflush(stdout);
    if (!arguments.dir.empty()) verify::write_outcome(arguments.dir, v, effort, outcome);
  }
  if (n_failed > 0) throw VerificationFailed(fmt::format("{} of {} checks do not hold", n_failed, n_checks));
  fmt::print("all {} checks hold\n", n_checks);
}

}  // namespace

void add_verify(CLI::App& app) {
  CLI::App* command = app.add_subcommand("verify", "Solve problems with known answers, compare");
  auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("names", arguments->names, "Which ones; by default all")->type_name("NAME");
  command->add_option("-o,--output", arguments->dir, "Folder for the numbers and curves, a file each")
      ->type_name("DIR");
  command->add_flag("--quick", arguments->quick, "Coarser, in seconds");
  command->add_flag("--list", arguments->list, "Name them and stop");
  command->callback([arguments] { run_verifications(*arguments); });
}

}  // namespace slipfront::cli
