// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "boundary/machine_springs.hpp"
#include "mesh/mesh.hpp"
#include "motion/interface_side.hpp"
#include "motion/level.hpp"
#include "motion/probes.hpp"
#include "motion/settings.hpp"
#include "motion/state_by_node.hpp"
#include "motion/step_plan.hpp"
#include "record/energies.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// Workspace of one step in flight for one body.
struct BodyStep {
  solid::RollingRows w;                  ///< of u + beta_R v, of the coarsest level's sweep
  solid::RollingRowsOf<float> w_single;  ///< the same in single precision, if it is asked for
  ImpulseProducts products;
  record::Energies works;
};

/// Steps of a whole body.
BodySteps body_steps(const BodySource& body, const TimeStepping& time);
/// Of each body the whole one's. @param motions  of the bodies
std::vector<BodySteps> body_steps(std::span<const BodySource> bodies, std::span<const BodyMotion> motions,
                                  const TimeStepping& time);

/// The bodies at rest.
std::vector<BodyMotion> motions_of(std::span<const BodySource> bodies);

/// A deformable body without contact: its cells in levels with different time steps, and its motion. Its
/// cells kick the velocities of the interface nodes; the coupling moves them.
///
/// Every body lies above its interface, y pointing away from it: a body below is described upside down, with
/// u_y and y reversed.
class Body {
 public:
  /// @param motion  of motions_of
  /// @param lands   whether the contact shifts nodes, whose work is to be known; see Landing
  /// @throws UserError where the interface rows do not fit into the mesh.
  Body(const BodySource& source, BodyMotion motion, const StepPlan::OfBody& steps, const TimeStepping& time,
       bool lands);

  const BodySteps& steps() const { return steps_.allowed; }
  /// Whether the wavefront takes the later bands of the coarsest level, apply_later_band_impulse. The other
  /// levels, and all of a body with a shorter step, go with the interface.
  bool has_common_step() const { return steps_.has_common_step; }
  bool has_single_precision() const { return !single_.u_x_m.empty(); }

  const solid::Operator& op() const { return motion_.op; }
  const mesh::NodeColumns& columns() const { return motion_.columns; }
  const solid::Field& u_m() const { return motion_.u_m; }
  const solid::Field& v_m_per_s() const { return motion_.v_m_per_s; }
  double damping_s() const { return motion_.damping_s; }
  const StepLevels& levels() const { return levels_; }
  std::size_t n_bands() const { return levels_.level.front().bands.size(); }
  /// Rows below the next band of the coarsest level.
  int rows_moved(std::size_t band) const {
    return levels_.level.front().bands[std::min(band, n_bands() - 1)].last_row + 1;
  }
  /// The band of the coarsest level with which a node moves; all that moves with finer levels or the
  /// interface does so with the first one.
  std::size_t band_of(mesh::Node n) const;
  /// Displacement of a node while steps are taken, after its band.
  solid::Pair u_in_flight_m(mesh::Node n) const;
  int period() const { return steps_.period(); }
  /// With which a node moves.
  double step_s(mesh::Node n) const;

  /// Begins the motion at a place of equilibrium, with the velocity that the top's gives to u_per_shear: what
  /// the levels do to each other there is kept as an equilibrium force, without which a stressed body at rest
  /// would not stay at rest. Without displacements nothing is strained, and nothing but the loaded edge
  /// moves.
  void start(const solid::Field& u_m, const solid::Field& u_per_shear, double top_speed_m_per_s);

  /// Workspace of a step of the stepper.
  BodyStep new_step() const;
  /// Begins a step, in which kick and move (SteppedBody) sum into this workspace.
  void begin(BodyStep& step);
  /// Kicks by the cells of every level whose step begins with sub-step k. Nodes of these cells alone move at
  /// once, while they are in cache. Where the body has the common step, this takes the first band of the
  /// coarsest level only.
  void kick(int k);
  /// Moves the nodes that levels share.
  void move(int k);
  /// One later band of the coarsest level of a body with the common step, after all sub-steps.
  void apply_later_band_impulse(BodyStep& step, std::size_t band);
  /// Adds the works of a step that is done to the body's.
  void complete(const BodyStep& step) { add_terms(works_, step.works); }
  /// Copies rows in single precision into u_m and v_m_per_s; needed before these are read.
  void sync_to_double() { to_double(single_, motion_); }

