// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "run/sample.hpp"

namespace slipfront::run {

/// The phase in which a sample under a law that sticks is loaded by static equilibria: where the last event
/// has left its interface, it sticks and has its static strength again. It ends in the state in which the
/// next event begins: where t/p inside passes mu_s by loading.critical_margin, or at rest if it does so
/// there.
/// @return false where that is beyond sequence.end_s, to which the sample is loaded then
/// @throws UserError where no shear does it; Interrupted
bool stick_to_next(Sample& sample);

}  // namespace slipfront::run
