// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/per_node.hpp"
#include "interface/friction.hpp"
#include "mesh/mesh.hpp"
#include "motion/coupling.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "setup/initial_state.hpp"
#include "statics/statics.hpp"

// How a case's event begins: what is put onto the interface, and where friction is weakened.
namespace slipfront::setup {

/// t/p at which nodes slip in the state before the event: static coefficients; with a cohesion the strength
/// under the prescribed pressure over that.
/// @param x_m     of the interface nodes
/// @param healed  see friction_at
PerNode strength_over_pressure(const Problem& problem, const std::vector<double>& x_m,
                               const std::vector<double>& healed = {});

/// When the loads of a case's event last change; inf where they go on to.
double loads_settle_s(const Problem& problem);
/// Loads of a case's event in the state that it begins with: prescribed tractions, trigger or patch, weakened
/// nodes, states of friction.
/// @throws UserError  where a trigger adds nothing, or no node that is weakened has a law that weakens
motion::Loads event_loads(const Problem& problem, const InitialState& initial);
/// Those of rank 0, on all ranks. Collective. @throws as Processes::from_root
motion::Loads event_loads(const Problem& problem, const InitialState& initial, Processes& processes);
/// Those without strength grown at rest and states of friction.
motion::Loads event_loads(const Problem& problem, const statics::Equilibrium& state, const mesh::Mesh& mesh,
                          const std::vector<double>& healed = {});

}  // namespace slipfront::setup
