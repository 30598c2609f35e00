// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
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

namespace slipfront::cli {
namespace {

std::string number(double value, const char* unit = "", double factor = 1) {
  return std::isfinite(value) ? fmt::format("{:.3g}{}", factor * value, unit) : "-";
}

void print_outcome(const kammer2012::OpenChoicesResult& result, const kammer2012::SampleOutcome& o) {
  for (std::size_t k = 0; k < result.choices.size(); ++k) {
    const auto& choice = result.choices[k];
    if (o.sample.values[k] != choice.standard && is_in_use(result.choices, k, o.sample.values))
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
  print("{} samples of {} choices\n", result.outcomes.size(), result.choices.size());
  print_ends(result.counts);
  print("C1 to C11 hold for {} of {} triggers\n", result.triggers.n_holding, result.triggers.n_triggers);
  print("region: {} left triggers, {} right ones\n", result.left.all.size(), result.right.all.size());
  if (result.chosen()) {
    print("chosen, in its middle:\n");
    print_outcome(result, result.outcomes[*result.chosen()]);
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

/// Adds a study of the paper, which goes on where it was interrupted.
/// @param study  given the options and a monitor, which is told often how many runs are done of how many
template <class Options, class Result, class Monitor>
void add(CLI::App& group, const std::string& name, const char* description, const char* quick_help,
         Result (*study)(const Options&, const Monitor&),
         void (*write)(const std::filesystem::path&, const Result&)) {
  struct Arguments {
    std::string dir;
    bool overwrite = false, quiet = false;
    Options options;
  };
  CLI::App* command = group.add_subcommand(name, description);
  auto arguments = std::make_shared<Arguments>();
  auto& [dir, overwrite, quiet, options] = *arguments;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command->add_option("-o,--output", dir, "Folder for the results")->required()->type_name("DIR");
  command->add_flag("--overwrite", overwrite, "Replace the results that the folder already holds");
  command->add_flag("-q,--quiet", quiet, "Print nothing but errors");
  command->add_flag("--quick", options.quick, quick_help);
  command->add_option("--threads", options.threads, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([arguments, name, study, write] {
    Arguments& given = *arguments;
    results::ResultFolder folder(
        given.dir, fmt::format("study {}{} with {}", name, given.options.quick ? " --quick" : "",
                               run::program_identity()));
    folder.require_empty(given.overwrite, true);
    folder.begin_or_resume();
    given.options.kept = folder.state() / "runs";
    catch_interrupts();
    std::optional<Progress> progress;
    try {
      const auto result = study(given.options, [&](std::size_t done, std::size_t n) {
        if (!progress) progress.emplace("study", static_cast<std::int64_t>(n), given.quiet, "runs");
        progress->update(static_cast<std::int64_t>(done));
        return !interrupt_wanted();
      });
      progress.reset();
      write(folder.unfinished(), result);
      folder.publish();
      if (!given.quiet) print_table(result, given.dir);
    } catch (const UserError&) {
      folder.abandon();
      throw;
    }
  });
}

}  // namespace

void add_study(CLI::App& app) {
  CLI::App* group =
      app.add_subcommand("study", "Vary the numerical parameters of a case, or the paper's choices");
  group->group("Studies");
  group->require_subcommand(1);
  add(*group, "open-choices",
      "What Kammer et al. (2012) leave open, varied: which of their statements depend on it",
      "A few samples on a coarse mesh, to try the command", kammer2012::study_open_choices,
      kammer2012::write_open_choices);
  add(*group, "base",
      "The events of Kammer et al. (2012) on deformable bases: what remains of direction and energy "
      "criterion",
      "Elements of 2 mm, to try the command", kammer2012::study_bases, kammer2012::write_bases);
}

}  // namespace slipfront::cli
