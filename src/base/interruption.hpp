// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "base/error.hpp"

namespace slipfront {

namespace detail {
inline std::atomic<bool (*)()> asked_for_interruption = nullptr, asked_for_checkpoint = nullptr;

inline bool is_wanted(const std::atomic<bool (*)()>& by) {
  const auto asked = by.load(std::memory_order_relaxed);
  return asked != nullptr && asked();
}
}  // namespace detail

/// Says who knows whether the work in hand is to end; it is asked often, in any thread.
inline void ask_for_interruption(bool (*asked)()) {
  detail::asked_for_interruption = asked;
}

/// Whether the work in hand is to end, as by a signal.
inline bool is_interruption_wanted() {
  return detail::is_wanted(detail::asked_for_interruption);
}

/// Says who knows whether a checkpoint is wanted, until it is asked what else is.
inline void ask_for_checkpoint(bool (*asked)()) {
  detail::asked_for_checkpoint = asked;
}

/// Whether the steps are to pause, for an end or a checkpoint.
inline bool is_pause_wanted() {
  return is_interruption_wanted() || detail::is_wanted(detail::asked_for_checkpoint);
}

/// Ends work of which nothing can be kept.
inline void require_no_interruption(const char* told) {
  if (is_interruption_wanted()) throw Interrupted(told);
}

}  // namespace slipfront
