// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "fronts/from_history.hpp"
#include "synthetic.hpp"

namespace slipfront::fronts::testing {
namespace {

constexpr double threshold = 0.01;

TEST(RecordFromHistory, EqualsTheDirectRecord) {
  const auto x = nodes(31, h);
  const auto tau = bilateral(x, x[10], V, 3.3e-6);
  const auto traction = [](double x_m, double time_s) {
    return record::Traction{4e6 + 1e9 * x_m - 1e10 * time_s,
                            5e6 + 2e9 * x_m + 3e10 * time_s};  // linear in time
  };
  const record::SlipRecord direct = make_record(
      x, tau,
      {.halo = 2, .end_time_s = 50e-6, .duration_s = [](double) { return 10e-6; }, .traction = traction});

  // The slip rate rises through the threshold at tau and falls through it 10 us later, over straight lines
  // whose ends are instants of the history (all of them 0.1 us apart).
  record::History history;
  history.x_m = x;
  constexpr double dt = 0.1e-6;
  for (int row = 0; row <= 500; ++row) history.time_s.push_back(row * dt);
  history.time_s.back() = 50e-6;
  for (const double time_s : history.time_s) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double past_s = std::min(time_s - tau[k], tau[k] + 10e-6 - time_s);
      // Linear within 0.2 us about the crossings, so the interval that holds a crossing is straight.
      history.slip_rate_m_per_s.push_back(
          std::max(0.0, threshold + std::clamp(past_s, -0.2e-6, 0.2e-6) * 5e4));
      history.t_Pa.push_back(traction(x[k], time_s).t_Pa);
      history.p_Pa.push_back(traction(x[k], time_s).p_Pa);
    }
  }
  // At 0.2 us before tau the rate would be 0.01 - 0.01 = 0: never cut off inside the straight part.
  const record::SlipRecord record = record_from_history(history, threshold, 2);

  EXPECT_EQ(record.x_m, direct.x_m);
  EXPECT_EQ(record.halo, 2);
  EXPECT_DOUBLE_EQ(record.end_time_s, 50e-6);
  ASSERT_EQ(record.onsets.size(), direct.onsets.size());
  ASSERT_EQ(record.stops.size(), direct.stops.size());
  ASSERT_EQ(record.around.size(), direct.around.size());
  std::vector<double> time_s(x.size());
  for (std::size_t k = 0; k < record.onsets.size(); ++k) {
    if (k > 0) {
      EXPECT_LE(record.onsets[k - 1].time_s, record.onsets[k].time_s);
      EXPECT_LE(record.stops[k - 1].time_s, record.stops[k].time_s);
    }
    const record::Onset& onset = record.onsets[k];
    EXPECT_NEAR(onset.time_s, tau[onset.node], 1e-15);
    EXPECT_NEAR(record.stops[k].time_s, tau[record.stops[k].node] + 10e-6, 1e-15);
    for (int offset = -2; offset <= 2; ++offset) {
      const int node = onset.node + offset;
      const record::Traction& found = record.around_onset(k)[static_cast<std::size_t>(offset + 2)];
      if (node < 0 || node > 30) {
        EXPECT_TRUE(std::isnan(found.t_Pa) && std::isnan(found.p_Pa));
        continue;
      }
      const record::Traction expected = traction(x[node], tau[onset.node]);
      EXPECT_NEAR(found.t_Pa, expected.t_Pa, 1e-3);  // rounding of values of 1e6
      EXPECT_NEAR(found.p_Pa, expected.p_Pa, 1e-3);
    }
  }
}

record::History one_node(std::vector<double> rate) {
  record::History history;
  history.x_m = {0.0};
  for (std::size_t k = 0; k < rate.size(); ++k) {
    history.time_s.push_back(static_cast<double>(k));
    history.t_Pa.push_back(10.0 * static_cast<double>(k));
    history.p_Pa.push_back(1.0);
  }
  history.slip_rate_m_per_s = std::move(rate);
  return history;
}

TEST(RecordFromHistory, OfANode) {
  const struct {
    std::vector<double> rate, onsets_s, t_Pa, stops_s;
  } cases[] = {{{1, 1, 0}, {0}, {0}, {1.5}},                     // slips from the first time
               {{0, -1, 1, 1}, {0.5, 1.75}, {5, 17.5}, {1.25}},  // reversal is a stop and an onset
               {{0.5, -0.5, 0.1}, {}, {}, {}}};
  for (const auto& c : cases) {
    const auto record = record_from_history(one_node(c.rate), 0.5, 0);
    EXPECT_EQ(record.end_time_s, static_cast<double>(c.rate.size()) - 1);
    ASSERT_EQ(record.onsets.size(), c.onsets_s.size());
    ASSERT_EQ(record.around.size(), c.onsets_s.size());
    ASSERT_EQ(record.stops.size(), c.stops_s.size());
    for (std::size_t k = 0; k < c.onsets_s.size(); ++k) {
      EXPECT_DOUBLE_EQ(record.onsets[k].time_s, c.onsets_s[k]);
      EXPECT_DOUBLE_EQ(record.around[k].t_Pa, c.t_Pa[k]);
    }
    for (std::size_t k = 0; k < c.stops_s.size(); ++k) EXPECT_DOUBLE_EQ(record.stops[k].time_s, c.stops_s[k]);
  }
  EXPECT_TRUE(record_from_history({}, 0.5, 3).onsets.empty());
}

TEST(RecordFromHistory, ATipAtThePeakOfTraction) {
  // |t| = 9 - (time - 2.3)^2 up to 4 s, a parabola, and higher after the largest slip rate, at 5 s; a second
  // slip of which t falls from the first row on.
  auto history = one_node({0, 0, 0.1, 0.9, 1.5, 2, 1, 0, 0, 1, 2});
  for (std::size_t k = 0; k < 6; ++k) history.t_Pa[k] = std::pow(static_cast<double>(k) - 2.3, 2) - 9;
  for (std::size_t k = 6; k < 11; ++k) history.t_Pa[k] = 40.0 - static_cast<double>(k);
  history.p_Pa = history.time_s;
  const auto record = record_from_history(history, 0.5, 0, TipAt::peak);
  ASSERT_EQ(record.onsets.size(), 2);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 2.3);
  EXPECT_DOUBLE_EQ(record.around[0].p_Pa, 2.3);
  EXPECT_DOUBLE_EQ(record.onsets[1].time_s, 7);  // not 6, before the stop
  EXPECT_EQ(record.stops.size(), 1);
}

TEST(RecordFromHistory, ATipAtThePeakOfUnevenRows) {
  auto history = one_node({0, 0, 1, 0});
  history.time_s = {0, 1, 4, 5};
  for (std::size_t k = 0; k < 4; ++k) history.t_Pa[k] = 9 - std::pow(history.time_s[k] - 1.9, 2);
  EXPECT_DOUBLE_EQ(record_from_history(history, 0.5, 0, TipAt::peak).onsets.at(0).time_s, 1.9);
}

TEST(RecordFromHistoryDeathTest, WrongInput) {
  EXPECT_DEATH(record_from_history(one_node({1.0}), 0.0, 0), "slip rate");
  record::History history = one_node({1.0, 1.0});
  history.time_s[1] = 0.0;
  EXPECT_DEATH(record_from_history(history, 0.5, 0), "ascend");
  history = one_node({1.0, 1.0});
  history.p_Pa.pop_back();
  EXPECT_DEATH(record_from_history(history, 0.5, 0), "times x nodes");
}

}  // namespace
}  // namespace slipfront::fronts::testing
