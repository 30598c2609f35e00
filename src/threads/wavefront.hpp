// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>

#include "threads/team.hpp"

namespace slipfront::threads {

/// Takes many time steps in one sweep through memory. A step consists of units 0 ... n-1, in this order; unit
/// k of a step may begin when unit k + 1 of the step before has ended (the last one's, where there is no
/// k + 1). A thread takes `steps_per_sweep` steps through the units together, each one unit behind the step
/// before, so that a unit's data are still in cache when the next step needs them; the threads take turns
/// with such groups of steps.
///
/// Whatever they and the threads are, each unit sees the same data, and the units 0 run one after the other.
class Wavefront {
 public:
  /// @return of unit 0: whether another step may follow; else without meaning
  using Unit = std::function<bool(std::int64_t step, int unit)>;

  Wavefront(int threads, int steps_per_sweep);

  /// As many as asked for, or fewer if no more are available.
  int threads() const { return team_.size(); }
  int steps_per_sweep() const { return steps_per_sweep_; }
  /// Steps that may be under way at a time: steps that differ by this much never are.
  int max_steps() const { return threads() * steps_per_sweep_; }

  /// Takes steps first ... first + n - 1, or fewer where a unit 0 asks for it.
  /// @return the number of steps taken, all of their units done.
  /// @throws what a unit throws; the steps are then left where they are.
  std::int64_t run(std::int64_t first, std::int64_t n, int units, const Unit& unit);

 private:
  /// Units that a thread's last group has done, counted on over its groups; on a cache line of its own.
  struct alignas(64) Progress {
    std::atomic<std::int64_t> value = 0;
  };
  struct Task {
    std::int64_t first = 0, n = 0;
    int units = 0;
    const Unit* unit = nullptr;
  };

  void take_groups(int thread);
  bool wait_for(int thread, std::int64_t value) const;

  int steps_per_sweep_;
  Team team_;
  std::unique_ptr<Progress[]> ended_;  ///< [threads]
  Task task_;
  std::atomic<std::int64_t> end_ = 0;  ///< step before which the run ends
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;
};

}  // namespace slipfront::threads
