// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <thread>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "io/log.hpp"
#include "io/results.hpp"
#include "study/convergence.hpp"

namespace slipfront::cli {
namespace {

struct StudyArguments {
  std::string dir;
  bool overwrite = false;
  bool quiet = false;
  study::ConvergenceOptions options;
};

std::string number(double value, const char* unit = "", double factor = 1) {
  return std::isfinite(value) ? fmt::format("{:.3g}{}", factor * value, unit) : "-";
}

void print_row(const std::string& parameter, const char* fronts, const study::Summary& s) {
  fmt::print("{:<30}{:<7}{:>9}  {:>7}  {:>7}  {:>8}  {}\n", parameter, fronts,
             number(s.median_relative_error, " %", 100), number(s.median_order), number(s.growth),
             fmt::format("{}/{}", s.n_stations, s.n_wanted), study::name(s.verdict));
}

void print_table(const study::Convergence& result, const std::string& dir) {
  fmt::print("V_tip over {:.4g} m at stations every {:.4g} m; tolerance {:g} %; {} runs\n\n", result.l_star_m,
             result.options.station_spacing_m, 100 * result.options.tolerance, result.n_runs);
  fmt::print("{:<30}{:<7}{:>9}  {:>7}  {:>7}  {:>8}  {}\n", "parameter", "fronts", "error", "order", "growth",
             "stations", "verdict");
  for (const auto& s : result.sequences) {
    print_row(s.plan.parameter, "both", s.both);
    print_row("", "to -x", s.left);
    print_row("", "to +x", s.right);
    std::string values;
    for (const auto& member : s.plan.members) values += fmt::format(" {:.4g}", member.value);
    fmt::print("  values{}; the case's {:.4g}", values, s.plan.case_value);
    if (std::isfinite(s.relative_difference_at_limit))
      fmt::print("; computed at 0: {:.3g} % from the extrapolated", 100 * s.relative_difference_at_limit);
    fmt::print("\n");
  }
  for (const auto& warning : result.warnings) fmt::print("note: {}\n", warning);
  fmt::print("results: {}\n", dir);
}

void study_case(const CaseArguments& arguments, const StudyArguments& study) {
  const io::Case config = arguments.read();
  study::plan_convergence(config, study.options);  // mistakes in the options, before a folder is made
  io::claim_output_folder(study.dir, study.overwrite);
  catch_interrupts();
  std::optional<io::Progress> progress;
  try {
    const auto result = study::study_convergence(config, study.options, [&](std::size_t done, std::size_t n) {
      if (!progress) progress.emplace("runs", static_cast<std::int64_t>(n), study.quiet);
      progress->update(static_cast<std::int64_t>(done));
      return !interrupt_wanted();
    });
    progress.reset();
    study::write_convergence(study.dir, config, result);
    if (!study.quiet) print_table(result, study.dir);
  } catch (const UserError& error) {
    throw UserError(io::with_place(arguments.file, error.what(), arguments.overrides()));
  }
}

}  // namespace

void add_study(CLI::App& app) {
  CLI::App* group = app.add_subcommand("study", "Vary the numerical parameters of a case");
  group->require_subcommand(1);
  CLI::App* command = group->add_subcommand(
      "convergence", "Front speeds over element size, interface step and damping, with their limits");
  const auto arguments = add_case_arguments(*command);
  auto study = std::make_shared<StudyArguments>();
  auto& options = study->options;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command->add_option("-o,--output", study->dir, "Folder for the results")->required()->type_name("DIR");
  command->add_flag("--overwrite", study->overwrite, "Replace the results that the folder already holds");
  command->add_flag("-q,--quiet", study->quiet, "Print nothing but errors");
  command
      ->add_option("--element-sizes", options.element_sizes_m,
                   "Element sizes in m, the case's among them; by default it times 2, 1, 1/2")
      ->type_name("H,H,H")
      ->delimiter(',');
  command->add_option("--station-spacing", options.station_spacing_m, "Distance of the stations, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--tolerance", options.tolerance, "Median relative error that counts as converged")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--threads", options.threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([arguments, study] { study_case(*arguments, *study); });
}

}  // namespace slipfront::cli
