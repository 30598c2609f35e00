// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace slipfront::cli {

void add_keys(CLI::App& app) {
  CLI::App* command = app.add_subcommand("keys", "Print the reference of all keys of a case file (Markdown)");
  command->callback([] { print_output(input::schema_reference()); });
}

}  // namespace slipfront::cli
