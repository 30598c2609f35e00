// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/python_command.hpp"
#include "processes/processes.hpp"
#include "run/subdomains.hpp"

namespace {

enum ExitCode {
  done = 0,
  internal_error = 1,  ///< or what was to be written could not be
  user_error = 2,
  blow_up = 3,
  verification_failed = 4
};

/// A program that a signal has made end tells so by this code, as a shell would.
int code_of(int signal) {
  constexpr int first = 128;
  return first + (signal != 0 ? signal : SIGINT);
}

#if defined(__AVX2__)
/// Ends a program that was compiled for another processor before the first instruction that this one lacks,
/// which could be in the initialisation of any static object.
[[gnu::constructor(101)]] void require_processor() {
  __builtin_cpu_init();
#ifdef __AVX512F__
  const bool is_there = __builtin_cpu_supports("avx512f") != 0;
#else
  const bool is_there = __builtin_cpu_supports("avx2") != 0;
#endif
  if (is_there) return;
  static constexpr char text[] =
      "slipfront: compiled for another processor than this one; compile it here, or install a package\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, sizeof text - 1);
  ::_exit(user_error);
}
#endif

/// Files that are opened take the lowest free number: one of a closed standard stream would get what is
/// printed. Writing to these stand-ins fails, as to a closed stream.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) != stream) std::_Exit(internal_error);
}

/// Beyond its end there is no message.
void require_stack() {
  constexpr rlim_t least_bytes = 1U << 20U;
  rlimit limit{};
  if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= least_bytes) return;
  throw slipfront::UserError("slipfront: a stack of {} KiB is too small; allow {} or more, as by ulimit -s",
                             limit.rlim_cur / 1024, least_bytes / 1024);
}

/// A user's error starts with its place, FILE:LINE, so that editors find it; the rest with the program's
/// name.
int report(int code, const std::string& message) {
  std::fputs((message + "\n").c_str(), stderr);
  return code;
}

/// Of several processes all but the leader wait for what it asks of them.
class Leading {
 public:
  explicit Leading(slipfront::Processes& processes) : processes_(processes) {
    slipfront::run::lead(processes);
  }
  Leading(const Leading&) = delete;
  Leading& operator=(const Leading&) = delete;
  ~Leading() { slipfront::run::dismiss(processes_); }

 private:
  slipfront::Processes& processes_;
};

/// Other commands would leave all of their work to the leader.
void require_shared(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string_view command(argv[1]);
  if (command == "run" || command == "bench") return;
  throw slipfront::UserError(
      "slipfront: only run and bench can be shared by several processes; start {} alone", command);
}

int run(int argc, char** argv) {
  const auto processes = slipfront::join_processes(argc, argv);
  if (processes && processes->rank() > 0) {
    slipfront::run::serve(*processes);
    return done;
  }
  std::optional<Leading> leading;
  if (processes) {
    leading.emplace(*processes);
    require_shared(argc, argv);
  }
  if (slipfront::cli::is_python_command(argc, argv)) slipfront::leave_processes();
  slipfront::cli::become_python_command(argc, argv);
  slipfront::cli::Program program("slipfront", "Slip fronts at frictional interfaces",
                                  slipfront::cli::version_text());
  auto& app = program.app();
  slipfront::cli::add_run(app, processes.get());
  slipfront::cli::add_info(app);
  slipfront::cli::add_validate(app);
  slipfront::cli::add_new(app);
  slipfront::cli::add_keys(app);
  slipfront::cli::add_python_commands(app);
  slipfront::cli::add_study(app);
  slipfront::cli::add_verify(app);
  slipfront::cli::add_reproduce(app);
  slipfront::cli::add_bench(app, processes.get());
  slipfront::cli::add_page(app, program);
  program.run(argc, argv);
  return done;
}

}  // namespace

int main(int argc, char** argv) try {
  hold_standard_streams();
  require_stack();
  return run(argc, argv);
} catch (const slipfront::UserError& error) {
  return report(user_error, error.what());
} catch (const slipfront::BlowUp& error) {
  return report(blow_up, fmt::format("slipfront: {}", error.what()));
} catch (const slipfront::VerificationFailed& error) {
  return report(verification_failed, fmt::format("slipfront: {}", error.what()));
} catch (const slipfront::Interrupted& error) {
  return report(code_of(slipfront::cli::interrupting_signal()), fmt::format("slipfront: {}", error.what()));
} catch (const slipfront::WriteError& error) {
  return report(internal_error, fmt::format("slipfront: {}", error.what()));
} catch (const slipfront::ProcessError& error) {
  return report(internal_error, fmt::format("slipfront: {}", error.what()));
} catch (const std::bad_alloc&) {
  return report(internal_error, "slipfront: not enough memory; use larger elements");
} catch (const std::exception& error) {
  return report(internal_error, fmt::format("slipfront: internal error: {}", error.what()));
} catch (...) {
  return report(internal_error, "slipfront: internal error of unknown kind");
}
