// SPDX-License-Identifier: BSD-3-Clause
#include "setup/event.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "motion/distributed_stepper.hpp"
#include "motion/quasi_dynamic.hpp"
#include "motion/trigger_zone.hpp"
#include "problem/contact.hpp"
#include "setup/event_loads.hpp"
#include "setup/outputs.hpp"
#include "setup/subdomains.hpp"
#include "stability/verdict.hpp"

namespace slipfront::setup {

std::unique_ptr<motion::Stepper> new_stepper(const Problem& problem, const mesh::Mesh& plate,
                                             const std::optional<mesh::Mesh>& base,
                                             const std::vector<double>& healed,
                                             const motion::Execution& execution) {
  return std::make_unique<motion::Stepper>(GlobalBodies(problem, plate, base).bodies(),
                                           contact_model(problem, mesh::interface_x_m(plate), healed),
                                           problem.time, execution);
}

std::unique_ptr<motion::PlainStepper> new_plain_stepper(const Problem& problem, const mesh::Mesh& plate,
                                                        const std::optional<mesh::Mesh>& base,
                                                        const std::vector<double>& healed) {
  return std::make_unique<motion::PlainStepper>(GlobalBodies(problem, plate, base).bodies(),
                                                contact_model(problem, mesh::interface_x_m(plate), healed),
                                                problem.time);
}

std::unique_ptr<motion::TimeStepper> whole_stepper(const Problem& problem, const InitialState& initial,
                                                   const motion::Execution& execution) {
  const auto& mesh = initial.mesh;
  const auto& base = initial.base;
  std::unique_ptr<motion::TimeStepper> stepper;
  if (problem.is_plain())
    stepper = new_plain_stepper(problem, mesh, base, initial.healed);
  else
    stepper = new_stepper(problem, mesh, base, initial.healed, execution);
  stepper->set_probes(probes_of(problem, mesh, base));
  return stepper;
}

namespace {

std::unique_ptr<motion::TimeStepper> stepper_of(const Problem& problem, InitialState& initial,
                                                const motion::Execution& execution, Processes& processes) {
  if (processes.size() == 1) return whole_stepper(problem, initial, execution);
  return new_distributed_stepper(problem, initial, processes, execution);
}

/// What only the stepper needed.
void release_nodes(InitialState& initial) {
  const auto release = [](mesh::Mesh& mesh) {
    mesh.x_m = std::vector<double>();
    mesh.y_m = std::vector<double>();
    mesh.cells = std::vector<mesh::Cell>();
  };
  release(initial.mesh);
  if (initial.base) release(*initial.base);
  return_freed_memory();
}

}  // namespace

std::unique_ptr<motion::TimeStepper> start_event(const Problem& problem, InitialState& initial,
                                                 const motion::Execution& execution, Processes& processes) {
  auto& state = initial.before(problem.start.kind);
  initial.release_displacements(&state);
  const auto loads = event_loads(problem, initial, processes);
  // The other ranks get the state without its displacements, and their columns of these.
  std::array<solid::Field, 4> u;
  for (std::size_t k = 0; k < u.size(); ++k) std::swap(u[k], *state.displacements()[k]);
  auto stepper = stepper_of(problem, initial, execution, processes);
  for (std::size_t k = 0; k < u.size(); ++k) std::swap(u[k], *state.displacements()[k]);
  stepper->start(state, shear_speed_in_event_m_per_s(problem), loads);
  initial.release_displacements();
  release_nodes(initial);
  return stepper;
}

std::unique_ptr<motion::TimeStepper> make_stepper(const Problem& problem, InitialState& initial,
                                                  const motion::Execution& execution, Processes& processes) {
  auto stepper = stepper_of(problem, initial, execution, processes);
  release_nodes(initial);
  return stepper;
}

motion::EventRun begin_event(const Problem& problem, const InitialState& initial,
                             motion::TimeStepper& stepper, const motion::Monitor& monitor,
                             const results::Sinks& sinks, motion::Observers more) {
  const auto& state = initial.before(problem.start.kind);
  std::optional<motion::Interval> stop_window;
  if (problem.is_sequence()) stop_window = {state.inside_from_m, state.inside_to_m};
  const motion::EventSetup setup = {
      .state = state,
      .mu_s = strength_over_pressure(problem, state.tractions.x_m, initial.healed),
      .waves = {fastest_speed_m_per_s(problem),
                stability::radiation_damping_Pa_s_per_m(materials_of(problem))},
      .loads_settle_s = loads_settle_s(problem),
      .time = problem.time,
      .tip_slip_interval_s = problem.output.history_interval_s,
      .energy_interval_s = problem.output.energy_interval_s,
      .halo = motion::halo_for(initial.mesh, problem.fronts.l_star_m),
      .stop_window = stop_window,
      .slow_m_per_s = problem.is_slow() ? slow_slip_rate_m_per_s(problem) : infinity};
  auto list = results::observers_of(output_setup(problem, initial, stepper.step_s()), stepper, sinks);
  std::ranges::move(more, std::back_inserter(list));
  return {stepper, setup, monitor, std::move(list)};
}

}  // namespace slipfront::setup