  const InterfaceSide& interface_side() const { return interface_; }
  /// What the contact moves.
  ContactBody contact() { return {&interface_, &motion_.u_m, &motion_.v_m_per_s}; }

  int n_rows() const { return motion_.columns.n_rows(); }
  /// See Stepper::visit_columns. @param with_shared  also what levels keep of shared nodes
  template <class Visit>
  void visit_columns(solid::Span columns, solid::Span rows, bool with_shared, Visit&& visit);
  /// Adds all that changes.
  void add_to(StateView& state);
  /// After other values have been put there.
  void update_after_restore() { to_single(motion_, single_); }
  /// Places along the interface of the nodes in some columns.
  solid::Span interface_nodes_in(solid::Span columns) const;

  /// Energies and works up to the last half (sub-)step.
  record::Energies energies();
  double kinetic_energy_J_per_m() const;
  double mass_kg_per_m() const;
  double strain_energy_J_per_m() const;
  /// See Stepper::mean_velocity_m_per_s.
  solid::Field mean_velocity_m_per_s() const;
  /// A component of it, of the nodes [first, end).
  void append_mean_velocity(std::vector<double> solid::Field::*component, mesh::Node first, mesh::Node end,
                            std::vector<double>& to) const;

  const boundary::MachineSprings& springs() const { return motion_.springs; }
  /// Turns the motion round at the places `u_m`, with the machine's forces there, see Stepper::reverse.
  void reverse(const solid::Field& u_m, boundary::MachineSprings springs, double time_s);

 private:
  template <class F>
  void for_own_nodes(F&& f) const {
    for (int r = 0; r < n_rows(); ++r) {
      const auto first = static_cast<mesh::Node>(motion_.columns.row(r).first);
      for (int i = motion_.own[r].begin; i < motion_.own[r].end; ++i) f(first + i);
    }
  }
  /// Products of the landings since the last impulse of a level, if it is the last one.
  void take_landing(const StepLevel& level, ImpulseProducts& products);
  void begin_damping_work();
  void find_equilibrium_load(StepLevel& level);

  BodyMotion motion_;
  StepPlan::OfBody steps_;
  StepLevels levels_;
  SingleRows single_;           ///< none unless time.precision is single
  solid::RollingRows finer_w_;  ///< of u + beta_R v, of the other levels' sweeps
  BodyStep* begun_ = nullptr;   ///< the step that kick and move are in

  InterfaceSide interface_;
  record::Energies works_;  ///< the works alone
};

template <class Visit>
void Body::visit_columns(solid::Span columns, solid::Span rows, bool with_shared, Visit&& visit) {
  const auto nodes_of_row = [&](int row) { return motion_.columns.nodes(row, columns); };
  for (int r = rows.begin; r < rows.end; ++r) {
    const auto nodes = nodes_of_row(r);
    const auto n = static_cast<std::size_t>(nodes.count);
    const bool is_single = !single_.u_x_m.empty() && r >= single_.first_row && r <= single_.last_row;
    if (is_single) {
      const auto at = nodes.first - motion_.columns.row(single_.first_row).first;
      for (auto* values : {&single_.u_x_m, &single_.u_y_m, &single_.v_x_m_per_s, &single_.v_y_m_per_s})
        visit(values->data() + at, n);
    }
    // The row below the first one in single precision reads it in double precision.
    if (!is_single || r == single_.first_row)
      for (auto* values : {&motion_.u_m.x, &motion_.u_m.y, &motion_.v_m_per_s.x, &motion_.v_m_per_s.y})
        visit(values->data() + nodes.first, n);
  }
  if (!with_shared) return;
  for (auto& level : levels_.level) {
    auto& s = level.shared;
    auto next = s.node.begin();
    while (next != s.node.end()) {
      const int row = motion_.columns.row_of(*next);
      const auto nodes = nodes_of_row(row);
      const auto begin = std::lower_bound(next, s.node.end(), nodes.first);
      const auto end = std::lower_bound(begin, s.node.end(), nodes.end());
      const auto at = begin - s.node.begin();
      for (const auto& [field, is_in_halos] : shared_fields)
        for (auto* values : {&(s.*field).x, &(s.*field).y})
          if (is_in_halos) visit(values->data() + at, static_cast<std::size_t>(end - begin));
      next = std::lower_bound(end, s.node.end(), motion_.columns.row(row).end());
    }
  }
}

}  // namespace slipfront::motion
