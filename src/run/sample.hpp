// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "interface/quasi_dynamic.hpp"
#include "motion/ramp.hpp"
#include "problem/loading_path.hpp"
#include "problem/problem.hpp"
#include "processes/processes.hpp"
#include "record/sequence.hpp"
#include "setup/initial_state.hpp"
#include "solid/operator.hpp"
#include "statics/statics.hpp"

namespace slipfront::run {

/// Displacements of the plate at the interface relative to those of a base. [interface nodes]
struct RelativeDisplacement {
  std::vector<double> x_m, y_m;
};
RelativeDisplacement relative(const InitialState& initial, const statics::Equilibrium& state);

/// What an event leaves. Where nodes are in contact they stick. The plate is where its mean slip has moved
/// it: that strains nothing, and would take digits from what does.
struct RestState {
  double time_s = 0;  ///< since normal loading
  double moved_m = 0;
  double shear_m = 0;  ///< of the top edge beyond that
  std::vector<statics::Contact> contact;
  std::vector<double> u_x_m;  ///< [interface nodes] relative to a base, beyond that
  interface::LawStates law_states;
  std::vector<double> rests_since_s;  ///< [interface nodes] where mu_s grows at rest
};

/// A sample that is loaded from event to event: its bodies and their statics, which are factorised once, what
/// the last event has left, and how it was loaded so far. The phases between events change it.
struct Sample {
  /// @param monitor  asked between linear solutions
  /// @throws UserError, Interrupted as make_initial_state
  Sample(const Problem& problem, const motion::Monitor& monitor, const Processes& processes);
  Sample(const Sample&) = delete;
  Sample& operator=(const Sample&) = delete;

  /// At which the loading brings about a shear beyond rest.moved_m.
  double time_s(double shear_m) const { return path.time_s(shear_m + rest.moved_m, rest.time_s); }
  /// Gives nodes the mu_s that they have at a time.
  void heal_until(double time_s);
  /// Finds the equilibrium of `rest`.
  void equilibrate();
  /// Refuses a state in which the plate tips over or no event comes, however far it is loaded.
  /// @param shear_m  since normal loading
  void require_stands(double time_s, double shear_m, const std::vector<double>& t_Pa,
                      const std::vector<double>& p_Pa) const;

  /// A row of the loading with the works so far. @param shear_m  since normal loading
  record::LoadingRow row(record::LoadingPhase phase, double time_s, double shear_m,
                         const record::StaticState& tractions) const;
  /// Adds to a row what the tractions do not tell.
  /// @param state  as found: without what the events have moved the plate
  void add_state(const statics::Equilibrium& state, record::LoadingRow& row) const;
  /// Adds the row of an equilibrium after `at_rest`.
  void load_to(record::LoadingPhase phase, const statics::Equilibrium& state);

  Problem problem;
  problem::LoadingPath path;
  InitialState initial;  ///< of the next event
  statics::Statics statics;
  solid::Operator plate;
  std::optional<solid::Operator> base;
  motion::Monitor monitor;

  RestState rest;                             ///< of a law that sticks empty before the first event
  statics::Equilibrium at_rest;               ///< of it
  std::vector<record::SequenceEvent> events;  ///< that have come to rest
  std::vector<record::LoadingRow> loading;
  std::size_t n_rows_at_rest = 0;  ///< of loading, until the last event has ended
};

}  // namespace slipfront::run
