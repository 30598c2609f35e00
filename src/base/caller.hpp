// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <string>

namespace slipfront {

/// Who reads messages that say what to do: whoever called the program, or its Python module.
enum class Caller { shell, python };

namespace detail {
inline Caller caller = Caller::shell;
}

/// The module sets it when it is imported, before any other call.
inline void set_caller(Caller caller) {
  detail::caller = caller;
}

/// A part of a message in the words of the caller: an option, a command or a call.
template <class... Args>
std::string for_caller(fmt::format_string<const Args&...> shell, fmt::format_string<const Args&...> python,
                       const Args&... args) {
  return fmt::format(detail::caller == Caller::shell ? shell : python, args...);
}

}  // namespace slipfront
