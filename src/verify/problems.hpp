// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "verify/verification.hpp"

/// The problems, a file each.
namespace slipfront::verify {

Outcome impact(Effort effort);
Outcome plane_waves(Effort effort);

}  // namespace slipfront::verify
