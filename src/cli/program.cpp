// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "processes/processes.hpp"

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

Program::Program(const char* name, const char* description)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("--version", version_text());
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
  const bool has_subcommands = !app_->get_subcommands([](const CLI::App*) { return true; }).empty();
  app_->require_subcommand(has_subcommands ? 1 : 0);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    require_subcommand(app_.get());
    app_->exit(help);
    finish_output();
  } catch (const CLI::ParseError& error) {
    require_subcommand(app_.get());
    throw UserError("{0}: {1}; see {0} --help", app_->get_name(), error.what());
  }
}

namespace {

enum ExitCode {
  internal_error = 1,  ///< or what was to be written could not be
  user_error = 2,
  blow_up = 3
};

/// A program that a signal has made end tells so by this code, as a shell would.
int code_of(int signal) {
  constexpr int first = 128;
  return first + (signal != 0 ? signal : SIGINT);
}

#if defined(__AVX2__)
/// Ends a program that was compiled for another processor before the first instruction that this one lacks,
/// which could be in the initialisation of any static object.
[[gnu::constructor(101)]] void require_processor() {
  __builtin_cpu_init();
#ifdef __AVX512F__
  const bool is_there = __builtin_cpu_supports("avx512f") != 0;
#else
  const bool is_there = __builtin_cpu_supports("avx2") != 0;
#endif
  if (is_there) return;
  static constexpr char text[] =
      "slipfront: compiled for another processor than this one; compile it here, or install a package\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, sizeof text - 1);
  ::_exit(user_error);
}
#endif

/// Files that are opened take the lowest free number: one of a closed standard stream would get what is
/// printed. Writing to these stand-ins fails, as to a closed stream.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) != stream) std::_Exit(internal_error);
}

/// Beyond its end there is no message.
void require_stack() {
  constexpr rlim_t least_bytes = 1U << 20U;
  rlimit limit{};
  if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= least_bytes) return;
  throw UserError("slipfront: a stack of {} KiB is too small; allow {} or more, as by ulimit -s",
                  limit.rlim_cur / 1024, least_bytes / 1024);
}

}  // namespace

std::pair<int, std::string> reason_to_end() try { throw; } catch (const UserError& error) {
  return {user_error, error.what()};
} catch (const BlowUp& error) {
  return {blow_up, fmt::format("slipfront: {}", error.what())};
} catch (const Interrupted& error) {
  return {code_of(interrupting_signal()), fmt::format("slipfront: {}", error.what())};
} catch (const WriteError& error) {
  return {internal_error, fmt::format("slipfront: {}", error.what())};
} catch (const ProcessError& error) {
  return {internal_error, fmt::format("slipfront: {}", error.what())};
} catch (const std::bad_alloc&) {
  return {internal_error, "slipfront: not enough memory; use larger elements"};
} catch (const std::exception& error) {
  return {internal_error, fmt::format("slipfront: internal error: {}", error.what())};
} catch (...) {
  return {internal_error, "slipfront: internal error of unknown kind"};
}

int exit_code_of(const std::function<int()>& work) try {
  hold_standard_streams();
  require_stack();
  return work();
} catch (...) {
  // A user's error starts with its place, FILE:LINE, so that editors find it; the rest with the program's
  // name.
  const auto [code, line] = reason_to_end();
  std::fputs((line + "\n").c_str(), stderr);
  return code;
}

}  // namespace slipfront::cli
