// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/case.hpp"

namespace slipfront::input {

/// Mean pressure of the interface before the event: prescribed, of the normal force where the case gives it,
/// else under the tilt, the bodies' sides free; a base takes its share of the compression.
double nominal_pressure_Pa(const Case& config);

}  // namespace slipfront::input
