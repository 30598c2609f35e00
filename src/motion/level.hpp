// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "boundary/boundary.hpp"
#include "boundary/dashpot.hpp"
#include "boundary/machine_springs.hpp"
#include "mesh/mesh.hpp"
#include "mesh/node_columns.hpp"
#include "motion/damping_work.hpp"
#include "motion/settings.hpp"
#include "motion/step_plan.hpp"
#include "record/energies.hpp"
#include "solid/kernels.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// A body's stiffness and its motion: displacements at whole steps, velocities at half steps.
struct BodyMotion {
  solid::Operator op;
  double damping_s = 0;
  solid::Field u_m, v_m_per_s;
  mesh::NodeColumns columns;
  /// Owned nodes of a part of a larger body, which enter energies and works: per row as places in it, and
  /// per node. A run, or a span of a stencil row, is owned as a whole or not at all. Empty for a whole body,
  /// which owns all its nodes.
  std::vector<solid::Span> own;
  std::vector<bool> is_own;
  boundary::Boundary boundary = {};
  boundary::MachineSprings springs = {};

  bool is_owned(int row, solid::Span nodes) const {
    return own.empty() || (nodes.begin >= own[row].begin && nodes.begin < own[row].end);
  }
  bool is_owned(mesh::Node n) const { return is_own.empty() || is_own[n]; }
};

/// Nodes with consecutive numbers in a list: node at + k is first + k for k < count.
struct NodeRun {
  std::size_t at = 0;
  mesh::Node first = 0;
  std::size_t count = 0;
  bool is_owned = true;  ///< see BodyMotion
};
std::vector<NodeRun> runs_of(std::span<const mesh::Node> nodes, const BodyMotion& body);

/// Nodes of a level's cells that belong to finer cells, too, and move with the finer level's steps. Of the
/// force of the level's own cells on them, what it was in the equilibrium at the start acts as a constant
/// load in each of these steps; the change since then comes as one kick per step of the level, an impulse.
struct Shared {
  std::vector<mesh::Node> node;  ///< ascending
  std::vector<NodeRun> runs;
  std::vector<boundary::Dashpot> dashpots;
  std::vector<std::int32_t> irregular_row;  ///< place in `irregular`; -1: on an edge
  solid::Field u_before_m;                  ///< displacements at the level's last impulse
  solid::Field impulse_m_per_s;             ///< the impulse, until the finer level's next step takes it
  /// The constant load, as an acceleration.
  solid::Field equilibrium_load_m_per_s2;
  // For the energies: velocities after the finer level's last step; K w/m at the level's last impulse, and
  // the mean velocity over the level's step before it.
  solid::Field v_last_m_per_s, a_m_per_s2, v_mean_before_m_per_s;
};

/// A field of Shared.
struct SharedField {
  solid::Field Shared::*field;
  bool is_in_halos;  ///< or serves the energies of own nodes alone
};
/// All of them: allocated, and kept in checkpoints.
inline constexpr std::array<SharedField, 6> shared_fields = {{{&Shared::u_before_m, true},
                                                              {&Shared::impulse_m_per_s, true},
                                                              {&Shared::equilibrium_load_m_per_s2, true},
                                                              {&Shared::v_last_m_per_s, true},
                                                              {&Shared::a_m_per_s2, false},
                                                              {&Shared::v_mean_before_m_per_s, false}}};

/// Consecutive rows of nodes that are kicked and moved together: the unit in which threads::Wavefront takes a
/// step, so that the rows of a band stay in cache while the next steps follow. That is possible since a band
/// reads, besides its own rows, only the row below and the row above it.
///
/// What reads or writes more is in a level's first band, which is taken with the interface: nodes of the
/// interface, nodes shared with other levels, and those that have neighbours farther away than the next row.
/// A row that has irregular nodes is a separate band. Levels but the coarsest have one band.
struct Band {
  int first_row = 0, last_row = 0;
  // Ranges within the level's lists:
  solid::Span stencil, edges, irregular, dashpots;
  std::vector<NodeRun> runs;  ///< of the irregular nodes; takes_impulse, moves: uniform in each
  bool has_top = false;
  /// Whether the whole body, of which this may be a part, has irregular nodes here; of the coarsest level.
  bool is_irregular = false;
};

/// Motion of rows of the coarsest level in single precision. While steps are taken these rows of BodyMotion
/// are out of date; to_double brings them up to date afterwards.
struct SingleRows {
  solid::Span bands;  ///< of the level: above the first one, without irregular nodes
  int first_row = 0, last_row = -1;
  std::vector<float> u_x_m, u_y_m, v_x_m_per_s, v_y_m_per_s;  ///< [nodes of these rows]
};

/// All cells that take the same time step, what they do to their nodes, and the nodes that move with this
/// step. Each level's step is a whole multiple of the next one's. The last level, the finest, has the
/// interface.
struct StepLevel {
  double step_s = 0;
  int period = 1;  ///< see step_plan.hpp
  solid::PartialStiffness stiffness;
  /// Nodes of the general rows, all of them in the first band, then those with own stencils.
  std::vector<mesh::Node> irregular;
  solid::GeneralRows::Workspace general_space;
  std::vector<Band> bands;                  ///< rows ascending
  std::vector<boundary::Dashpot> dashpots;  ///< as in `irregular`
  std::vector<bool> takes_impulse;          ///< [irregular] kicked at once: not shared, no dashpot
  std::vector<bool> moves;                  ///< [irregular] moved at once: not shared, not in contact
  std::vector<double> a_x, a_y;             ///< [irregular]
  std::vector<mesh::Node> top;              ///< nodes of the loaded edge that move with this level
  Shared shared;
  solid::BlockRows top_rows;           ///< K of the level's cells, N/m
  std::vector<mesh::Node> edge_nodes;  ///< of the stencil's edge rows, all in the lowest block
  solid::Field edge_kick_m_per_s;      ///< [edge_nodes]
  solid::Field top_force_N;            ///< K w of top_rows at the last impulse
  DampingWork damping_work;
};

