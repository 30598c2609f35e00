// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <thread>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/log.hpp"
#include "cli/print.hpp"
#include "papers/kammer2012/bases.hpp"
#include "papers/kammer2012/open_choices.hpp"
#include "results/folder.hpp"
#include "run/checkpoint.hpp"
#include "study/convergence.hpp"
#include "study/interface_step.hpp"

namespace slipfront::cli {
namespace {

struct Target {
  std::string dir;
  bool overwrite = false;
  bool quiet = false;
};

struct StudyArguments {
  Target target;
  study::ConvergenceOptions options;
};

struct InterfaceStepArguments {
  Target target;
  study::InterfaceStepOptions options;
};

void add_target(CLI::App& command, Target& target) {
  command.add_option("-o,--output", target.dir, "Folder for the results")->required()->type_name("DIR");
  command.add_flag("--overwrite", target.overwrite, "Replace the results that the folder already holds");
  command.add_flag("-q,--quiet", target.quiet, "Print nothing but errors");
}

/// Runs a study with its progress shown and publishes its results; a user's mistake gets its place in the
/// case file.
/// @param arguments  of the case; null where it has none
/// @param study  given the monitor, the folder to write to and that of the runs that are done
template <class Study>
void run_study(const std::string& name, const CaseArguments* arguments, const Target& target, Study&& study) {
  results::ResultFolder folder(target.dir, fmt::format("study {} with {}", name, run::program_identity()));
  folder.require_empty(target.overwrite, true);
  folder.begin_or_resume();
  catch_interrupts();
  std::optional<cli::Progress> progress;
  const study::StudyMonitor monitor = [&](std::size_t done, std::size_t n) {
    if (!progress) progress.emplace("study", static_cast<std::int64_t>(n), target.quiet, "runs");
    progress->update(static_cast<std::int64_t>(done));
    return !interrupt_wanted();
  };
  try {
    study(monitor, folder.unfinished(), folder.state() / "runs");
    folder.publish();
  } catch (const UserError& error) {
    folder.abandon();
    if (arguments == nullptr) throw;
    throw arguments->with_place(error);
  }
}

std::string number(double value, const char* unit = "", double factor = 1) {
  return std::isfinite(value) ? fmt::format("{:.3g}{}", factor * value, unit) : "-";
}

void print_row(const std::string& parameter, const char* fronts, const study::Summary& s) {
  print("{:<30}{:<7}{:>9}  {:>7}  {:>7}  {:>8}  {}\n", parameter, fronts,
        number(s.median_relative_error, " %", 100), number(s.median_order), number(s.growth),
        fmt::format("{}/{}", s.n_stations, s.n_wanted), study::name(s.verdict));
}

void print_table(const study::Convergence& result, const std::string& dir) {
  print("V_tip over {:.4g} m at stations every {:.4g} m; tolerance {:g} %\n", result.l_star_m,
        result.options.station_spacing_m, 100 * result.options.tolerance);
  print_ends(result.counts);
  print("\n{:<30}{:<7}{:>9}  {:>7}  {:>7}  {:>8}  {}\n", "parameter", "fronts", "error", "order", "growth",
        "stations", "verdict");
  for (const auto& s : result.sequences) {
    print_row(s.plan.parameter, "both", s.both);
    print_row("", "to -x", s.left);
    print_row("", "to +x", s.right);
    std::string values;
    for (const auto& member : s.plan.members) values += fmt::format(" {:.4g}", member.value);
    print("  values{}; the case's {:.4g}", values, s.plan.case_value);
    if (std::isfinite(s.relative_difference_at_limit))
      print("; computed at 0: {:.3g} % from the extrapolated", 100 * s.relative_difference_at_limit);
    print("\n");
  }
  for (const auto& warning : result.warnings) print("note: {}\n", warning);
  print("results: {}\n", dir);
}

void study_convergence(const CaseArguments& arguments, const StudyArguments& study) {
  const input::Case config = arguments.read();
  study::plan_convergence(config, study.options);  // mistakes in the options, before a folder is made
  study::Convergence result;
  run_study("convergence", &arguments, study.target,
            [&](const study::StudyMonitor& monitor, const auto& dir, const auto& kept) {
              auto options = study.options;
              options.kept = kept;
              result = study::study_convergence(config, options, monitor);
              study::write_convergence(dir, config, result);
            });
  if (!study.target.quiet) print_table(result, study.target.dir);
}

void print_table(const study::InterfaceStep& result, const std::string& dir) {
  print("V_tip at {} stations against the limit of small steps (observed order {})\n", result.stations.size(),
        number(result.median_order));
  print_ends(result.counts);
  print("\n{:<34}{:>8}{:>10}{:>12}{:>12}\n", "stepping", "cost", "time", "median", "90 % within");
  for (const auto& s : result.all) {
    using Kind = study::Stepping::Kind;
    const std::string what =
        s.kind == Kind::plain ? fmt::format("plain, step_factor {:.4g}", s.step_factor)
        : s.kind == Kind::layer
            ? fmt::format("{} rows, {} sub-steps", s.rows, s.substeps)
            : fmt::format("{} rows, {} and {}, extrapolated", s.rows, s.substeps / 2, s.substeps);
    print("{:<34}{:>8.2f}{:>10}{:>12}{:>12}\n", what, s.cost, number(s.time_s, " s"),
          number(s.median_error, " %", 100), number(s.p90_error, " %", 100));
  }
  print("\ncost: node updates over those of the plain scheme at the case's step_factor\n");
  if (result.chosen >= 0) {
    const auto& s = result.all[result.chosen];
    print(
        "cheapest within {:g} %: time.step_factor = {:.4g}, time.interface_rows = {}, "
        "time.interface_substeps = {}; the case with it: {}/chosen.toml\n",
        100 * result.options.tolerance, s.step_factor, s.rows, s.substeps, dir);
  } else {
    print("none is within {:g} %\n", 100 * result.options.tolerance);
  }
  for (const auto& warning : result.warnings) print("note: {}\n", warning);
  print("results: {}\n", dir);
}

void study_interface_step(const CaseArguments& arguments, const InterfaceStepArguments& study) {
  const input::Case config = arguments.read();
  study::InterfaceStep result;
  run_study("interface-step", &arguments, study.target,
            [&](const study::StudyMonitor& monitor, const auto& dir, const auto& kept) {
              auto options = study.options;
              options.kept = kept;
              result = study::study_interface_step(config, options, monitor);
              study::write_interface_step(dir, config, result);
            });
  if (!study.target.quiet) print_table(result, study.target.dir);
}

void print_outcome(const kammer2012::OpenChoicesResult& result, const kammer2012::SampleOutcome& o) {
  for (std::size_t k = 0; k < result.choices.size(); ++k) {
    const auto& choice = result.choices[k];
    if (o.sample.values[k] != choice.standard)
      print("  {:<20} {} instead of {}\n", choice.name, choice.text(o.sample.values[k]),
            choice.text(choice.standard));
  }
  if (o.fit)
    print(
        "  a = {:.2f} [{:.2f}, {:.2f}], b = {:.2f} [{:.2f}, {:.2f}], c = {:.2f} [{:.2f}, {:.2f}]; {} in the "
        "band\n",
        o.fit->a.value, o.fit->a.low, o.fit->a.high, o.fit->b.value, o.fit->b.low, o.fit->b.high,
        o.fit->c.value, o.fit->c.low, o.fit->c.high, number(o.share_in_band, " %", 100));
}

void print_table(const kammer2012::OpenChoicesResult& result, const std::string& dir) {
  const auto& standard = result.outcomes.front();
  print("{} samples of {} choices\n", result.outcomes.size(), result.choices.size());
  print_ends(result.counts);
  print("standard choices\n");
  print_outcome(result, standard);
  print("C1 to C11 hold for {} of {} triggers\n", result.triggers.n_holding, result.triggers.n_triggers);
  if (result.chosen >= 0) {
    print("least extreme of the {} samples of the region:\n", result.region.size());
    print_outcome(result, result.outcomes[result.chosen]);
  }
  for (const auto& e : kammer2012::evidence(result)) {
    print("{}: {} samples", e.name, e.n);
    if (e.n > 0)
      print("; spread of V_tip {} at equal energy rise, {} at equal t_d/p_d, {} at equal t_s/p_s (medians)",
            number(e.spread_at_energy_rise.median, " %", 100),
            number(e.spread_at_dynamic_ratio.median, " %", 100),
            number(e.spread_at_static_ratio.median, " %", 100));
    print("\n");
  }
  print("results: {}\n", dir);
}

struct OpenChoicesArguments {
  Target target;
  kammer2012::OpenChoicesOptions options;
};

void study_open_choices(const OpenChoicesArguments& study) {
  kammer2012::OpenChoicesResult result;
  run_study(study.options.quick ? "open-choices --quick" : "open-choices", nullptr, study.target,
            [&](const study::StudyMonitor& monitor, const auto& dir, const auto& kept) {
              auto options = study.options;
              options.kept = kept;
              result = kammer2012::study_open_choices(options, monitor);
              kammer2012::write_open_choices(dir, result);
            });
  if (!study.target.quiet) print_table(result, study.target.dir);
}

void add_open_choices(CLI::App& group) {
  CLI::App* command = group.add_subcommand(
      "open-choices", "What Kammer et al. (2012) leave open, varied: which of their statements depend on it");
  auto study = std::make_shared<OpenChoicesArguments>();
  auto& options = study->options;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  add_target(*command, study->target);
  command->add_flag("--quick", options.quick, "A few samples on a coarse mesh, to try the command");
  command->add_option("--threads", options.threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([study] { study_open_choices(*study); });
}

struct BasesArguments {
  Target target;
  kammer2012::BasesOptions options;
};

void print_table(const kammer2012::BasesResult& result, const std::string& dir) {
  print("{:<10} {:>26} {:>22} {:>8} {:>20}\n", "base", "V against / along (range)", "pressure along, against",
        "in band", "spread: t/p, energy");
  for (const auto& on : result.bases) {
    const auto& r = on.speed_ratio;
    const auto& m = on.main_fronts;
    print("{:<10} {:>26} {:>22} {:>8} {:>20}\n", on.base.name,
          fmt::format("{} ({} to {})", number(r.median), number(r.low), number(r.high)),
          fmt::format("{}, {}", number(on.pressure_change.along, " %", 100),
                      number(on.pressure_change.against, " %", 100)),
          number(m.share_in_paper_band, " %", 100),
          fmt::format("{}, {}", number(m.dynamic_ratio.fronts.median_relative),
                      number(m.energy_rise.fronts.median_relative)));
  }
  print_ends(result.counts);
  for (const auto& warning : result.warnings) print("note: {}\n", warning);
  print("results: {}\n", dir);
}

void study_base(const BasesArguments& study) {
  kammer2012::BasesResult result;
  run_study(study.options.quick ? "base --quick" : "base", nullptr, study.target,
            [&](const study::StudyMonitor& monitor, const auto& dir, const auto& kept) {
              auto options = study.options;
              options.kept = kept;
              result = kammer2012::study_bases(options, monitor);
              kammer2012::write_bases(dir, result);
            });
  if (!study.target.quiet) print_table(result, study.target.dir);
}

void add_base(CLI::App& group) {
  CLI::App* command = group.add_subcommand("base",
                                           "The events of Kammer et al. (2012) on deformable bases: what "
                                           "remains of direction and energy criterion");
  auto study = std::make_shared<BasesArguments>();
  auto& options = study->options;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  add_target(*command, study->target);
  command->add_flag("--quick", options.quick, "Elements of 2 mm, to try the command");
  command->add_option("--threads", options.threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([study] { study_base(*study); });
}

void add_convergence(CLI::App& group) {
  CLI::App* command = group.add_subcommand(
      "convergence", "Front speeds over element size, interface step and damping, with their limits");
  const auto arguments = add_case_arguments(*command);
  auto study = std::make_shared<StudyArguments>();
  auto& options = study->options;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  add_target(*command, study->target);
  command
      ->add_option("--element-sizes", options.element_sizes_m,
                   "Element sizes in m, the case's among them; by default it times 2, 1, 1/2")
      ->type_name("H,H,H")
      ->delimiter(',');
  command->add_option("--station-spacing", options.station_spacing_m, "Distance of the stations, m")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--tolerance", options.tolerance, "Median relative error that counts as converged")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--threads", options.threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([arguments, study] { study_convergence(*arguments, *study); });
}

void add_interface_step(CLI::App& group) {
  CLI::App* command = group.add_subcommand("interface-step",
                                           "Error of the front speeds against the cost of sub-cycling the "
                                           "interface; the cheapest way within a tolerance");
  const auto arguments = add_case_arguments(*command);
  auto study = std::make_shared<InterfaceStepArguments>();
  auto& options = study->options;
  add_target(*command, study->target);
  command
      ->add_option("--tolerance", options.tolerance, "Relative error of V_tip that nine of ten stations keep")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--rows", options.rows, "Rows of cells to try")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--substeps", options.substeps, "Sub-steps to try")
      ->delimiter(',')
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  command->add_option("--station-spacing", options.station_spacing_m, "Distance of the stations, m")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--threads", options.threads, "Runs side by side; more than one falsifies the times")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([arguments, study] { study_interface_step(*arguments, *study); });
}

}  // namespace

void add_study(CLI::App& app) {
  CLI::App* group = app.add_subcommand("study", "Vary the numerical parameters of a case");
  group->group("Studies");
  group->require_subcommand(1);
  add_convergence(*group);
  add_interface_step(*group);
  add_open_choices(*group);
  add_base(*group);
}

}  // namespace slipfront::cli
