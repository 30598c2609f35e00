// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/schema.hpp"

namespace CLI {
class App;
}

/// The subcommands, one file each. `add_<name>` registers its options and, as CLI11's callback, its work; the
/// work reports failure by the exceptions of base/error.hpp, which main turns into one line and an exit code.
namespace slipfront::cli {

void add_run(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_study(CLI::App& app);
void add_verify(CLI::App& app);
void add_info(CLI::App& app);
void add_bench(CLI::App& app);
void add_validate(CLI::App& app);
void add_keys(CLI::App& app);

/// The arguments of every subcommand that works on a case: CASE.toml [--set key=value]...
struct CaseArguments {
  std::string file;
  std::vector<std::string> set;

  std::vector<io::Override> overrides() const;
  io::Case read() const { return io::read_case(file, overrides()); }
};

/// Adds them to a subcommand; filled when the command line is parsed. The subcommand's callback must keep the
/// result alive by capturing it.
std::shared_ptr<CaseArguments> add_case_arguments(CLI::App& command);

}  // namespace slipfront::cli
