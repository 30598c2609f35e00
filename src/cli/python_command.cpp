// SPDX-License-Identifier: BSD-3-Clause
#include "cli/python_command.hpp"

#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "cli/command.hpp"

namespace slipfront::cli {
namespace {

struct PythonCommand {
  const char* group;  ///< subcommand that it belongs to; null: the program
  const char* name;
  const char* description;
};

constexpr std::array python_commands = {
    PythonCommand{nullptr, "report", "Write a page (HTML) to look at a run or a study in a browser"},
    PythonCommand{nullptr, "fronts", "Find fronts in a history of slip along an interface, from any source"},
    PythonCommand{nullptr, "gauges",
                  "Fit the field of a front's tip to strain gauges: fracture energy and cohesive zone"},
    PythonCommand{nullptr, "compare", "Put runs beside an experiment's records: misfits and pictures"},
    PythonCommand{nullptr, "fit", "Find which values of a case's keys explain records, with intervals"},
    PythonCommand{nullptr, "records", "Cut the files of a laboratory's recorders into events, calibrated"},
    PythonCommand{nullptr, "picks", "Pick when a front passes each gauge of recorded events, with errors"},
    PythonCommand{nullptr, "sweep", "Run a case over values of its keys, and compare"},
    PythonCommand{"study", "convergence",
                  "Front speeds over element size, interface step and damping, with their limits"},
    PythonCommand{"study", "interface-step",
                  "Error of the front speeds against the cost of sub-cycling the interface; the cheapest way "
                  "within a tolerance"}};

/// Tells in one line what is missing. The folder that the program is called in is no place for packages.
constexpr const char* start_of_package = R"(import os, sys
sys.path = [place for place in sys.path if place]
def refuse(what):
    print(f"slipfront: error: {sys.argv[1]} needs {what}", file=sys.stderr)
    sys.exit(2)
if sys.version_info < (3, 11):
    refuse(f"Python 3.11 or later, which {sys.executable} is not: set SLIPFRONT_PYTHON to one")
try:
    from slipfront.__main__ import main
except ModuleNotFoundError as error:
    package = error.name.split(".")[0]
    tree = os.environ.get("SLIPFRONT_SOURCES")
    if tree:
        refuse(f"Python packages, {package} first of all: 'make module' in {tree} installs them all")
    how = f"{sys.executable} -m pip install {'.' if package == 'slipfront' else package}"
    where = "' in the source tree of slipfront" if package == "slipfront" else "'"
    refuse(f"the Python package {package}, which {sys.executable} does not have: install it with '{how}{where}, "
           "or set SLIPFRONT_PYTHON to an interpreter that has it")
sys.exit(main(sys.argv[1:])))";

namespace fs = std::filesystem;

/// The source tree of a program build/PRESET/slipfront; empty for one that is elsewhere.
fs::path source_tree() {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  const fs::path build = program.parent_path().parent_path();
  const bool is_in_tree =
      build.filename() == "build" && fs::is_directory(build.parent_path() / "python" / "slipfront", unknown);
  return is_in_tree ? build.parent_path() : fs::path();
}

std::string interpreter(const fs::path& tree) {
  if (const char* named = std::getenv("SLIPFRONT_PYTHON"); named != nullptr && *named != '\0') return named;
  const fs::path own = tree / ".venv" / "bin" / "python";
  return !tree.empty() && ::access(own.c_str(), X_OK) == 0 ? own.string() : "python3";
}

/// Refuses a program that is named as the interpreter and is none: it would do nothing, and might call that
/// done. The error of one that cannot be started comes when it is started.
void require_runs_python(const std::string& named) {
  std::array<char, 3> printed{};
  std::FILE* pipe = ::popen(R"("$SLIPFRONT_PYTHON" -c 'print(42)' 2>/dev/null)", "r");
  if (pipe == nullptr) return;
  const std::size_t n_read = std::fread(printed.data(), 1, printed.size(), pipe);
  const int status = ::pclose(pipe);
  constexpr int first_not_started = 126;
  if (WIFEXITED(status) && WEXITSTATUS(status) >= first_not_started) return;
  if (std::string_view(printed.data(), n_read) != "42\n")
    throw UserError("slipfront: SLIPFRONT_PYTHON is {}, which does not run Python; set it to an interpreter",
                    named);
}

void put_first_on_python_path(const fs::path& folder) {
  const char* others = std::getenv("PYTHONPATH");
  const bool alone = others == nullptr || *others == '\0';
  ::setenv("PYTHONPATH", (folder.string() + (alone ? "" : ":" + std::string(others))).c_str(), 1);
}

}  // namespace

void add_python_commands(CLI::App& app) {
  CLI::App* study = app.add_subcommand("study", "Vary the numerical parameters of a case");
  study->group("Studies");
  study->require_subcommand(1);
  for (const auto& [group, name, description] : python_commands)
    if (group == nullptr)
      app.add_subcommand(name, description)->group("Results, in Python");
    else
      app.get_subcommand(group)->add_subcommand(name, description);
}

static bool is_python_command(int argc, char** argv) {
  const auto is_at = [&](int k, std::string_view word) { return k < argc && word == argv[k]; };
  return std::ranges::any_of(python_commands, [&](const PythonCommand& command) {
    const bool is_in_group = command.group != nullptr;
    return (!is_in_group || is_at(1, command.group)) && is_at(is_in_group ? 2 : 1, command.name);
  });
}

void become_python_command(int argc, char** argv) {
  if (!is_python_command(argc, argv)) return;
  const fs::path tree = source_tree();
  if (!tree.empty()) put_first_on_python_path(tree / "python");
  // Where `make module` brings what is missing: not into an interpreter of the user's.
  if (!tree.empty() && std::getenv("SLIPFRONT_PYTHON") == nullptr)
    ::setenv("SLIPFRONT_SOURCES", tree.c_str(), 1);
  std::error_code unknown;
  const fs::path self = fs::read_symlink("/proc/self/exe", unknown);
  if (!unknown) ::setenv("SLIPFRONT_PROGRAM", self.c_str(), 0);  // what a sweep runs
  std::string python = interpreter(tree);
  if (const char* named = std::getenv("SLIPFRONT_PYTHON"); named != nullptr && python == named)
    require_runs_python(python);
  std::vector<std::string> start = {python, "-c", start_of_package};
  std::vector<char*> arguments;
  for (std::string& argument : start) arguments.push_back(argument.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  arguments.push_back(nullptr);
  ::execvp(python.c_str(), arguments.data());
  throw UserError(
      "slipfront: {} is a Python program, and {} cannot be started: {}; install python3, or set "
      "SLIPFRONT_PYTHON to an interpreter",
      argv[1], python, std::strerror(errno));
}

}  // namespace slipfront::cli
