// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "base/error.hpp"
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

void add_strict(CLI::App& command, CaseArguments& arguments) {
  command.add_flag("--strict", arguments.strict, "Refuse the case where a note is of units or of resolution");
}

void CaseArguments::require_none_refused(const Diagnostics& notes) const {
  const auto n = std::ranges::count_if(notes, &Diagnostic::is_refused_if_strict);
  if (!strict || n == 0) return;
  const auto first = std::ranges::find_if(notes, &Diagnostic::is_refused_if_strict);
  throw UserError("{}: {}{}; --strict refuses notes of units and resolution", file, first->text,
                  n > 1 ? fmt::format(" (and {} more)", n - 1) : "");
}

}  // namespace slipfront::cli
