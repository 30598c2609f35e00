// SPDX-License-Identifier: BSD-3-Clause
#include "threads/wavefront.hpp"

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

#include "base/error.hpp"

namespace slipfront::threads {

namespace {

/// Looks at a condition before the processor is left to others.
constexpr int max_looks = 2000;

void pause() {
#ifdef __x86_64__
  __builtin_ia32_pause();
#endif
}

}  // namespace

Wavefront::Wavefront(int threads, int steps_per_sweep)
    : steps_per_sweep_(steps_per_sweep), team_(threads), ended_(std::make_unique<Progress[]>(team_.size())) {
  SLIPFRONT_ASSERT(threads >= 1 && steps_per_sweep >= 1, "a wavefront needs a thread and a step");
}

std::int64_t Wavefront::run(std::int64_t first, std::int64_t n, int units, const Unit& unit) {
  task_ = {first, n, units, &unit};
  end_ = first + n;
  failed_ = false;
  for (int thread = 0; thread < threads(); ++thread) ended_[static_cast<std::size_t>(thread)].value = 0;
  // One group alone needs no other thread.
  team_.run(n <= steps_per_sweep_ ? 1 : threads(), [this](int thread) { take_groups(thread); });
  if (failed_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return end_ - first;
}

bool Wavefront::wait_for(int thread, std::int64_t value) const {
  const auto& ended = ended_[static_cast<std::size_t>(thread)].value;
  for (int looks = 0; ended.load(std::memory_order_acquire) < value; ++looks) {
    if (failed_.load(std::memory_order_relaxed)) return false;
    if (looks < max_looks) {
      pause();
    } else {
      std::this_thread::yield();
    }
  }
  return true;
}

void Wavefront::take_groups(int thread) {
  const auto& [first, n, units, unit] = task_;
  auto& ended = ended_[static_cast<std::size_t>(thread)].value;
  const int n_threads = threads();
  try {
    for (std::int64_t group = thread;; group += n_threads) {
      const std::int64_t first_step = first + group * steps_per_sweep_;
      // Progress of group g counts from g times this.
      const std::int64_t per_group = units + 1;
      const std::int64_t before = (group - 1) * per_group;
      const int other = static_cast<int>((group + n_threads - 1) % n_threads);
      std::int64_t steps = std::min<std::int64_t>(steps_per_sweep_, first + n - first_step);
      if (steps <= 0) break;
      // In round `front`, step s of the group takes unit front - s: each is one unit behind the step before.
      for (std::int64_t front = 0; front < units + steps - 1; ++front) {
        // The first step follows the last one of the group before, which must have ended one unit more.
        if (group > 0 && front < units && n_threads > 1) {
          if (!wait_for(other, before + std::min<std::int64_t>(front + 2, units))) return;
        }
        for (std::int64_t s = 0; s < steps; ++s) {
          const std::int64_t k = front - s;
          if (k < 0 || k >= units) continue;
          const std::int64_t step = first_step + s;
          if (k == 0 && step >= end_.load(std::memory_order_relaxed)) {
            steps = s;
            break;
          }
          const bool go_on = (*unit)(step, static_cast<int>(k));
          if (k == 0 && !go_on) end_.store(step + 1, std::memory_order_relaxed);
        }
        if (steps == 0) break;
        // A group is as far as its last step.
        const std::int64_t units_done = std::clamp<std::int64_t>(front - (steps - 1) + 1, 0, units);
        ended.store(group * per_group + units_done, std::memory_order_release);
      }
      if (steps < steps_per_sweep_) break;
    }
  } catch (...) {
    if (!failed_.exchange(true)) failure_ = std::current_exception();
    return;
  }
  // Nobody waits for a thread that has come to its end.
  ended.store(std::numeric_limits<std::int64_t>::max(), std::memory_order_release);
}

}  // namespace slipfront::threads
