// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "input/case.hpp"
#include "mesh/mesh.hpp"
#include "motion/settings.hpp"
#include "motion/stepper.hpp"
#include "record/record.hpp"
#include "solid/element.hpp"
#include "stability/modes.hpp"
#include "statics/settings.hpp"

namespace slipfront::run {

/// Displacements of all nodes, from the bodies' measures alone: for refusals before anything is built.
struct Unknowns {
  double of_plate = 0, of_base = 0;
};
Unknowns approximate_unknowns(const input::Case& config);

/// Threads of one run: one for so many nodes that a step takes longer than waking a thread does, few enough
/// to leave most of a large machine to others, and no more than processors.
int suitable_threads(const input::Case& config);

/// Speed of the top edge where the plate is loaded by a ramp, and during the event; or of the pusher between
/// events.
double top_speed_m_per_s(const input::Case& config);
/// A pusher stays where it is.
double top_speed_in_event_m_per_s(const input::Case& config);

/// The largest that a slip rate can be by linear elasticity, see motion::Watch.
double fastest_speed_m_per_s(const input::Case& config);

/// The materials on both sides of the interface.
stability::Bodies bodies_of(const input::Case& config);

/// The state of the bulk that carries prescribed tractions, which displacements leave out. None of tractions
/// that vary along x: they do not determine it.
std::optional<solid::UniformStress> prescribed_stress(const input::Case& config);

/// stability::damping_of_grid_waves_s rounded up to three digits, as notes print it.
double advised_damping_s(const input::Case& config);

/// What the plate's shape leaves of loading.solver.
statics::StaticSolver wanted_solver(const input::Case& config);

/// Whether steps are computed as the scheme is written.
bool is_plain(const input::Case& config);

/// Whether the output asks for fields of all nodes.
bool has_snapshots(const input::Case& config);

/// Whether rank 0 of several needs no more of the bodies than their interfaces (see
/// mesh::make_interface) and the cells at their corners: nothing is strained before the event, and all other
/// cells are equal squares, enough of them for the stable step to follow from their side.
bool root_has_interface_only(const input::Case& config, int n_processes);

/// Given tractions at the nodes of the interface, from their file if there is one.
/// @throws UserError
record::StaticState prescribed_tractions(const input::Case& config, const mesh::Mesh& mesh);

/// Positions of the nodes of the interface.
std::vector<double> interface_x_m(const mesh::Mesh& mesh);

}  // namespace slipfront::run
