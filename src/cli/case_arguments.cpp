// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command.hpp"
#include "cli/commands.hpp"

namespace slipfront::cli {

input::CaseFile CaseArguments::read() const {
  std::vector<input::Override> overrides;
  for (const std::string& text : set) overrides.push_back(input::parse_override(text));
  return input::CaseFile(file, overrides);
}

std::shared_ptr<CaseArguments> add_case_arguments(CLI::App& command) {
  auto arguments = std::make_shared<CaseArguments>();
  command.add_option("CASE", arguments->file, "Case file (TOML)")->required()->type_name("FILE");
  command
      .add_option("--set", arguments->set,
                  "Set a key of the case, e.g. --set friction.mu_k=1.0; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  return arguments;
}

}  // namespace slipfront::cli
