// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/message.hpp"

namespace slipfront {

/// The user's input cannot be used. The message is one line that says where and what to do; exit code 2. It
/// is about the keys that it names,
///     throw UserError("{} is {} m; it must be at most {} m", Key("plate.width_m"), width_m, max_m);
/// and where they were set is added by whoever has read the case.
class UserError : public std::runtime_error {
 public:
  explicit UserError(Message message) : std::runtime_error(message.text), keys_(std::move(message.keys)) {}
  template <typename... Args>
  explicit UserError(fmt::format_string<Args...> format, Args&&... args)
      : UserError(Message(format, std::forward<Args>(args)...)) {}

  /// Dotted keys, those first that come first in the message.
  const std::vector<std::string>& keys() const { return keys_; }

  /// The same error, about further keys that its message does not name.
  template <class... Keys>
  UserError about(const Keys&... keys) const {
    UserError error = *this;
    (error.keys_.push_back(Key(keys).name), ...);
    return error;
  }
  /// The same error with its place before the message.
  UserError at(const std::string& place) const {
    UserError error("{}: {}", place, what());
    error.keys_ = keys_;
    return error;
  }

 private:
  std::vector<std::string> keys_;
};

/// The system refuses to write or keep a file: a full disk, a quota, a broken device. The message is one line
/// that names the file; exit code 1.
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;
  template <typename... Args>
  explicit WriteError(fmt::format_string<Args...> format, Args&&... args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

/// The computed motion is no longer physical (not a number, energy from nowhere); exit code 3.
struct BlowUp : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user interrupted the work; what was done so far is written. Exit code 130.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {
/// Prints the broken condition with its place and aborts.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line, const char* why);
}  // namespace detail

}  // namespace slipfront

/// Checks a condition that only a programming error can break; on in every build, for use outside hot loops.
#define SLIPFRONT_ASSERT(condition, why) \
  ((condition) ? static_cast<void>(0)    \
               : ::slipfront::detail::assertion_failed(#condition, __FILE__, __LINE__, why))
