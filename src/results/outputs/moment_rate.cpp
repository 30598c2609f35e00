// SPDX-License-Identifier: BSD-3-Clause
// moment_rate.h5: how fast slip releases potency and moment, and how fast as a far receiver sees it.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "results/outputs.hpp"
#include "results/table.hpp"

namespace slipfront::results {
namespace {

/// Sums slip over the interface in equal intervals of time: as it comes; and that of each node later by the
/// way of an S wave from it to the right end, or to the left one: in the order in which the waves pass a far
/// receiver there (Ben-Menahem 1961, doi:10.1785/BSSA0510030401). Slip between two rows counts as even.
class MomentRate final : public motion::Observer {
 public:
  MomentRate(const OutputSetup& setup, RowSink& rows)
      : every_(setup.history_interval_s),
        interval_s_(std::max(setup.history_interval_s, setup.step_s)),
        shear_modulus_Pa_(setup.shear_modulus_Pa),
        tributary_m_(setup.tributary_m),
        slip_m_(setup.x_m.size(), 0.0),
        rows_(rows) {
    for (const double x_m : setup.x_m) {
      delays_s_[0].push_back(0);
      delays_s_[1].push_back((setup.x_m.back() - x_m) / setup.c_S_m_per_s);
      delays_s_[2].push_back((x_m - setup.x_m.front()) / setup.c_S_m_per_s);
    }
  }

  bool wants_row(const motion::Now& now) const override { return every_.is_due(now); }
  void take_row(const record::History& row) override {
    add(row);
    while (static_cast<double>(n_rows_ + 1) * interval_s_ <= time_s_) put_row();
  }
  /// Waves are still on their way.
  void at_end(motion::Pause& pause) override {
    add(pause.stepper().interface_row());
    while (std::ranges::any_of(sums_m2_, [](const auto& sums) { return !sums.empty(); })) put_row();
  }

  const char* name() const override { return "moment rate"; }
  void archive(StateArchive& archive) override {
    archive(time_s_, n_rows_, sums_m2_[0], sums_m2_[1], sums_m2_[2]);
    archive_vector(archive, slip_m_);
  }
  void restored(motion::Pause& pause) override {
    require_possible(time_s_ >= 0 && time_s_ <= pause.now().time_s() &&
                         static_cast<double>(n_rows_) * interval_s_ <= time_s_,
                     "a moment rate");
  }

 private:
  void add(const record::History& row) {
    const double from_s = std::exchange(time_s_, row.time_s.front());
    for (std::size_t k = 0; k < slip_m_.size(); ++k) {
      const double potency_m2 = tributary_m_[k] * (row.slip_m[k] - std::exchange(slip_m_[k], row.slip_m[k]));
      if (potency_m2 == 0) continue;
      for (std::size_t d = 0; d < delays_s_.size(); ++d)
        spread(sums_m2_[d], from_s + delays_s_[d][k], time_s_ + delays_s_[d][k], potency_m2);
    }
  }
  /// Adds what comes evenly from one time to the other to the sums of intervals that have no row yet.
  void spread(std::vector<double>& sums_m2, double from_s, double to_s, double potency_m2) const {
    const auto first = std::max(n_rows_, static_cast<std::uint64_t>(from_s / interval_s_));
    for (auto n = first;; ++n) {
      if (sums_m2.size() <= n - n_rows_) sums_m2.resize(n - n_rows_ + 1);
      const double end_s = static_cast<double>(n + 1) * interval_s_;
      const double part_m2 = end_s < to_s ? potency_m2 * (end_s - from_s) / (to_s - from_s) : potency_m2;
      sums_m2[n - n_rows_] += part_m2;
      if (end_s >= to_s) return;
      potency_m2 -= part_m2;
      from_s = end_s;
    }
  }
  void put_row() {
    std::array<double, 3> rate_m2_per_s{};
    for (std::size_t d = 0; d < rate_m2_per_s.size(); ++d) {
      if (sums_m2_[d].empty()) continue;
      rate_m2_per_s[d] = sums_m2_[d].front() / interval_s_;
      sums_m2_[d].erase(sums_m2_[d].begin());
    }
    const auto [normal, right, left] = rate_m2_per_s;
    const double time_s = (static_cast<double>(n_rows_++) + 0.5) * interval_s_;
    rows_.put({time_s, normal, shear_modulus_Pa_ * normal, right, left});
  }

  motion::Every every_;
  double interval_s_, shear_modulus_Pa_;
  std::vector<double> tributary_m_;
  std::array<std::vector<double>, 3> delays_s_;  ///< of waves at right angles, to the right, to the left
  double time_s_ = 0;                            ///< of the last row of the interface
  std::vector<double> slip_m_;                   ///< then. [nodes]
  std::uint64_t n_rows_ = 0;                     ///< intervals that are complete
  std::array<std::vector<double>, 3> sums_m2_;   ///< of the later ones
  RowSink& rows_;
};

constexpr std::array<Description, 4> moment_rate_fields = {{
    {"potency_rate_m2_per_s", "m2/s", "slip rate, summed over the interface"},
    {"moment_rate_N_per_s", "N/s", "potency rate times the shear modulus of the plate, per unit thickness"},
    {"right_potency_rate_m2_per_s", "m2/s",
     "potency rate as S waves show it that leave to +x, from the right end of the interface"},
    {"left_potency_rate_m2_per_s", "m2/s",
     "potency rate as S waves show it that leave to -x, from the left end of the interface"},
}};

}  // namespace

const Output moment_rate_output = {
    .file = "moment_rate.h5",
    .name = "the moment rate",
    .remedy = [] { return Message("a larger {}", Key("output.history_interval_s")); },
    .forecast =
        [](const OutputSetup& setup) {
          if (!setup.moment_rate) return Forecast{};
          const double n_rows = rows_at(setup, setup.history_interval_s);
          return Forecast{n_rows,
                          n_rows * sizeof(double) * static_cast<double>(1 + moment_rate_fields.size())};
        },
    .format =
        [](const OutputSetup& setup) {
          return row_format(moment_rate_output.file,
                            {.origin = setup.origin,
                             .time = {"time_s", "s",
                                      "time since the start of the event, in the middle of the interval over "
                                      "which rates are means"},
                             .fields = {moment_rate_fields.begin(), moment_rate_fields.end()}});
        },
    .observer = [](const OutputSetup& setup, motion::TimeStepper& /*stepper*/, RowSink& rows)
        -> std::unique_ptr<motion::Observer> { return std::make_unique<MomentRate>(setup, rows); }};

}  // namespace slipfront::results
