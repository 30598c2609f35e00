// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <exception>
#include <string>
#include <utility>

#include "processes/processes.hpp"

namespace slipfront {

/// Runs what other ranks wait for; a failure ends the program.
template <class F>
void or_fail(Processes& processes, F&& f) {
  try {
    f();
  } catch (const std::exception& error) {
    processes.fail(reason_of(error));
  }
}

/// What work gives, or in one line why it failed, for the process that has asked for it.
/// @param work  puts it into a buffer
template <class F>
MessageBuffer answer_of(const Processes& processes, F&& work) {
  const auto failed = [](const std::string& reason) { return std::move(MessageBuffer().put(reason)); };
  try {
    MessageBuffer answer;
    answer.put(std::string());
    work(answer);
    return answer;
  } catch (const ProcessError& error) {
    return failed(error.what());
  } catch (const std::exception& error) {
    return failed(fmt::format("process {} of {}: {}", processes.rank(), processes.size(), reason_of(error)));
  }
}

/// Takes the answers of several processes: all of them, whatever fails, so that those of the next command are
/// not mixed up with them.
class Answers {
 public:
  explicit Answers(Processes& processes) : processes_(processes) {}

  /// Does what is wanted as long as nothing has failed.
  template <class F>
  void unless_failed(F&& f) {
    if (failure_ != nullptr) return;
    try {
      f();
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
  template <class F>
  void take(int from, F&& f) {
    MessageBuffer answer;
    or_fail(processes_, [&] { answer = processes_.receive(from); });
    unless_failed([&] {
      if (const auto failed = answer.take_text(); !failed.empty()) throw ProcessError(failed);
      f(answer);
    });
  }
  /// @throws what has failed first
  void end() const {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
  }

 private:
  Processes& processes_;
  std::exception_ptr failure_;
};

}  // namespace slipfront
