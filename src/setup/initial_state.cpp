// SPDX-License-Identifier: BSD-3-Clause
#include "setup/initial_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "motion/stepper.hpp"
#include "problem/contact.hpp"
#include "setup/event.hpp"
#include "setup/event_loads.hpp"
#include "statics/plate_solver.hpp"
#include "statics/prestress.hpp"

namespace slipfront::setup {

void InitialState::release_displacements(const statics::Equilibrium* but) {
  std::vector<statics::Equilibrium*> states = {&subcritical, &supercritical};
  if (ramp) states.insert(states.end(), {&ramp->subcritical, &ramp->supercritical});
  for (auto* state : states)
    for (auto* field : state->displacements())
      if (state != but) *field = {};
}

InitialState unloaded_state(const Problem& problem, const Processes& processes) {
  InitialState initial;
  auto meshes = check(problem, processes);
  initial.mesh = std::move(meshes.plate);
  initial.base = std::move(meshes.base);
  initial.n_nodes = n_nodes_of(initial.mesh) + (initial.base ? n_nodes_of(*initial.base) : 0);
  initial.n_cells = n_cells_of(initial.mesh) + (initial.base ? n_cells_of(*initial.base) : 0);
  initial.tributary_m = mesh::tributary_lengths_m(initial.mesh);
  return initial;
}

namespace {

statics::Statics statics_of(const Problem& problem, const mesh::Mesh& plate,
                            const std::optional<mesh::Mesh>& base_mesh, const PerNode& mu_s,
                            statics::Statics::MayContinue may_continue) {
  std::optional<statics::ElasticBody> base;
  if (base_mesh) base.emplace(statics::ElasticBody{*base_mesh, problem.below().material});
  auto loading = problem.loading;
  loading.solver = wanted_solver(problem);
  return {{plate, problem.above().material, problem.above().machine},
          base,
          loading,
          mu_s.at_all(plate.interface_nodes.size()),
          interface::static_coefficient_key(problem.friction.law),
          std::move(may_continue)};
}

}  // namespace

statics::Statics statics_of(const Problem& problem, const InitialState& initial,
                            statics::Statics::MayContinue may_continue) {
  return statics_of(problem, initial.mesh, initial.base,
                    strength_over_pressure(problem, mesh::interface_x_m(initial.mesh), initial.healed),
                    std::move(may_continue));
}

statics::StaticSolver wanted_solver(const Problem& problem) {
  const auto& machine = problem.above().machine;
  if (machine.pusher.is_there() || !machine.is_rigid() || problem.is_slow())
    return statics::StaticSolver::direct;
  const auto shape = [](const problem::Body& body) {
    const auto& plate = body.plate;
    return statics::Shape{std::round(plate.width_m / plate.element_size_m),
                          std::round(plate.height_m / plate.element_size_m), plate.coarsenings > 0};
  };
  std::optional<statics::Shape> base;
  if (problem.has_below()) base = shape(problem.below());
  return statics::solver_for_shapes(problem.loading.solver, shape(problem.above()), base);
}

void describe_solver(const Problem& problem, const statics::Statics& statics, InitialState& initial) {
  initial.cost.n_unknowns = statics.solver().n_unknowns();
  initial.cost.solver =
      statics::choose_solver(wanted_solver(problem), 2.0 * static_cast<double>(initial.n_nodes));
  initial.cost.solver_bytes = statics.solver().bytes();
}

InitialState make_initial_state(const Problem& problem, const motion::Monitor& monitor,
                                const motion::Execution& execution, const RampBegins& ramp_begins,
                                const Processes& processes) {
  const auto start = Clock::now();
  auto initial = unloaded_state(problem, processes);
  if (problem.is_prestressed()) {
    initial.subcritical =
        statics::prestressed(initial.mesh, prescribed_tractions(problem, mesh::interface_x_m(initial.mesh)),
                             initial.base ? &*initial.base : nullptr);
    initial.supercritical = initial.subcritical;
    initial.critical_shear_m = nan;
    initial.cost.wall_s = seconds_since(start);
    return initial;
  }
  const auto statics = statics_of(problem, initial, [&] { return monitor(0, 0); });
  describe_solver(problem, statics, initial);
  const auto critical = statics.shear_to(1);
  initial.critical_shear_m = critical.shear_m;
  if (problem.loading.method == statics::LoadingMethod::direct) {
    initial.subcritical = common_state(problem, statics, critical, initial.tributary_m);
    initial.supercritical = statics::is_sheared_by_force(problem.loading)
                                ? initial.subcritical
                                : statics.shear_to(1 + problem.loading.critical_margin);
  } else {
    auto of_ramp = problem;
    of_ramp.time.interface_substeps = 1;
    const auto with_ramp = new_stepper(of_ramp, initial.mesh, initial.base, {}, execution);
    auto& stepper = *with_ramp;
    const auto tilted = statics.shear_by(0);
    stepper.start(tilted, problem.shear_speed_m_per_s);
    motion::RampRun ramp(
        stepper,
        {tilted, problem.loading, strength_over_pressure(problem, mesh::interface_x_m(initial.mesh)),
         problem.shear_speed_m_per_s, fastest_speed_m_per_s(problem), initial.critical_shear_m},
        monitor);
    if (ramp_begins) ramp_begins(stepper, ramp);
    initial.ramp = ramp.run();
    if (initial.ramp->interrupted) throw Interrupted("interrupted during the ramp, before the event");
    initial.subcritical = initial.ramp->subcritical;
    initial.supercritical = initial.ramp->supercritical;
  }
  if (has_forces(problem))
    initial.loads = resolved_loads(problem, statics, critical, initial.subcritical, initial.tributary_m);
  initial.cost.wall_s = seconds_since(start);
  return initial;
}

std::optional<LoadedState> loaded_state(const Problem& problem, const Meshes& meshes) {
  if (!has_forces(problem)) return {};
  const auto statics =
      statics_of(problem, meshes.plate, meshes.base,
                 strength_over_pressure(problem, mesh::interface_x_m(meshes.plate)), [] { return true; });
  const auto tributary_m = mesh::tributary_lengths_m(meshes.plate);
  const auto critical = statics.shear_to(1);
  auto subcritical = common_state(problem, statics, critical, tributary_m);
  const auto loads = resolved_loads(problem, statics, critical, subcritical, tributary_m);
  return LoadedState{loads, std::move(subcritical)};
}

}  // namespace slipfront::setup
