// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <thread>

#include "advice/needs.hpp"
#include "advice/notes.hpp"
#include "advice/outlook.hpp"
#include "advice/prediction.hpp"
#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/log.hpp"
#include "cli/print.hpp"
#include "cli/words.hpp"
#include "fracture/passage.hpp"
#include "fronts/fit.hpp"
#include "results/folder.hpp"
#include "run/session.hpp"
#include "setup/subdomains.hpp"

namespace slipfront::cli {
namespace {

struct RunArguments {
  std::optional<std::string> dir;      ///< of a new run
  std::optional<std::string> restart;  ///< of one to go on with
  bool overwrite = false;
  bool quiet = false;
  run::SessionOptions session;

  const std::string& folder() const { return restart ? *restart : *dir; }
  /// Without a folder, one beside what else is in the working folder, of the name of the case file.
  void take_folder_of(const std::string& file) {
    if (restart || dir) return;
    if (!std::filesystem::is_regular_file(file))
      throw UserError("slipfront: {} is no regular file, which would name the folder; give --output DIR",
                      file);
    dir = std::filesystem::path(file).stem().string();
  }
};

void print_ramp(const motion::Ramp& ramp, double direct_shear_m) {
  const double shear_m = ramp.supercritical.shear_m;
  const auto n_inside = ramp.n_onsets_inside();
  print(
      "the ramp brings t/p inside to mu_s at x = {:.4g} m, at a shear of {:.5g} m, {:+.3f} % of the {:.5g} m "
      "found directly\n",
      ramp.subcritical.peak_x_m, shear_m, 100 * (shear_m / direct_shear_m - 1), direct_shear_m);
  print("beginnings of slip during the ramp: {} at the edges, {} inside, in the last step\n",
        ramp.record.n_onsets() - n_inside, n_inside);
}

void print_rupture(const advice::RuptureOutlook& rupture) {
  const auto& o = rupture.of_nodes;
  if (rupture.tip_slip_rate_m_per_s) {
    print("a front's tip is where the slip rate passes {:.3g} m/s\n", *rupture.tip_slip_rate_m_per_s);
    return;
  }
  std::string text = fmt::format("S before the event, inside: {:.3g}", o.S.median);
  if (o.S.least < o.S.largest)
    text += fmt::format(" in the median, {:.3g} to {:.3g}", o.S.least, o.S.largest);
  if (o.n_barriers > 0 && o.n_barriers < o.n_nodes)
    text += fmt::format(", at {} of {} nodes; at the others t is below mu_k p, or S above {:g}",
                        o.n_nodes - o.n_barriers, o.n_nodes, stability::barrier_S);
  if (o.nucleation_length_m) text += fmt::format("; nucleation length {:.3g} m", *o.nucleation_length_m);
  if (o.griffith_half_length_m)
    text += fmt::format(", critical crack {:.3g} m", 2 * *o.griffith_half_length_m);
  if (rupture.process_zone_elements)
    text += fmt::format(", process zone {:.3g} elements", *rupture.process_zone_elements);
  print("{}\nexpected: {}\n", text, o.regime);
}

std::string speed_text(const fronts::Front& front, const solid::WaveSpeeds& speeds) {
  const double median = median_speed_m_per_s(front);
  if (!std::isfinite(median)) return "speed undefined";
  const auto fast =
      std::ranges::find_if(front.points, [&](const auto& point) { return point.v_tip_m_per_s > speeds.c_S; });
  return fmt::format(
      "median speed {}{}", speed(median, speeds),
      fast == front.points.end() ? "" : fmt::format(", above c_S first at {}", engineering(fast->x_m, "m")));
}

/// Medians over the front's nodes.
std::string fracture_text(const run::Result& result, std::size_t f) {
  std::vector<double> zone_m, G_slip;
  for (const auto& passage : result.passages[f]) {
    zone_m.push_back(passage.cohesive_zone_m);
    G_slip.push_back(passage.G_slip_J_per_m2);
  }
  const double gamma = fracture_energy_J_per_m2(result, result.fronts[f]);
  const double G = fronts::median(G_slip), zone = fronts::median(zone_m);
  if (!(gamma > 0)) return {};
  auto text = fmt::format("  fracture energy {:.3g} J/m2 in the median", gamma);
  if (!advice::has_fracture_energy(result.problem)) text += " (of this mesh: the law has no length)";
  // Few rows are those of a tip that hardly ran, or ran above the limiting speed.
  const auto n_known = std::ranges::count_if(G_slip, [](double g) { return std::isfinite(g); });
  if (2 * n_known > std::ssize(G_slip)) text += fmt::format(", G by slip {:.3g} J/m2", G);
  if (std::isfinite(zone))
    text += fmt::format(", cohesive zone {}, {:.2g} elements", engineering(zone, "m", 2),
                        zone / result.problem.element_size_m());
  return text + "\n";
}

/// Those that did not leave the trigger share a line.
void print_fronts(const run::Result& result) {
  std::vector<int> of_trigger;
  for (std::size_t f = 0; f < result.fronts.size(); ++f) {
    const auto& front = result.fronts[f];
    const auto &first = front.points.front(), &last = front.points.back();
    if (is_of_trigger(front)) {
      of_trigger.push_back(front.id);
      continue;
    }
    print("front {}: x = {} to {}, {} to {}, {}, {}, ends: {}\n", front.id, engineering(first.x_m, "m"),
          engineering(last.x_m, "m"), engineering(first.onset_s, "s"), engineering(last.onset_s, "s"),
          speed_text(front, result.speeds), fronts::name(front.mode), fronts::name(front.end));
    print("{}", fracture_text(result, f));
  }
  if (!of_trigger.empty())
    cli::print("front{} {}: did not leave the trigger\n", of_trigger.size() == 1 ? "" : "s",
               fmt::join(of_trigger, ", "));
}

void print_notes(const Diagnostics& notes) {
  for (const auto& note : notes) print("note: {}\n", note.text);
}

void print_summary(const run::Result& result, const InitialState& initial, const std::string& dir) {
  const auto& event = result.event;
  print("{}\n{}\n", outcome(result), set_up(result.problem));
  if (result.problem.is_prestressed())
    print("prescribed tractions, t/p {} to {:.4g}{}\n", initial.subcritical.peak_ratio < 0 ? "down" : "up",
          initial.subcritical.peak_ratio,
          result.problem.prestress->file.empty()
              ? ""
              : " at x = " + engineering(initial.subcritical.peak_x_m, "m"));
  else if (initial.ramp)
    print_ramp(*initial.ramp, initial.critical_shear_m);
  else if (statics::is_sheared_by_force(result.problem.loading))
    print("shear force {}, {:.4g} of the critical one, t/p up to {:.4g} at x = {}\n",
          engineering(initial.loads->shear_force_N_per_m, "N/m"),
          initial.loads->shear_force_N_per_m / initial.loads->critical_shear_force_N_per_m,
          initial.subcritical.peak_ratio, engineering(initial.subcritical.peak_x_m, "m"));
  else
    print("t/p inside reaches mu_s at x = {}, at a shear of {}\n",
          engineering(initial.subcritical.peak_x_m, "m"), engineering(initial.critical_shear_m, "m"));
  if (const double speed_m_per_s = shear_speed_in_event_m_per_s(result.problem); speed_m_per_s > 0)
    print("the upper edge moves to +x at {} during the event (loading.shear_speed_m_per_s)\n",
          engineering(speed_m_per_s, "m/s", 3));
  print(
      "{} steps of {} ({} sub-steps at the interface), {:.3g} s of wall time, {:.0f} million node "
      "updates/s\n",
      event.steps, engineering(result.step_s, "s"), std::lround(result.step_s / result.substep_s),
      result.stepping_wall_s,
      1e-6 * static_cast<double>(event.steps) * result.node_updates_per_step / result.stepping_wall_s);
  print("ended: {}\n", run::end_of_event(result));
  print_fronts(result);
  print_rupture(result.rupture);
  print_notes(result.notes);
  print("results: {}\n", dir);
}

/// Shows progress, and asks the signals what is wanted.
run::SessionHooks hooks(bool quiet) {
  struct Shown {
    std::string part;
    std::unique_ptr<cli::Progress> progress;
  };
  auto shown = std::make_shared<Shown>();
  run::SessionHooks hooks;
  // The total is known only when the first step is done.
  hooks.progress = [quiet, shown](const char* part, std::int64_t step, std::int64_t total) {
    if (shown->part != part)
      shown->progress = std::make_unique<cli::Progress>(part, total, quiet, "steps", step);
    shown->part = part;
    shown->progress->update(step);
  };
  pause_for_checkpoints();
  hooks.request = [] {
    if (interrupt_wanted()) return run::Request::stop;
    return checkpoint_wanted() ? run::Request::keep : run::Request::none;
  };
  hooks.note = [quiet, shown](const std::string& note) {
    if (!shown->progress) shown->progress = std::make_unique<cli::Progress>("", 1, quiet);
    shown->progress->note("note: " + note);
  };
  return hooks;
}

/// The case that the command names, perhaps one to compare with.
struct GivenCase {
  input::CaseFile file;
  Problem problem;
  explicit GivenCase(input::CaseFile read)
      : file(std::move(read)), problem(problem::make_problem(file.config())) {}
};

void print_event(std::size_t number, const record::SequenceEvent& e) {
  const auto extent = e.length_m > 0
                          ? fmt::format("x = {} to {}{}, mean slip {}", engineering(e.from_x_m, "m"),
                                        engineering(e.to_x_m, "m"), e.is_global != 0 ? " (global)" : "",
                                        engineering(e.mean_slip_m, "m", 3))
                          : "nowhere faster than a front's tip";
  print("event {}: at {}, {}, F_S/F_N {:.4f} to {:.4f}, {} {}\n", number, engineering(e.begin_s, "s", 6),
        extent, e.friction_before, e.friction_after, e.n_fronts, e.n_fronts == 1 ? "front" : "fronts");
}

void print_sequence(const run::Finished& finished, const std::string& dir) {
  const auto& events = finished.events;
  print("{}\n", outcome(events));
  const auto& strongest = record::strongest(finished.loading);
  print("largest F_S/F_N {:.4f}, before event {}\n", strongest.shear_over_normal,
        strongest.n_events + (is_of_event(strongest.phase) ? 0 : 1));
  print("ended: {}\n", finished.end);
  if (!events.empty() &&
      std::ranges::none_of(events, [](const auto& e) { return std::isnan(e.nucleation_length_m); }))
    print("{} of them longer than the nucleation length, or global\n",
          std::ranges::count_if(events, record::has_nucleated));
  print_notes(finished.notes);
  print("results: {}\n", dir);
}

void run_case(const CaseArguments& arguments, RunArguments& options) {
  std::optional<GivenCase> given;
  if (!arguments.file.empty()) given.emplace(arguments.read());
  const bool compares_nothing = !given && !arguments.set.empty();
  if (options.restart ? options.dir || options.overwrite || compares_nothing : !given)
    throw UserError(
        "slipfront: run takes CASE, or --restart DIR, perhaps with CASE to compare; see slipfront run "
        "--help");
  options.take_folder_of(arguments.file);
  results::ResultFolder folder(options.folder(), run::run_work);
  if (options.restart && run::is_done(folder, given ? &given->problem : nullptr)) {
    if (!options.quiet) print("{}: is complete\n", folder.dir().string());
    return;
  }
  const Processes& processes = *options.session.processes;
  if (!options.restart) {
    folder.require_empty(options.overwrite);
    // What the machine cannot hold is refused before anything is written.
    given->file.placing_errors([&] { advice::require_fit(given->problem, folder.dir(), processes); });
  }
  if (processes.size() > 1 && given)
    given->file.placing_errors([&] {
      advice::require_memory_fits(given->problem, processes);
      setup::require_divisible(given->problem, processes);
    });
  if (given && arguments.strict)
    arguments.require_none_refused(
        given->file.placing_errors([&] { return advice::notes_of_case(given->problem, processes); }));
  catch_interrupts();
  try {
    auto hooks = cli::hooks(options.quiet);
    if (!options.quiet)
      hooks.event_done = [&](std::size_t number, const record::SequenceEvent& event) {
        if (given && number == 1) print("{}\n", set_up(given->problem));
        print_event(number, event);
      };
    const auto print_notes = [&] {
      for (const auto& note : given ? given->file.notes() : std::vector<std::string>())
        if (!options.quiet) print("note: {}\n", note);
    };
    const bool is_sequence = given && given->problem.is_sequence();
    if (is_sequence) print_notes();
    const auto finished = options.restart
                              ? run::resume(folder, given ? &given->problem : nullptr, options.session, hooks)
                              : given->file.placing_errors([&] {
                                  return run::run_into(folder, given->problem, options.session, hooks);
                                });
    run::require_came_to_end(finished.last.result, folder);
    if (!is_sequence) print_notes();
    if (options.quiet) return;
    if (finished.end.empty())
      print_summary(finished.last.result, finished.last.initial, folder.dir().string());
    else
      print_sequence(finished, folder.dir().string());
  } catch (const WriteError& error) {
    if (!folder.has_unfinished()) throw;
    throw WriteError("{}; {}", error.what(), run::how_to_resume(folder));
  }
}

}  // namespace

void add_run(CLI::App& app, Processes& processes) {
  CLI::App* command = app.add_subcommand("run", "Run a case: statics, event, fronts");
  command->group("Cases");
  const auto arguments = add_case_arguments(*command);
  add_strict(*command, *arguments);
  auto options = std::make_shared<RunArguments>();
  options->session.processes = &processes;
  command->get_option("CASE")->required(false);
  command
      ->add_option("-o,--output", options->dir,
                   "Folder for the results; by default the name of CASE without its ending")
      ->type_name("DIR");
  command
      ->add_option("--restart", options->restart,
                   "Go on with the run that was left unfinished in this folder, as if it had never stopped")
      ->type_name("DIR");
  command->add_flag("--overwrite", options->overwrite, "Replace the results that the folder already holds");
  auto& session = options->session;
  command
      ->add_option("--threads", session.threads,
                   "Threads of the run; the results do not depend on them. They wait for each other: give no "
                   "more than are idle. By default one for every 20,000 nodes, up to 4 and the processors")
      ->check(CLI::Range(1, 1024));
  command
      ->add_option("--checkpoint-every", session.keep_every_wall_s,
                   "Wall time between checkpoints, s; the signal USR1 asks for one at once")
      ->check(non_negative())
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--checkpoint-every-simulated", session.keep_every_s,
                   "Simulated time between checkpoints, s; by default only wall time counts")
      ->check(positive())
      ->type_name("S");
  command
      ->add_option(
          "--state-dir", session.shared_states,
          "Folder in which runs share the state before the event: taken from there where a run of the "
          "same plate, loading and strength at rest has kept it, else solved and kept")
      ->type_name("DIR")
      ->check(not_empty());
  command->add_flag("-q,--quiet", options->quiet, "Print nothing but errors");
  command->callback([arguments, options] { run_case(*arguments, *options); });
}

}  // namespace slipfront::cli
