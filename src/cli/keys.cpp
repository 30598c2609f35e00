// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace slipfront::cli {

void add_keys(CLI::App& app) {
  CLI::App* command = app.add_subcommand("keys", "Print the reference of the keys of a case file (Markdown)");
  command->group("Cases");
  auto part = std::make_shared<std::string>();
  command->add_option("KEY", *part, "Only a table, e.g. friction, or a key, e.g. friction.mu_k");
  command->callback([part] {
    print_output(part->empty() ? input::schema_reference() : input::schema_reference_of(*part));
  });
}

}  // namespace slipfront::cli
