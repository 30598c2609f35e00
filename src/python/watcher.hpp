// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>

#include "base/clock.hpp"
#include "run/session.hpp"

namespace slipfront::python {

/// Looks after Python while a run goes without its lock: signals such as Ctrl-C, and the progress shown.
class Watcher {
 public:
  /// @param progress  called with part, step and total; or None
  explicit Watcher(nanobind::object progress);
  ~Watcher();
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  run::SessionHooks hooks();
  /// Raises what Python code has raised meanwhile, but for Ctrl-C: it becomes the run's own interruption,
  /// which says what was kept.
  void rethrow() const;

  /// Whether the run is to end; Python is asked once in a while.
  bool is_stopped();

  /// Does work with Python's lock. What it throws ends the run and is kept for rethrow.
  void in_python(const std::function<void()>& work);

 private:
  void ask_python();

  Watcher* outer_;  ///< of a run that calls Python, which begins this one
  nanobind::object progress_;
  std::string part_;  ///< empty before the first
  std::int64_t step_ = 0, total_ = 0;
  std::atomic<Clock::time_point> asked_ = {};
  std::atomic<bool> stopped_ = false;  ///< threads of a batch ask, too
  std::exception_ptr raised_;
};

}  // namespace slipfront::python
