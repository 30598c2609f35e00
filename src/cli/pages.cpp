// SPDX-License-Identifier: BSD-3-Clause
#include "cli/pages.hpp"

#include <fmt/core.h>

#include <memory>
#include <string_view>

#include "base/version.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "input/entries.hpp"

namespace slipfront::cli {
namespace {

/// Text for roff: nothing of it is a request, and a minus sign can be copied from the page.
std::string roff(std::string_view text) {
  std::string escaped = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  return escaped;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string all;
  for (const auto& word : words) all += (all.empty() ? "" : std::string(between)) + word;
  return all;
}

/// "-o, --output DIR", a positional's name alone.
std::string option_title(const OptionDescription& option) {
  std::string title = "\\fB" + roff(joined(option.names, ", ")) + "\\fR";
  if (!option.value.empty()) title += " \\fI" + roff(option.value) + "\\fR";
  return title;
}

std::string man_options(const CommandDescription& command) {
  std::string page;
  for (const auto& option : command.options) {
    page += fmt::format(".TP\n{}\n{}", option_title(option), roff(option.help));
    if (!option.choices.empty()) page += fmt::format(" One of {}.", roff(joined(option.choices, ", ")));
    if (!option.preset.empty()) page += fmt::format(" Default: {}.", roff(option.preset));
    page += "\n";
  }
  return page;
}

/// A command and those below it. `path`: as the user types it.
std::string man_command(const CommandDescription& command, const std::string& path) {
  std::string page = fmt::format(".SS \"{}\"\n{}.\n{}", roff(path), roff(command.help), man_options(command));
  for (const auto& sub : command.subcommands) page += man_command(sub, path + " " + sub.name);
  return page;
}

constexpr std::string_view ends = R"(.SH EXIT STATUS
.TP
0
Done; every file is as computed.
.TP
1
An internal error, or what was to be written could not be.
.TP
2
The user's input cannot be used; one line on standard error says where and what to do.
.TP
3
The computed motion is no longer physical.
.TP
128 + \fIn\fR
Ended by signal \fIn\fR.
.SH SIGNALS
.TP
INT, TERM, HUP
A run keeps a checkpoint and ends; \fBslipfront run \-\-restart\fR goes on with it.
.TP
USR1
A run keeps a checkpoint and goes on.
)";

/// Words for `compgen -W "..."`.
std::string option_words(const CommandDescription& command) {
  std::string words;
  for (const auto& option : command.options)
    if (!option.positional) words += joined(option.names, " ") + " ";
  return words;
}

std::vector<std::string> names_of(const std::vector<CommandDescription>& commands) {
  std::vector<std::string> names;
  for (const auto& command : commands) names.push_back(command.name);
  return names;
}

/// A branch for each command: what may follow it.
std::string bash_words(const CommandDescription& command, const std::string& path) {
  std::string branches = fmt::format("    \"{}\") options=\"{}\" commands=\"{}\" ;;\n", path,
                                     option_words(command), joined(names_of(command.subcommands), " "));
  for (const auto& sub : command.subcommands) branches += bash_words(sub, path + "/" + sub.name);
  return branches;
}

/// A branch for each option that takes a value: the values it may take, or none for files and numbers.
std::string bash_values(const CommandDescription& command, const std::string& path) {
  std::string branches;
  for (const auto& option : command.options)
    if (!option.positional && !option.value.empty() && option.value != "KEY=VALUE")
      for (const auto& name : option.names)
        branches +=
            fmt::format("    \"{}:{}\") takes=1 values=\"{}\" ;;\n", path, name, joined(option.choices, " "));
  for (const auto& sub : command.subcommands) branches += bash_values(sub, path + "/" + sub.name);
  return branches;
}

std::vector<std::string> all_keys() {
  std::vector<std::string> keys;
  for (const auto& entry : input::common_entries()) keys.push_back(entry.key);
  for (const auto& law : input::friction_laws())
    for (const auto& entry : law.entries) keys.push_back(entry.key);
  return keys;
}

}  // namespace

std::string man_page(const CommandDescription& program) {
  std::string page = fmt::format(".TH SLIPFRONT 1 \"\" \"slipfront {}\" \"User Commands\"\n", version());
  page += fmt::format(".SH NAME\n{} \\- {}\n", program.name, roff(program.help));
  page += fmt::format(
      ".SH SYNOPSIS\n.B {0}\n.I COMMAND\n.RI [ OPTION ...]\n.SH DESCRIPTION\n"
      "Computes how sliding begins when an elastic body is pressed and sheared on a rigid plane or on "
      "another "
      "body:\nstatics, contact, friction, explicit motion, and the speeds of slip fronts. Case files are "
      "TOML in "
      "SI units;\n.B {0} keys\nprints all keys.\n.SH OPTIONS\n{1}.SH COMMANDS\n",
      program.name, man_options(program));
  for (const auto& command : program.subcommands)
    page += man_command(command, program.name + " " + command.name);
  return page += ends;
}

std::string bash_completion(const CommandDescription& program, const std::vector<std::string>& keys) {
  return fmt::format(
      R"(# bash completion for {0}; written by the program itself
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}
  local path= options= commands= takes= values= k
  local -r keys="{1}"
  # "=" stands alone among the words; what follows it is left to the user.
  [[ $word == "=" || $previous == "=" ]] && return
  COMPREPLY=()
  if [[ $previous == --set ]]; then
    compopt -o nospace
    mapfile -t COMPREPLY < <(compgen -S = -W "$keys" -- "$word")
    return
  fi
  for ((k = 1; k < COMP_CWORD; ++k)); do
    case "$path/${{COMP_WORDS[k]}}" in
{2}    esac
  done
  case "$path" in
{3}  esac
  case "$path:$previous" in
{4}  esac
  if [[ -n $takes ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
  fi
}}
complete -o default -F _{0} {0}
)",
      program.name, joined(keys, " "),
      [&] {
        std::string paths;
        const auto add = [&](const auto& self, const CommandDescription& command,
                             const std::string& path) -> void {
          for (const auto& sub : command.subcommands) {
            const std::string below = path + "/" + sub.name;
            paths += fmt::format("      \"{0}\") path=\"{0}\" ;;\n", below);
            self(self, sub, below);
          }
        };
        add(add, program, "");
        return paths;
      }(),
      bash_words(program, ""), bash_values(program, ""));
}

void add_page(CLI::App& app, const Program& program) {
  CLI::App* command = app.add_subcommand("page", "Print the manual page, or the completion for bash");
  command->group("");
  auto page = std::make_shared<std::string>();
  command->add_option("PAGE", *page, "Which")->required()->check(CLI::IsMember({"man", "bash"}));
  command->callback([page, &program] {
    const auto description = program.description();
    print_output(*page == "man" ? man_page(description) : bash_completion(description, all_keys()));
  });
}

}  // namespace slipfront::cli
