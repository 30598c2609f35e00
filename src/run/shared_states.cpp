// SPDX-License-Identifier: BSD-3-Clause
#include "run/shared_states.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"
#include "results/archive.hpp"
#include "run/checkpoint.hpp"

namespace slipfront::run {
namespace {

std::string state_key(const Problem& problem) {
  return files::sha256(program_identity() + "\n" + problem.source.state_key);
}

}  // namespace

SharedStates::SharedStates(std::filesystem::path dir) : dir_(files::resolved(std::move(dir))) {
  std::error_code error;
  std::filesystem::create_directory(dir_, error);  // another process may do so at the same time
  if (!files::is_folder(dir_) || ::access(dir_.c_str(), R_OK | W_OK | X_OK) != 0)
    throw UserError("folder of states {}: is no folder that can be written; choose another place",
                    dir_.string());
}

std::filesystem::path SharedStates::file_of(const std::string& key) const {
  return dir_ / ("state-" + key.substr(0, 32) + ".bin");
}

std::optional<InitialState> SharedStates::take(const Problem& problem,
                                               const std::function<void(const std::string&)>& note) const {
  const auto wanted = state_key(problem);
  const auto file = file_of(wanted);
  if (!files::is_there(file)) return {};
  try {
    results::InputArchive archive(file);
    std::string key;
    archive(key);
    if (key != wanted) throw UserError("{}: is the state of another case", file.string());
    auto initial = read_initial_state(archive, problem);
    archive.close();
    require_possible(problem.is_prestressed() ||
                         (initial.subcritical.u_m.size() > 0 && initial.supercritical.u_m.size() > 0),
                     "displacements");
    return initial;
  } catch (const UserError& error) {
    note(fmt::format("{}; the state before the event is solved again", error.what()));
    return {};
  }
}

void SharedStates::keep(const Problem& problem, InitialState& initial) const {
  const auto key = state_key(problem);
  // Under a separate name until it is complete: others may be writing the same state.
  char host[256] = {};
  ::gethostname(host, sizeof(host) - 1);
  const auto own = dir_ / fmt::format("writing-{}-{}-{}.bin", key.substr(0, 8), host, ::getpid());
  results::OutputArchive archive(own);
  archive(key, initial);
  archive.close();
  files::move_file(own, file_of(key));
}

}  // namespace slipfront::run
