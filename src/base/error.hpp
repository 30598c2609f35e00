// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace slipfront {

/// The user's input cannot be used. The message is one line that says where and what to do; exit code 2.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
  template <typename... Args>
  explicit UserError(fmt::format_string<Args...> format, Args&&... args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
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

/// A problem with a known answer was solved otherwise than it should be; exit code 4.
struct VerificationFailed : std::runtime_error {
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
