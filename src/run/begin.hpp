// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/per_node.hpp"
#include "interface/friction.hpp"
#include "mesh/mesh.hpp"
#include "motion/coupling.hpp"
#include "problem/problem.hpp"
#include "statics/statics.hpp"

// How a case's event begins: what is put onto the interface, and where friction is weakened.
namespace slipfront::run {

/// t/p at which nodes slip in the state before the event: static coefficients; with a cohesion the strength
/// under the prescribed pressure over that. @param of_nodes  as below
PerNode ratios_at_rest(const Problem& problem, const std::vector<double>& of_nodes);
/// t/p at rest of each node; empty where all have the static coefficient of the case. @param healed  see
/// friction_at
std::vector<double> ratios_at_rest(const Problem& problem, const mesh::Mesh& mesh,
                                   const std::vector<double>& healed = {});

/// When the loads of a case's event last change; inf where they go on to.
double loads_settle_s(const Problem& problem);
/// Loads of a case's event in the state that it begins with: prescribed tractions, trigger or patch, weakened
/// nodes.
/// @param of_nodes  ratios_at_rest
/// @throws UserError  where a trigger adds nothing, or no node that is weakened has a law that weakens
motion::Loads starting_loads(const Problem& problem, const statics::Equilibrium& state,
                             const mesh::Mesh& mesh, const std::vector<double>& of_nodes);

}  // namespace slipfront::run
