// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "motion/settings.hpp"

// The whole numbers of time stepping:
//
//   interface_substeps  sub-steps in a step of the lowest block of the fastest body, a key of the case
//   block_ratios        steps of the blocks of one body over that of its lowest block, 1, 2, 4 ...
//   period              of a level, a block, a body or the stepper: sub-steps in its step
//   steps_per_sweep     steps of the stepper that a thread takes in one sweep through memory
//
// The sub-step is that of the cells next to the interface, one for all bodies. A body's step is that of its
// coarsest level, the stepper's is the shortest one that is whole for all bodies.

namespace slipfront::motion {

/// What a body's steps follow from, whatever the other body is.
struct BodySteps {
  double stable_step_s = 0;
  std::vector<int> block_ratios;  ///< of all blocks, upwards; see the function of this name
  template <class Archive>
  void serialize(Archive& archive) {
    archive(stable_step_s, block_ratios);
  }
};

/// The steps of all bodies of a run.
struct StepPlan {
  struct OfBody {
    BodySteps allowed;
    double step_s = 0;
    std::vector<int> block_periods;  ///< of all blocks, upwards
    bool has_common_step = true;     ///< that of the stepper
    int period() const { return block_periods.back(); }
    /// A level's step.
    double level_step_s(int level_period) const { return step_s * level_period / period(); }
  };
  double stable_step_s = 0;  ///< of the fastest body
  double lowest_step_s = 0;  ///< of its lowest block: time.step_factor of the stable one
  double step_s = 0;
  int period = 1;
  std::vector<OfBody> bodies;

  double substep_s() const { return step_s / period; }
};

/// Bodies share the sub-step that the fastest of them allows. Another one's cells away from the interface
/// take steps longer by the whole number that they allow, up to 16: beyond this there is little left to save,
/// and the common step would outgrow what is to be seen.
StepPlan step_plan(std::span<const BodySteps> bodies, const TimeStepping& time);

}  // namespace slipfront::motion
