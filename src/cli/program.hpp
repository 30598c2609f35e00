// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace slipfront::cli {

/// An option as its declaration has it.
struct OptionDescription {
  std::vector<std::string> names;  ///< "-o", "--output"; a positional's own
  std::string value;               ///< what the help calls it; empty for a flag
  std::string help;
  std::string preset;                ///< its default, where the help tells it
  std::vector<std::string> choices;  ///< the only values, where they are named
  bool positional = false;
};

/// The program or a subcommand, those below it included that are not hidden.
struct CommandDescription {
  std::string name, help;
  std::vector<OptionDescription> options;
  std::vector<CommandDescription> subcommands;
};

/// A program's command line, by CLI11.
class Program {
 public:
  Program(const char* name, const char* description);
  ~Program();

  CLI::App& app() { return *app_; }
  CommandDescription description() const;
  /// Parses the command line and does its or the subcommand's work, or prints the help or version it asks
  /// for.
  /// @throws UserError where it cannot be understood
  void run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

/// All that a main does: prepares the process, and works.
/// @param work  gives the exit code
/// @return this, or that of the exception that ended the work, of which a line on standard error tells
int exit_code_of(const std::function<int()>& work);

/// The exit code for the exception under way, and the line that says why.
std::pair<int, std::string> reason_to_end();

}  // namespace slipfront::cli
