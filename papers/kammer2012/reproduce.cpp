// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/reproduce.hpp"

#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "files/checksum.hpp"
#include "files/files.hpp"
#include "papers/kammer2012/analysis.hpp"
#include "papers/kammer2012/open_choices.hpp"
#include "results/folder.hpp"
#include "run/batch.hpp"
#include "run/checkpoint.hpp"
#include "run/sequence_session.hpp"

namespace slipfront::kammer2012 {

namespace {

/// Runs cases and writes each to its folder.
class Runner {
 public:
  Runner(const ReproduceOptions& options, const results::ResultFolder& folder, const RunMonitor& monitor,
         std::size_t total)
      : dir_(folder.unfinished()),
        monitor_(monitor),
        total_(total),
        batch_(
            options.threads, [this] { return wanted({}); },
            fmt::format("interrupted; completed runs are in {}: repeat the command to continue",
                        folder.unfinished().string()),
            folder.state() / "runs") {}

  /// The outcomes, in the order of the cases.
  std::vector<Outcome> run(const std::vector<NamedCase>& cases) {
    std::vector<input::Case> configs;
    for (const auto& c : cases) configs.push_back(c.config);
    std::vector<Outcome> outcomes(cases.size());
    batch_.run(
        configs,
        [&](std::size_t k, const run::Result& result, const run::InitialState& initial, bool was_kept) {
          const auto& name = cases[k].name;
          {
            const std::lock_guard lock(files_);  // HDF5 need not be built for several threads
            if (!was_kept) write(dir_ / name, result, initial);
            if (result.event.end == motion::EventEnd::blow_up)
              blow_ups.push_back(name + ": " + result.event.reason);
          }
          outcomes[k] = make_outcome(config_name(name), result, initial);
          wanted(name);
        },
        [&](std::size_t k) { return !needs_snapshots(configs[k]) && is_written(dir_ / cases[k].name); });
    return outcomes;
  }

  /// Loads a plate on until all of it slips in one event.
  LoadedOn run_sequence(const NamedCase& named, const results::ResultFolder& within, int threads) {
    results::ResultFolder folder(dir_ / named.name, run::run_work, &within);
    run::SessionOptions options;
    options.threads = threads;
    const run::SessionHooks hooks{[](const char*, std::int64_t, std::int64_t) {},
                                  [this] { return wanted({}) ? run::Request::none : run::Request::stop; },
                                  [](const std::string&) {}};
    const auto finished = run::run_sequence_into(folder, named.config, options, hooks,
                                                 [](std::size_t, const record::SequenceEvent&) {});
    wanted(named.name);
    const auto& friction = named.config.friction;
    return {interface::static_coefficient(friction), interface::kinetic_coefficient(friction),
            record::strongest(finished.loading).shear_over_normal, finished.events.size()};
  }

  const run::Counts& counts() const { return batch_.counts(); }

  std::vector<std::string> blow_ups;

 private:
  /// Tells the monitor, with the name of a run that is done.
  bool wanted(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (!name.empty()) ++done_;
    interrupted_ = !monitor_(done_, total_, name) || interrupted_;
    return !interrupted_;
  }

  /// Whether the outcome is that of a run with its snapshots (C25), which are not kept.
  static bool needs_snapshots(const input::Case& config) {
    return config.event == interface::EventKind::left && !config.output.snapshot_times_s.empty();
  }

  /// Whether a run's folder is complete and as it was written.
  static bool is_written(const std::filesystem::path& dir) {
    try {
      files::require_intact(dir);
      return files::is_there(dir / files::checksum_list);
    } catch (const UserError&) {
      return false;
    }
  }

  static void write(const std::filesystem::path& dir, const run::Result& result,
                    const run::InitialState& initial) {
    results::remove_tree(dir);  // what an interruption has left
    files::make_folders(dir);
    run::write(dir, result, initial);
  }

  /// The last part of a study's path names its event.
  static std::string config_name(const std::string& name) {
    return std::filesystem::path(name).filename().string();
  }

