// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "interface/quasi_dynamic.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {

/// Nodes that bear less, next to an edge where contact opens, have friction too small and too steep to be
/// followed: in slow slip they slip without it, and an event's end does not wait for them. A hundredth of the
/// mean pressure. @param tributary_m  [interface nodes]
double light_pressure_Pa(const std::vector<double>& p_Pa, const std::vector<double>& tributary_m);

/// Slip of an interface whose bodies are in equilibrium at all times. All lists [interface nodes].
struct QuasiDynamicState {
  double time_s = 0;
  double shear_m = 0;         ///< of the loaded edge along x
  std::vector<double> u_x_m;  ///< relative to a base
  interface::LawStates law_states;
  std::vector<double> slip_rate_m_per_s;
  std::vector<double> t_Pa, p_Pa;  ///< of the equilibrium: friction and what radiates
  std::vector<double> gap_m;       ///< between the surfaces
  std::vector<statics::Contact> contact;

  double fastest_m_per_s() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(time_s, shear_m, u_x_m, law_states, slip_rate_m_per_s, t_Pa, p_Pa, gap_m, contact);
  }
};

/// Works between two states, per unit thickness.
struct SlowWorks {
  double of_load_J_per_m = 0;      ///< of the interface's shear force on the loaded edge's way
  double of_friction_J_per_m = 0;  ///< on the bodies, negative
  double of_contact_J_per_m = 0;   ///< of the pressure
  double radiated_J_per_m = 0;     ///< in waves, by the radiation damping
};

/// Quasi-dynamic slip under a law with states (Rice 1993): bodies in equilibrium, but for the traction that
/// slip radiates, under an edge that moves at a constant speed. Steps by Bogacki and Shampine's pair of
/// orders 3 and 2, as long as the error of a step allows.
class QuasiDynamicSlip {
 public:
  /// @param tributary_m  [interface nodes]
  QuasiDynamicSlip(const statics::Statics& statics, interface::QuasiDynamicFriction friction,
                   std::vector<double> tributary_m, double edge_speed_m_per_s);

  /// From an equilibrium in which the slip rates follow from the tractions and the states.
  void start(double time_s, double shear_m, std::vector<statics::Contact> contact, std::vector<double> u_x_m,
             interface::LawStates law_states);
  /// From now on.
  void set_edge_speed(double m_per_s) { edge_speed_m_per_s_ = m_per_s; }
  /// @return why it ended: whether a node has passed the slip rate, by no more than a tenth, before the end
  /// @param after_step  whether another step may follow
  bool slip_until(double end_s, double slip_rate_m_per_s, const std::function<bool()>& after_step);

  const QuasiDynamicState& state() const { return now_; }
  /// Both since start.
  const SlowWorks& works() const { return works_; }
  std::int64_t n_steps() const { return n_steps_; }
  const interface::QuasiDynamicFriction& friction() const { return friction_; }

  /// All that changes after start, between two steps. What goes on from it does as if it had never stopped.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(now_, rates_.u_x, rates_.law_states, works_.of_load_J_per_m, works_.of_friction_J_per_m,
            works_.of_contact_J_per_m, works_.radiated_J_per_m, light_Pa_, next_dt_s_, n_steps_,
            edge_speed_m_per_s_);
    if (archive.is_loading()) restored();
  }

 private:
  struct Rates {
    std::vector<double> u_x;
    interface::LawStates law_states;
  };
  /// Finds what follows from the places, the states and the shear of a state.
  void balance(QuasiDynamicState& state, Rates& rates) const;
  /// Those that follow from the tractions.
  void slide(QuasiDynamicState& state, Rates& rates) const;
  double first_dt_s() const;
  /// One step of at most dt_s. @return its length, 0 where its error was too large
  double try_step(double dt_s);
  void add_works(const QuasiDynamicState& from, const QuasiDynamicState& to);
  /// Lets nodes that would be pulled go, and those that come down touch.
  /// @return by how much that has changed the slip rate over d_c of nodes that stay in contact, at most, 1/s
  double settle_contact(QuasiDynamicState& state, Rates& rates);
  /// @return whether it has changed
  bool correct_contact(QuasiDynamicState& state) const;
  /// @throws StateError where what was read is of another interface
  void restored();

  const statics::Statics& statics_;
  interface::QuasiDynamicFriction friction_;
  std::vector<double> tributary_m_;
  double edge_speed_m_per_s_;
  std::unique_ptr<statics::SlidingInterface> bodies_;
  QuasiDynamicState now_, next_;
  Rates rates_;                  ///< now
  std::array<Rates, 3> stages_;  ///< of a step, after the first
  SlowWorks works_;
  double light_Pa_ = 0;  ///< pressure below which nodes slip without friction
  double next_dt_s_ = 0;
  std::int64_t n_steps_ = 0;
};

}  // namespace slipfront::motion
