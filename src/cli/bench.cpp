// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/version.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/print.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::cli {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

/// With what was measured and where.
void print_json(const nlohmann::ordered_json& measured) {
  nlohmann::ordered_json all = {{"version", version()}, {"commit", commit()}, {"processor", processor()}};
  all.update(measured);
  print("{}\n", all.dump(2));
}

void print_json(const bench::Results& results) {
  nlohmann::ordered_json rates, events;
  for (const auto& r : results.rates)
    rates.push_back({{"path", r.path},
                     {"columns", r.columns},
                     {"rows", r.rows},
                     {"threads", r.threads},
                     {"steps_per_sweep", r.steps_per_sweep},
                     {"node_updates_per_s", r.node_updates_per_s},
                     {"bound_per_s", r.bound_per_s},
                     {"fraction_of_bound", r.node_updates_per_s / r.bound_per_s},
                     {"bytes_per_node", r.bytes_per_node}});
  for (const auto& r : results.events)
    events.push_back({{"columns", r.columns},
                      {"rows", r.rows},
                      {"threads", r.threads},
                      {"statics_s", r.statics_s},
                      {"event_s", r.event_s},
                      {"node_updates_per_s", r.node_updates_per_s}});
  const nlohmann::ordered_json measured = {
      {"compiler", compiler()},
      {"bandwidth_bytes_per_s", results.bandwidth_bytes_per_s},
      {"bandwidth_all_threads_bytes_per_s", results.bandwidth_all_threads_bytes_per_s},
      {"stencil_alone_per_s", results.stencil_alone_per_s},
      {"rates", rates},
      {"events", events}};
  print_json(measured);
}

void print_table(const bench::Results& results) {
  print("{}, {}, {}\n\n", version_line(), processor(), compiler());
  print("bandwidth of u, v in and out: {:.1f} GB/s by one thread, {:.1f} GB/s by all\n",
        results.bandwidth_bytes_per_s * 1e-9, results.bandwidth_all_threads_bytes_per_s * 1e-9);
  print("the stencil alone, in the nearest cache: {:.0f} million node updates/s\n\n",
        results.stencil_alone_per_s * 1e-6);
  print("{:<32}{:>15}{:>9}{:>13}{:>12}{:>9}{:>10}{:>12}\n", "path", "mesh", "threads", "steps/sweep",
        "M updates/s", "bound", "fraction", "bytes/node");
  for (const auto& r : results.rates)
    print("{:<32}{:>15}{:>9}{:>13}{:>12.0f}{:>9.0f}{:>10.2f}{:>12}\n", r.path,
          fmt::format("{} x {}", r.columns, r.rows), r.threads, r.steps_per_sweep,
          r.node_updates_per_s * 1e-6, r.bound_per_s * 1e-6, r.node_updates_per_s / r.bound_per_s,
          r.bytes_per_node > 0 ? fmt::format("{:.0f}", r.bytes_per_node) : "");
  print(
      "\nBound: bandwidth over {:.0f} bytes a node for one step per sweep through memory, else the "
      "stencil alone. Medians of 5.\n\n",
      bench::bytes_per_node_update);
  for (const auto& r : results.events)
    print(
        "an event of two bodies, each {} x {}, {} thread{}: statics {:.2f} s, event {:.2f} s ({:.0f} "
        "million node updates/s)\n",
        r.columns, r.rows, r.threads, r.threads > 1 ? "s" : "", r.statics_s, r.event_s,
        r.node_updates_per_s * 1e-6);
}

void print_statics(const bench::StaticsRun& r, bool as_json) {
  if (as_json) {
    const nlohmann::ordered_json measured = {{"columns", r.columns},
                                             {"rows", r.rows},
                                             {"solver", r.solver},
                                             {"unknowns", r.unknowns},
                                             {"wall_s", r.wall_s},
                                             {"processor_s", r.processor_s},
                                             {"cycles", r.cycles},
                                             {"peak_bytes", r.peak_bytes},
                                             {"critical_shear_m", r.critical_shear_m}};
    return print_json(measured);
  }
  print(
      "{} x {}, {}, {:.3g} unknowns: {:.2f} s ({:.2f} s of processor), {} cycles, peak memory {:.2f} GB, "
      "critical shear {:.12g} m\n",
      r.columns, r.rows, r.solver, r.unknowns, r.wall_s, r.processor_s, r.cycles, r.peak_bytes * 1e-9,
      r.critical_shear_m);
}

struct BenchArguments {
  std::optional<int> threads, columns;
  std::optional<std::string> solver;
  bool large = false;

  /// @throws UserError where some of them are of different measurements
  void require_one() const {
    const auto refuse = [](bool is_given, const char* option, const char* with) {
      if (is_given) throw UserError("slipfront: bench {} takes no {}; leave it out", with, option);
    };
    refuse(columns && threads, "--threads", "--statics");
    refuse(columns && large, "--large", "--statics");
    refuse(solver && !columns, "--solver", "without --statics");
  }
};

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure node updates per second against the machine's bounds");
  command->group("The program itself");
  auto arguments = std::make_shared<BenchArguments>();
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON, for comparison between versions");
  command->add_option("--threads", arguments->threads, "The most threads to measure with")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--large", arguments->large, "Also 10,000 x 5,000 cells, some 7 GB");
  command
      ->add_option("--statics", arguments->columns,
                   "Measure the statics of a plate of so many columns instead")
      ->check(CLI::Range(2, 100'000));
  command
      ->add_option("--solver", arguments->solver, "... by this solver: auto, direct or iterative (default)")
      ->check(CLI::IsMember({"auto", "direct", "iterative"}));
  command->callback([arguments, json] {
    arguments->require_one();
    if (arguments->columns) {
      const auto solver = arguments->solver.value_or("iterative");
      for (const auto s : {statics::StaticSolver::automatic, statics::StaticSolver::direct,
                           statics::StaticSolver::iterative})
        if (statics::name_of(s) == solver)
          print_statics(bench::measure_statics(*arguments->columns, s), *json);
      return finish_output();
    }
    bench::Options options;
    options.threads =
        arguments->threads.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
    options.large = arguments->large;
    const auto results = bench::measure(
        options, [](const std::string& next) { std::fputs(fmt::format("\r{:<70}", next).c_str(), stderr); });
    std::fputs(fmt::format("\r{:<70}\r", "").c_str(), stderr);
    *json ? print_json(results) : print_table(results);
    finish_output();
  });
}

}  // namespace slipfront::cli
