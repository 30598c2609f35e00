// SPDX-License-Identifier: BSD-3-Clause
#include "motion/step_plan.hpp"

#include <algorithm>
#include <numeric>

namespace slipfront::motion {

StepPlan step_plan(std::span<const BodySteps> bodies, const TimeStepping& time) {
  constexpr double max_ratio = 16;
  StepPlan plan;
  plan.stable_step_s = std::ranges::min(bodies, {}, &BodySteps::stable_step_s).stable_step_s;
  plan.lowest_step_s = time.step_factor * plan.stable_step_s;
  for (const auto& body : bodies) {
    const double allowed = body.stable_step_s / plan.stable_step_s * (1 + 1e-9);
    const int ratio = static_cast<int>(std::clamp(allowed, 1.0, max_ratio));
    StepPlan::OfBody of_body{body, plan.lowest_step_s * (ratio * body.block_ratios.back()), {}};
    for (const int block_ratio : body.block_ratios)
      of_body.block_periods.push_back(ratio * time.interface_substeps * block_ratio);
    plan.period = std::lcm(plan.period, of_body.period());
    plan.bodies.push_back(std::move(of_body));
  }
  const int n_lowest = plan.period / time.interface_substeps;  // each body's period is a multiple of these
  plan.step_s = plan.lowest_step_s * n_lowest;
  for (auto& body : plan.bodies) body.has_common_step = body.period() == plan.period;
  return plan;
}

}  // namespace slipfront::motion
