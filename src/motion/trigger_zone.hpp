// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/per_node.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Interface nodes in contact that lie within zone_m of the outermost one of the event's edge.
std::vector<std::size_t> trigger_zone(const statics::Equilibrium& state, interface::EventKind kind,
                                      double zone_m);

/// Sign of the tangential force on a zone before the event; 1 where that is 0.
double load_direction(const statics::Equilibrium& state, std::span<const double> tributary_m,
                      std::span<const std::size_t> zone);

/// Forces on the interface nodes that the trigger adds, see TriggerForm, N per unit thickness. [interface
/// nodes]
std::vector<double> trigger_forces(const statics::Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger,
                                   const PerNode& mu_s);

/// When a trigger's loads last change: the end of its ramp, or its removal.
double last_change_s(const interface::Trigger& trigger);

/// Halo of the slip record that t_d, p_d at a distance l_star_m ahead of the tip need.
int halo_for(const mesh::Mesh& mesh, double l_star_m);

}  // namespace slipfront::motion
