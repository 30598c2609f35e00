// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/circle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "synthetic.hpp"

namespace slipfront::kammer2012 {
namespace {

using namespace synthetic;

constexpr double zone_from_m = 5e-3, zone_to_m = 20e-3;

/// A plate of 200 x 100 mm with squares of 1 mm.
mesh::Mesh make_plate() {
  mesh::Mesh plate;
  for (int j = 0; j <= 100; ++j)
    for (int i = 0; i <= 200; ++i) {
      if (j == 0) plate.interface_nodes.push_back(plate.n_nodes());
      plate.x_m.push_back(i * 1e-3);
      plate.y_m.push_back(j * 1e-3);
    }
  return plate;
}

/// |v| by the distance from the trigger zone.
motion::Snapshot snapshot_of(const mesh::Mesh& plate, const std::function<double(double)>& speed) {
  motion::Snapshot snapshot{.time_s = 50e-6, .u_m = {}, .v_m_per_s = solid::Field(plate.x_m.size())};
  for (std::size_t n = 0; n < plate.x_m.size(); ++n) {
    const double x = plate.x_m[n];
    const double r = std::hypot(x - std::clamp(x, zone_from_m, zone_to_m), plate.y_m[n]);
    snapshot.v_m_per_s.x[n] = -0.6 * speed(r);
    snapshot.v_m_per_s.y[n] = 0.8 * speed(r);
  }
  return snapshot;
}

double bump(double r, double at) {
  return std::exp(-(r - at) * (r - at) / 16e-6);
}

TEST(Circle, TheWaveIsTheOutermostLightMaximumOnEachRay) {
  const auto plate = make_plate();
  // Ahead of it a dark forerunner, behind it a dark zone and then lighter slip.
  const auto waves = waves_on_rays(
      {snapshot_of(plate,
                   [](double r) { return 0.9 * bump(r, 95e-3) + 2 * bump(r, 80e-3) + 5 * bump(r, 40e-3); })},
      plate, zone_from_m, zone_to_m);
  ASSERT_EQ(waves.size(), 2U);
  EXPECT_EQ(waves[0].angle_deg, 30);
  EXPECT_EQ(waves[1].angle_deg, 45);
  for (const auto& wave : waves) {
    EXPECT_EQ(wave.time_s, 50e-6);
    EXPECT_NEAR(wave.distance_m, 80e-3, 1e-3);        // the nodes are 1 to 1.4 mm apart
    EXPECT_NEAR(wave.peak_m_per_s, 2, 0.05);          // bump(0.7 mm from its top) is 0.97
    EXPECT_LT(wave.lowest_behind_m_per_s, 2 * 2e-2);  // between bumps, 20 mm from both
  }
}

TEST(Circle, BehindTheWaveIsWhereItIsNotYetExceeded) {
  const auto plate = make_plate();
  // The velocity falls to 1.5 m/s, rises above the wave's, and falls to 0 farther behind.
  const auto speed = [](double r) {
    return r < 20e-3 ? 0 : r < 60e-3 ? 4 : r < 70e-3 ? 1.5 : 2 * bump(r, 80e-3);
  };
  for (const auto& wave : waves_on_rays({snapshot_of(plate, speed)}, plate, zone_from_m, zone_to_m))
    EXPECT_NEAR(wave.lowest_behind_m_per_s, 2 * bump(70e-3, 80e-3), 0.05);
}

TEST(Circle, ADarkWaveIsNone) {
  const auto plate = make_plate();
  for (const auto& wave : waves_on_rays({snapshot_of(plate, [](double r) { return 0.99 * bump(r, 80e-3); })},
                                        plate, zone_from_m, zone_to_m)) {
    EXPECT_TRUE(std::isnan(wave.peak_m_per_s));
    EXPECT_TRUE(std::isnan(wave.distance_m));
  }
}

TEST(Circle, SnapshotsAreThoseWhileTheTipIsBetweenTwoPlaces) {
  Outcome left = make_left(linear(1, 0));  // c_L from 8 mm on
  const double c_L = left.speeds.c_L;
  const auto times_s = wave_times_s(left);
  ASSERT_FALSE(times_s.empty());
  for (const double t : times_s) {
    const double tip_m = contact_from_m + c_L * t;
    EXPECT_GE(tip_m, tip_from_m - 1e-9);
    EXPECT_LE(tip_m, tip_to_m + 1e-9);
    EXPECT_NEAR(t, std::round(t / 5e-6) * 5e-6, 1e-15);
  }
  EXPECT_EQ(times_s.size(), 9U);  // 32.8 to 77.0 us
  left.fronts.clear();
  EXPECT_TRUE(wave_times_s(left).empty());
}

TEST(Circle, FourOfFiveSnapshotsAreEnough) {
  const auto circle_with = [](int n_spoilt) {
    Outcome left = make_left(linear(1, 0));
    for (int k = 0; k < n_spoilt; ++k) left.waves[2 * static_cast<std::size_t>(k)].distance_m = nan;
    return circle(left);
  };
  const auto whole = circle_with(0);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->n_snapshots, 9);
  EXPECT_EQ(whole->n_apart, 9);
  EXPECT_DOUBLE_EQ(whole->peak_m_per_s, 2);
  EXPECT_DOUBLE_EQ(whole->gap, 0.25);
  EXPECT_DOUBLE_EQ(whole->over_c_L_t, 0.95);
  EXPECT_TRUE(circle_with(1)->holds());
  EXPECT_EQ(circle_with(2)->n_apart, 7);  // 78 %
  EXPECT_FALSE(circle_with(2)->holds());
}

TEST(Circle, WithoutASnapshotThatIsWantedThereIsNoVerdict) {
  Outcome left = make_left(linear(1, 0));
  std::erase_if(left.waves, [](const WaveOnRay& wave) { return std::abs(wave.time_s - 50e-6) < 1e-9; });
  EXPECT_FALSE(circle(left));
  left.waves.clear();
  EXPECT_FALSE(circle(left));
}

}  // namespace
}  // namespace slipfront::kammer2012
