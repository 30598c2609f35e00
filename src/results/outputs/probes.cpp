// SPDX-License-Identifier: BSD-3-Clause
// probes.h5: motion, strain and stress at given places.
#include "motion/probes.hpp"

#include "results/outputs.hpp"
#include "results/rows.hpp"
#include "results/table.hpp"

namespace slipfront::results {
namespace {

/// Puts what the stepper's probes record, at an interval.
class ProbeRows final : public motion::Observer {
 public:
  /// @param stepper  its velocity has been the present one
  ProbeRows(const OutputSetup& setup, const motion::TimeStepper& stepper, RowSink& rows)
      : recorder_(recorder(setup, stepper)), rows_(rows) {}
  double* displacements(std::int64_t step) override { return recorder_.room_for(step); }
  void expect(const motion::Now& now, std::int64_t n) override { recorder_.expect(now.step, n); }
  void at_pause(motion::Pause& pause) override {
    record::ProbeRecord rows;
    recorder_.take_rows(pause.now().step, rows);
    if (!rows.time_s.empty()) rows_.put(rows_of(members_of(std::as_const(rows), record::probe_fields)));
  }
  const char* name() const override { return "probes"; }
  void archive(StateArchive& archive) override { recorder_.serialize(archive); }

 private:
  static motion::ProbeRecorder recorder(const OutputSetup& setup, const motion::TimeStepper& stepper) {
    const auto now_m = stepper.probed_u_m();
    auto before_m = now_m;
    const auto v_m_per_s = stepper.probed_v_m_per_s();
    for (std::size_t k = 0; k < before_m.size(); ++k) before_m[k] -= stepper.step_s() * v_m_per_s[k];
    return {stepper.probes(),    stepper.step_s(), setup.probe_interval_s, before_m, now_m,
            setup.further_stress};
  }

  motion::ProbeRecorder recorder_;
  RowSink& rows_;
};

}  // namespace

Table probe_table(std::span<const record::ProbePlace> places, const Origin& origin) {
  Table table{origin,
              {{{"x_m", "m", "position along the interface from the left edge"}, {}},
               {{"y_m", "m", "position above the interface; below 0 in the base"}, {}}},
              {},
              description_of(record::probe_time),
              descriptions_of(record::probe_fields)};
  for (const auto& place : places) {
    table.names.push_back(place.name);
    table.axes[0].values.push_back(place.x_m);
    table.axes[1].values.push_back(place.y_m);
  }
  return table;
}

const Output probe_output = {
    .file = "probes.h5",
    .name = "probes",
    .remedy =
        [] { return Message("fewer {}, or a larger {:leaf}", Key("probes.x_m"), Key("probes.interval_s")); },
    .forecast =
        [](const OutputSetup& setup) {
          if (setup.probes.empty()) return Forecast{};
          const double n_rows = rows_at(setup, setup.probe_interval_s);
          return Forecast{n_rows, n_rows * sizeof(double) *
                                      static_cast<double>(record::probe_row_values(setup.probes.size()))};
        },
    .format =
        [](const OutputSetup& setup) {
          return row_format(probe_output.file, probe_table(setup.probes, setup.origin));
        },
    .observer = [](const OutputSetup& setup, motion::TimeStepper& stepper, RowSink& rows)
        -> std::unique_ptr<motion::Observer> { return std::make_unique<ProbeRows>(setup, stepper, rows); }};

}  // namespace slipfront::results
