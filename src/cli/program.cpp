// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/output.hpp"

namespace slipfront::cli {

static CLI::Validator number_that(bool (*fits)(double), const char* words, const char* name) {
  return {[=](const std::string& text) {
            double value = 0;
            const bool is_right = CLI::detail::lexical_cast(text, value) && fits(value);
            return is_right ? std::string() : fmt::format("{} is not a number {}", text, words);
          },
          name};
}

CLI::Validator positive() {
  return number_that([](double value) { return value > 0; }, "greater than 0", "POSITIVE");
}

CLI::Validator finite() {
  return number_that([](double value) { return std::isfinite(value); }, "finite", "FINITE");
}

CLI::Validator non_negative() {
  return number_that([](double value) { return value >= 0; }, "of at least 0", "NONNEGATIVE");
}

CLI::Validator not_empty() {
  return {[](const std::string& text) { return text.empty() ? "is empty; give a path" : std::string(); }, ""};
}

Program::Program(const char* name, const char* description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
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

/// Refuses a word in place of a subcommand, beside which CLI11 would print help.
static void require_subcommand(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  const std::vector<std::string> unused = app->remaining();
  if (!unused.empty() && app->get_require_subcommand_min() > 0)
    throw UserError("slipfront: no subcommand {}; see slipfront --help", unused.front());
}

void Program::run(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    require_subcommand(app_.get());
    app_->exit(help);
    finish_output();
  } catch (const CLI::ParseError& error) {
    require_subcommand(app_.get());
    throw UserError("slipfront: {}; see slipfront --help", error.what());
  }
}

}  // namespace slipfront::cli
