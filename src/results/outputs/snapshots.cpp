// SPDX-License-Identifier: BSD-3-Clause
// fields.vtkhdf: displacement and velocity of all nodes at given times.
#include "results/snapshots.hpp"

#include "results/outputs.hpp"

namespace slipfront::results {
namespace {

/// Puts snapshots, each after the first step at or after its time.
class Snapshots final : public motion::Observer {
 public:
  Snapshots(const OutputSetup& setup, RowSink& rows)
      : times_s_(setup.snapshot_times_s),
        seam_(setup.seam),
        n_nodes_(static_cast<std::size_t>(setup.n_nodes)),
        rows_(rows) {}
  std::int64_t steps_to_pause(const motion::Now& now) const override {
    return next_ < times_s_.size() ? motion::steps_until(now, times_s_[next_]) : motion::many_steps;
  }
  void at_pause(motion::Pause& pause) override {
    for (; next_ < times_s_.size() && pause.now().time_s() >= times_s_[next_]; ++next_) put(pause.stepper());
  }
  const char* name() const override { return "snapshots"; }
  void archive(StateArchive& archive) override { archive(next_); }
  /// All that were due have been taken.
  void restored(motion::Pause& pause) override {
    const double now_s = pause.now().time_s();
    require_possible(next_ <= times_s_.size() && (next_ == 0 || times_s_[next_ - 1] <= now_s) &&
                         (next_ == times_s_.size() || times_s_[next_] > now_s),
                     "snapshots");
  }

 private:
  /// Each piece of the motion when there is room for a copy of it.
  void put(const motion::TimeStepper& stepper) {
    rows_.put({stepper.time_s()});
    const auto max_bytes = stepper.snapshot_chunk_bytes();
    std::size_t place = 0;
    for (int k = 0; k < stepper.n_snapshot_chunks(); ++k) {
      rows_.wait_for_room(max_bytes);
      auto values = stepper.snapshot_chunk(k);
      close_seam(values, place, n_nodes_, seam_);
      place += values.size();
      rows_.put(std::move(values));
    }
  }

  std::vector<double> times_s_;
  Seam seam_;
  std::size_t n_nodes_;
  RowSink& rows_;
  std::uint64_t next_ = 0;
};

}  // namespace

const Output snapshot_output = {
    .file = "fields.vtkhdf",
    .name = "snapshots",
    .remedy =
        [] {
          return Message("fewer {}, a longer {:leaf}, {:leaf} = false", Key("output.snapshot_times_s"),
                         Key("output.snapshot_interval_s"), Key("output.snapshot_stress"));
        },
    .forecast =
        [](const OutputSetup& setup) {
          constexpr double of_mesh = 65;                                          // of a node: place, cell
          constexpr double of_motion = 32;                                        // of a node: u and v
          constexpr double of_tensors = tensor_values_per_cell * sizeof(double);  // of a cell
          const auto n = static_cast<double>(setup.snapshot_times_s.size());
          const double of_stress = setup.snapshot_stress ? of_tensors : 0;
          return Forecast{n, n == 0 ? 0 : setup.n_nodes * (of_mesh + n * (of_motion + of_stress))};
        },
    .format =
        [](const OutputSetup& setup) {
          return snapshot_format(setup.origin, setup.snapshot_times_s.size(),
                                 static_cast<std::size_t>(setup.n_nodes));
        },
    .observer = [](const OutputSetup& setup, motion::TimeStepper& /*stepper*/, RowSink& rows)
        -> std::unique_ptr<motion::Observer> { return std::make_unique<Snapshots>(setup, rows); }};

}  // namespace slipfront::results