/// A body's cells, divided into levels.
struct StepLevels {
  std::vector<StepLevel> level;             ///< coarsest first
  std::vector<std::uint8_t> level_of_node;  ///< [nodes]; orphans count to the first
  std::vector<bool> is_orphan;
  std::vector<boundary::Dashpot> contact_dashpots;  ///< of interface nodes
  /// Nodes moved in one step of the coarsest level, sub-steps counted.
  double node_updates_per_step = 0;
};

/// @throws UserError where the interface rows do not fit into the mesh.
/// @param table  of the case file that describes the body
void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time, std::string_view table = "plate");

/// For each block of the mesh, its step over that of the lowest one: the largest power of two that its cells
/// allow, twice, four times ... as long for squares.
/// @param stable_step_s  of the whole body
std::vector<int> block_ratios(const mesh::Mesh& mesh, const solid::Material& material,
                              const boundary::Boundary& boundary, const TimeStepping& time,
                              double stable_step_s);

/// A body's cells divided into levels, coarsest first.
struct CellLevels {
  std::vector<int> periods;
  /// [cells], [nodes]: a node moves with the finest of its cells; orphans count to the first level.
  std::vector<std::uint8_t> of_cell, of_node;
};
/// @param block_periods  of a StepPlan
CellLevels cell_levels(const mesh::Mesh& mesh, const TimeStepping& time, std::span<const int> block_periods);

/// How often a level's cells kick their nodes, and over how many columns they reach.
struct LevelReach {
  int period = 1, columns = 1;
};
/// Reaches of a body's levels, coarsest first.
std::vector<LevelReach> reach_of_levels(const mesh::Mesh& mesh, std::span<const int> block_periods);

/// Columns at either end in which the layer that takes sub-steps has cells above its rows, since it follows a
/// rounded corner; 0 where there are none.
int columns_of_rounded_layer(const mesh::Mesh& mesh, const TimeStepping& time,
                             std::span<const int> block_periods);

/// Replaces each number by its maximum over the subdomains of a body; empty for a whole body.
using MaxOverSubdomains = std::function<void(std::span<double>)>;

/// @param largest  asked as often by all parts of a body
StepLevels make_levels(const mesh::Mesh& mesh, const solid::Material& material, const BodyMotion& body,
                       const TimeStepping& time, const StepPlan::OfBody& steps,
                       const MaxOverSubdomains& largest);

/// Sets what a level keeps of its shared nodes' motion before now, as if their velocities had been constant.
void set_motion_before(StepLevel& level, const BodyMotion& body);

/// Begins an impulse. At shared nodes the level's cells see the mean velocity since their last impulse; it
/// replaces that of the finer steps until end_impulse.
void begin_impulse(StepLevel& level, BodyMotion& body, record::Energies& works);
/// Kicks the nodes of one band by the forces of the level's cells, and moves those that move with the level.
/// Bands go from the first to the last, with the same `w`, which keeps w = u + beta_R v from before the
/// impulse of rows that have moved already.
void apply_band_impulse(StepLevel& level, const Band& band, BodyMotion& body, solid::RollingRows& w,
                        ImpulseProducts& products, record::Energies& works);
/// Longest run of bands that can be stepped in single precision; none where all have irregular nodes.
SingleRows make_single_rows(const StepLevel& coarsest, const solid::Operator& op);
/// Nothing where there are no such rows.
void to_single(const BodyMotion& body, SingleRows& single);
void to_double(const SingleRows& single, BodyMotion& body);
/// Applies the impulse of one of these bands, as apply_band_impulse does.
/// @param w  holds the row below at the first of these bands, and after the last one its last row and the
/// next
void apply_band_impulse(const StepLevel& level, const Band& band, BodyMotion& body, SingleRows& single,
                        solid::RollingRows& w, solid::RollingRowsOf<float>& w_single,
                        ImpulseProducts& products);

/// Puts the level's force on its shared nodes, less the constant load, into Shared::impulse_m_per_s. After
/// the first band, which has all shared nodes.
void end_impulse(StepLevel& level, BodyMotion& body);

/// Kicks the shared nodes of a coarser level by its equilibrium load and by the pending impulse, if any, and
/// moves them by a step dt_s of the finer level.
void move_shared(StepLevel& coarser, BodyMotion& body, double dt_s, record::Energies& works);

// For the energies. Between exchange and restore, velocities of shared nodes are the mean ones that the level
// sees, as between begin_impulse and end_impulse; the two functions after them need these.
void exchange_velocities(const StepLevel& level, BodyMotion& body);
void restore_velocities(const StepLevel& level, BodyMotion& body);
/// Less the work of the level's last force on its shared nodes through the mean velocities before and after
/// it: that much the level's own cells account for. The coupling's work is this and the work that load and
/// impulses do through the velocities of the finer steps, which move_shared sums.
double coupling_work(const StepLevel& level, const BodyMotion& body);
/// ImpulseProducts::next_velocity_K_w of a band, once all velocities after the last impulse are known.
double next_velocity_product(const StepLevel& level, const Band& band, const BodyMotion& body);

/// Products of displacements u and velocities v with K, the stiffness of a level's cells.
struct StiffnessProducts {
  double u_K_u = 0, v_K_u = 0;
};
StiffnessProducts stiffness_products(const StepLevel& level, const BodyMotion& body);
/// u K u of the displacements `back_s` earlier, had the velocity been the present one.
double stiffness_product_before(const StepLevel& level, const BodyMotion& body, double back_s);

}  // namespace slipfront::motion
