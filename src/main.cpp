// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <string_view>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "cli/program.hpp"
#include "cli/python_command.hpp"
#include "processes/processes.hpp"
#include "run/session.hpp"

namespace {

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
  slipfront::cli::Program program("slipfront", "Slip fronts at frictional interfaces");
  auto& app = program.app();
  slipfront::cli::add_run(app, processes);
  slipfront::cli::add_info(app);
  slipfront::cli::add_fracture(app);
  slipfront::cli::add_validate(app);
  slipfront::cli::add_new(app);
  slipfront::cli::add_keys(app);
  slipfront::cli::add_python_commands(app);
  slipfront::cli::add_bench(app);
  slipfront::cli::add_page(app, program);
  program.run(argc, argv);
}

/// Rank 0 reads the options, and the others take part in the runs that these ask for.
void run_on(slipfront::Processes& processes, int argc, char** argv) try {
  if (processes.size() > 1) slipfront::run::require_same_program(processes);
  if (!processes.is_root()) return slipfront::run::serve_ranks(processes);
  run(argc, argv, processes);
  slipfront::run::stop_ranks(processes);
} catch (const slipfront::FailedElsewhere&) {
  // Rank 0 tells why.
} catch (...) {
  const auto [code, line] = slipfront::cli::reason_to_end();
  constexpr std::string_view name = "slipfront: ";
  if (!processes.is_root())
    processes.fail(code, fmt::format("{}rank {}: {}", name, processes.rank(),
                                     line.substr(line.starts_with(name) ? name.size() : 0)));
  if (processes.is_awaited()) processes.fail(code, line);
  slipfront::run::stop_ranks(processes);
  throw;
}

}  // namespace

int main(int argc, char** argv) {
  return slipfront::cli::exit_code_of([&] {
    run_on(*slipfront::join_processes(argc, argv), argc, argv);
    return 0;
  });
}
