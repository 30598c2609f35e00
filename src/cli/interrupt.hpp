// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::cli {

/// From now on the signals that would end the program (HUP, INT, QUIT, TERM, XCPU; PIPE and XFSZ where
/// somebody sends them) only set a flag, so that what there is can be kept; a second INT or QUIT ends it.
/// USR1 asks for a checkpoint. A reader who has gone or a file that grows beyond its limit make writing fail,
/// and no more.
void catch_interrupts();

/// Whether an end was asked for.
bool interrupt_wanted();
/// The signal that did; 0 for none.
int interrupting_signal();

/// Whether a checkpoint was asked for since the last call.
bool checkpoint_wanted();
/// From now on one that is asked for pauses the steps at once. Who calls it asks checkpoint_wanted in pauses.
void pause_for_checkpoints();

}  // namespace slipfront::cli
