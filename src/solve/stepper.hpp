// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "solid/kernels.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "solve/energies.hpp"
#include "solve/recorder.hpp"
#include "solve/settings.hpp"
#include "solve/statics.hpp"

namespace slipfront::solve {

/// @throws UserError where the interface rows do not fit into the mesh.
void require_rows_fit(const mesh::Mesh& mesh, const TimeStepping& time);

/// Explicit motion of the plate: Newmark with beta = 0, gamma = 1/2 (displacements at whole steps, velocities
/// at half steps), damping force on the last half-step velocity.
///
/// The rows of cells next to the interface are sub-cycled: every cell has its own step, and pushes its nodes
/// when its own time comes; in between the nodes move at constant velocity: the asynchronous variational
/// integrator of Lew et al. (2003). The nodes between the two kinds of cells feel the coarse cells' force at
/// the start of the event as a constant load in every sub-step, and its change since then in pushes; without
/// this, a stressed plate at rest would not stay at rest. Reversible and symplectic where nothing dissipates.
/// With one sub-step it is the plain scheme. The blocks of a graded plate are such levels, too: each one's
/// step is that of the lowest block times the largest power of two that its cells allow, twice, four times
/// ... as long for squares. A step of the plate is that of its coarsest block.
class Stepper {
 public:
  /// @throws UserError where the interface rows do not fit into the mesh.
  Stepper(const mesh::Mesh& mesh, const solid::Material& material, const interface::ContactModel& contact,
          const TimeStepping& time);

  double stable_step_s() const { return stable_step_s_; }
  double step_s() const { return step_s_; }
  /// The step of the lowest block, time.step_factor of the stable one.
  double lowest_step_s() const { return step_s_ / multiple_; }
  double substep_s() const { return step_s_ / substeps_; }
  /// The (sub-)step with which a node moves; its velocity belongs to half of it before the displacement.
  double step_s(mesh::Node n) const { return node_step_s_[n]; }
  const solid::Operator& plate() const { return plate_; }

  /// Nodes moved in one step, sub-steps counted, and nodes of the plate that move at all.
  double node_updates_per_step() const { return node_updates_per_step_; }

  /// Puts the plate into an equilibrium, moving with the shear at top_speed_m_per_s, at time 0.
  void start(const Equilibrium& equilibrium, double top_speed_m_per_s);

  /// External forces along x on the interface nodes, scaled in time by the trigger's ramp. [lower], N per
  /// unit thickness
  void set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m);

  /// External tractions on the interface nodes: t0 drives the plate to +x, p0 presses it down. [lower]; after
  /// start.
  void set_prestress(std::vector<double> t0_Pa, std::vector<double> p0_Pa);

  /// Weakens nodes for good, see Interface::intact; [lower], after start, which makes all of them intact.
  void set_intact(std::vector<double> intact);

  /// One step. Every contact update is shown to the recorder; the state at the beginning of the step is
  /// appended to `sample` where it is given.
  void advance(Recorder& recorder, fronts::History* sample = nullptr);

  /// Turns the motion round: the steps to come go back through the displacements of those before, exactly but
  /// for rounding where the forces do not depend on time and nothing dissipates. Time goes on. The contact is
  /// updated once, which the recorder sees; the works start anew and lack the first step's coupling.
  void reverse(Recorder& recorder);

  /// Time of the displacements. The velocities belong to half a step, or half a sub-step in the layer,
  /// earlier.
  double time_s() const { return static_cast<double>(step_) * step_s_; }
  std::int64_t step() const { return step_; }
  const solid::Field& u_m() const { return u_; }
  const solid::Field& v_m_per_s() const { return v_; }
  /// The same with the mean velocity over the last step at nodes between sub-cycled and other cells, which
  /// the pushes set swinging within the step.
  solid::Field mean_velocity_m_per_s() const;
  const interface::Interface& interface_state() const { return interface_; }

  double energy_J_per_m() const;  ///< strain and kinetic, each of its own instant
  double kinetic_energy_J_per_m() const;

  /// Energies and works up to the last half (sub-)step.
  Energies energies();

 private:
  /// An absorbing node: with the mass m and the constant c of its dashpot, d = c dt/(2 m), dt the step with
  /// which it moves; v+ = ((1 - d) v- - dt a)/(1 + d), stable whatever c.
  struct Dashpot {
    std::size_t at = 0;  ///< row of the level, shared node, or interface node
    mesh::Node node = 0;
    double d_x = 0, d_y = 0;
  };
  /// Nodes between a level and the next finer one, which moves them.
  struct Shared {
    std::vector<mesh::Node> node;
    std::vector<Dashpot> dashpots;
    std::vector<std::int32_t> irregular_row;  ///< of the level; -1: in its stencil row
    solid::Field u_before_m;                  ///< place at the level's last push
    solid::Field push_m_per_s;                ///< change of velocity that waits for the next sub-step
    /// Acceleration by the level's cells in the equilibrium at the start.
    solid::Field steady_m_per_s2;
    // For the energies: velocity after the last sub-step; acceleration at the last push and the mean velocity
    // before it.
    solid::Field v_last_m_per_s, a_m_per_s2, v_mean_before_m_per_s;
  };
  /// Products with K of a level's cells, w = u + beta_R v: place u and velocity v before a push, velocity
  /// after it where that is known within the push.
  struct ForceProducts {
    double u_K_w = 0, v_K_w = 0, after_K_w = 0;
  };
  /// What the next push needs of the last one's, for the damping's work.
  struct Products {
    double u_K_u = 0, v_K_v = 0, after_K_w = 0;
    bool begun = false;  ///< whether there is a last push
    /// Of the shift s of landing nodes since: s K v, and s K (u' + u' - s) with u' the place after it.
    double shift_K_v = 0, shift_K_u = 0;
  };
  /// Cells with one step; each level's step is a whole multiple of the next one's. The last level holds the
  /// interface.
  struct Level {
    double step_s = 0;
    int period = 1;  ///< in steps of the last level
    solid::Part part;
    std::vector<mesh::Node> irregular;  ///< nodes of the block rows, then of the general rows
    solid::GeneralRows::Workspace general_space;
    std::vector<Dashpot> dashpots;
    std::vector<bool> takes_push;  ///< [irregular rows] not shared with a finer level, no dashpot
    std::vector<bool> moves;       ///< [irregular rows] moved with the level's own push
    std::vector<double> a_x, a_y;  ///< [irregular rows]
    std::vector<mesh::Node> top;   ///< nodes of the loaded edge that move with this level
    Shared shared;
    std::size_t node_begin = 0, node_end = 0;  ///< its nodes' numbers lie in this range
    solid::BlockRows top_rows;                 ///< K of the level's cells, N/m
    /// Kicks of the stencil's edge rows, x then y, in their order. [2 columns]
    std::vector<std::vector<double>> edge_kick_m_per_s;
    std::vector<solid::Pair> top_force_N;  ///< K w of top_rows at the last push
    Products products;
  };

