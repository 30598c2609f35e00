// SPDX-License-Identifier: BSD-3-Clause
#include "paper/reproduce.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "base/error.hpp"
#include "io/results.hpp"
#include "paper/analysis.hpp"

namespace slipfront::paper {

namespace {

using Clock = std::chrono::steady_clock;

/// Calls work(k) for k in [0, n) from several threads; the first exception ends it and is thrown here.
void in_parallel(int threads, std::size_t n, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto loop = [&] {
    for (std::size_t k = next++; k < n; k = next++) {
      try {
        work(k);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = n;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (std::size_t t = 1; t < std::min(static_cast<std::size_t>(threads), n); ++t)
        others.emplace_back(loop);
    } catch (const std::system_error&) {
      // No more threads to be had: those that are there do the work.
    }
    loop();
  }
  if (failure) std::rethrow_exception(failure);
}

/// Runs cases side by side, sharing their initial states.
class Runner {
 public:
  Runner(const ReproduceOptions& options, const RunMonitor& monitor, std::size_t total)
      : options_(options), monitor_(monitor), total_(total) {}

  /// The outcomes, in the order of the cases; every run is written to its folder.
  std::vector<Outcome> run(const std::vector<NamedCase>& cases) {
    compute_initial_states(cases);
    std::vector<Outcome> outcomes(cases.size());
    in_parallel(options_.threads, cases.size(), [&](std::size_t k) {
      const auto& [name, config] = cases[k];
      const auto& initial = states_.at(run::initial_state_key(config));
      const auto result = run::run_event(config, initial, continue_while_wanted());
      io::prepare_output_folder(options_.dir / name, options_.overwrite);
      {
        const std::lock_guard lock(files_);  // HDF5 need not be built for several threads
        run::write(options_.dir / name, result, initial);
      }
      outcomes[k] = make_outcome(config_name(name), result, initial);
      const std::lock_guard lock(mutex_);
      if (result.event.end == solve::EventEnd::blow_up)
        blow_ups.push_back(name + ": " + result.event.blow_up);
      if (!monitor_(++done_, total_, name)) interrupted_ = true;
      if (interrupted_)
        throw Interrupted(
            fmt::format("interrupted; the runs that were done are in {}", options_.dir.string()));
    });
    return outcomes;
  }

  std::vector<std::string> blow_ups;

 private:
  void compute_initial_states(const std::vector<NamedCase>& cases) {
    std::vector<std::pair<std::string, const io::Case*>> missing;
    for (const auto& c : cases) {
      auto key = run::initial_state_key(c.config);
      if (states_.contains(key)) continue;
      states_[key] = {};
      missing.emplace_back(std::move(key), &c.config);
    }
    in_parallel(options_.threads, missing.size(), [&](std::size_t k) {
      // The statics do not ask by themselves.
      if (!continue_while_wanted()(0, 0))
        throw Interrupted(
            fmt::format("interrupted; the runs that were done are in {}", options_.dir.string()));
      states_.at(missing[k].first) = run::make_initial_state(*missing[k].second, continue_while_wanted());
    });
  }

  /// The last part of a study's path names its event.
  static std::string config_name(const std::string& name) {
    return std::filesystem::path(name).filename().string();
  }

  solve::Monitor continue_while_wanted() {
    return [this](std::int64_t, std::int64_t) {
      const std::lock_guard lock(mutex_);
      interrupted_ = interrupted_ || !monitor_(done_, total_, {});
      return !interrupted_;
    };
  }

  const ReproduceOptions& options_;
  const RunMonitor& monitor_;
  std::size_t total_, done_ = 0;
  bool interrupted_ = false;
  std::mutex mutex_, files_;
  std::map<std::string, run::InitialState> states_;
};

}  // namespace

ReproduceReport reproduce(const ReproduceOptions& options, const RunMonitor& monitor) {
  std::optional<io::Experiment> experiment;
  if (!options.experiment.empty())
    experiment = io::read_experiment(options.experiment, run::wave_speeds(solid::Material{}).c_L);
  io::prepare_output_folder(options.dir, options.overwrite);
  // An interrupted reproduction must not leave the verdicts of an earlier one beside its runs.
  for (const char* name : {"scorecard.json", "analysis.json", "timings.json"})
    std::filesystem::remove(options.dir / name);
  const auto events = paper_cases(options.quick);
  const auto study_list = options.regularised ? regularised_studies() : studies(options.quick);

  // All study runs as one list, so that the machine is busy to the end.
  std::vector<NamedCase> study_cases;
  for (const auto& study : study_list)
    for (const auto& point : study.points)
      for (const auto& c : point.cases)
        study_cases.push_back({fmt::format("studies/{}/{}/{}", study.name, point.value, c.name), c.config});

  ReproduceReport report;
  auto last = Clock::now();
  const auto lap = [&](const char* part) {
    const auto now = Clock::now();
    report.timings.push_back({part, std::chrono::duration<double>(now - last).count()});
    last = now;
  };
  Runner runner(options, monitor, events.size() + study_cases.size());
  auto four = runner.run(events);
  Reproduction runs{four[0], four[1], four[2], four[3], {}, experiment};
  lap("statics, four events and their files");
  const auto event_blow_ups = runner.blow_ups;
  scorecard(runs);
  lap("analysis of the four events");

  auto outcomes = runner.run(study_cases);
  auto next = outcomes.begin();
  for (const auto& study : study_list) {
    StudyOutcome result{study, {}};
    for (const auto& point : study.points) {
      result.outcomes.emplace_back(next, next + static_cast<std::ptrdiff_t>(point.cases.size()));
      next += static_cast<std::ptrdiff_t>(point.cases.size());
    }
    runs.studies.push_back(std::move(result));
  }
  lap("studies");
  report.claims = scorecard(runs);
  write_scorecard(options.dir / "scorecard.json", report.claims);
  write_analysis(options.dir / "analysis.json", runs);
  lap("analysis and scorecard");

  nlohmann::ordered_json timings;
  for (const auto& t : report.timings) timings.push_back({{"part", t.part}, {"wall_s", t.wall_s}});
  io::write_text(options.dir / "timings.json", timings.dump(2) + "\n");
  report.warnings = runner.blow_ups;
  if (!event_blow_ups.empty()) throw BlowUp(event_blow_ups.front());
  return report;
}

}  // namespace slipfront::paper
