// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::verification {

/// The join between a sub-cycled layer and the other cells acts as if the cell above it were thinner by this
/// share, for changes of stress since the start: verification/subcycling.md.
/// @param courant_number  c dt/h of the longer step
double thinning_of_join(double courant_number, int substeps);

}  // namespace slipfront::verification
