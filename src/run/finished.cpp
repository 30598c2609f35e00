// SPDX-License-Identifier: BSD-3-Clause
#include "run/finished.hpp"

#include "base/error.hpp"
#include "results/archive.hpp"
#include "run/checkpoint.hpp"

namespace slipfront::run {
namespace {

statics::Equilibrium at_interface(const statics::Equilibrium& state) {
  statics::Equilibrium light;
  light.shear_m = state.shear_m;
  light.contact = state.contact;
  light.tractions = state.tractions;
  light.peak_ratio = state.peak_ratio;
  light.peak_x_m = state.peak_x_m;
  light.inside_from_m = state.inside_from_m;
  light.inside_to_m = state.inside_to_m;
  return light;
}

/// The state without the plate's displacements, and without its mesh.
InitialState at_interface(const InitialState& state) {
  InitialState light;
  light.n_nodes = state.n_nodes;
  light.n_cells = state.n_cells;
  light.tributary_m = state.tributary_m;
  light.common = at_interface(state.common);
  light.spontaneous = at_interface(state.spontaneous);
  light.prescribed = state.prescribed;
  light.mu_s = state.mu_s;
  light.critical_shear_m = state.critical_shear_m;
  light.n_unknowns = state.n_unknowns;
  light.solver = state.solver;
  light.solver_bytes = state.solver_bytes;
  light.wall_s = state.wall_s;
  light.loads = state.loads;
  if (state.ramp)
    light.ramp = motion::Ramp{at_interface(state.ramp->common), at_interface(state.ramp->spontaneous),
                              state.ramp->record, state.ramp->steps, state.ramp->interrupted};
  return light;
}

}  // namespace

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
    if (event.energies.empty() || event.record.x_m != initial.common.tractions.x_m ||
        !record::is_consistent(event.record) || event.end > motion::EventEnd::observer)
      return false;
  } catch (const UserError&) {
    return false;
  }
  result.config = config;
  result.speeds = wave_speeds(config.material);
  measure(result, initial);
  return true;
}

void FinishedRuns::keep(const Result& result, const InitialState& initial) const {
  if (!files::is_there(dir_)) files::make_folder(dir_);
  auto light = at_interface(initial);
  results::OutputArchive archive(file_of(result.config));
  auto key = key_of(result.config);
  archive(key, result, light);
  archive.close();
}

}  // namespace slipfront::run
