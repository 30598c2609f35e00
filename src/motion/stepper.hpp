// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "base/state.hpp"
#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "motion/level.hpp"
#include "motion/recorder.hpp"
#include "motion/settings.hpp"
#include "record/energies.hpp"
#include "solid/material.hpp"
#include "solid/operator.hpp"
#include "statics/statics.hpp"
#include "threads/wavefront.hpp"

namespace slipfront::motion {

/// How the steps of one run are computed; the results do not depend on it.
struct Execution {
  int threads = 1;  ///< at most; fewer where the plate has not rows enough to keep them at work
  /// Steps that a thread takes in one sweep through memory; 0 chooses by the size of the topmost block.
  int steps_per_sweep = 0;
};

/// Looks into a run between its steps. Both are called in the order of steps, not always by the same thread,
/// and may ask the stepper for its time, its step and the interface's state only.
struct Between {
  /// Where to put the state at the beginning of the step that follows; null for nowhere.
  std::function<record::History*()> sample = [] { return nullptr; };
  /// After the interface's part of a step: whether another one may follow.
  std::function<bool()> go_on = [] { return true; };
};

/// Explicit motion of the plate: Newmark with beta = 0, gamma = 1/2 (displacements at whole steps, velocities
/// at half steps), damping force on the last half-step velocity.
///
/// The rows of cells next to the interface are sub-cycled: every cell has its own step, and pushes its nodes
/// when its own time comes; in between the nodes move at constant velocity: the asynchronous variational
/// integrator of Lew et al. (2003). The nodes between the two kinds of cells feel the coarse cells' force at
/// the start of the event as a constant load in every sub-step, and its change since then in pushes; without
/// this, a stressed plate at rest would not stay at rest. Reversible and symplectic where nothing dissipates.
/// With one sub-step it is the plain scheme. The blocks of a graded plate are such levels, too, each with the
/// step that its cells allow (step_multiples); a step of the plate is that of its coarsest block.
class Stepper {
 public:
  /// @throws UserError where the interface rows do not fit into the mesh.
  Stepper(const mesh::Mesh& mesh, const solid::Material& material, const interface::ContactModel& contact,
          const TimeStepping& time, const Execution& execution = {});

  double stable_step_s() const { return stable_step_s_; }
  double step_s() const { return step_s_; }
  /// The step of the lowest block, time.step_factor of the stable one.
  double lowest_step_s() const { return step_s_ / multiple_; }
  double substep_s() const { return step_s_ / substeps_; }
  /// The (sub-)step with which a node moves; its velocity belongs to half of it before the displacement.
  double step_s(mesh::Node n) const {
    return levels_.is_orphan[n] ? 0 : levels_.level[levels_.level_of_node[n]].step_s;
  }
  const solid::Operator& plate() const { return plate_.op; }

  /// Nodes moved in one step, sub-steps counted, and nodes of the plate that move at all.
  double node_updates_per_step() const { return levels_.node_updates_per_step; }

  /// Steps that a thread takes in one sweep through memory.
  int steps_per_sweep() const { return wavefront_->depth(); }

  /// Puts the plate into an equilibrium, moving with the shear at top_speed_m_per_s, at time 0.
  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s);

