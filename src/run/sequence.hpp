// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "run/initial_state.hpp"

namespace slipfront::run {

/// Where an event has left the interface. [interface nodes]
struct Rest {
  double shear_m = 0;  ///< of the loaded edge since the tilt
  std::vector<statics::Contact> contact;
  std::vector<double> u_x_m;  ///< along x, relative to a base
};

/// @param initial  with which the event began, its meshes whole
/// @param shear_m  of the loaded edge now
Rest rest_of(const motion::Snapshot& snapshot, const InitialState& initial, double shear_m);

/// A sample that is loaded by static equilibria from one spontaneous event to the next: its upper edge is moved
/// on along x, its interface sticks where the last event has left it, and has the static strength again. The
/// statics are factorised once.
class Sequence {
 public:
  /// @throws UserError, Interrupted as make_initial_state
  Sequence(const input::Case& config, const motion::Monitor& monitor);

  /// The state in which the next event begins: the first one where t/p inside passes mu_s, by
  /// loading.critical_margin, or where the last event has left the sample if it does there.
  /// @throws UserError where no shear does it
  const InitialState& next();
  /// Goes on from where an event has left the interface.
  /// @return the equilibrium there
  statics::Equilibrium hold(const Rest& rest);

 private:
  input::Case config_;
  InitialState initial_;
  statics::Statics statics_;
  double shear_m_ = 0;
};

}  // namespace slipfront::run
