// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace slipfront {

/// Reproducible numbers in [-1, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace slipfront
