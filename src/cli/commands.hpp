// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
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
class CaseArguments {
 public:
  std::string file;
  std::vector<std::string> set;

  const io::Case& read() const { return case_file().config(); }
  /// See io::CaseFile.
  std::string with_place(const std::string& message) const { return case_file().with_place(message); }

 private:
  const io::CaseFile& case_file() const;
  mutable std::optional<io::CaseFile> case_file_;  ///< once read
};

/// Adds them to a subcommand; filled when the command line is parsed. The subcommand's callback must keep the
/// result alive by capturing it.
std::shared_ptr<CaseArguments> add_case_arguments(CLI::App& command);

}  // namespace slipfront::cli