  std::filesystem::path dir_;
  const RunMonitor& monitor_;
  std::size_t total_, done_ = 0;
  bool interrupted_ = false;
  std::mutex mutex_, files_;
  run::Batch batch_;
};

/// Cases of studies as one list, so that the machine is busy to the end.
std::vector<NamedCase> list_cases(const std::vector<Study>& studies, const std::string& folder) {
  std::vector<NamedCase> list;
  for (const auto& study : studies)
    for (const auto& point : study.points)
      for (const auto& c : point.cases)
        list.push_back(
            {fmt::format("{}studies/{}/{}/{}", folder, study.name, point.value, c.name), c.config});
  return list;
}

/// The outcomes of such a list, by study. Takes them away.
std::vector<StudyOutcome> by_study(const std::vector<Study>& studies, std::span<Outcome> outcomes) {
  std::vector<StudyOutcome> list;
  auto next = std::make_move_iterator(outcomes.begin());
  for (const auto& study : studies) {
    StudyOutcome result{study, {}};
    for (const auto& point : study.points) {
      const auto end = next + static_cast<std::ptrdiff_t>(point.cases.size());
      result.outcomes.emplace_back(next, end);
      next = end;
    }
    list.push_back(std::move(result));
  }
  return list;
}

/// All cases of a variation in its own folder: the events first.
std::vector<NamedCase> list_cases(const Variation& variation) {
  const std::string folder = fmt::format("variations/{}/", variation.name);
  std::vector<NamedCase> list;
  for (const auto& c : variation.events) list.push_back({folder + c.name, c.config});
  for (auto& c : list_cases(variation.studies, folder)) list.push_back(std::move(c));
  return list;
}

/// What is done, for results::ResultFolder: a reproduction goes on behind one of the same runs by the same
/// program.
std::string work(const ReproduceOptions& options) {
  return fmt::format("reproduce{}{}{} with {}", options.quick ? " --quick" : "",
                     options.regularised ? " --regularised" : "", options.sensitivity ? " --sensitivity" : "",
                     run::program_identity());
}

/// What a user gives besides the paper's cases.
struct Given {
  std::optional<input::Experiment> experiment;
  std::optional<TriggerSample> triggers;
};

Given read_given(const ReproduceOptions& options) {
  Given given;
  if (!options.experiment.empty())
    given.experiment = input::read_experiment(options.experiment, run::wave_speeds(solid::Material{}).c_L);
  if (!options.open_choices.empty()) {
    std::error_code error;
    if (std::filesystem::equivalent(options.open_choices, options.dir, error))
      throw UserError("output folder {}: holds the study of the open choices; choose another",
                      options.dir.string());
    given.triggers = read_trigger_sample(options.open_choices, options.quick);
  }
  return given;
}

/// All that a reproduction runs.
struct Plan {
  std::vector<NamedCase> events;
  std::vector<Study> studies;
  std::vector<NamedCase> sequences;
  std::vector<Variation> variations;

  std::size_t n_runs() const {
    std::size_t n = events.size() + sequences.size() + list_cases(studies, "").size();
    for (const auto& variation : variations) n += list_cases(variation).size();
    return n;
  }
};

Plan make_plan(const ReproduceOptions& options) {
  return {paper_cases(options.quick), options.regularised ? regularised_studies() : studies(options.quick),
          sequences(options.quick),
          options.sensitivity ? variations(options.quick) : std::vector<Variation>{}};
}

/// The wall time of the parts of a reproduction, one after the other.
class Laps {
 public:
  void end(const char* part) {
    const auto now = Clock::now();
    timings.push_back({part, seconds_between(last_, now)});
    last_ = now;
  }

  std::vector<Timing> timings;

 private:
  Clock::time_point last_ = Clock::now();
};

/// The claims at the variation's values beside those of the paper's cases.
void run_variation(const Variation& variation, const Given& given, Runner& runner,
                   std::vector<Claim>& claims) {
  auto all = runner.run(list_cases(variation));
  const auto varied_studies = by_study(variation.studies, std::span(all).subspan(4));
  add_variation(claims, variation,
                // The triggers were not sampled on other meshes.
                scorecard({all[0], all[1], all[2], all[3], varied_studies, given.experiment, {}}));
}

void write_timings(const std::filesystem::path& file, const std::vector<Timing>& timings) {
  nlohmann::ordered_json json;
  for (const auto& t : timings) json.push_back({{"part", t.part}, {"wall_s", t.wall_s}});
  files::write_text(file, json.dump(2) + "\n");
}

}  // namespace

ReproduceReport reproduce(const ReproduceOptions& options, const RunMonitor& monitor) {
  SLIPFRONT_ASSERT(!(options.regularised && options.sensitivity), "no variations of the delayed friction");
  const Given given = read_given(options);
  results::ResultFolder folder(options.dir, work(options));
  folder.require_empty(options.overwrite, true);
  folder.begin_or_resume();
  const Plan plan = make_plan(options);
  Laps laps;
  Runner runner(options, folder, monitor, plan.n_runs());

  auto four = runner.run(plan.events);
  Reproduction runs{four[0], four[1], four[2], four[3], {}, given.experiment, given.triggers};
  laps.end("statics, four events and their files");
  const auto event_blow_ups = runner.blow_ups;
  scorecard(runs);
  laps.end("analysis of the four events");

  auto outcomes = runner.run(list_cases(plan.studies, ""));
  runs.studies = by_study(plan.studies, outcomes);
  laps.end("studies");
  for (const auto& c : plan.sequences)
    runs.loaded_on.push_back(runner.run_sequence({"sequences/" + c.name, c.config}, folder, options.threads));
  laps.end("sequences");
  ReproduceReport report;
  report.claims = scorecard(runs);
  for (const auto& variation : plan.variations) run_variation(variation, given, runner, report.claims);
  if (!plan.variations.empty()) laps.end("variations of mesh and step");
  write_scorecard(folder.unfinished() / "scorecard.json", report.claims);
  write_analysis(folder.unfinished() / "analysis.json", runs);
  laps.end("analysis and scorecard");

  report.timings = laps.timings;
  write_timings(folder.unfinished() / "timings.json", report.timings);
  folder.publish();
  report.warnings = runner.blow_ups;
  report.counts = runner.counts();
  if (!event_blow_ups.empty()) throw BlowUp(event_blow_ups.front());
  return report;
}

}  // namespace slipfront::kammer2012
