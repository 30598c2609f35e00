// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "base/interruption.hpp"

namespace slipfront::test {

/// While it lives the end of the work in hand is wanted, from a number of questions after that on.
class InterruptionAfter {
 public:
  explicit InterruptionAfter(int questions) {
    last_ = questions;
    asked_ = 0;
    ask_for_interruption([] { return asked_++ >= last_; });
  }
  ~InterruptionAfter() { ask_for_interruption(nullptr); }
  InterruptionAfter(const InterruptionAfter&) = delete;
  InterruptionAfter& operator=(const InterruptionAfter&) = delete;

  static int asked() { return asked_; }
  static bool is_wanted() { return asked_ > last_; }

 private:
  inline static std::atomic<int> last_ = 0, asked_ = 0;
};

}  // namespace slipfront::test
