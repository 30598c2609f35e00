// SPDX-License-Identifier: BSD-3-Clause
#include "setup/event_loads.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "interface/nucleation.hpp"
#include "motion/quasi_dynamic.hpp"
#include "motion/trigger_zone.hpp"
#include "problem/contact.hpp"

namespace slipfront::setup {

namespace {

using interface::is_at_edge;

/// B at the nodes of the interface. [interface nodes]
std::vector<double> patch(const interface::Nucleation& nucleation, const mesh::Mesh& mesh) {
  std::vector<double> B;
  for (const auto n : mesh.interface_nodes)
    B.push_back(interface::nucleation_profile(nucleation, mesh.x_m[n], mesh.period_m));
  return B;
}

/// Why a trigger at an edge adds nothing, and which amount does.
Message idle_trigger(const Problem& problem, const statics::Equilibrium& state, const PerNode& mu_s,
                     std::span<const double> tributary_m) {
  const auto& trigger = problem.start.trigger;
  const auto zone = motion::trigger_zone(state, problem.start.kind, trigger.zone_m);
  const double direction = motion::load_direction(state, tributary_m, zone);
  double least = infinity;
  for (const auto k : zone)
    least = std::min(least, direction * state.tractions.t_s_Pa[k] / state.tractions.p_s_Pa[k] / mu_s[k]);
  const bool added = trigger.form == interface::TriggerForm::added;
  return Message(
      "{} = {:g} adds no traction in the trigger zone, where t is at least {:.4g} mu_s p before the event; "
      "choose more than {}",
      Key(problem.start.trigger_key()), trigger.amount, least,
      !added      ? Message("{:.4g}", least)
      : least < 1 ? Message("0")
                  : Message("{:.4g} with {} = raised", least, Key("event.trigger_form")));
}

/// Forces of a trigger at an edge, none for other events.
/// @throws UserError  where the trigger adds nothing
std::vector<double> trigger_forces(const Problem& problem, const statics::Equilibrium& state,
                                   const PerNode& mu_s, std::span<const double> tributary_m) {
  auto forces = motion::trigger_forces(state, tributary_m, problem.start.kind, problem.start.trigger, mu_s);
  if (problem.start.pushes_edge() && std::ranges::all_of(forces, [](double force) { return force == 0; }))
    throw UserError(idle_trigger(problem, state, mu_s, tributary_m)).about("event.trigger_form");
  return forces;
}

/// Forces of the trigger, and of a patch that is overstressed. [interface nodes]
std::vector<double> starting_forces_N_per_m(const Problem& problem, const statics::Equilibrium& state,
                                            const PerNode& mu_s, const mesh::Mesh& mesh,
                                            std::span<const double> tributary_m) {
  auto forces = trigger_forces(problem, state, mu_s, tributary_m);
  if (!problem.start.overstresses()) return forces;
  const auto B = patch(problem.start.nucleation, mesh);
  for (std::size_t k = 0; k < B.size(); ++k)
    if (state.contact[k] != statics::Contact::open)
      forces[k] = problem.start.nucleation.overstress_Pa * B[k] * tributary_m[k];
  return forces;
}

/// Forces along y that part the bodies; empty for none. [interface nodes]
std::vector<double> unloading_N_per_m(const Problem& problem, const statics::Equilibrium& state,
                                      const mesh::Mesh& mesh, std::span<const double> tributary_m) {
  const auto& start = problem.start;
  if (!start.unloads_edge() && !start.unloads_patch()) return {};
  std::vector<double> forces(tributary_m.size(), 0.0);
  for (const auto k : motion::trigger_zone(state, start.kind, start.trigger.zone_m))
    forces[k] = start.trigger.amount * state.tractions.p_s_Pa[k] * tributary_m[k];
  if (start.unloads_patch()) {
    const auto B = patch(start.nucleation, mesh);
    for (std::size_t k = 0; k < B.size(); ++k)
      if (state.contact[k] != statics::Contact::open)
        forces[k] = start.nucleation.unloading_Pa * B[k] * tributary_m[k];
  }
  return forces;
}

/// Interface::strength_fraction of an event that begins with a weakened patch or zone; empty for others.
std::vector<double> intact_shares(const Problem& problem, const statics::Equilibrium& state,
                                  const mesh::Mesh& mesh) {
  if (problem.start.weakens_patch()) {
    auto shares = patch(problem.start.nucleation, mesh);
    for (double& share : shares) share = 1 - share;
    return shares;
  }
  if (!is_at_edge(problem.start.kind) || problem.start.trigger.form != interface::TriggerForm::weakened)
    return {};
  std::vector<double> shares(mesh.interface_nodes.size(), 1.0);
  for (const auto k : motion::trigger_zone(state, problem.start.kind, problem.start.trigger.zone_m))
    shares[k] = 0;
  return shares;
}

/// Refuses an event that begins with weakening at nodes whose friction does not weaken.
void require_weakening(const Problem& problem, const std::vector<double>& strength_fraction,
                       const std::vector<interface::FrictionLaw>& laws) {
  if (strength_fraction.empty() || laws.empty()) return;
  for (std::size_t i = 0; i < laws.size(); ++i)
    if (strength_fraction[i] < 1 &&
        interface::kinetic_coefficient(laws[i]) < interface::static_coefficient(laws[i]))
      return;
  throw UserError("{} = {} does nothing where friction does not weaken at any node; choose another form",
                  Key(is_at_edge(problem.start.kind) ? "event.trigger_form" : "nucleation.form"),
                  problem.start.weakening_form())
      .about("event.kind");
}

}  // namespace

PerNode strength_over_pressure(const Problem& problem, const std::vector<double>& x_m,
                               const std::vector<double>& healed) {
  const auto& of_all = problem.friction.law;
  auto laws = friction_at(problem, x_m, healed);
  if (laws.empty() && of_all.cohesion_Pa() == 0) return interface::static_coefficient(of_all);
  laws.resize(x_m.size(), of_all);
  const bool is_cohesive = std::ranges::any_of(laws, [](const auto& law) { return law.cohesion_Pa() > 0; });
  std::vector<double> ratios;
  for (const auto& law : laws) ratios.push_back(interface::static_coefficient(law));
  if (!is_cohesive) return ratios;
  const auto s = prescribed_tractions(problem, x_m);
  for (std::size_t k = 0; k < laws.size(); ++k)
    ratios[k] = interface::static_strength_Pa(laws[k], s.p_s_Pa[k]) / s.p_s_Pa[k];
  return ratios;
}

double loads_settle_s(const Problem& problem) {
  if (problem.has_growing_tractions()) return infinity;
  if (problem.start.is_by_force()) return motion::last_change_s(problem.start.trigger);
  if (!problem.start.is_forced()) return 0;
  const auto& n = problem.start.nucleation;
  return n.reach_m() / n.front_speed_m_per_s + n.weakening_time_s;
}

motion::Loads event_loads(const Problem& problem, const InitialState& initial) {
  auto loads = event_loads(problem, initial.before(problem.start.kind), initial.mesh, initial.healed);
  loads.law_states = initial.law_states;
  return loads;
}

motion::Loads event_loads(const Problem& problem, const InitialState& initial, Processes& processes) {
  return unpacked<motion::Loads>(
      processes.from_root([&](MessageBuffer& to) { to.append(packed(event_loads(problem, initial))); }));
}

motion::Loads event_loads(const Problem& problem, const statics::Equilibrium& state, const mesh::Mesh& mesh,
                          const std::vector<double>& healed) {
  motion::Loads loads;
  if (problem.is_prestressed()) {
    loads = motion::prescribed_loads(state);
    loads.prestress_rate = {problem.prestress->t_rate_Pa_per_s, problem.prestress->p_rate_Pa_per_s};
  }
  const auto tributary_m = mesh::tributary_lengths_m(mesh);
  if (problem.is_sequence()) loads.light_Pa = motion::light_pressure_Pa(state.tractions.p_s_Pa, tributary_m);
  loads.trigger = problem.start.trigger;
  loads.trigger_force_N_per_m = starting_forces_N_per_m(
      problem, state, strength_over_pressure(problem, state.tractions.x_m, healed), mesh, tributary_m);
  loads.unloading_N_per_m = unloading_N_per_m(problem, state, mesh, tributary_m);
  loads.strength_fraction = intact_shares(problem, state, mesh);
  if (problem.start.is_forced()) {
    for (const auto n : mesh.interface_nodes)
      loads.weakens_at_s.push_back(from_centre_m(problem.start.nucleation, mesh.x_m[n], mesh.period_m) /
                                   problem.start.nucleation.front_speed_m_per_s);
    loads.weakening_time_s = problem.start.nucleation.weakening_time_s;
  }
  if (!loads.strength_fraction.empty())
    require_weakening(problem, loads.strength_fraction, friction_at(problem, mesh::interface_x_m(mesh)));
  return loads;
}

}  // namespace slipfront::setup
