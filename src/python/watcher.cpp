// SPDX-License-Identifier: BSD-3-Clause
#include "python/watcher.hpp"

#include <utility>

#include "base/interruption.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

/// Taking Python's lock is cheap beside so much work, and nobody waits so long for Ctrl-C.
constexpr double ask_every_s = 0.05;

/// The watcher of the run that this thread has begun.
thread_local Watcher* own_watcher = nullptr;

bool is_stop_wanted() {
  return own_watcher != nullptr && own_watcher->is_stopped();
}

}  // namespace

Watcher::Watcher(nb::object progress)
    : outer_(std::exchange(own_watcher, this)), progress_(std::move(progress)) {
  ask_for_interruption(is_stop_wanted);
}

Watcher::~Watcher() {
  own_watcher = outer_;
}

run::SessionHooks Watcher::hooks() {
  run::SessionHooks hooks;
  hooks.progress = [this](const char* part, std::int64_t step, std::int64_t total) {
    if (part != part_) asked_ = Clock::time_point();  // the first of each part is told
    part_ = part;
    step_ = step;
    total_ = total;
  };
  hooks.request = [this] { return is_stopped() ? run::Request::stop : run::Request::none; };
  hooks.note = [](const std::string&) {};
  return hooks;
}

bool Watcher::is_stopped() {
  if (!stopped_ && seconds_since(asked_) >= ask_every_s) ask_python();
  return stopped_;
}

void Watcher::ask_python() {
  asked_ = Clock::now();
  in_python([this] {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!part_.empty() && !progress_.is_none()) progress_(part_.c_str(), step_, total_);
  });
}

void Watcher::in_python(const std::function<void()>& work) {
  const nb::gil_scoped_acquire locked;
  try {
    work();
  } catch (const nb::python_error& error) {
    stopped_ = true;
    if (!error.matches(PyExc_KeyboardInterrupt)) raised_ = std::current_exception();
  } catch (...) {
    stopped_ = true;
    raised_ = std::current_exception();
  }
}

void Watcher::rethrow() const {
  if (raised_) std::rethrow_exception(raised_);
}

}  // namespace slipfront::python
