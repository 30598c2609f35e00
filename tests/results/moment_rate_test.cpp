// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "interface/friction/velocity_weakening.hpp"
#include "motion/stepper.hpp"
#include "results/outputs.hpp"
#include "support/plate.hpp"

namespace slipfront::results {
namespace {

constexpr double interval_s = 0.5e-6, c_S_m_per_s = 1000, v_m_per_s = 400, length_m = 0.1, slip_m = 1e-5;

/// Columns of moment_rate.h5.
enum Column { time, normal, moment, right, left, n_columns };

/// A front that runs from the left end to the right one, behind which nodes slip at once.
class MomentRate : public ::testing::Test {
 protected:
  MomentRate() {
    constexpr int n = 201;
    for (int k = 0; k < n; ++k) {
      setup_.x_m.push_back(length_m * k / (n - 1));
      setup_.tributary_m.push_back(length_m / (n - 1) * (k == 0 || k == n - 1 ? 0.5 : 1));
    }
    const auto mesh = test::make_plate(0.1, 0.05, 5e-3, mesh::Corner::none);
    stepper_.emplace(mesh, solid::Material{}, interface::ContactModel{interface::VelocityWeakening{}},
                     motion::TimeStepping{});
  }
  std::unique_ptr<motion::Observer> observer(KeptRows& rows) {
    return moment_rate_output.observer(setup_, *stepper_, rows);
  }
  /// Rows of the interface from one to another, at the output's interval.
  void show(motion::Observer& observer, int first, int end) const {
    for (int k = first; k < end; ++k) {
      record::History row;
      row.time_s = {interval_s * k};
      for (const double x_m : setup_.x_m)
        row.slip_m.push_back(x_m < v_m_per_s * row.time_s.front() ? slip_m : 0);
      observer.take_row(row);
    }
  }
  static constexpr int n_all = 1000;  ///< by when all waves have come
  std::vector<double> column(const KeptRows& rows, Column c) const {
    std::vector<double> values;
    for (std::size_t k = c; k < rows.values.size(); k += n_columns) values.push_back(rows.values[k]);
    return values;
  }

  OutputSetup setup_{.history_interval_s = interval_s,
                     .moment_rate = true,
                     .shear_modulus_Pa = 2e9,
                     .c_S_m_per_s = c_S_m_per_s};
  std::optional<motion::Stepper> stepper_;
};

TEST_F(MomentRate, IsThePotencyInTheEndWhereverItIsSeen) {
  KeptRows rows;
  show(*observer(rows), 0, n_all);
  for (const auto c : {normal, right, left}) {
    const auto rates = column(rows, c);
    EXPECT_NEAR(std::accumulate(rates.begin(), rates.end(), 0.0) * interval_s, slip_m * length_m,
                1e-12 * slip_m * length_m);  // rounding of some hundred sums
  }
  const auto of_normal = column(rows, normal), of_moment = column(rows, moment);
  for (std::size_t k = 0; k < of_normal.size(); ++k) EXPECT_EQ(of_moment[k], 2e9 * of_normal[k]);
}

TEST_F(MomentRate, IsShorterAheadOfTheFrontAndLongerBehindIt) {
  KeptRows rows;
  show(*observer(rows), 0, n_all);
  const auto is_seen = [](double rate) { return rate > 0; };
  const auto duration_s = [&](Column c) {
    const auto rates = column(rows, c);
    const auto first = std::ranges::find_if(rates, is_seen);
    const auto last = std::find_if(rates.rbegin(), rates.rend(), is_seen);
    return interval_s * static_cast<double>(last.base() - first);
  };
  // Ben-Menahem's directivity: (1 - (v/c) cos theta) of the duration L/v, with an interval at each end.
  const double all_s = length_m / v_m_per_s, ratio = v_m_per_s / c_S_m_per_s, ends_s = 2.1 * interval_s;
  EXPECT_NEAR(duration_s(normal), all_s, ends_s);
  EXPECT_NEAR(duration_s(right), all_s * (1 - ratio), ends_s);
  EXPECT_NEAR(duration_s(left), all_s * (1 + ratio), ends_s);
  // Ahead, waves of all of the front come as the first one has passed the interface.
  const auto of_right = column(rows, right);
  const auto first = std::ranges::find_if(of_right, is_seen) - of_right.begin();
  EXPECT_NEAR(column(rows, time)[static_cast<std::size_t>(first)], length_m / c_S_m_per_s, ends_s);
}

}  // namespace
}  // namespace slipfront::results
