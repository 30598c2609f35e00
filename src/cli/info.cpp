// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "run/run.hpp"

namespace slipfront::cli {
namespace {

void print_info(const CaseArguments& arguments) {
  const io::Case config = arguments.read();
  run::Info info;
  try {
    info = run::info(config);
  } catch (const UserError& error) {
    throw UserError(io::with_place(arguments.file, error.what(), arguments.overrides()));
  }
  const auto line = [](const char* what, const std::string& value) { fmt::print("{:<32}{}\n", what, value); };
  if (!config.title.empty()) line("title", config.title);
  line("longitudinal wave speed c_L", fmt::format("{:.1f} m/s", info.speeds.c_L));
  line("shear wave speed c_S", fmt::format("{:.1f} m/s", info.speeds.c_S));
  line("Rayleigh wave speed c_R", fmt::format("{:.1f} m/s", info.speeds.c_R));
  line("nodes", fmt::format("{} ({} on the interface, {} without a stencil)", info.n_nodes, info.n_interface,
                            info.n_irregular));
  line("cells", fmt::format("{}", info.n_cells));
  line("largest stable step", fmt::format("{:.4g} s", info.stable_step_s));
  line("step", fmt::format("{:.4g} s ({:.4g} s at the interface, {} rows)", info.step_s, info.substep_s,
                           config.time.interface_rows));
  line("steps to the end", fmt::format("{}", info.n_steps));
  line("memory", fmt::format("{:.3g} GB, of it {:.3g} GB for the static factorisation",
                             info.memory_bytes * 1e-9, info.factor_bytes * 1e-9));
  line("node updates",
       fmt::format("{:.4g} at {:.3g} million/s here", info.node_updates, info.node_updates_per_s * 1e-6));
  line("expected time", fmt::format("{:.2g} s", info.expected_s));
}

}  // namespace

void add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "Print what follows from a case: wave speeds, step, size, memory, expected time");
  const auto arguments = add_case_arguments(*command);
  command->callback([arguments] { print_info(*arguments); });
}

}  // namespace slipfront::cli
