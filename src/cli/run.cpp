// SPDX-License-Identifier: BSD-3-Clause
#include "run/run.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <thread>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "fronts/fit.hpp"
#include "io/log.hpp"
#include "io/results.hpp"
#include "io/stream.hpp"

namespace slipfront::cli {
namespace {

struct RunArguments {
  std::string dir;
  bool overwrite = false;
  bool quiet = false;
  int threads = 1;
};

/// The folder for the results; if nothing was written to it, the folders made for it go again.
struct OutputFolder {
  std::filesystem::path dir, outermost_made;
  ~OutputFolder() {
    std::error_code error;
    for (auto p = dir; !outermost_made.empty(); p = p.parent_path())
      if (!std::filesystem::remove(p, error) || error || p == outermost_made) return;
  }
};

void print_summary(const run::Result& result, const run::InitialState& initial, const std::string& dir) {
  const auto& event = result.event;
  if (initial.prescribed)
    fmt::print("prescribed tractions, t/p up to {:.4g} at x = {:.4g} m\n", initial.common.peak_ratio,
               initial.common.peak_x_m);
  else
    fmt::print("t/p inside reaches mu_s at x = {:.4g} m, at a shear of {:.5g} m\n", initial.common.peak_x_m,
               initial.critical_shear_m);
  if (initial.ramp)
    fmt::print("by the ramp at {:.5g} m ({:+.3f} %), after {} beginnings of slip at the edges\n",
               initial.ramp->spontaneous.shear_m,
               100 * (initial.ramp->spontaneous.shear_m / initial.critical_shear_m - 1),
               initial.ramp->record.n_onsets());
  fmt::print(
      "{} steps of {:.4g} s ({} sub-steps at the interface), {:.3g} s of wall time, {:.0f} million node "
      "updates/s\n",
      event.steps, result.step_s, std::lround(result.step_s / result.substep_s), result.stepping_wall_s,
      1e-6 * static_cast<double>(event.steps) * result.node_updates_per_step / result.stepping_wall_s);
  for (const auto& front : result.fronts) {
    std::vector<double> speeds;
    for (const auto& point : front.points) speeds.push_back(point.v_tip_m_per_s / result.speeds.c_L);
    const double speed = fronts::median(speeds);
    fmt::print("front {}: x = {:.4f} to {:.4f} m, {:.1f} to {:.1f} us, {}, {}, ends: {}\n", front.id,
               front.points.front().x_m, front.points.back().x_m, 1e6 * front.points.front().onset_s,
               1e6 * front.points.back().onset_s,
               std::isfinite(speed) ? fmt::format("median speed {:.2f} c_L", speed) : "speed undefined",
               fronts::name(front.mode), fronts::name(front.end));
  }
  for (const auto& warning : result.warnings) fmt::print("note: {}\n", warning);
  fmt::print("results: {}\n", dir);
}

void run_case(const CaseArguments& arguments, const RunArguments& options) {
  const io::Case config = arguments.read();
  const OutputFolder folder{options.dir, io::claim_output_folder(options.dir, options.overwrite)};
  catch_interrupts();
  const solve::Execution execution{.threads = options.threads};
  const auto with_progress = [&](const char* label) {
    // The total is known only when the first step is done.
    return [label, quiet = options.quiet, progress = std::shared_ptr<io::Progress>()](
               std::int64_t step, std::int64_t total) mutable {
      if (!progress) progress = std::make_shared<io::Progress>(label, total, quiet);
      progress->update(step);
      return !interrupt_wanted();
    };
  };
  try {
    auto initial = run::make_initial_state(config, with_progress("ramp"), execution);
    io::ResultStream stream(options.dir, initial.common.tractions.x_m, initial.mesh,
                            !config.output.snapshot_times_s.empty());
    const auto stepper = run::start_event(config, initial, execution);
    const auto result = run::run_event(config, initial, *stepper, with_progress("event"), &stream);
    stream.publish();
    run::write_beside_stream(options.dir, result, initial);
    if (result.event.end == solve::EventEnd::blow_up)
      throw BlowUp(result.event.blow_up + "; what there is was kept in " + options.dir);
    if (result.event.end == solve::EventEnd::interrupted)
      throw Interrupted(fmt::format("interrupted at t = {:.4g} s; what there is was kept in {}",
                                    result.event.time_s, options.dir));
    if (!options.quiet) print_summary(result, initial, options.dir);
  } catch (const UserError& error) {
    throw UserError(arguments.with_place(error.what()));
  }
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command = app.add_subcommand("run", "Run a case: statics, event, fronts");
  const auto arguments = add_case_arguments(*command);
  auto options = std::make_shared<RunArguments>();
  command->add_option("-o,--output", options->dir, "Folder for the results")->required()->type_name("DIR");
  command->add_flag("--overwrite", options->overwrite, "Replace the results that the folder already holds");
  // More pay on large meshes only.
  constexpr unsigned most_threads_by_default = 4;
  options->threads =
      static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, most_threads_by_default));
  command
      ->add_option("--threads", options->threads,
                   "Threads of the run; the results do not depend on them. They wait for each other: give no "
                   "more than are idle")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("-q,--quiet", options->quiet, "Print nothing but errors");
  command->callback([arguments, options] { run_case(*arguments, *options); });
}

}  // namespace slipfront::cli
