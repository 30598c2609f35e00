// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/numbers.hpp"
#include "boundary/pusher.hpp"

namespace slipfront::boundary {

/// The machine that loads a body at its far edge, or at its left side by a pusher. Its stiffnesses, mean
/// stress per metre of its motion, are in series with what it moves along x, the far edge or what is under
/// the pusher, and with the far edge along y once that is pressed down.
struct Machine {
  double shear_stiffness_Pa_per_m = infinity;
  double normal_stiffness_Pa_per_m = infinity;  ///< 0: the forces stay
  Pusher pusher = {};                           ///< with it the far edge moves freely along x
  double mass_kg_per_m2 = 0;                    ///< moves along x with what it loads, over the same area

  bool is_rigid() const {
    return shear_stiffness_Pa_per_m == infinity && normal_stiffness_Pa_per_m == infinity;
  }
  /// Length of what it moves along x, of a body of a given width.
  double moved_length_m(double width_m) const {
    return pusher.is_there() ? pusher.to_m - pusher.from_m : width_m;
  }
  /// Whether both displacements of the whole far edge are prescribed, and no others.
  bool prescribes_far_edge() const { return is_rigid() && !pusher.is_there(); }
};

}  // namespace slipfront::boundary
