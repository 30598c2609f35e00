// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "run/session.hpp"

namespace slipfront::test {

/// Stops at the given step of a part; never where that is negative.
inline run::SessionHooks stopping_at(const std::string& part, std::int64_t stop_at) {
  auto stop = std::make_shared<bool>(false);
  return {[=](const char* now, std::int64_t step, std::int64_t) {
            *stop = stop_at >= 0 && now == part && step >= stop_at;
          },
          [=] { return *stop ? run::Request::stop : run::Request::none; }, [](const std::string&) {}};
}

inline const run::SessionHooks undisturbed = stopping_at("", -1);

inline run::SessionOptions with_threads(int threads) {
  run::SessionOptions options;
  options.threads = threads;
  return options;
}

}  // namespace slipfront::test
