// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag, so that what there is can be kept; the second
/// ends the program.
void catch_interrupts();

/// Whether one has come.
bool interrupt_wanted();

}  // namespace slipfront::cli
