// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "base/error.hpp"

namespace slipfront {

namespace detail {
inline std::atomic<bool (*)()> asked_for_interruption = nullptr;
}

/// Says who knows whether the work in hand is to end; it is asked often, in any thread.
inline void ask_for_interruption(bool (*asked)()) {
  detail::asked_for_interruption = asked;
}

/// Whether the work in hand is to end, as by a signal.
inline bool is_interruption_wanted() {
  const auto asked = detail::asked_for_interruption.load(std::memory_order_relaxed);
  return asked != nullptr && asked();
}

/// Ends work of which nothing can be kept.
inline void require_no_interruption(const char* told) {
  if (is_interruption_wanted()) throw Interrupted(told);
}

}  // namespace slipfront
