// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/version.hpp"
#include "cli/interrupt.hpp"
#include "cli/print.hpp"
#include "cli/program.hpp"
#include "files/files.hpp"
#include "results/archive.hpp"
#include "results/folder.hpp"
#include "run/checkpoint.hpp"
#include "verification/verification.hpp"

namespace slipfront::verification {
namespace {

struct Arguments {
  std::vector<std::string> names;
  std::string dir;
  bool quick = false, list = false;
};

std::vector<Verification> chosen(const std::vector<std::string>& names) {
  const auto all = verifications();
  if (names.empty()) return {all.begin(), all.end()};
  std::vector<Verification> some;
  for (const auto& name : names) {
    const auto found = std::ranges::find(all, name, &Verification::name);
    if (found == all.end())
      throw UserError("slipfront-verify: no problem {}; see slipfront-verify --list", name);
    some.push_back(*found);
  }
  return some;
}

/// dir/<name>.json: the checks and the charts' curves.
void write_outcome(const std::filesystem::path& dir, const Verification& problem, Effort effort,
                   const Outcome& outcome) {
  using nlohmann::ordered_json;
  ordered_json checks = ordered_json::array(), charts = ordered_json::array();
  for (const auto& c : outcome.checks)
    checks.push_back({{"quantity", c.quantity},
                      {"unit", c.unit},
                      {"measured", c.measured},
                      {"expected", c.expected},
                      {"tolerance", c.tolerance},
                      {"reason", c.reason},
                      {"holds", c.holds()}});
  for (const auto& chart : outcome.charts) {
    ordered_json curves = ordered_json::array();
    for (const auto& c : chart.curves)
      curves.push_back({{"label", c.label},
                        {"kind", c.kind == Curve::Kind::theory ? "theory" : "program"},
                        {"x", c.x},
                        {"y", c.y}});
    charts.push_back({{"x_label", chart.x_label},
                      {"y_label", chart.y_label},
                      {"log_x", chart.log_x},
                      {"log_y", chart.log_y},
                      {"curves", curves}});
  }
  const ordered_json all = {
      {"version", version_line()}, {"name", problem.name},
      {"title", problem.title},    {"effort", effort == Effort::quick ? "quick" : "full"},
      {"holds", outcome.holds()},  {"checks", checks},
      {"charts", charts}};
  files::write_text(dir / (problem.name + ".json"), all.dump(1) + "\n");
}

/// The outcome of a problem, or what an interrupted verification has found of it.
/// @param folder  where outcomes are kept, or null
Outcome outcome_of(const Verification& problem, Effort effort, const results::ResultFolder* folder) {
  if (folder == nullptr) return problem.run(effort);
  const auto file = folder->state() / (problem.name + ".bin");
  Outcome outcome;
  if (files::is_there(file)) {
    results::InputArchive archive(file);
    archive(outcome);
    archive.close();
    return outcome;
  }
  outcome = problem.run(effort);
  write_outcome(folder->unfinished(), problem, effort, outcome);
  results::OutputArchive archive(file);
  archive(outcome);
  archive.close();
  return outcome;
}

/// @return the exit code
int solve(const Arguments& arguments) {
  const auto some = chosen(arguments.names);
  if (arguments.list) {
    for (const auto& v : some) cli::print("{:<26}{}\n", v.name, v.title);
    return 0;
  }
  std::optional<results::ResultFolder> folder;
  if (!arguments.dir.empty()) {
    folder.emplace(arguments.dir, fmt::format("verify{} {} with {}", arguments.quick ? " --quick" : "",
                                              fmt::join(arguments.names, " "), run::program_identity()));
    folder->begin_or_resume();
    cli::catch_interrupts();
  }
  const auto effort = arguments.quick ? Effort::quick : Effort::full;
  std::size_t n_checks = 0, n_failed = 0;
  for (const auto& v : some) {
    cli::print("{}: {}\n", v.name, v.title);
    const auto outcome = outcome_of(v, effort, folder ? &*folder : nullptr);
    for (const auto& c : outcome.checks) {
      cli::print("  {} {}\n           {:.8g}{}{}, expected {:.8g} +- {:.2g}\n",
                 c.holds() ? "  ok  " : "FAILED", c.quantity, c.measured, c.unit.empty() ? "" : " ", c.unit,
                 c.expected, c.tolerance);
      ++n_checks;
      n_failed += c.holds() ? 0 : 1;
    }
    std::fflush(stdout);
    if (cli::interrupt_wanted())
      throw Interrupted(fmt::format("interrupted; solved problems are in {}: repeat the command to continue",
                                    folder->unfinished().string()));
  }
  if (folder) folder->publish(true);
  if (n_failed == 0) {
    cli::print("all {} checks hold\n", n_checks);
    return 0;
  }
  fmt::print(stderr, "slipfront-verify: {} of {} checks do not hold\n", n_failed, n_checks);
  return 1;
}

int run_program(int argc, char** argv) {
  cli::Program program("slipfront-verify", "Solve problems with known answers, compare");
  auto& app = program.app();
  Arguments arguments;
  app.add_option("names", arguments.names, "Which ones; by default all")->type_name("NAME");
  app.add_option("-o,--output", arguments.dir, "Folder for the numbers and curves, a file each")
      ->type_name("DIR");
  app.add_flag("--quick", arguments.quick, "Coarser, in seconds");
  app.add_flag("--list", arguments.list, "Name them and stop");
  int code = 0;
  app.callback([&] { code = solve(arguments); });
  program.run(argc, argv);
  return code;
}

}  // namespace
}  // namespace slipfront::verification

int main(int argc, char** argv) {
  return slipfront::cli::exit_code_of([&] { return slipfront::verification::run_program(argc, argv); });
}
