// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/clock.hpp"

namespace slipfront::cli {

/// Progress of a known number of steps, or of what else `unit` names, on standard error: on a terminal one
/// line with percentage, rate and time to go that is redrawn at most 10 times a second; otherwise a plain
/// line every 10 %, at most one in 10 s. Silent where `quiet`.
class Progress {
 public:
  /// @param first  steps that were done before: the rate is that of those since
  /// @param now    the clock
  Progress(std::string label, std::int64_t total, bool quiet = false, std::string unit = "steps",
           std::int64_t first = 0, std::function<Clock::time_point()> now = Clock::now);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `step` steps are done. Cheap enough to be called every step.
  void update(std::int64_t step);
  /// Writes a separate line, on a terminal above that of the progress.
  void note(const std::string& line);
  /// The work is done, perhaps before the last step; says how long it took.
  void finish();

 private:
  std::string state(Clock::time_point now) const;

  std::string label_, unit_;
  std::function<Clock::time_point()> now_;
  std::int64_t total_, first_, step_ = first_;
  bool quiet_, terminal_, finished_ = false;
  bool line_open_ = false;  ///< the terminal's line waits to be redrawn
  Clock::time_point start_, drawn_;
  std::int64_t tenth_ = 0;  ///< last 10 % that a plain line was written for
};

/// "2.5 s", "3:07" (minutes:seconds) or "1:02:03".
std::string duration_text(double seconds);

}  // namespace slipfront::cli
