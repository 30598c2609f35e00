// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
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

/// The program's command line, by CLI11.
class Program {
 public:
  Program(const char* name, const char* description, const std::string& version);
  ~Program();

  CLI::App& app() { return *app_; }
  CommandDescription description() const;
  /// Parses the command line and does the subcommand's work, or prints the help or version it asks for.
  /// @throws UserError where it cannot be understood
  void run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace slipfront::cli
