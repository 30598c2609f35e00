// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "boundary/boundary.hpp"
#include "boundary/machine_springs.hpp"
#include "mesh/mesh.hpp"
#include "record/energies.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"

namespace slipfront::boundary {

/// Dashpots along x and y at an edge node of mass m, integrated implicitly: with the damping coefficient c
/// and the node's time step dt, d = c dt/(2 m) and v+ = ((1 - d) v- - dt a)/(1 + d), which is stable for any
/// c. An infinite d prescribes the node's velocity.
struct Dashpot {
  std::size_t at = 0;  ///< row of the level, shared node, or interface node
  mesh::Node node = 0;
  double d_x = 0, d_y = 0;
  std::size_t spring = MachineSprings::none;  ///< place among the body's
};

/// The dashpot of an edge node that moves with steps step_s: c_L rho along the normal, c_S rho across it, per
/// length of edge (Lysmer and Kuhlemeyer 1969); at is 0.
Dashpot make_dashpot(const EdgeNode& edge, const solid::Material& material, double mass_kg, double step_s);

/// Work of a node's dashpots in a step at a mean velocity, J per unit thickness; never positive.
double dashpot_work(double d_x, double d_y, double mass_kg, double mean_x_m_per_s, double mean_y_m_per_s);

/// Velocity of a dashpot's node at u_m after a kick that alone would lead from `before` to `trial`; the works
/// of the dashpot and of what springs the node are added to `works`.
/// @param step_s  with which it moves
solid::Pair damp(const Dashpot& dashpot, MachineSprings& springs, double step_s, double mass_kg,
                 solid::Pair u_m, solid::Pair before, solid::Pair trial, record::Energies& works);

}  // namespace slipfront::boundary
