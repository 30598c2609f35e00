// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stability/modes.hpp"

namespace slipfront::stability {

/// A function of p = s/(k c_S), c_S of the body above, that is zero where two half-spaces have a mode: the
/// equations of motion as a first-order system in y, whose eigenvectors that decay are found by numbers.
/// Nothing is shared with the relation under test.
Complex pair_by_eigenvectors(const Bodies& bodies, const Sliding& sliding, double wavenumber_per_m,
                             Complex p);

}  // namespace slipfront::stability
