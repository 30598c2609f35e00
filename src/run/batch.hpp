// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "run/finished.hpp"
#include "run/run.hpp"

namespace slipfront::run {

/// Runs that were done, and those of them that ended before time.end_s since nothing moved.
struct Counts {
  std::size_t n_runs = 0, n_quiet = 0;
  void add(motion::EventEnd end) {
    ++n_runs;
    if (end == motion::EventEnd::quiet) ++n_quiet;
  }
};

/// Runs cases side by side, sharing the initial states of those with the same initial_state_key. Results do
/// not depend on the number of threads.
class Batch {
 public:
  /// @param may_continue         asked often, by one thread at a time; false interrupts all runs
  /// @param interruption  the message then
  /// @param kept          folder of the runs that are done; empty for none
  Batch(int threads, std::function<bool()> may_continue, std::string interruption,
        const std::filesystem::path& kept = {});

  /// Called by the thread that ran case k, also where the event blew up; a run that was kept has no history
  /// and no snapshots.
  using Done =
      std::function<void(std::size_t k, const Result& result, const InitialState& initial, bool was_kept)>;
  /// Whether what was kept of a case will do.
  using Usable = std::function<bool(std::size_t k)>;

  /// Runs all cases, in their order where there are more than threads, but for those that were kept. Initial
  /// states are kept for later calls.
  /// @throws Interrupted, and what a run or `done` throws first.
  void run(std::span<const Problem> cases, const Done& done, const Usable& usable = {});

  /// Counts of all calls.
  const Counts& counts() const { return counts_; }

 private:
  void compute_initial_states(std::span<const Problem* const> cases);
  bool wanted();
  motion::Monitor monitor();

  int threads_;
  std::function<bool()> may_continue_;
  std::string interruption_;
  bool interrupted_ = false;
  Counts counts_;
  std::mutex mutex_;
  std::map<std::string, InitialState> states_;
  std::optional<FinishedRuns> kept_;
};

}  // namespace slipfront::run
