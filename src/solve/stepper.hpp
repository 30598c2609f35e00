// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "solve/recorder.hpp"
#include "solve/settings.hpp"
#include "solve/statics.hpp"

namespace slipfront::solve {

/// @throws UserError where the interface rows do not fit into the mesh.
void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time);

/// Explicit motion of the plate: Newmark with beta = 0, gamma = 1/2 (displacements at whole steps, velocities
/// at half steps), damping force on the last half-step velocity. The rows of nodes next to the interface are
/// sub-cycled: in each step the other nodes move first, then the interface layer takes its sub-steps while
/// its neighbours above move at constant velocity. With one sub-step this is the plain scheme.
class Stepper {
 public:
  /// @throws UserError where the interface rows do not fit into the mesh.
  Stepper(const mesh::Mesh& mesh, const solid::Material& material, const interface::ContactModel& contact,
          const TimeStepping& time);

  double stable_step_s() const { return stable_step_s_; }
  double step_s() const { return step_s_; }
  double substep_s() const { return step_s_ / substeps_; }
  const solid::Operator& plate() const { return plate_; }

  /// Nodes moved in one step, sub-steps counted, and nodes of the plate that move at all.
  double node_updates_per_step() const { return node_updates_per_step_; }

  /// Puts the plate into an equilibrium, moving with the shear at top_speed_m_per_s, at time 0.
  void start(const Equilibrium& equilibrium, double top_speed_m_per_s);

  /// External forces along x on the interface nodes, scaled in time by the trigger's ramp. [lower], N per
  /// unit thickness
  void set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m);

  /// One step. Every contact update is shown to the recorder; the state at the beginning of the step is
  /// appended to `sample` where it is given.
  void advance(Recorder& recorder, fronts::History* sample = nullptr);

  /// Time of the displacements. The velocities belong to half a step, or half a sub-step in the layer,
  /// earlier.
  double time_s() const { return static_cast<double>(step_) * step_s_; }
  std::int64_t step() const { return step_; }
  const solid::Field& u_m() const { return u_; }
  const solid::Field& v_m_per_s() const { return v_; }
  const interface::Interface& interface_state() const { return interface_; }

  double energy_J_per_m() const;  ///< strain and kinetic
  double kinetic_energy_J_per_m() const;
  double top_force_x_N_per_m() const;  ///< of the loaded edge on the plate
  double trigger_work_J_per_m() const { return trigger_work_; }

 private:
  struct IrregularRows {
    solid::BlockRows rows;
    std::vector<double> interpolated;  ///< [neighbours] 1 where the neighbour is outside the layer
    std::vector<bool> in_contact;      ///< [rows] interface nodes: moved by the contact update
    std::vector<double> a_x, a_y;      ///< [rows] M^-1 K w
  };

  void divide_rows(const mesh::Mesh& mesh, const std::vector<bool>& in_layer);
  void compute_irregular(IrregularRows& part, double remaining_s);
  void apply_irregular(const IrregularRows& part, double dt);
  /// Moves the nodes with a stencil in rows [first_row, last_row). `w_last_row`: u + beta_R v of row
  /// last_row, x then y, or null where it follows from the motion `remaining_s` earlier.
  void sweep(int first_row, int last_row, double dt, double remaining_s, const double* w_last_row);
  void take_substep(int k, Recorder& recorder, fronts::History* sample);
  void append_sample(fronts::History& history) const;

  solid::Operator plate_;
  double damping_s_;
  interface::ContactModel contact_;
  double stable_step_s_ = 0, step_s_ = 0;
  int layer_rows_, substeps_;
  double node_updates_per_step_ = 0;

  IrregularRows slow_, fast_;
  std::vector<mesh::Node> lower_, top_;
  std::vector<double> lower_mass_kg_;
  interface::Interface interface_;
  interface::Trigger trigger_;
  std::vector<double> trigger_force_N_;
  std::vector<std::size_t> trigger_nodes_;  ///< where the force is not zero
  double trigger_work_ = 0;

  solid::Field u_, v_;
  solid::Field start_u_;   ///< interface displacement at the start: slip is counted from it. [lower]
  std::vector<double> w_;  ///< three rows of u + beta_R v, rolling
  std::vector<double> w_above_layer_;  ///< u + beta_R v of the row above the layer before the step
  double top_speed_ = 0;
  std::int64_t step_ = 0;
};

}  // namespace slipfront::solve
