// SPDX-License-Identifier: BSD-3-Clause
#include "cli/output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "base/error.hpp"

namespace slipfront::cli {

void print_output(std::string_view text) {
  errno = 0;
  std::fwrite(text.data(), 1, text.size(), stdout);
  finish_output();
}

void finish_output() {
  std::cout.flush();
  std::fflush(stdout);
  if (std::ferror(stdout) == 0 || errno == EPIPE) return;
  throw WriteError("standard output cannot be written ({})", std::strerror(errno != 0 ? errno : EIO));
}

}  // namespace slipfront::cli
