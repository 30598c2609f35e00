// SPDX-License-Identifier: BSD-3-Clause
#include "cli/log.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

namespace slipfront::cli {
namespace {

constexpr std::chrono::milliseconds between_drawings{100};
constexpr std::chrono::seconds between_lines{10};
/// Nobody need be there to see it.
void show(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

constexpr const char* clear_line = "\r\033[K";

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 59.5) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(std::min(seconds, 3.6e9)));
  const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

Progress::Progress(std::string label, std::int64_t total, bool quiet, std::string unit, std::int64_t first,
                   std::function<Clock::time_point()> now)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      now_(std::move(now)),
      total_(std::max<std::int64_t>(total, 1)),
      first_(first),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(now_()),
      drawn_(start_) {}

Progress::~Progress() {
  // Left by an exception: its message starts on a separate line.
  if (line_open_) std::fputc('\n', stderr);
}

std::string Progress::state(Clock::time_point now) const {
  const double elapsed_s = std::max(seconds_between(start_, now), 1e-9);
  const double per_s = static_cast<double>(step_ - first_) / elapsed_s;
  std::string text = fmt::format("{}: {} %, {:.3g} {}/s", label_, 100 * step_ / total_, per_s, unit_);
  if (step_ > first_)
    text += fmt::format(", {} to go", duration_text(static_cast<double>(total_ - step_) / per_s));
  return text;
}

void Progress::update(std::int64_t step) {
  step_ = std::min(step, total_);
  if (quiet_ || finished_) return;
  const std::int64_t tenth = 10 * step_ / total_;
  if (!terminal_ && (tenth <= tenth_ || tenth >= 10)) return;
  const Clock::time_point now = now_();
  if (now - drawn_ < (terminal_ ? Clock::duration(between_drawings) : Clock::duration(between_lines))) return;
  drawn_ = now;
  tenth_ = tenth;
  show(fmt::format("{}{}{}", terminal_ ? clear_line : "", state(now), terminal_ ? "" : "\n"));
  line_open_ = terminal_;
}

void Progress::note(const std::string& line) {
  if (quiet_) return;
  show(fmt::format("{}{}\n", line_open_ ? clear_line : "", line));
  line_open_ = false;
}

void Progress::finish() {
  if (quiet_ || finished_) return;
  finished_ = true;
  show(fmt::format("{}{}: {} {} in {}\n", terminal_ ? clear_line : "", label_, step_, unit_,
                   duration_text(seconds_between(start_, now_()))));
  line_open_ = false;
}

}  // namespace slipfront::cli
