// SPDX-License-Identifier: BSD-3-Clause
#include "run/finished.hpp"

#include "base/error.hpp"
#include "results/archive.hpp"
#include "run/checkpoint.hpp"

namespace slipfront::run {

std::string FinishedRuns::key_of(const Problem& problem) {
  return files::sha256(program_identity() + "\n" + problem.source.case_text + problem.source.prestress_table +
                       problem.source.friction_table);
}

std::filesystem::path FinishedRuns::file_of(const Problem& problem) const {
  return dir_ / (key_of(problem).substr(0, 32) + ".bin");
}

bool FinishedRuns::has(const Problem& problem) const {
  return files::is_there(file_of(problem));
}

bool FinishedRuns::take(const Problem& problem, Result& result, InitialState& initial) const {
  if (!has(problem)) return false;
  try {
    results::InputArchive archive(file_of(problem));
    std::string key;
    archive(key);
    if (key != key_of(problem)) return false;  // a file that took another one's name
    archive(result);
    initial = read_initial_state(archive, problem);
    archive.close();
    const auto& event = result.event;
    if (event.energies.empty() || event.record.x_m != initial.subcritical.tractions.x_m ||
        !record::is_consistent(event.record) || event.end > motion::EventEnd::observer)
      return false;
  } catch (const UserError&) {
    return false;
  }
  result.problem = problem;
  result.speeds = solid::wave_speeds(problem.above().material);
  analyse(result, initial);
  return true;
}

void FinishedRuns::keep(const Result& result, const InitialState& initial) const {
  if (!files::is_there(dir_)) files::make_folder(dir_);
  auto light = initial;
  light.release_displacements();
  results::OutputArchive archive(file_of(result.problem));
  auto key = key_of(result.problem);
  archive(key, result, light);
  archive.close();
}

}  // namespace slipfront::run
