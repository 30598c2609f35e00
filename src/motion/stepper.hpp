// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "motion/body.hpp"
#include "motion/coupling.hpp"
#include "motion/probes.hpp"
#include "motion/settings.hpp"
#include "motion/step_observer.hpp"
#include "motion/step_plan.hpp"
#include "motion/time_stepper.hpp"
#include "processes/processes.hpp"
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
  /// Most steps of a call of advance, which the threads share; 0 for many.
  int max_steps = 0;
  /// Size of a stage in which a part sends its halo, see Halo.
  double halo_stage_bytes = Processes::eager_limit_bytes;
};

/// Callbacks while the bands of a step move, see Stepper::rows_moved.
struct BandCallbacks {
  /// Before a band moves in a step of a call, counted from 0, where the calling thread takes it; that it
  /// takes the first one, and later ones have not looked at the band yet.
  std::function<void(std::int64_t step, int band)> before;
  /// When a band has moved in the last one, in any thread, one band after the other. All steps are taken
  /// then.
  std::function<void(int band)> after_last;
};

/// Explicit motion of a plate on a rigid plane, or on another body: Newmark with beta = 0, gamma = 1/2
/// (displacements at whole steps, velocities at half steps), damping force on the last half-step velocity.
///
/// The rows of cells next to the interface are sub-cycled: every cell has its own step, and kicks its nodes
/// when its own time comes; in between the nodes move at constant velocity: the asynchronous variational
/// integrator of Lew et al. (2003). The nodes between the two kinds of cells feel the coarse cells' force at
/// the start of the event as a constant load in every sub-step, and its change since then in impulses;
/// without this, a stressed plate at rest would not stay at rest. Reversible and symplectic where nothing
/// dissipates. With one sub-step it is the plain scheme. The blocks of a graded plate are such levels, too,
/// each with the step that its cells allow; see step_plan.hpp.
class Stepper : public TimeStepper {
 public:
  /// On the rigid plane.
  /// @throws UserError where the interface rows do not fit into the mesh.
  Stepper(const mesh::Mesh& mesh, const solid::Material& material, const interface::ContactModel& contact,
          const TimeStepping& time, const Execution& execution = {});
  /// On another body, described upside down (see Body), with interface nodes at the same places along x.
  Stepper(const BodySource& above, const BodySource& below, const interface::ContactModel& contact,
          const TimeStepping& time, const Execution& execution = {});
  /// Steps one body or two, the one above first.
  Stepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
          const TimeStepping& time, const Execution& execution = {});

  const StepPlan& plan() const { return plan_; }
  double stable_step_s() const override { return plan_.stable_step_s; }
  double step_s() const override { return plan_.step_s; }
  double lowest_step_s() const override { return plan_.lowest_step_s; }
  double substep_s() const override { return plan_.substep_s(); }
  /// The (sub-)step with which a node moves; its velocity belongs to half of it before the displacement.
  double step_s(mesh::Node n) const { return bodies_.front().step_s(n); }
  const solid::Operator& plate() const { return bodies_.front().op(); }
  /// The body above and, where there is one, the body below, upside down.
  std::span<const Body> bodies() const { return bodies_; }

  double node_updates_per_step() const override;
  std::int64_t n_nodes() const override;

  /// Steps that a thread takes in one sweep through memory.
  int steps_per_sweep() const { return wavefront_->steps_per_sweep(); }

  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads = {}) override;

  /// Changes the prescribed tractions of Loads between two steps.
  void set_prestress(std::vector<double> t_Pa, std::vector<double> p_Pa) {
    coupling_.set_prestress(std::move(t_Pa), std::move(p_Pa));
  }

  void set_probes(std::vector<Probe> probes) override;
  const std::vector<Probe>& probes() const override { return probes_; }
  std::vector<double> probed_u_m() const override;
  std::vector<double> probed_v_m_per_s() const override;

  std::int64_t advance(SlipObserver& observer, std::int64_t max_steps) override;
  /// The same, seen by any observer.
  std::int64_t advance(StepObserver& observer, std::int64_t max_steps = 1,
                       const BandCallbacks& band_callbacks = {});

  /// Turns the motion round: the steps to come go back through the displacements of those before, exactly but
  /// for rounding where the forces do not depend on time and nothing dissipates. Time goes on. The contact is
  /// updated once, which the observer sees; the works start anew and lack the first step's coupling.
  void reverse(StepObserver& observer);

  std::int64_t step() const override { return step_; }
  const solid::Field& u_m() const { return bodies_.front().u_m(); }
  const solid::Field& v_m_per_s() const { return bodies_.front().v_m_per_s(); }
  /// Velocities, with the mean one over the last step at nodes between sub-cycled and other cells, which
  /// the impulses set swinging within the step.
  solid::Field mean_velocity_m_per_s() const { return bodies_.front().mean_velocity_m_per_s(); }
  const interface::Interface& interface_state() const { return coupling_.state(); }
  /// Slip of an interface node, see Coupling::slip_m.
  double slip_m(std::size_t i) const { return coupling_.slip_m(i); }

  SlipRates slip_rates() const { return coupling_.slip_rates(); }
  double largest_acceleration_m_per_s2() const { return coupling_.largest_acceleration_m_per_s2(); }
  double energy_J_per_m() const;  ///< strain and kinetic, each of its own instant
  double kinetic_energy_J_per_m() const override;
  double mass_kg_per_m() const override;
  double energy_of_tractions_J_per_m() const override;
  record::Energies energies() override;
  record::Breakdown breakdown() const override { return coupling_.breakdown(); }
  record::History interface_row() const override { return coupling_.interface_row(time_s()); }

  int n_snapshot_chunks() const override { return 1; }
  std::size_t snapshot_chunk_bytes() const override;
  std::vector<double> snapshot_chunk(int k) const override;
  /// Appends what a snapshot has of the nodes [first, end) of a body.
  void append(MotionComponent component, std::size_t body, mesh::Node first, mesh::Node end,
              std::vector<double>& to) const;

  int n_bands() const { return n_bands_; }
  /// Rows of a body's nodes that a step has moved for good when its band has: these, from 0. Of the others
  /// the first one has been read.
  int rows_moved(std::size_t body, int band) const {
    return bodies_[body].has_common_step() ? bodies_[body].rows_moved(static_cast<std::size_t>(band))
                                           : bodies_[body].n_rows();
  }
  /// Calls visit(values, n) with all that changes between two steps and decides on the motion of some
  /// neighbouring columns of nodes. Others may be put there.
  /// @param rows           of each body
  /// @param and_interface  besides these rows all that moves with the interface, wherever it lies
  template <class Visit>
  void visit_columns(solid::Span columns, std::span<const solid::Span> rows, bool and_interface,
                     Visit&& visit) {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_[b].visit_columns(columns, rows[b], and_interface, visit);
    if (and_interface) coupling_.visit_nodes(bodies_.front().interface_nodes_in(columns), visit);
  }
  /// Visits these columns in all rows.
  template <class Visit>
  void visit_columns(solid::Span columns, Visit&& visit) {
    std::vector<solid::Span> rows;
    for (const auto& body : bodies_) rows.push_back({0, body.n_rows()});
    visit_columns(columns, rows, true, visit);
  }
  /// After other values have been put there: before anyone but a step looks at them.
  void sync_to_double() {
    for (auto& body : bodies_) body.sync_to_double();
  }

  void keep(const std::function<void(const StateByNode& chunk)>& take) override {
    keep_in_chunks(state(), step_, n_nodes(), take);
  }
  void restore(const Loads& loads, const std::function<StateByNode()>& next) override {
    set_loads(loads);
    update_after_restore(restore_chunks(state(), next));
  }
  /// The state in parts. @param interface_nodes  of a subdomain, their places along the whole interface
  StateView state(const mesh::Subset& interface_nodes = {});
  void set_loads(const Loads& loads) { coupling_.set_loads(loads); }
  void update_after_restore(std::int64_t step) {
    for (auto& body : bodies_) body.update_after_restore();
    step_ = step;
  }

 private:
  Stepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
          const TimeStepping& time, const Execution& execution, std::vector<BodyMotion> motions);

  /// Workspaces of the bodies; several steps are in flight at a time, see threads::Wavefront.
  std::vector<BodyStep>& in_flight(std::int64_t step) {
    return steps_in_flight_[static_cast<std::size_t>(step % std::ssize(steps_in_flight_))];
  }
  /// The part of a step that concerns the interface: take_step, or the first n_substeps of it. Of the
  /// coarsest levels the later bands are left to advance_band.
  void advance_interface(std::int64_t step, int n_substeps, StepObserver& observer, record::History* sample);
  /// Copies the displacements of the watched nodes that the bands `band` have moved to where a step ends.
  void store_probed(std::int64_t step, std::size_t band, StepObserver& observer) const;
  /// One band of the coarsest levels with the common step.
  void advance_band(std::int64_t step, std::size_t band);

  StepPlan plan_;
  std::vector<Body> bodies_;
  Coupling coupling_;
  int n_bands_ = 1;  ///< of the bodies with the common step
  std::unique_ptr<threads::Wavefront> wavefront_;
  std::vector<std::vector<BodyStep>> steps_in_flight_;
  std::vector<Probe> probes_;
  /// A node of a probe, and where its displacement goes.
  struct ProbedNode {
    std::size_t body = 0;
    mesh::Node node = 0;
    std::size_t at = 0;
  };
  std::vector<std::vector<ProbedNode>> probed_nodes_;  ///< by band; none without probes
  std::int64_t step_ = 0;
};

}  // namespace slipfront::motion
