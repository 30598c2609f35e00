// SPDX-License-Identifier: BSD-3-Clause
#include "cli/interrupt.hpp"

#include <csignal>

namespace slipfront::cli {

namespace {

volatile std::sig_atomic_t wanted = 0;

void on_signal(int signal) {
  wanted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool interrupt_wanted() {
  return wanted != 0;
}

}  // namespace slipfront::cli
