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
#include <string>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/python_command.hpp"
#include "processes/processes.hpp"
#include "run/session.hpp"
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

/// Other commands would leave all of their work to rank 0.
void require_shared(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string_view command(argv[1]);
  if (command == "run") return;
  throw slipfront::UserError("slipfront: only run can be shared by several MPI ranks; start {} alone",
                             command);
}

void run(int argc, char** argv, slipfront::Processes& processes) {
  if (processes.size() > 1) require_shared(argc, argv);
  slipfront::cli::become_python_command(argc, argv);
  slipfront::cli::Program program("slipfront", "Slip fronts at frictional interfaces",
                                  slipfront::cli::version_text());
  auto& app = program.app();
  slipfront::cli::add_run(app, processes);
  slipfront::cli::add_info(app);
  slipfront::cli::add_fracture(app);
  slipfront::cli::add_validate(app);
  slipfront::cli::add_new(app);
  slipfront::cli::add_keys(app);
  slipfront::cli::add_python_commands(app);
  slipfront::cli::add_verify(app);
  slipfront::cli::add_bench(app);
  slipfront::cli::add_page(app, program);
  program.run(argc, argv);
}

/// The exit code for the exception under way, and the line that says why.
std::pair<int, std::string> reason_to_end() try { throw; } catch (const slipfront::UserError& error) {
  return {user_error, error.what()};
} catch (const slipfront::BlowUp& error) {
  return {blow_up, fmt::format("slipfront: {}", error.what())};
} catch (const slipfront::VerificationFailed& error) {
  return {verification_failed, fmt::format("slipfront: {}", error.what())};
} catch (const slipfront::Interrupted& error) {
  return {code_of(slipfront::cli::interrupting_signal()), fmt::format("slipfront: {}", error.what())};
} catch (const slipfront::WriteError& error) {
  return {internal_error, fmt::format("slipfront: {}", error.what())};
} catch (const slipfront::ProcessError& error) {
  return {internal_error, fmt::format("slipfront: {}", error.what())};
} catch (const std::bad_alloc&) {
  return {internal_error, "slipfront: not enough memory; use larger elements"};
} catch (const std::exception& error) {
  return {internal_error, fmt::format("slipfront: internal error: {}", error.what())};
} catch (...) {
  return {internal_error, "slipfront: internal error of unknown kind"};
}

/// Rank 0 reads the options, and the others take part in the runs that these ask for.
void run_on(slipfront::Processes& processes, int argc, char** argv) try {
  if (processes.size() > 1) slipfront::run::require_same_program(processes);
  if (!processes.is_root()) return slipfront::run::take_part(processes);
  run(argc, argv, processes);
  slipfront::run::release(processes);
} catch (const slipfront::FailedElsewhere&) {
  // Rank 0 tells why.
} catch (...) {
  const auto [code, line] = reason_to_end();
  constexpr std::string_view name = "slipfront: ";
  if (!processes.is_root())
    processes.fail(code, fmt::format("{}rank {}: {}", name, processes.rank(),
                                     line.substr(line.starts_with(name) ? name.size() : 0)));
  if (processes.is_awaited()) processes.fail(code, line);
  slipfront::run::release(processes);
  throw;
}

}  // namespace

int main(int argc, char** argv) try {
  hold_standard_streams();
  require_stack();
  run_on(*slipfront::join_processes(argc, argv), argc, argv);
  return done;
} catch (...) {
  // A user's error starts with its place, FILE:LINE, so that editors find it; the rest with the program's
  // name.
  const auto [code, line] = reason_to_end();
  std::fputs((line + "\n").c_str(), stderr);
  return code;
}
