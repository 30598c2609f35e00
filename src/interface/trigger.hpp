// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "base/numbers.hpp"

namespace slipfront::interface {

/// What starts the event.
enum class EventKind {
  none,         ///< nothing: the common state is left to itself
  spontaneous,  ///< the shear is raised statically just past the critical one
  left,         ///< added tangential traction next to the left edge of contact
  right,        ///< added tangential traction next to the right edge of contact
  nucleation,   ///< a patch of given place, see Nucleation
};

/// Whether the event starts with a trigger next to an edge of contact.
inline bool is_at_edge(EventKind kind) {
  return kind == EventKind::left || kind == EventKind::right;
}

/// How a trigger next to an edge of contact starts the event.
enum class TriggerForm {
  added,     ///< an external traction amount * (mu_s p_s - t_s)
  raised,    ///< one that raises t_s to amount * mu_s p_s
  weakened,  ///< its friction is mu_k from the start: Interface::strength_fraction = 0
  unloaded,  ///< an external traction amount * p_s that parts the bodies
};

/// How a trigger's traction grows in time, to its full size at T = ramp_s.
enum class Ramp {
  linear,
  smooth,  ///< exp[(t - T)^2/(t (t - 2 T))]: all derivatives are continuous (SCEC TPV101)
};

/// A zone next to an edge of contact. The tractions of the forms but `weakened` are external forces on the
/// plate, not part of the reported t and p, times a ramp in time. Along x it acts, and t_s counts, in the
/// direction in which the zone as a whole is loaded, +x for none; where it would lower t_s it is left out.
struct Trigger {
  TriggerForm form = TriggerForm::added;
  double zone_m = 5e-3;  ///< measured inward from the outermost node in contact
  double amount = 5;     ///< see TriggerForm: 1 just reaches the strength
  Ramp ramp = Ramp::linear;
  double ramp_s = 2.5e-6;        ///< rises from zero over this time
  double duration_s = infinity;  ///< taken away this long after its start
};

/// Time factor of the trigger, 0 to 1.
inline double trigger_factor(const Trigger& trigger, double time_s) {
  if (time_s >= trigger.duration_s) return 0;
  if (time_s >= trigger.ramp_s) return 1;
  const double s = time_s / trigger.ramp_s;
  if (trigger.ramp == Ramp::linear) return s;
  return s > 0 ? std::exp((s - 1) * (s - 1) / (s * (s - 2))) : 0;
}

}  // namespace slipfront::interface
