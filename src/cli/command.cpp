// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command.hpp"

#include <fmt/core.h>

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

/// Of CLI11's own checks the messages name the largest double, and nan passes.
static CLI::Validator number_that(bool (*fits)(double), const char* words, const char* name) {
  return {[=](const std::string& text) {
            double value = 0;
            const bool is_right = CLI::detail::lexical_cast(text, value) && fits(value);
            return is_right ? std::string() : fmt::format("{} is not a number {}", text, words);
          },
          name};
}

Option* Option::positive() {
  option_.check(number_that([](double value) { return value > 0; }, "greater than 0", "POSITIVE"));
  return this;
}

Option* Option::finite() {
  option_.check(number_that([](double value) { return std::isfinite(value); }, "finite", "FINITE"));
  return this;
}

Option* Option::non_negative() {
  option_.check(number_that([](double value) { return value >= 0; }, "of at least 0", "NONNEGATIVE"));
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

void Command::hide() {
  app_.group("");
}

template <class Value>
Option* Command::add_option(const char* names, Value& value, const char* description) {
  return keep(*app_.add_option(names, value, description));
}
template Option* Command::add_option(const char*, int&, const char*);
template Option* Command::add_option(const char*, std::optional<int>&, const char*);
template Option* Command::add_option(const char*, double&, const char*);
template Option* Command::add_option(const char*, std::optional<double>&, const char*);
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

/// CLI11 has the choices in the name of the type: "TEXT:{auto,direct}".
static std::vector<std::string> choices_in(const std::string& type) {
  const auto from = type.find('{'), to = type.find('}');
  if (from == std::string::npos || to == std::string::npos) return {};
  return CLI::detail::split(type.substr(from + 1, to - from - 1), ',');
}

static OptionDescription described(const CLI::Option& option) {
  OptionDescription described;
  described.positional = option.get_positional();
  for (const auto& name : option.get_snames()) described.names.push_back("-" + name);
  for (const auto& name : option.get_lnames()) described.names.push_back("--" + name);
  if (described.positional) described.names = {option.get_name(true)};
  const std::string type = option.get_type_name();
  if (!described.positional && option.get_items_expected_max() > 0)
    described.value = type.substr(0, type.find(':'));
  described.help = option.get_description();
  described.preset = option.get_default_str();
  described.choices = choices_in(type);
  return described;
}

static CommandDescription described(const CLI::App& app) {
  CommandDescription described_app{app.get_name(), app.get_description(), {}, {}};
  for (const auto* option : app.get_options()) described_app.options.push_back(described(*option));
  for (const auto* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!sub->get_group().empty()) described_app.subcommands.push_back(described(*sub));
  return described_app;
}

CommandDescription Program::description() const {
  return described(*app_);
}

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
