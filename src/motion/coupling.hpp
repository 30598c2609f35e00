// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "interface/breakdown.hpp"
#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/node_columns.hpp"
#include "motion/interface_side.hpp"
#include "motion/state_by_node.hpp"
#include "motion/step_observer.hpp"
#include "motion/time_stepper.hpp"
#include "record/energies.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// What acts on the interface of a state that begins to move, besides the state itself. All [interface
/// nodes], or empty for none.
struct Loads {
  /// External tractions: t drives the plate to +x, p presses it down; those on a body below are opposite.
  std::vector<double> prestress_t_Pa = {}, prestress_p_Pa = {};
  /// External forces along x, N per unit thickness, scaled in time by the trigger's ramp; those on a body
  /// below are opposite.
  std::vector<double> trigger_force_N_per_m = {};
  /// The same along y, which part the bodies.
  std::vector<double> unloading_N_per_m = {};
  interface::Trigger trigger = {};
  std::vector<double> strength_fraction = {};  ///< weakens nodes for good, see Interface::strength_fraction
  /// When they are forced to weaken, linearly over the time; or empty: at once.
  std::vector<double> weakens_at_s = {};
  double weakening_time_s = 0;
  /// At which the prescribed tractions grow, everywhere alike.
  struct Rate {
    double t_Pa_per_s = 0, p_Pa_per_s = 0;
  } prestress_rate = {};
  /// States of a law that has some, [states] of [interface nodes]; empty: as the law begins.
  std::vector<std::vector<double>> law_states = {};
  double light_Pa = 0;  ///< pressure up to which a node does not count as in contact, see light_pressure_Pa

  /// The arrays with a value for each interface node, but for law_states.
  template <class State>
  static auto arrays(State& l) {
    return std::array{&l.strength_fraction, &l.trigger_force_N_per_m, &l.unloading_N_per_m,
                      &l.prestress_t_Pa,    &l.prestress_p_Pa,        &l.weakens_at_s};
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(prestress_t_Pa, prestress_p_Pa, trigger_force_N_per_m, unloading_N_per_m, trigger,
            strength_fraction, weakens_at_s, weakening_time_s, prestress_rate, law_states, light_Pa);
  }
};

/// Tractions that prescribe a state, see statics::prestressed.
inline Loads prescribed_loads(const statics::Equilibrium& state) {
  return {.prestress_t_Pa = state.tractions.t_s_Pa, .prestress_p_Pa = state.tractions.p_s_Pa};
}

/// Contact and friction between a body and the rigid plane below it, or between two bodies whose interface
/// nodes face each other.
///
/// Between two bodies all quantities of interface::Interface are relative: the slip rate is that of the body
/// above less that of the one below, the gap what opens between them, the mass m_1 m_2/(m_1 + m_2). What the
/// interface does to a pair of nodes is shared between them in inverse proportion to their masses, so that
/// their momentum is exchanged.
class Coupling {
 public:
  /// @param bodies  the one above, and the one below where there is one, with as many interface nodes; they
  ///                have to stay where they are
  Coupling(const interface::ContactModel& contact, std::vector<ContactBody> bodies);

  /// Begins with the bodies' motion, the tractions of an equilibrium, and the loads.
  void start(const statics::Equilibrium& equilibrium, Loads loads);
  void set_loads(Loads loads);
  /// Changes the prescribed tractions between two steps.
  void set_prestress(std::vector<double> t_Pa, std::vector<double> p_Pa);

  /// The sub-step of length dt_s that begins at time_s: finds the tractions and moves the interface nodes.
  /// @param sample  where to put the state of own nodes at time_s, or null
  void update(double time_s, double dt_s, StepObserver& observer, record::History* sample,
              record::Energies& works);

  /// Turns the relative motion round.
  void reverse();

