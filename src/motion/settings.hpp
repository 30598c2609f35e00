// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::motion {

/// Numbers in which the plate's motion away from the interface is computed.
enum class Precision { double_precision, single_precision };

/// How steps are computed: fast, or as the scheme is written (step.hpp).
enum class StepperKind { fast, plain };

/// Explicit time stepping: Newmark with beta = 0, gamma = 1/2, the interface layer sub-cycled.
struct TimeStepping {
  double step_factor = 0.9;     ///< step over the largest stable one
  bool allow_unstable = false;  ///< accept a step_factor above 1
  StepperKind stepper = StepperKind::fast;
  Precision precision = Precision::double_precision;
  int interface_rows = 4;       ///< rows of cells next to the interface that are sub-cycled
  int interface_substeps = 18;  ///< sub-steps per step there; 1 is the plain scheme
  bool local_steps = true;      ///< a graded plate's larger elements take larger steps
  double end_s = 0.5625e-3;     ///< end of the event, unless it comes to rest before
  double quiet_s = 15e-6;       ///< end it earlier when no node has slipped for this long
};

}  // namespace slipfront::motion
