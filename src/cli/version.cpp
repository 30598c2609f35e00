// SPDX-License-Identifier: BSD-3-Clause
#include "base/version.hpp"

#include <fmt/core.h>

#include "cli/commands.hpp"
#include "statics/settings.hpp"

namespace slipfront::cli {

std::string version_text() {
  return fmt::format(
      "{}\n"
      "compiler: {}\n"
      "processor: {}, vectors of {} bytes\n"
      "precision: double; with time.precision = \"single\" the rows away from the interface in single\n"
      "statics: multifrontal Cholesky, multigrid; {}",
      version_line(), compiler(), processor(), vector_bytes_of_processor(), statics::algebra_library());
}

}  // namespace slipfront::cli
