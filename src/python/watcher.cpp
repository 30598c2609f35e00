// SPDX-License-Identifier: BSD-3-Clause
#include "python/watcher.hpp"

#include <string>

namespace slipfront::python {
namespace {

namespace nb = nanobind;

/// Taking Python's lock is cheap beside so much work, and nobody waits so long for Ctrl-C.
constexpr double ask_every_s = 0.05;

}  // namespace

run::SessionHooks Watcher::hooks() {
  run::SessionHooks hooks;
  hooks.progress = [this](const char* part, std::int64_t step, std::int64_t total) {
    if (part != part_) asked_ = {};  // the first of each part is told
    part_ = part;
    step_ = step;
    total_ = total;
  };
  hooks.request = [this] {
    if (stopped_) return run::Request::stop;
    if (seconds_since(asked_) < ask_every_s) return run::Request::none;
    return ask_python();
  };
  hooks.note = [](const std::string&) {};
  return hooks;
}

run::Request Watcher::ask_python() {
  const nb::gil_scoped_acquire locked;
  asked_ = Clock::now();
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (part_ != nullptr && !progress_.is_none()) progress_(part_, step_, total_);
    return run::Request::none;
  } catch (const nb::python_error& error) {
    stopped_ = true;
    if (!error.matches(PyExc_KeyboardInterrupt)) raised_ = std::current_exception();
    return run::Request::stop;
  }
}

void Watcher::rethrow() const {
  if (raised_) std::rethrow_exception(raised_);
}

}  // namespace slipfront::python