  /// External forces along x on the interface nodes, scaled in time by the trigger's ramp. [lower], N per
  /// unit thickness
  void set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m);

  /// External tractions on the interface nodes: t0 drives the plate to +x, p0 presses it down. [lower]; after
  /// start.
  void set_prestress(std::vector<double> t0_Pa, std::vector<double> p0_Pa);

  /// Weakens nodes for good, see Interface::intact; [lower], after start, which makes all of them intact.
  void set_intact(std::vector<double> intact);

  /// Takes at most `most_steps` steps, several of them in one sweep through memory. Every contact update is
  /// shown to the recorder.
  /// @return the number of steps taken
  /// @throws what recorder and `between` throw; after that only start may follow.
  std::int64_t advance(Recorder& recorder, std::int64_t most_steps, const Between& between);
  /// One step; the state at its beginning is appended to `sample` where it is given.
  void advance(Recorder& recorder, record::History* sample = nullptr);

  /// Turns the motion round: the steps to come go back through the displacements of those before, exactly but
  /// for rounding where the forces do not depend on time and nothing dissipates. Time goes on. The contact is
  /// updated once, which the recorder sees; the works start anew and lack the first step's coupling.
  void reverse(Recorder& recorder);

  /// Time of the displacements. The velocities belong to half a step, or half a sub-step in the layer,
  /// earlier.
  double time_s() const { return static_cast<double>(step_) * step_s_; }
  std::int64_t step() const { return step_; }
  const solid::Field& u_m() const { return plate_.u_m; }
  const solid::Field& v_m_per_s() const { return plate_.v_m_per_s; }
  /// The same with the mean velocity over the last step at nodes between sub-cycled and other cells, which
  /// the pushes set swinging within the step.
  solid::Field mean_velocity_m_per_s() const;
  const interface::Interface& interface_state() const { return interface_; }

  double energy_J_per_m() const;  ///< strain and kinetic, each of its own instant
  double kinetic_energy_J_per_m() const;

  /// Energies and works up to the last half (sub-)step.
  record::Energies energies();

  /// All that changes, between two calls of advance. A stepper of the same mesh, material and stepping that
  /// has read it goes on as this one would, to the last bit; start need not have been called.
  template <class Archive>
  void serialize(Archive& archive);

 private:
  /// What a step under way has of its own.
  struct StepUnderWay {
    solid::RollingRows w;                  ///< of u + beta_R v, of the coarsest level's sweep
    solid::RollingRowsOf<float> w_single;  ///< the same in single precision, if it is asked for
    PushProducts products;
    record::Energies works;
  };

  StepUnderWay& under_way(std::int64_t step) { return under_way_[step % wavefront_->most_steps()]; }
  /// The part of a step that concerns the interface: the first band of the coarsest level and the sub-steps
  /// of all others; only the first n_substeps of them.
  void advance_interface(StepUnderWay& step, int n_substeps, Recorder& recorder, record::History* sample);
  /// A later band of the coarsest level; the last one completes the step.
  void advance_band(StepUnderWay& step, std::size_t band);
  void push(Level& level, record::Energies& works);
  /// The trial motion of the interface nodes, all forces but the contact's included.
  void gather_trial(double impulse_s);
  /// Gives the corrected velocities to the plate and moves the nodes; counts the contact's work.
  void move_interface(record::Energies& works);
  void take_contact(double time_s, Recorder& recorder, record::History* sample, record::Energies& works);
  /// Work of the shifts that put landing nodes onto the plane, after the sub-step of length dt_s that began
  /// with them.
  double landing_work(double dt_s);
  /// Products of the landings since the last push of the last level.
  void add_landing(PushProducts& products) const;
  /// The same for a push of a level, if it is the last one.
  void take_landing(const Level& level, PushProducts& products);
  void begin_damping_work();
  void append_sample(record::History& history) const;

  Plate plate_;
  interface::ContactModel contact_;
  double stable_step_s_ = 0, step_s_ = 0;
  int multiple_ = 1;  ///< steps of the lowest block in a step of the coarsest one
  int substeps_;      ///< of the last level in a step
  Levels levels_;
  SingleRows single_;           ///< none unless time.precision is single
  solid::RollingRows finer_w_;  ///< of u + beta_R v, of the other levels' sweeps
  std::unique_ptr<threads::Wavefront> wavefront_;
  std::vector<StepUnderWay> under_way_;

  std::vector<mesh::Node> lower_;
  std::vector<NodeRun> lower_runs_;
  std::vector<double> tributary_m_, v_x_before_, v_y_before_;  ///< [lower]
  std::vector<double> lower_mass_kg_;
  std::vector<double> contact_mass_kg_;  ///< along y, effective; see Dashpot. [lower]
  std::vector<double> v_y_trial_;        ///< [lower]
  // Predictor-corrector contact only.
  solid::BlockRows lower_rows_;               ///< K of the interface nodes, N/m
  std::vector<double> landing_shift_m_;       ///< [nodes] upwards; 0 but for nodes that land
  std::vector<std::size_t> landing_nodes_;    ///< of this sub-step, interface nodes
  double landing_K_v_ = 0, landing_K_u_ = 0;  ///< see PushProducts
  interface::Interface interface_;
  interface::Trigger trigger_;
  std::vector<double> trigger_force_N_;
  std::vector<std::size_t> trigger_nodes_;               ///< where the force is not zero
  std::vector<double> prestress_t_Pa_, prestress_p_Pa_;  ///< [lower], or empty
  record::Energies works_;                               ///< the works alone

  solid::Field start_u_;  ///< interface displacement at the start: slip is counted from it. [lower]
  double top_speed_ = 0;
  std::int64_t step_ = 0;
};

template <class Archive>
void Stepper::serialize(Archive& archive) {
  archive_field(archive, plate_.u_m, plate_.u_m.size());
  archive_field(archive, plate_.v_m_per_s, plate_.v_m_per_s.size());
  for (auto& level : levels_.level) archive(level);
  archive(interface_);
  for (auto* values : {&v_x_before_, &v_y_before_, &v_y_trial_, &trigger_force_N_})
    archive_vector(archive, *values);
  archive_field(archive, start_u_, lower_.size());
  archive(prestress_t_Pa_, prestress_p_Pa_, trigger_, landing_K_v_, landing_K_u_, works_, top_speed_, step_);
  if constexpr (Archive::is_loading::value) {
    if (prestress_t_Pa_.size() != prestress_p_Pa_.size() ||
        (!prestress_t_Pa_.empty() && prestress_t_Pa_.size() != lower_.size()))
      throw UserError("the state that was kept has tractions of another interface");
    set_trigger(trigger_, std::vector<double>(trigger_force_N_));
    to_single(plate_, single_);
  }
}

}  // namespace slipfront::motion
