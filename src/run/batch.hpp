// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>

#include "run/run.hpp"

namespace slipfront::run {

/// Runs cases side by side, sharing the initial states of those with the same initial_state_key. Results do
/// not depend on the number of threads.
class Batch {
 public:
  /// @param go_on         asked often, by one thread at a time; false interrupts all runs
  /// @param interruption  the message then
  Batch(int threads, std::function<bool()> go_on, std::string interruption);

  /// Called by the thread that ran case k, also where the event was interrupted or blew up.
  using Done = std::function<void(std::size_t k, const Result& result, const InitialState& initial)>;

  /// Runs all cases, in their order where there are more than threads. Initial states are kept for later
  /// calls.
  /// @throws Interrupted, and what a run or `done` throws first.
  void run(std::span<const io::Case> cases, const Done& done);

 private:
  void compute_initial_states(std::span<const io::Case> cases);
  bool wanted();
  solve::Monitor monitor();

  int threads_;
  std::function<bool()> go_on_;
  std::string interruption_;
  bool interrupted_ = false;
  std::mutex mutex_;
  std::map<std::string, InitialState> states_;
};

}  // namespace slipfront::run
