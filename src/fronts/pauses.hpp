// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace slipfront::fronts {

/// Calls a function once in so many pieces of work, such as nodes; one that throws ends the work.
class Pauses {
 public:
  explicit Pauses(const std::function<void()>& pause) : pause_(pause) {}
  void count() {
    if (++n_ % every == 0 && pause_) pause_();
  }

 private:
  static constexpr long every = 4096;
  const std::function<void()>& pause_;
  long n_ = 0;
};

}  // namespace slipfront::fronts
