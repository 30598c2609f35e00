// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/numbers.hpp"
#include "boundary/pusher.hpp"

namespace slipfront::boundary {

/// The machine that loads a body at its far edge, or at its left side by a pusher. Its stiffnesses, per unit
/// thickness, are in series with what it moves along x, and with the far edge along y once that is pressed
/// down. Every node has its share of them by its length.
struct Machine {
  double shear_stiffness_Pa = infinity;
  double normal_stiffness_Pa = infinity;  ///< 0: the forces stay
  Pusher pusher = {};                     ///< with it the far edge moves freely along x

  bool is_rigid() const { return shear_stiffness_Pa == infinity && normal_stiffness_Pa == infinity; }
  /// Whether both displacements of the whole far edge are prescribed, and no others.
  bool prescribes_far_edge() const { return is_rigid() && !pusher.is_there(); }
};

}  // namespace slipfront::boundary
