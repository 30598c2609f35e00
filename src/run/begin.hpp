// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/per_node.hpp"
#include "input/case.hpp"
#include "interface/friction.hpp"
#include "mesh/mesh.hpp"
#include "motion/coupling.hpp"
#include "statics/statics.hpp"

// How a case's event begins: what is put onto the interface, and where friction is weakened.
namespace slipfront::run {

/// Coefficients at rest of the nodes; the case's where it has none of their own.
PerNode static_coefficients(const input::Case& config, const std::vector<double>& of_nodes);
/// Those of the nodes' laws; empty where they all have the case's.
std::vector<double> static_coefficients(const std::vector<interface::FrictionLaw>& laws);

/// Loads of a case's event in the state that it begins with: prescribed tractions, trigger or patch, weakened
/// nodes.
/// @param of_nodes  coefficients at rest of the nodes; none where they all have the case's
/// @throws UserError  where a trigger adds nothing, or no node that is weakened has a law that weakens
motion::Loads starting_loads(const input::Case& config, const statics::Equilibrium& state,
                             const mesh::Mesh& mesh, const std::vector<double>& of_nodes);

}  // namespace slipfront::run
