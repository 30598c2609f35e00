// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/observer.hpp"
#include "motion/observers/event_output.hpp"
#include "motion/probes.hpp"

namespace slipfront::motion {

/// Gives what the stepper's probes record to an output, at an interval.
class ProbeRows final : public Observer {
 public:
  /// @param stepper  about to begin: the velocity has been the present one
  /// @param further  stress that the displacements leave out
  ProbeRows(const TimeStepper& stepper, double interval_s, const std::optional<solid::UniformStress>& further,
            EventOutput& output)
      : recorder_(probe_recorder(stepper, interval_s, further)), output_(output) {}
  double* displacements(std::int64_t step) override { return recorder_.room_for(step); }
  void expect(const Now& now, std::int64_t n) override { recorder_.expect(now.step, n); }
  void at_pause(Pause& pause) override {
    record::ProbeRecord rows;
    recorder_.take_rows(pause.now().step, rows);
    if (!rows.time_s.empty()) output_.probe(rows);
  }
  const char* name() const override { return "probes"; }
  void archive(StateArchive& archive) override { recorder_.serialize(archive); }

 private:
  static ProbeRecorder probe_recorder(const TimeStepper& stepper, double interval_s,
                                      const std::optional<solid::UniformStress>& further) {
    const auto now_m = stepper.probed_u_m();
    auto before_m = now_m;
    const auto v_m_per_s = stepper.probed_v_m_per_s();
    for (std::size_t k = 0; k < before_m.size(); ++k) before_m[k] -= stepper.step_s() * v_m_per_s[k];
    return {stepper.probes(), stepper.step_s(), interval_s, before_m, now_m, further};
  }

  ProbeRecorder recorder_;
  EventOutput& output_;
};

}  // namespace slipfront::motion
