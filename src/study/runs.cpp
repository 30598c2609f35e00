// SPDX-License-Identifier: BSD-3-Clause
#include "study/runs.hpp"

#include <atomic>

namespace slipfront::study {

input::Case for_study(input::Case config) {
  config.output.history_interval_s = 1e-5;
  config.output.snapshot_times_s.clear();
  return config;
}

std::vector<Run> run_cases(std::span<const input::Case> cases, int threads, const StudyMonitor& monitor,
                           const std::filesystem::path& kept) {
  for (const auto& c : cases) run::check(c);
  std::vector<Run> runs(cases.size());
  std::atomic<std::size_t> done = 0;
  run::Batch batch(
      threads, [&] { return monitor(done, cases.size()); },
      "interrupted; completed runs are saved: repeat the command to continue", kept);
  batch.run(cases, [&](std::size_t k, const run::Result& r, const run::InitialState& initial, bool) {
    auto& run = runs[k];
    run.main.options = run::front_options(cases[k], initial);
    run.end = r.event.end;
    if (run.end == motion::EventEnd::blow_up)
      run.blow_up = r.event.reason;
    else
      run.main.fronts = main_fronts(r.fronts);
    run.node_updates_per_s = r.node_updates_per_step / r.step_s;
    run.stepping_wall_s = r.stepping_wall_s;
    ++done;
  });
  return runs;
}

run::Counts counts_of(std::span<const Run> runs) {
  run::Counts counts;
  for (const auto& run : runs) counts.add(run.end);
  return counts;
}

}  // namespace slipfront::study
