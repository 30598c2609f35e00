// SPDX-License-Identifier: BSD-3-Clause
#include "run/finished.hpp"

#include "base/error.hpp"
#include "results/archive.hpp"
#include "run/checkpoint.hpp"

namespace slipfront::run {

std::string FinishedRuns::key_of(const input::Case& config) {
  return files::sha256(program_identity() + "\n" + resolved_text(config) + config.prestress.table.text +
                       config.friction_along_x.table.text);
}

std::filesystem::path FinishedRuns::file_of(const input::Case& config) const {
  return dir_ / (key_of(config).substr(0, 32) + ".bin");
}

bool FinishedRuns::has(const input::Case& config) const {
  return files::is_there(file_of(config));
}

bool FinishedRuns::take(const input::Case& config, Result& result, InitialState& initial) const {
  if (!has(config)) return false;
  try {
    results::InputArchive archive(file_of(config));
    std::string key;
    archive(key);
    if (key != key_of(config)) return false;  // a file that took another one's name
    archive(result);
    initial = read_initial_state(archive, config);
    archive.close();
    const auto& event = result.event;
    if (event.energies.empty() || event.record.x_m != initial.subcritical.tractions.x_m ||
        !record::is_consistent(event.record) || event.end > motion::EventEnd::observer)
      return false;
  } catch (const UserError&) {
    return false;
  }
  result.config = config;
  result.speeds = wave_speeds(config.material);
  analyse(result, initial);
  return true;
}

void FinishedRuns::keep(const Result& result, const InitialState& initial) const {
  if (!files::is_there(dir_)) files::make_folder(dir_);
  auto light = initial;
  light.release_displacements();
  results::OutputArchive archive(file_of(result.config));
  auto key = key_of(result.config);
  archive(key, result, light);
  archive.close();
}

}  // namespace slipfront::run
