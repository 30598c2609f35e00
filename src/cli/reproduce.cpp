// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/reproduce.hpp"

#include <fmt/core.h>

#include <optional>
#include <thread>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/log.hpp"
#include "cli/print.hpp"

namespace slipfront::cli {
namespace {

void print_report(const kammer2012::ReproduceReport& report, const std::string& dir) {
  print("\nScorecard of Kammer, Yastrebov, Spijker, Molinari (2012)\n\n");
  for (const auto& c : report.claims) {
    print("{:<7}{:<15}{} [{}]\n{:22}{}\n", c.id, verdict(c), c.claim, c.paper, "", c.measured);
    if (!c.second_test_of.empty())
      print("{:22}second test of {}{}: {}\n", "", c.second_test_of, c.counts ? ", counts in its place" : "",
            c.why);
    for (const auto& v : c.variations) {
      const std::string moves = describe(c, v);
      if (!moves.empty()) print("{:22}at {} = {:g} it moves by: {}\n", "", v.key, v.value, moves);
    }
  }
  print("\n{}\n\n", kammer2012::summary(report.claims));
  for (const auto& t : report.timings) print("{:8.2f} s  {}\n", t.wall_s, t.part);
  print_ends(report.counts);
  for (const auto& warning : report.warnings) print("warning: {}\n", warning);
  print("results: {}\n", dir);
}

}  // namespace

void add_reproduce(CLI::App& app) {
  CLI::App* command = app.add_subcommand("reproduce", "Run everything behind the paper and test its claims");
  command->group("Studies");
  auto options = std::make_shared<kammer2012::ReproduceOptions>();
  auto dir = std::make_shared<std::string>("results");
  auto experiment = std::make_shared<std::string>();
  auto open_choices = std::make_shared<std::string>();
  command->add_option("-o,--output", *dir, "Folder for the results")->type_name("DIR")->capture_default_str();
  command->add_flag("--quick", options->quick,
                    "Elements of 2 mm and fewer studies: a second instead of half a minute");
  command
      ->add_flag("--regularised", options->regularised,
                 "Studies of friction that responds to pressure with a delay, over the element size and the "
                 "delay, in place of the paper's")
      ->excludes("--quick");
  command
      ->add_flag(
          "--sensitivity", options->sensitivity,
          "Also with elements of 1 mm and with half the sub-steps: how far the scorecard's figures move")
      ->excludes("--regularised");
  command->add_flag("--overwrite", options->overwrite, "Replace the results that the folder already holds");
  command
      ->add_option("--experiment", *experiment,
                   "CSV of measured points for claim E1: static_ratio, v_over_c_L (or v_m_per_s)")
      ->type_name("FILE")
      ->check(not_empty());
  command
      ->add_option("--open-choices", *open_choices,
                   "Folder of slipfront study open-choices, for claim C11b: the share of its triggers")
      ->type_name("DIR")
      ->check(not_empty());
  options->threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command->add_option("--threads", options->threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([options, dir, experiment, open_choices] {
    options->dir = *dir;
    options->experiment = *experiment;
    options->open_choices = *open_choices;
    catch_interrupts();
    std::optional<cli::Progress> progress;
    const auto report =
        kammer2012::reproduce(*options, [&](std::size_t done, std::size_t total, const std::string&) {
          if (!progress) progress.emplace("reproduce", static_cast<std::int64_t>(total), false, "runs");
          progress->update(static_cast<std::int64_t>(done));
          return !interrupt_wanted();
        });
    progress.reset();
    print_report(report, *dir);
  });
}

}  // namespace slipfront::cli
