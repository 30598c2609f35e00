// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fracture/tip.hpp"
#include "solid/element.hpp"

// Stress and strain near a front: those of the tip of a mode II crack that moves steadily between equal
// half-spaces or on the rigid plane (Freund 1990, section 4.3). They add to the state with the residual
// traction on the slipping side.
namespace slipfront::fracture {

using solid::PlaneTensor;

/// The field of a tip at the origin.
///
/// K in Pa m^(1/2) is positive where the body above slips to +x against the one below or the plane, whichever
/// way the front runs. Ahead of the tip, at y = 0, stress_xy = K/sqrt(2 pi |x|): the traction t on the body
/// above, positive against sliding to +x. Behind it stress_xy = 0. stress_xx and stress_yy of a front along
/// -x have the other sign: its field is that of a front along +x, mirrored, with slip to the other side.
class TipField {
 public:
  /// @param speed_m_per_s  from 0 up to limiting_speed; a tip below 1e-4 c_S has the field at that speed
  /// @param along_x        +1 or -1: where the front runs
  /// Not a number of bodies that differ, and from the limiting speed on.
  TipField(const Bodies& bodies, double speed_m_per_s, int along_x = 1);

  /// Over K, m^(-1/2), at a place other than the tip. y = 0 is the edge of the body above, -0 that of the one
  /// below. Not a number below the rigid plane.
  PlaneTensor stress_per_K(double x_m, double y_m) const;
  /// Over K, 1/(Pa m^(1/2)).
  PlaneTensor strain_per_K(double x_m, double y_m) const;

 private:
  solid::Material material_;
  bool has_body_below_;
  double along_x_;
  double a_d_, a_s_;  // how much slower the two waves' fields fall off in y
  double f_, g_;      // amplitudes of the two potentials' second derivatives, over K
};

}  // namespace slipfront::fracture
