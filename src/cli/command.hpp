// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Subcommands and options as CLI11 has them. Only command.cpp includes CLI11, whose header takes longer to
/// compile than all the rest of a subcommand.
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

/// An option; each function adds to it and returns it.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(option) {}

  Option* required(bool is = true);
  /// What the help calls the value.
  Option* type_name(const char* name);
  /// The help tells the default, which is the variable's value now.
  Option* capture_default_str();
  Option* excludes(const char* option);
  /// Between the values of a list.
  Option* delimiter(char c);
  /// Whether a list may take more values than one each time.
  Option* allow_extra_args(bool may);

  // Values that are refused otherwise.
  Option* range(int from, int to);
  Option* positive();
  Option* finite();
  Option* non_negative();
  Option* one_of(const std::vector<std::string>& values);
  /// An empty text, as of a variable that is not set, is no path.
  Option* not_empty();

 private:
  CLI::Option& option_;
};

/// The program or a subcommand; owns its options and subcommands.
class Command {
 public:
  explicit Command(CLI::App& app);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  Command* add_subcommand(const char* name, const char* description);
  void require_subcommand();
  /// From the help.
  void hide();
  /// @param value  filled when the command line is parsed; command.cpp lists the types
  template <class Value>
  Option* add_option(const char* names, Value& value, const char* description);
  Option* add_flag(const char* names, bool& value, const char* description);
  Option* get_option(const char* name);
  /// The work, done once the command line is parsed.
  void callback(std::function<void()> work);

 private:
  Option* keep(CLI::Option& option);
  CLI::App& app_;
  std::vector<std::unique_ptr<Command>> subcommands_;
  std::vector<std::unique_ptr<Option>> options_;
};

class Program {
 public:
  Program(const char* name, const char* description, const std::string& version);
  ~Program();

  Command& command() { return command_; }
  CommandDescription description() const;
  /// Parses the command line and does the subcommand's work, or prints the help or version it asks for.
  /// @throws UserError where it cannot be understood
  void run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
  Command command_;
};

}  // namespace slipfront::cli
