// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <utility>

#include "run/batch.hpp"

namespace slipfront::cli {

/// Prints for commands whose results are in files: a reader who has gone or a full device is no reason to
/// lose them.
template <typename... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stdout);
}

/// How many of a study's runs ended early, and why.
inline void print_ends(const run::Counts& counts) {
  print("{} runs, {} of which ended before time.end_s since nothing moved\n", counts.n_runs, counts.n_quiet);
}

}  // namespace slipfront::cli
