// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/example_cases.hpp"
#include "cli/output.hpp"

namespace slipfront::cli {

void add_new(CLI::App& app) {
  CLI::App* command = app.add_subcommand("new", "Print a commented case to begin with, for a file of yours");
  command->group("Cases");
  auto kind = std::make_shared<std::string>(example_cases.front().kind);
  std::vector<std::string> kinds;
  for (const auto& example : example_cases) kinds.emplace_back(example.kind);
  command
      ->add_option("KIND", *kind,
                   "rigid: a block on a rigid plane; two-bodies: of unlike materials; pressed: two blocks, "
                   "pressed and sheared by displacements; gauges: with strain gauges; "
                   "sequence: events of a block pushed at its side; "
                   "stick-slip: of rate-and-state friction in a machine")
      ->check(CLI::IsMember(kinds))
      ->capture_default_str();
  command->callback(
      [kind] { print_output(std::ranges::find(example_cases, *kind, &ExampleCase::kind)->text); });
}

}  // namespace slipfront::cli