  /// For each block, its step over that of the lowest one.
  std::vector<int> choose_multiples(const mesh::Mesh& mesh, const solid::Material& material,
                                    const TimeStepping& time) const;
  void divide_cells(const mesh::Mesh& mesh, const solid::Material& material, const TimeStepping& time,
                    std::span<const int> multiples);
  void set_dashpots(const mesh::Mesh& mesh, const solid::Material& material,
                    std::span<const int> level_of_node);
  /// Lets the dashpot act during a kick that alone would lead from `before` to `trial`, and counts its work.
  void damp(const Dashpot& dashpot, double before_x, double before_y, double& trial_x, double& trial_y);
  /// Motion of a level's shared nodes before now, as if it had been steady.
  void set_motion_before(Level& level);
  /// Forces of a level's cells at their nodes' places, and the moves of the nodes that no finer level has.
  void push(Level& level);
  void compute_irregular(Level& level);
  ForceProducts sweep(Level& level);
  void apply_irregular(const Level& level);
  /// Collects what a level does to its shared nodes: its force without the steady part.
  void gather_push(Level& level);
  void move_shared(Level& coarser, double dt);
  void advance_substep(int k, Recorder& recorder, fronts::History* sample);
  void take_contact(double time_s, Recorder& recorder, fronts::History* sample);
  /// Work of the shifts that put landing nodes onto the plane, after the sub-step of length dt_s that began
  /// with them.
  double landing_work(double dt_s);
  /// The velocities as a level sees them: mean ones since its last push at shared nodes.
  void exchange_velocities(const Level& level);
  void restore_velocities(const Level& level);
  // With the velocities as the level sees them:
  void add_coupling_work(Level& level);
  double coupling_work(const Level& level) const;
  void begin_damping_work();
  /// The rest of after_K_w of the last push, now that all velocities after it are known.
  double late_product(const Level& level) const;
  /// Counts the damping's work at the last push, and completes the products of the new one by those over
  /// block rows and loaded edge.
  void add_damping_work(Level& level, double after_K_w, ForceProducts sums);
  /// Of the last push. @param after_K_u  the velocity after it times K u at it
  double damping_work(const Level& level, double after_K_w, double after_K_u) const;
  void stiffness_product(const Level& level, const solid::Field& w, solid::Field& a) const;  ///< a = M^-1 K w
  /// z K w, a as of stiffness_product.
  double inner_product(const Level& level, const solid::Field& a, const solid::Field& w,
                       const solid::Field& z) const;
  void append_sample(fronts::History& history) const;

  solid::Operator plate_;
  double damping_s_;
  double interior_mass_kg_ = 0;  ///< of a node amid four squares
  interface::ContactModel contact_;
  double stable_step_s_ = 0, step_s_ = 0;
  int multiple_ = 1;  ///< steps of the lowest block in a step of the coarsest one
  int substeps_;      ///< of the last level in a step
  double node_updates_per_step_ = 0;
  std::vector<double> node_step_s_;  ///< [nodes]; 0 for orphans

  std::vector<Level> levels_;  ///< coarsest first
  std::vector<mesh::Node> lower_;
  std::vector<double> tributary_m_, v_x_before_, v_y_before_;  ///< [lower]
  std::vector<double> lower_mass_kg_;
  std::vector<double> contact_mass_kg_;  ///< along y, effective; see Dashpot. [lower]
  std::vector<double> v_y_trial_;        ///< [lower]
  // Predictor-corrector contact only.
  solid::BlockRows lower_rows_;             ///< K of the interface nodes, N/m
  std::vector<double> landing_shift_m_;     ///< [nodes] upwards; 0 but for nodes that land
  std::vector<std::size_t> landing_nodes_;  ///< of this sub-step, interface nodes
  std::vector<Dashpot> contact_dashpots_;
  interface::Interface interface_;
  interface::Trigger trigger_;
  std::vector<double> trigger_force_N_;
  std::vector<std::size_t> trigger_nodes_;               ///< where the force is not zero
  std::vector<double> prestress_t_Pa_, prestress_p_Pa_;  ///< [lower], or empty
  Energies works_;                                       ///< the works alone
  solid::Field scratch_;

  solid::Field u_, v_;
  solid::Field start_u_;  ///< interface displacement at the start: slip is counted from it. [lower]
  solid::RollingRows w_;  ///< of u + beta_R v
  double top_speed_ = 0;
  std::int64_t step_ = 0;
};

}  // namespace slipfront::solve
