// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "verification/verification.hpp"

/// The problems, a file each.
namespace slipfront::verification {

Outcome plane_waves(Effort effort);
Outcome manufactured(Effort effort);
Outcome rayleigh_wave(Effort effort);
Outcome lamb(Effort effort);
Outcome column(Effort effort);
Outcome time_reversal(Effort effort);
Outcome subcycling(Effort effort);
/// The join between a sub-cycled layer and the other cells acts as if the cell above it were thinner by this
/// share, for changes of stress since the start: verification/subcycling.md.
/// @param courant_number  c dt/h of the longer step
double thinning_of_join(double courant_number, int substeps);
Outcome symmetry(Effort effort);
Outcome growing_modes(Effort effort);
Outcome growing_modes_of_two(Effort effort);
Outcome slip_patch(Effort effort);
Outcome crack(Effort effort);
Outcome layer_spectrum(Effort effort);
Outcome impact(Effort effort);
Outcome block(Effort effort);
Outcome bonded_waves(Effort effort);

}  // namespace slipfront::verification
