// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"

#include <cstdio>
#include <cstdlib>

namespace slipfront::detail {

void assertion_failed(const char* condition, const char* file, int line, const char* why) {
  std::fprintf(stderr, "slipfront: internal error at %s:%d: %s (%s)\n", file, line, why, condition);
  std::abort();
}

}  // namespace slipfront::detail
