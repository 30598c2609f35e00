// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <utility>

namespace slipfront::cli {

/// Prints for commands whose results are in files: a reader who has gone or a full device is no reason to
/// lose them.
template <typename... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stdout);
}

}  // namespace slipfront::cli
