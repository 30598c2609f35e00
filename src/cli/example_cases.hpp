// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace slipfront::cli {

/// A case to begin with, by the word that stands for it.
struct ExampleCase {
  const char* kind;
  const char* text;  ///< of its file, read when the program is built
};
extern const std::array<ExampleCase, 6> example_cases;

}  // namespace slipfront::cli
