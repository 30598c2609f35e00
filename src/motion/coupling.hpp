// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "base/state.hpp"
#include "interface/interface.hpp"
#include "interface/trigger.hpp"
#include "mesh/node_columns.hpp"
#include "motion/interface_side.hpp"
#include "motion/probes.hpp"
#include "motion/slip_finder.hpp"
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
  interface::Trigger trigger = {};
  std::vector<double> intact = {};  ///< weakens nodes for good, see Interface::intact
};

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
  /// Whether it began with these loads.
  bool has_loads(const Loads& loads) const;
  /// Changes the prescribed tractions between two steps.
  void set_prestress(std::vector<double> t_Pa, std::vector<double> p_Pa);

  /// The sub-step of length dt_s that begins at time_s: finds the tractions and moves the interface nodes.
  /// @param sample  where to put the state at time_s, or null
  void update(double time_s, double dt_s, UpdateObserver& observer, record::History* sample,
              record::Energies& works);

  /// Turns the relative motion round.
  void reverse();

  const interface::Interface& state() const { return interface_; }
  /// See Stepper::visit_columns. @param nodes  places along the interface
  template <class Visit>
  void visit_nodes(solid::Span nodes, Visit&& visit) {
    const auto n = static_cast<std::size_t>(nodes.end - nodes.begin);
    const auto visit_all = [&](auto& values) { visit(values.data() + nodes.begin, n); };
    for (auto* values : {&interface_.intact, &interface_.v_x_m_per_s, &interface_.v_y_m_per_s,
                         &interface_.u_y_m, &interface_.slip_rate_m_per_s, &interface_.t_Pa, &interface_.p_Pa,
                         &interface_.trial_traction_Pa, &interface_.strength_Pa, &interface_.slip_m,
                         &interface_.relaxed_Pa, &interface_.target_Pa, &interface_.acceleration_m_per_s2})
      visit_all(*values);
    visit_all(interface_.slipping);
    visit_all(interface_.locked);
    for (auto& side : sides_) {
      visit_all(side.v_x);
      visit_all(side.v_y);
    }
  }
  SlipRates slip_rates() const;
  /// Of a node whose tractions are not balanced.
  double largest_acceleration_m_per_s2() const;

  /// See Stepper::visit_state.
  template <class Visitor>
  void visit_state(Visitor& visitor, const mesh::NodeColumns& columns, const SubdomainPlace& place);
  void update_after_restore() { set_trigger(trigger_, std::vector<double>(trigger_force_N_)); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(interface_);
    for (auto* values : {&v_x_before_, &v_y_before_, &v_y_trial_, &trigger_force_N_, &start_u_x_m_})
      archive_vector(archive, *values);
    for (auto& side : sides_)
      for (auto* values : {&side.v_x, &side.v_y, &side.v_x_before, &side.v_y_before})
        archive_vector(archive, *values);
    archive(prestress_t_Pa_, prestress_p_Pa_, trigger_);
    if constexpr (Archive::is_loading::value) {
      require_possible(prestress_t_Pa_.size() == prestress_p_Pa_.size() &&
                           (prestress_t_Pa_.empty() || prestress_t_Pa_.size() == interface_.size()),
                       "tractions");
      set_trigger(trigger_, std::vector<double>(trigger_force_N_));
    }
  }

 private:
  /// One of two bodies. Velocities in its own axes.
  struct Side {
    double sign = 1;  ///< of its velocity along x in the relative one
    std::vector<double> v_x, v_y, v_x_before, v_y_before;
    std::vector<double> share_x, share_y;  ///< of the relative motion's change
  };

  bool is_own(std::size_t i) const { return i >= own_begin_ && i < own_end_; }
  void set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m);
  double relative_u_x_m(std::size_t i) const;
  double u_y_m(std::size_t body, std::size_t i) const {
    return bodies_[body].u_m->y[bodies_[body].side->nodes[i]];
  }
  /// The trial motion of the interface nodes, all forces but the contact's included.
  void gather(double dt_s, double impulse_s);
  void gather_both(double dt_s, double impulse_s);
  /// That of one body. @param sign  of its velocity along x in the relative one
  void take_trial(const ContactBody& body, double sign, double dt_s, double impulse_s,
                  const std::vector<double>& v_x_before, const std::vector<double>& v_y_before,
                  std::vector<double>& v_x, std::vector<double>& v_y) const;
  /// Gives the corrected velocities to the bodies and moves their nodes.
  void scatter(double dt_s, record::Energies& works);
  void scatter_both(double dt_s, record::Energies& works);
  void add_works_of_loads(double dt_s, double impulse_s, record::Energies& works) const;
  void append_sample(double time_s, record::History& history) const;

  std::vector<ContactBody> bodies_;
  interface::ContactModel contact_;
  interface::Interface interface_;
  std::vector<double> tributary_m_;      ///< [nodes]
  std::vector<double> contact_mass_kg_;  ///< along y, effective; see Dashpot. [nodes]
  std::vector<double> v_x_before_, v_y_before_, v_x_trial_, v_y_trial_;  ///< relative. [nodes]
  std::vector<Side> sides_;                                              ///< of two bodies; else none
  interface::Trigger trigger_;
  std::vector<double> trigger_force_N_;
  std::vector<std::size_t> trigger_nodes_;               ///< where the force is not zero
  std::vector<double> prestress_t_Pa_, prestress_p_Pa_;  ///< [nodes], or empty
  std::vector<double> start_u_x_m_;                      ///< slip is counted from it
  std::size_t own_begin_, own_end_;                      ///< nodes that count in works, see BodyMotion
};

template <class Visitor>
void Coupling::visit_state(Visitor& visitor, const mesh::NodeColumns& columns, const SubdomainPlace& place) {
  bool has_prestress = !prestress_t_Pa_.empty();
  visitor.flag(has_prestress);
  if (has_prestress) {
    prestress_t_Pa_.resize(interface_.size());
    prestress_p_Pa_.resize(interface_.size());
  }
  visitor.list(
      StateKey::place, 0, interface_.size(),
      [&](std::size_t k) { return place.interface_nodes.number_at(static_cast<int>(k)); },
      [&](std::size_t k) { return columns.column_of(bodies_.front().side->nodes[k]); },
      [&](std::size_t k, auto&& f) {
        for (auto* values :
             {&interface_.intact, &interface_.v_x_m_per_s, &interface_.v_y_m_per_s, &interface_.u_y_m,
              &interface_.slip_rate_m_per_s, &interface_.t_Pa, &interface_.p_Pa,
              &interface_.trial_traction_Pa, &interface_.strength_Pa, &interface_.slip_m,
              &interface_.relaxed_Pa, &interface_.target_Pa, &interface_.acceleration_m_per_s2, &v_x_before_,
              &v_y_before_, &v_y_trial_, &trigger_force_N_, &start_u_x_m_})
          f((*values)[k]);
        f(interface_.slipping[k]);
        f(interface_.locked[k]);
        for (auto& side : sides_)
          for (auto* values : {&side.v_x, &side.v_y, &side.v_x_before, &side.v_y_before}) f((*values)[k]);
        if (has_prestress) {
          f(prestress_t_Pa_[k]);
          f(prestress_p_Pa_[k]);
        }
      });
  visitor.flag(interface_.begun);
  visitor.trigger(trigger_);
}

}  // namespace slipfront::motion
