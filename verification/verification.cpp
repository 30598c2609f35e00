// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verification.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "verification/problems.hpp"

namespace slipfront::verification {

bool Check::holds() const {
  return std::abs(measured - expected) <= tolerance;
}

double Curve::value_at(double at) const {
  const auto i = static_cast<std::size_t>(std::ranges::lower_bound(x, at) - x.begin());
  const double w = (at - x[i - 1]) / (x[i] - x[i - 1]);
  return (1 - w) * y[i - 1] + w * y[i];
}

bool Outcome::holds() const {
  return !checks.empty() && std::ranges::all_of(checks, [](const Check& check) { return check.holds(); });
}

std::span<const Verification> verifications() {
  static const std::array all = {
      Verification{"plane_waves", "Speed and dispersion of plane longitudinal and shear waves",
                   plane_waves::verify},
      Verification{"bonded_waves", "Waves that fall at an angle onto the bond of two bodies",
                   bonded_waves::verify},
      Verification{"manufactured", "Convergence towards exact waves of a layer on its plane",
                   manufactured::verify},
      Verification{"subcycling", "Join between a sub-cycled layer and the other cells", subcycling::verify},
      Verification{"rayleigh_wave", "Speed and shape of the Rayleigh wave on the free lower edge",
                   rayleigh_wave::verify},
      Verification{"lamb", "Line loads on the edge of a half-plane", lamb::verify},
      Verification{"column", "Sliding of a column with velocity-weakening friction", column::verify},
      Verification{"time_reversal", "Motion there and back", time_reversal::verify},
      Verification{"symmetry", "Turned cells and mirrored plates", symmetry::verify},
      Verification{"growing_modes", "Growth of waves on uniform sliding", growing_modes::verify},
      Verification{"growing_modes_of_two", "Growth of waves between two sliding bodies",
                   growing_modes_of_two::verify},
      Verification{"growing_modes_with_state", "Growth of waves under rate-and-state friction",
                   growing_modes_with_state::verify},
      Verification{"layer_spectrum", "Growth of waves on a sliding layer", layer_spectrum::verify},
      Verification{"slip_patch", "Slip of a patch without strength", slip_patch::verify},
      Verification{"impact", "Impact of a free body on the plane", impact::verify},
      Verification{"block", "Stick-slip of a block", block::verify},
      Verification{"block_on_spring", "A block that a soft machine pulls", block_on_spring::verify},
      Verification{"spring_slider", "A slider on a spring under rate-and-state friction",
                   spring_slider::verify},
      Verification{"velocity_steps", "Velocity steps and holds under rate-and-state friction",
                   velocity_steps::verify},
      Verification{"recontact", "A sliding node that leaves the plane and lands", recontact::verify},
      Verification{"stiff_base", "The rigid plane as the limit of stiff bases", stiff_base::verify},
      Verification{"nucleation", "Lengths at which slip runs away", nucleation::verify},
      Verification{"static_crack", "Energy release rate of cracks at rest", static_crack::verify},
      Verification{"self_similar_crack", "Fracture energy and speed of a crack that grows from a point",
                   self_similar_crack::verify},
      Verification{"steady_strip", "Fronts that are driven along a strip", steady_strip::verify},
      Verification{"crack", "A crack under friction that weakens with slip", crack::verify},
  };
  return all;
}

}  // namespace slipfront::verification
