// SPDX-License-Identifier: BSD-3-Clause
#include "threads/wavefront.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace slipfront::threads {
namespace {

struct Shape {
  int threads, depth, units, steps;
};
constexpr Shape shapes[] = {{1, 1, 1, 4}, {1, 5, 7, 23}, {2, 1, 2, 23}, {2, 5, 1, 4},
                            {2, 2, 7, 0}, {3, 2, 7, 1},  {3, 5, 7, 23}, {3, 1, 2, 4}};

/// A chain of cells whose next value depends on both neighbours' present ones, updated in place: a step that
/// comes too early or too late on any unit leaves other numbers.
std::vector<double> diffused(int threads, int depth, int units, int steps) {
  const auto n = static_cast<std::size_t>(units);
  std::vector<double> value(n + 2, 0.0);
  for (std::size_t k = 0; k < n; ++k) value[k + 1] = static_cast<double>(k * k % 11);
  Wavefront wavefront(threads, depth);
  std::vector<double> below(static_cast<std::size_t>(wavefront.max_steps()));
  const auto taken = wavefront.run(0, steps, units, [&](std::int64_t step, int unit) {
    double& old_below = below[static_cast<std::size_t>(step % wavefront.max_steps())];
    if (unit == 0) old_below = 0;
    double& here = value[static_cast<std::size_t>(unit) + 1];
    const double old = here;
    here += 0.25 * (old_below - 2 * old + value[static_cast<std::size_t>(unit) + 2]) + 0.001 * unit;
    old_below = old;
    return true;
  });
  EXPECT_EQ(taken, steps);
  return value;
}

TEST(Wavefront, ComputesWhatStepAfterStepDoes) {
  for (const auto& [threads, depth, units, steps] : shapes)
    EXPECT_EQ(diffused(threads, depth, units, steps), diffused(1, 1, units, steps));
}

TEST(Wavefront, AUnitBeginsWhenTheNextOneOfTheStepBeforeHasEnded) {
  for (const auto& shape : shapes) {
    const int units = shape.units;
    std::vector<std::atomic<int>> ended(static_cast<std::size_t>(shape.steps) + 1);
    ended.front() = units;
    Wavefront(shape.threads, shape.depth).run(0, shape.steps, units, [&](std::int64_t step, int unit) {
      EXPECT_GE(ended[static_cast<std::size_t>(step)], std::min(unit + 2, units));
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      ended[static_cast<std::size_t>(step) + 1] = unit + 1;
      return true;
    });
  }
}

TEST(Wavefront, EndsAfterTheStepThatAsksForIt) {
  for (const auto& shape : shapes) {
    const int threads = shape.threads, depth = shape.depth, units = shape.units, steps = shape.steps;
    Wavefront wavefront(threads, depth);
    for (int last = 10; last < 10 + steps; ++last) {
      std::vector<std::atomic<int>> done(static_cast<std::size_t>(steps));
      const auto taken = wavefront.run(10, steps, units, [&](std::int64_t step, int) {
        ++done[static_cast<std::size_t>(step - 10)];
        return step < last;
      });
      EXPECT_EQ(taken, last - 10 + 1);
      for (int step = 0; step < steps; ++step)
        EXPECT_EQ(done[static_cast<std::size_t>(step)], step <= last - 10 ? units : 0);
    }
  }
}

TEST(Wavefront, PassesOnWhatAUnitThrows) {
  for (const auto& shape : shapes) {
    const int threads = shape.threads, depth = shape.depth, units = shape.units, steps = shape.steps;
    Wavefront wavefront(threads, depth);
    const auto failing = [](std::int64_t step, int unit) -> bool {
      if (step == 3 && unit == 0) throw std::runtime_error("no more");
      return true;
    };
    if (steps > 3) {
      EXPECT_THROW(wavefront.run(0, steps, units, failing), std::runtime_error);
    }
    // And is of use again.
    EXPECT_EQ(wavefront.run(0, steps, units, [](std::int64_t, int) { return true; }), steps);
  }
}

}  // namespace
}  // namespace slipfront::threads