  const interface::Interface& state() const { return interface_; }
  /// Displacement along x relative to the plane, or to the body below, since the start.
  double slip_m(std::size_t i) const { return relative_u_x_m(i) - start_u_x_m_[i]; }
  /// See Stepper::visit_columns. @param nodes  places along the interface
  template <class Visit>
  void visit_nodes(solid::Span nodes, Visit&& visit) {
    const auto n = static_cast<std::size_t>(nodes.end - nodes.begin);
    interface::for_each_field(interface_, [&](interface::FieldKind kind, auto& values) {
      if (kind == interface::FieldKind::memory) visit(values.data() + nodes.begin, n);
    });
    breakdown_.for_each_array([&](auto& values) { visit(values.data() + nodes.begin, n); });
    if (is_pair())
      for (auto& side : sides_)
        for (auto* values : {&side.v_x, &side.v_y}) visit(values->data() + nodes.begin, n);
  }
  SlipRates slip_rates() const;
  /// Breakdown of own nodes.
  record::Breakdown breakdown() const;
  /// State of own nodes between two steps, see TimeStepper::interface_row.
  record::History interface_row(double time_s) const;
  /// Acceleration of a node whose tractions are not balanced.
  double largest_acceleration_m_per_s2() const;

  /// Adds all that changes, and the loads, to a stepper's state, which has the bodies.
  void add_to(StateView& state);

 private:
  /// One of the bodies. [nodes]
  struct Side {
    ContactBody body;
    double sign = 1;                       ///< see sign_of_body
    std::vector<double> share_x, share_y;  ///< of the relative motion's change
    std::vector<double> shift_m;           ///< up to which it lands in the update under way
    /// In its own axes, of two bodies; a single body's motion is the relative one.
    std::vector<double> v_x = {}, v_y = {};
    std::vector<double> v_x_before = {}, v_y_before = {};  ///< of the update under way
  };
  struct Velocities {
    std::vector<double>&x, &y, &x_before, &y_before;
  };

  bool is_pair() const { return sides_.size() == 2; }
  const ContactBody& above() const { return sides_.front().body; }
  /// Of a body's interface nodes, in its own axes.
  Velocities velocities(Side& side) {
    if (is_pair()) return {side.v_x, side.v_y, side.v_x_before, side.v_y_before};
    return {interface_.v_x_m_per_s, interface_.v_y_m_per_s, v_x_before_, v_y_before_};
  }
  bool is_own(std::size_t i) const { return i >= own_begin_ && i < own_end_; }
  double relative_u_x_m(std::size_t i) const;
  double relative_u_y_m(std::size_t i) const;
  /// Reads the velocities of a body's interface nodes.
  void take_velocities(Side& side);
  /// Adds to them all forces but the contact's: the trial.
  void add_loads(Side& side, double dt_s, double impulse_s);
  /// The relative motion from those of the bodies.
  void set_relative_motion();
  /// The shifts of nodes that land, see Landing.
  void take_shifts();
  /// Gives the corrected velocities to a body and moves its nodes.
  template <bool is_pair>
  void move_nodes(Side& side, double dt_s);
  void add_works_of_contact(double dt_s, record::Energies& works) const;
  /// Brings weakening nodes to this time.
  void weaken(double time_s);
  /// @param changed  update_contact's answer
  void follow_breakdown(double dt_s, bool changed);
  void add_works_of_loads(double dt_s, double impulse_s, record::Energies& works);
  /// Before an update, which takes them on to the next one.
  void append_law_states(record::History& history) const;
  /// After it: what belongs to the same time.
  void append_sample(double time_s, record::History& history) const;

  std::vector<Side> sides_;  ///< the one above first
  interface::ContactModel contact_;
  interface::Interface interface_;
  interface::BreakdownMonitor breakdown_;
  std::vector<double> tributary_m_;      ///< [nodes]
  std::vector<double> contact_mass_kg_;  ///< along y, effective; see boundary::Dashpot. [nodes]
  /// Relative, of the update under way. [nodes]
  std::vector<double> v_x_before_, v_y_before_, v_x_trial_, v_y_trial_;
  double unloading_N_per_m(std::size_t i) const {
    return loads_.unloading_N_per_m.empty() ? 0 : loads_.unloading_N_per_m[i];
  }

  Loads loads_;                               ///< forces and strength_fraction of all nodes
  std::vector<std::size_t> trigger_nodes_;    ///< where the force is not zero
  std::vector<std::size_t> weakening_nodes_;  ///< whose friction falls during the event
  /// By how much the prescribed tractions have grown at the update under way.
  double prestress_growth_t_Pa_ = 0, prestress_growth_p_Pa_ = 0;
  std::vector<double> start_u_x_m_;  ///< slip is counted from it
  std::size_t own_begin_, own_end_;  ///< nodes that count in works, see BodyMotion
};

}  // namespace slipfront::motion
