// SPDX-License-Identifier: BSD-3-Clause
#include "motion/ramp.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "motion/observers/blow_up_monitor.hpp"
#include "motion/observers/onsets.hpp"

namespace slipfront::motion {

namespace {

constexpr std::int64_t monitor_interval = 1000;

Observers observers(Stepper& stepper, const statics::Equilibrium& tilted, double c_L_m_per_s,
                    std::unique_ptr<RampStates> states, const Monitor& monitor) {
  const bool is_single =
      std::ranges::any_of(stepper.bodies(), [](const Body& body) { return body.has_single_precision(); });
  const auto expected_steps = states->expected_steps();
  Observers list;
  list.push_back(std::make_unique<Onsets>(tilted.tractions.x_m, 0));
  list.push_back(std::make_unique<BlowUpMonitor>(
      stepper, c_L_m_per_s, is_single ? Precision::single_precision : Precision::double_precision,
      stepper.energies()));
  list.push_back(std::move(states));
  list.push_back(std::make_unique<Progress>(stepper, monitor_interval, expected_steps, monitor));
  return list;
}

}  // namespace

RampRun::RampRun(Stepper& stepper, const statics::Equilibrium& tilted, const statics::Loading& loading,
                 const PerNode& mu_s, double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m,
                 const Monitor& monitor)
    : stepper_(stepper),
      run_(stepper, {tilted, mu_s, 0, 0}, tilted.tractions.x_m,
           observers(stepper, tilted, c_L_m_per_s,
                     std::make_unique<RampStates>(stepper, tilted, loading, mu_s, top_speed_m_per_s,
                                                  c_L_m_per_s, expected_shear_m),
                     monitor)) {}

std::uint64_t Ramp::n_onsets_inside() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(record.onsets, [&](const record::Onset& onset) {
    return spontaneous.is_inside(record.x_m[onset.node]);
  }));
}

Ramp RampRun::run() {
  const End end = run_.run();
  if (end.why == EventEnd::blow_up) throw BlowUp(end.reason);
  auto found = run_.get<RampStates>().take();
  return {std::move(found.common), std::move(found.spontaneous),
          run_.get<Onsets>().record_until(stepper_.time_s()), stepper_.step(),
          end.why == EventEnd::interrupted};
}

}  // namespace slipfront::motion
