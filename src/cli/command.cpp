// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command.hpp"

#include <CLI/CLI.hpp>
#include <optional>

#include "base/error.hpp"
#include "cli/output.hpp"

namespace slipfront::cli {

Option* Option::required(bool is) {
  option_.required(is);
  return this;
}

Option* Option::type_name(const char* name) {
  option_.type_name(name);
  return this;
}

Option* Option::capture_default_str() {
  option_.capture_default_str();
  return this;
}

Option* Option::excludes(const char* option) {
  option_.excludes(option);
  return this;
}

Option* Option::delimiter(char c) {
  option_.delimiter(c);
  return this;
}

Option* Option::allow_extra_args(bool may) {
  option_.allow_extra_args(may);
  return this;
}

Option* Option::range(int from, int to) {
  option_.check(CLI::Range(from, to));
  return this;
}

/// Not a number where the text is none.
static double number_in(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) ? value : std::numeric_limits<double>::quiet_NaN();
}

Option* Option::positive() {
  option_.check(CLI::Validator(
      [](const std::string& text) {
        return number_in(text) > 0 ? std::string() : text + " is not a number greater than 0";
      },
      "POSITIVE"));
  return this;
}

Option* Option::non_negative() {
  option_.check(CLI::Validator(
      [](const std::string& text) {
        return number_in(text) >= 0 ? std::string() : text + " is not a number of at least 0";
      },
      "NONNEGATIVE"));
  return this;
}

Option* Option::one_of(const std::vector<std::string>& values) {
  option_.check(CLI::IsMember(values));
  return this;
}

Option* Option::not_empty() {
  option_.check(CLI::Validator(
      [](const std::string& text) { return text.empty() ? "is empty; give a path" : std::string(); }, ""));
  return this;
}

Command::Command(CLI::App& app) : app_(app) {}
Command::~Command() = default;

Command* Command::add_subcommand(const char* name, const char* description) {
  return subcommands_.emplace_back(std::make_unique<Command>(*app_.add_subcommand(name, description))).get();
}

void Command::require_subcommand() {
  app_.require_subcommand(1);
}

template <class Value>
Option* Command::add_option(const char* names, Value& value, const char* description) {
  return keep(*app_.add_option(names, value, description));
}
template Option* Command::add_option(const char*, int&, const char*);
template Option* Command::add_option(const char*, std::optional<int>&, const char*);
template Option* Command::add_option(const char*, double&, const char*);
template Option* Command::add_option(const char*, std::string&, const char*);
template Option* Command::add_option(const char*, std::optional<std::string>&, const char*);
template Option* Command::add_option(const char*, std::vector<int>&, const char*);
template Option* Command::add_option(const char*, std::vector<double>&, const char*);
template Option* Command::add_option(const char*, std::vector<std::string>&, const char*);

Option* Command::add_flag(const char* names, bool& value, const char* description) {
  return keep(*app_.add_flag(names, value, description));
}

Option* Command::get_option(const char* name) {
  return keep(*app_.get_option(name));
}

void Command::callback(std::function<void()> work) {
  app_.callback(std::move(work));
}

Option* Command::keep(CLI::Option& option) {
  return options_.emplace_back(std::make_unique<Option>(option)).get();
}

Program::Program(const char* name, const char* description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)), command_(*app_) {
  app_->set_version_flag("--version", version);
  command_.require_subcommand();
}

Program::~Program() = default;

void Program::run(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    app_->exit(help);
    finish_output();
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> unused = app_->remaining();
    if (!unused.empty() && app_->get_subcommands().empty())
      throw UserError("slipfront: no subcommand {}; see slipfront --help", unused.front());
    throw UserError("slipfront: {}; see slipfront --help", error.what());
  }
}

}  // namespace slipfront::cli
