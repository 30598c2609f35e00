// SPDX-License-Identifier: BSD-3-Clause
#include "cli/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <initializer_list>

#include "base/interruption.hpp"

namespace slipfront::cli {

namespace {

volatile std::sig_atomic_t ended_by = 0;
volatile std::sig_atomic_t checkpoint = 0;

void on_end(int signal) {
  ended_by = signal;
  // A second key ends the program at once. The other signals may come twice for one event: HUP of kernel and
  // shell, TERM once for each thread of a parent that is killed (PR_SET_PDEATHSIG), XCPU each second.
  for (const int each : {SIGINT, SIGQUIT}) std::signal(each, SIG_DFL);
}

void on_refused_write(int signal, siginfo_t* info, void* /*context*/) {
  // The kernel sends it in this process's own name.
  if (info->si_code == SI_USER && info->si_pid != getpid()) on_end(signal);
}

void on_checkpoint(int /*signal*/) {
  checkpoint = 1;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  sigfillset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  const auto take = [&](int signal) {
    // What is ignored from the start, as by nohup, stays so.
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  };
  action.sa_handler = on_end;
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU}) take(signal);
  action.sa_handler = on_checkpoint;
  take(SIGUSR1);
  action.sa_sigaction = on_refused_write;
  action.sa_flags |= SA_SIGINFO;
  for (const int signal : {SIGPIPE, SIGXFSZ}) take(signal);
  ask_for_interruption(interrupt_wanted);
}

bool interrupt_wanted() {
  return ended_by != 0;
}

int interrupting_signal() {
  return ended_by;
}

void pause_for_checkpoints() {
  ask_for_checkpoint([] { return checkpoint != 0; });
}

bool checkpoint_wanted() {
  const bool wanted = checkpoint != 0;
  if (wanted) checkpoint = 0;
  return wanted;
}

}  // namespace slipfront::cli
