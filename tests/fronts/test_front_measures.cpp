// SPDX-License-Identifier: BSD-3-Clause
// What is measured at the points of a front.
#include <gtest/gtest.h>

#include "fronts/measures.hpp"
#include "synthetic.hpp"

namespace slipfront::fronts::testing {
namespace {

const std::vector<double> x = nodes(301, h);

/// The one front from the left end, or whose onsets these are.
Front front_of(const std::vector<double>& tau = bilateral(x, 0.0, V), const Recipe& recipe = {},
               const FrontOptions& options = make_options()) {
  return find(make_record(x, tau, recipe), options).at(0);
}

/// Constant speed from a nucleation in the middle, whatever the mesh and l*: the answer is exact, as tau is
/// linear.
void expect_constant_speed(int n, double spacing_m, double l_star_m) {
  const auto places = nodes(n, spacing_m);
  const auto fronts = find(make_record(places, bilateral(places, places[n / 2], V)), make_options(l_star_m));
  ASSERT_EQ(fronts.size(), 2u);
  const double half_m = 0.5 * std::max(l_star_m, spacing_m) * (1 - 1e-9);
  for (const Front& front : fronts) {
    for (const FrontPoint& point : front.points) {
      const bool inside = std::abs(point.x_m - front.points.front().x_m) >= half_m &&
                          std::abs(point.x_m - front.points.back().x_m) >= half_m;
      ASSERT_EQ(std::isfinite(point.v_tip_m_per_s), inside) << point.x_m;
      if (inside) {
        EXPECT_NEAR(point.v_tip_m_per_s, V, 1e-9 * V);  // rounding
      }
    }
  }
}

TEST(TipSpeed, ConstantSpeedIsExact) {
  expect_constant_speed(301, h, 0.67e-3);
  expect_constant_speed(301, h, 1.15e-3);  // no multiple of the spacing
  expect_constant_speed(601, 0.2 / 600, 0.67e-3);
  expect_constant_speed(101, 2e-3, 0.67e-3);  // one element
}

constexpr double V0 = 500.0, rise_per_s = 1e4;

/// When a front is at x whose speed is V0 + rise_per_s x.
double accelerating(double x_m) {
  return std::log(1 + rise_per_s * x_m / V0) / rise_per_s;
}

TEST(TipSpeed, AcceleratingFront) {
  std::vector<double> tau, reversed;
  for (const double place : x) {
    tau.push_back(accelerating(place));
    reversed.push_back(accelerating(x.back()) - accelerating(x.back() - place));
  }
  const auto front = front_of(tau);
  for (std::size_t i = 1; i + 1 < front.points.size(); ++i) {
    const double speed = V0 + rise_per_s * x[i];
    // Linear interpolation of tau is off by up to h^2/8 |tau''| = h^2/8 k/V^2, k the rise, at each end of l*,
    // here taken as h; the mean over l* instead of the value at x adds an order less. The speed at the near
    // end is the lowest.
    const double slowest = speed - rise_per_s * h;
    EXPECT_NEAR(front.points[i].v_tip_m_per_s / speed, 1.0, 2 * h / 8 * rise_per_s / slowest);
    EXPECT_TRUE(front.points[i].accelerating);
  }
  // The same path run backwards slows down.
  for (const FrontPoint& point : front_of(reversed).points) EXPECT_FALSE(point.accelerating);
}

TEST(TipSpeed, AccelerationIsSmoothed) {
  std::vector<double> tau;
  // Onsets late and early by 2 % of a node's time in turn, which alternates the speed by 4 % about a rise
  // of 1.3 % a node at the slow end.
  for (const double place : x)
    tau.push_back(accelerating(place) + (tau.size() % 2 == 0 ? 0.02 : -0.02) * h / (V0 + rise_per_s * place));
  for (const FrontPoint& point : front_of(tau).points) EXPECT_TRUE(point.accelerating);
}

TEST(TipSpeed, MayBeThatOfTheApproach) {
  // Each element at a separate speed, from the right: the speed at a node is that of the element behind the
  // tip.
  const auto places = nodes(31, h);
  std::vector<double> tau(places.size(), 0);
  const auto speed_m_per_s = [](std::size_t element) {
    return 500.0 + 20.0 * static_cast<double>(element % 7);
  };
  for (std::size_t k = places.size() - 1; k-- > 0;) tau[k] = tau[k + 1] + h / speed_m_per_s(k);
  const auto record = make_record(places, tau);
  auto options = make_options(h);
  options.speed_interval = SpeedInterval::approach;
  const auto front = find(record, options).at(0), centred = find(record, make_options(h)).at(0);
  ASSERT_EQ(front.points.size(), places.size());
  EXPECT_TRUE(std::isnan(front.points[0].v_tip_m_per_s));
  for (std::size_t k = 1; k < front.points.size(); ++k)
    EXPECT_NEAR(front.points[k].v_tip_m_per_s, speed_m_per_s(places.size() - 1 - k), 1e-6) << k;
  EXPECT_NE(centred.points[5].v_tip_m_per_s, front.points[5].v_tip_m_per_s);
}

TEST(TipSpeed, WhereTheTipJumps) {
  auto tau = bilateral(x, 0.0, V);
  tau[102] = tau[100] + 0.01e-6;  // the tip jumps from node 100 to 102; node 101 slips in its own time
  const auto points = [&] { return front_of(tau, {}, make_options(h)).points; };
  const auto jumping = points();
  ASSERT_EQ(jumping.size(), 301u);
  for (const FrontPoint& point : jumping) EXPECT_FALSE(point.v_tip_m_per_s <= 0.0);
  // From half-way between 100 and 101 to half-way between 101 and 102 it needs half of 0.01 us.
  EXPECT_NEAR(jumping[101].v_tip_m_per_s, h / 0.005e-6, 1e-6 * h / 0.005e-6);
  EXPECT_TRUE(std::isfinite(jumping[101].t_d_Pa));
  EXPECT_TRUE(std::isnan(jumping[102].t_d_Pa));  // it is never l* before node 102
  EXPECT_TRUE(std::isfinite(jumping[103].t_d_Pa));

  tau = bilateral(x, 0.0, V);
  tau[101] = tau[102];  // no time between them
  EXPECT_TRUE(std::isfinite(points()[101].v_tip_m_per_s));
  tau[100] = tau[101] = tau[102];
  EXPECT_TRUE(std::isnan(points()[101].v_tip_m_per_s));
}

TEST(TipSpeed, IsUndefinedWhereTheTimeIsNotResolved) {
  auto tau = bilateral(x, 0.0, V);
  tau[101] = tau[100] + 1e-12;
  tau[102] = tau[101] + 1e-12;
  for (int k = 103; k < 301; ++k) tau[k] = tau[102] + (x[k] - x[102]) / V;
  auto options = make_options(h);
  auto record = make_record(x, tau);
  const auto speeds = [&] { return find(record, options).at(0).points; };
  EXPECT_NEAR(speeds()[101].v_tip_m_per_s, h / 1e-12, 1e-3 * h / 1e-12);
  for (const double resolution_s : {1e-11, 0.9 * h / V}) {
    record.resolution_s = resolution_s;
    for (int k = 1; k < 300; ++k) EXPECT_EQ(std::isnan(speeds()[k].v_tip_m_per_s), k == 101) << k;
  }
  // Over several elements: the nodes around the length are what counts, also where they end it.
  options.l_star_m = 2 * h;
  for (int k = 2; k < 299; ++k) EXPECT_EQ(std::isnan(speeds()[k].v_tip_m_per_s), k == 101) << k;
  record.resolution_s = 1.9 * h / V;
  EXPECT_FALSE(std::isnan(speeds()[50].v_tip_m_per_s));
  record.resolution_s = 2.1 * h / V;
  EXPECT_TRUE(std::isnan(speeds()[50].v_tip_m_per_s));
}

TEST(TipSpeed, IsUndefinedWhereNothingIsPassedOn) {
  // Slip passed on over n elements, one in a resolution's time, takes more than n - 1 of these times.
  auto record = make_record(x, bilateral(x, 0.0, V));
  for (const int n : {4, 10})
    for (const double share : {0.999, 1.001}) {
      record.resolution_s = share * n / (n - 1) * h / V;
      EXPECT_EQ(find(record, make_options(n * h)).at(0).points[50].speed_kind,
                share < 1 ? SpeedKind::front : SpeedKind::simultaneous)
          << n;
    }
}

TEST(TipSpeed, HasItsKind) {
  auto tau = bilateral(x, 0.0, V);
  tau[201] = tau[202] = tau[200];
  auto record = make_record(x, tau);
  record.resolution_s = 1e-9;
  auto options = make_options(h);
  options.driven = {{x[0], x[20]}};
  const auto points = find(record, options).at(0).points;
  EXPECT_EQ(points[0].speed_kind, SpeedKind::triggered);
  EXPECT_EQ(points[21].speed_kind, SpeedKind::triggered);  // its length begins behind node 20
  EXPECT_EQ(points[22].speed_kind, SpeedKind::front);
  EXPECT_EQ(points[201].speed_kind, SpeedKind::simultaneous);
  EXPECT_EQ(points[300].speed_kind, SpeedKind::path_end);
  for (const auto& point : points)
    EXPECT_EQ(std::isnan(point.v_tip_m_per_s), point.speed_kind != SpeedKind::front) << point.node;
  options.speed_interval = SpeedInterval::approach;
  const auto behind = find(record, options).at(0).points;
  EXPECT_EQ(behind[21].speed_kind, SpeedKind::triggered);
  EXPECT_EQ(behind[22].speed_kind, SpeedKind::front);
  EXPECT_EQ(behind[300].speed_kind, SpeedKind::front);
}

TEST(TipSpeed, IsUndefinedWhereTheTriggerDrives) {
  // Zones whose ends are nodes, which belong to them; the length at the nodes beside them begins within.
  auto options = make_options();
  options.driven = {{x[10], x[30]}, {x[100], x[110]}};
  const auto before = front_of(), after = front_of(bilateral(x, 0.0, V), {}, options);
  for (int k = 0; k < 301; ++k) {
    const bool inside = (k >= 9 && k <= 31) || (k >= 99 && k <= 111);
    const double v = after.points[k].v_tip_m_per_s, v_before = before.points[k].v_tip_m_per_s;
    EXPECT_TRUE(inside || std::isnan(v_before) ? std::isnan(v) : v == v_before) << k;
  }
}

/// Tractions linear in the distance of a front that runs to +x from x = 0: t_d and p_d are exact.
record::Traction ahead_of_tip(double x_m, double time_s) {
  const double distance_m = x_m - V * time_s;
  return {5.2e6 - 1e9 * distance_m, 4e6 + 0.5e9 * distance_m};
}

TEST(TipTractions, LinearInTipPosition) {
  constexpr double l_star_m = 1.15e-3;
  const auto front = front_of(bilateral(x, 0.0, V), {.traction = ahead_of_tip}, make_options(l_star_m));
  for (const FrontPoint& point : front.points) {
    const double rounding_Pa = 1e-3;  // of values of 1e6
    EXPECT_NEAR(point.t_r_Pa, 5.2e6, rounding_Pa);
    EXPECT_NEAR(point.p_r_Pa, 4e6, rounding_Pa);
    EXPECT_EQ(point.t_s_Pa, 4e6);
    EXPECT_EQ(point.p_s_Pa, 5e6);
    if (point.x_m <= l_star_m) {
      EXPECT_TRUE(std::isnan(point.t_d_Pa) && std::isnan(point.p_d_Pa));
      EXPECT_TRUE(std::isnan(point.U_s_J_per_m3) && std::isnan(point.U_r_J_per_m3));
      continue;
    }
    const double t_d_Pa = 5.2e6 - 1e9 * l_star_m, p_d_Pa = 4e6 + 0.5e9 * l_star_m;
    EXPECT_NEAR(point.t_d_Pa, t_d_Pa, rounding_Pa);
    EXPECT_NEAR(point.p_d_Pa, p_d_Pa, rounding_Pa);
    const double U_s = (2 * 1.37 * t_d_Pa * t_d_Pa + p_d_Pa * p_d_Pa) / 5.2e9;
    const double U_r = (2 * 1.37 * 5.2e6 * 5.2e6 + 4e6 * 4e6) / 5.2e9;
    EXPECT_NEAR(point.U_s_J_per_m3, U_s, 1e-9 * U_s);
    EXPECT_NEAR(point.U_r_J_per_m3, U_r, 1e-9 * U_r);
  }
}

TEST(TipTractions, RoundedLStarIsOneElement) {
  // l* = 0.67 mm on elements of 0.6667 mm, tractions of the next node only.
  const auto front = front_of(bilateral(x, 0.0, V), {.halo = 1, .traction = ahead_of_tip});
  EXPECT_TRUE(std::isnan(front.points[1].t_d_Pa));
  for (std::size_t k = 2; k < front.points.size(); ++k)
    EXPECT_NEAR(front.points[k].t_d_Pa, 5.2e6 - 1e9 * h, 1e-3);  // rounding of values of 1e6
}

TEST(TipTractions, LeftGoingFront) {
  const auto traction = [](double x_m, double time_s) { return ahead_of_tip(x.back() - x_m, time_s); };
  const auto front = front_of(bilateral(x, x.back(), V), {.traction = traction}, make_options(1e-3));
  ASSERT_EQ(front.direction, -1);
  for (std::size_t k = 2; k < front.points.size(); ++k)
    EXPECT_NEAR(front.points[k].t_d_Pa, 5.2e6 - 1e9 * 1e-3, 1e-3);
}

TEST(TipTractions, HaloTooSmall) {
  // l* lies between the second and the first node before.
  const auto front = front_of(bilateral(x, 0.0, V), {.halo = 1}, make_options(1.15e-3));
  for (const FrontPoint& point : front.points)
    EXPECT_TRUE(std::isnan(point.t_d_Pa) && std::isnan(point.U_s_J_per_m3));
  EXPECT_TRUE(std::isfinite(front.points[10].t_r_Pa));
}

TEST(TipTractions, ExcludedZones) {
  FrontOptions options = make_options();
  options.exclude_left_m = 20.1e-3;
  options.exclude_right_m = 180.1e-3;
  for (const FrontPoint& point : front_of(bilateral(x, 0.0, V), {}, options).points) {
    const bool inside = point.x_m > 20.1e-3 && point.x_m < 180.1e-3;
    EXPECT_EQ(std::isfinite(point.t_d_Pa), inside);
    EXPECT_EQ(std::isfinite(point.U_s_J_per_m3), inside);
    EXPECT_EQ(std::isfinite(point.U_r_J_per_m3), inside);
    EXPECT_TRUE(std::isfinite(point.t_r_Pa));
  }
}

TEST(EnergyDensity, PlaneStressAndPlaneStrain) {
  // (2 * 1.37 * 4 + 9) * 1e12 / 5.2e9
  EXPECT_NEAR(energy_density_J_per_m3({2e6, 3e6}, {2.6e9, 0.37, false}), 19.96e12 / 5.2e9, 1e-9);
  // 9 becomes (1 - 0.1369) * 9 = 7.7679
  EXPECT_NEAR(energy_density_J_per_m3({-2e6, 3e6}, {2.6e9, 0.37, true}), 18.7279e12 / 5.2e9, 1e-9);
}

/// A node is 5.1 us from onset to stop: at speed V the 7 nodes behind the tip slip, 4.67 mm.
double pulse(double) {
  return 5.1e-6;
}

TEST(SlippingShare, TellsCracksFromPulses) {
  const auto crack = [](double) { return never; };
  const auto both = [](double x_m) { return x_m < 0.1 ? 150e-6 : pulse(x_m); };
  const struct {
    std::function<double(double)> duration_s;
    SlipMode mode;
    int last_of_crack, first_of_pulse;
  } cases[] = {{crack, SlipMode::crack, 300, 301},
               {pulse, SlipMode::pulse, -1, 20},  // below 0.2 from x = 23.3 mm on, 88 % of the path
               {both, SlipMode::mixed, 140, 290}};
  for (const auto& c : cases) {
    const auto front = front_of(bilateral(x, 0.0, V), {.duration_s = c.duration_s});
    EXPECT_EQ(front.mode, c.mode);
    for (int k = 0; k < 301; ++k) {
      const double share = front.points[k].slipping_share;
      if (x[k] < 5 * 0.67e-3) {
        EXPECT_TRUE(std::isnan(share));
      } else if (k <= c.last_of_crack) {
        EXPECT_DOUBLE_EQ(share, 1.0);
      } else if (k >= c.first_of_pulse) {
        EXPECT_NEAR(share, 7 * h / x[k], 1e-12);
      }
    }
  }
}

TEST(SlippingShare, ZoneIsContiguousButForShortGaps) {
  const auto with_sticking = [&](int first, int last) {
    const auto duration_s = [=](double x_m) {
      return x_m > x[first] - 0.1 * h && x_m < x[last] + 0.1 * h ? 0.5e-6 : never;
    };
    return front_of(bilateral(x, 0.0, V), {.duration_s = duration_s}).points[200].slipping_share;
  };
  EXPECT_DOUBLE_EQ(with_sticking(100, 100), 1.0);
  EXPECT_NEAR(with_sticking(100, 102), 97 * h / x[200], 1e-12);
}

/// A pulse from the left end, and all nodes up to one slip again.
std::vector<FrontPoint> pulse_and_slip_again(int last, double time_s) {
  auto record = make_record(x, bilateral(x, 0.0, V), {.halo = 0, .duration_s = pulse});
  for (int k = 0; k <= last; ++k) {
    record.onsets.push_back({k, time_s});
    record.around.push_back({4e6, 5e6});
  }
  std::ranges::stable_sort(record.onsets, {}, &record::Onset::time_s);
  return find(record).at(0).points;
}

TEST(SlippingShare, SlipAgain) {
  const auto points = pulse_and_slip_again(150, 110e-6);
  ASSERT_EQ(points.size(), 301u);
  // At 109 us; then 151 to 158 stick, and 150 to 283.
  for (const int k : {164, 290}) EXPECT_NEAR(points[k].slipping_share, 7 * h / x[k], 1e-12);
  EXPECT_DOUBLE_EQ(points[166].slipping_share, 7 * h / x[166]);
  // Once the front is at node 165, in contact with its slipping zone.
  EXPECT_DOUBLE_EQ(pulse_and_slip_again(160, 110.01e-6)[166].slipping_share, 1.0);
}

TEST(LocalSlopes, WindowReachesHalfWidth) {
  // |s| by hand: at s = 1 with half-width 2 the points -1 ... 3 have y = 1 0 1 2 3, slope (2*3 + 1*2 - 2)/10.
  std::vector<double> s, y;
  for (int k = -10; k <= 10; ++k) {
    s.push_back(k);
    y.push_back(std::abs(k));
  }
  const auto slopes = local_slopes(s, y, 2.0, 1);
  EXPECT_NEAR(slopes[11], 0.6, 1e-12);
  EXPECT_NEAR(slopes[10], 0.0, 1e-12);
  EXPECT_NEAR(slopes[20], 1.0, 1e-12);
}

TEST(LocalSlopes, OfManyPointsAreAsOfFew) {
  // A parabola away from zero: at equal distances the least-squares slope is that of its middle.
  std::vector<double> s, y;
  for (int k = 0; k <= 4000; ++k) {
    s.push_back(10.0 + 1e-3 * k);
    y.push_back(s.back() * s.back());
  }
  const auto few = local_slopes(s, y, 0.1, 1), many = local_slopes(s, y, 0.5, 1);
  for (const int k : {500, 2000, 3500}) {
    EXPECT_NEAR(few[k], 2 * s[k], 1e-9);
    EXPECT_NEAR(many[k], 2 * s[k], 1e-9);
  }
}

/// Speed rises to 60 mm, falls after it; the ratio falls to 50 mm, rises up to `turn_m` and falls again.
struct Curves {
  std::vector<double> s, speed, ratio;
};
Curves curves(double turn_m, double noise) {
  Curves c;
  for (int k = 0; k < 301; ++k) {
    const double s = k * h;
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    c.s.push_back(s);
    c.speed.push_back(1000.0 - 1e4 * std::abs(s - 0.06) + sign * noise * 1000.0);
    c.ratio.push_back(1.0 + (s < turn_m ? std::abs(s - 0.05) : turn_m - 0.05 - (s - turn_m)) - sign * noise);
  }
  return c;
}

TEST(Stretches, FallWhileTheOtherRises) {
  for (const double noise :
       {0.0, 1e-3}) {  // noise alternates by 2e-3, three times the change over one element
    const auto c = curves(0.07, noise);
    const auto found = find_stretches(c.s, c.speed, c.ratio);
    ASSERT_EQ(found.size(), 1u);
    // Slopes over +-2 mm of a symmetric peak change sign at the peak itself, to one element.
    EXPECT_NEAR(c.s[found[0].first], 0.06, 1.01 * h);
    EXPECT_NEAR(c.s[found[0].last], 0.07, 1.01 * h);
    EXPECT_NEAR(found[0].length_m, 0.01, 2.02 * h);
    EXPECT_NEAR(found[0].rise, 0.01, 2.02 * h + 2 * noise);
    EXPECT_NEAR(found[0].fall, 100.0, 1e4 * 2.02 * h + 2e3 * noise);
  }
  const auto short_one = curves(0.063, 0.0);
  EXPECT_TRUE(find_stretches(short_one.s, short_one.speed, short_one.ratio).empty());
  EXPECT_EQ(find_stretches(short_one.s, short_one.speed, short_one.ratio, {.min_length_m = 2e-3}).size(), 1u);
}

TEST(Stretches, UndefinedPoints) {
  auto c = curves(0.09, 0.0);
  c.speed[110] = c.ratio[111] = nan;
  EXPECT_EQ(find_stretches(c.s, c.speed, c.ratio).size(), 1u);
  c.speed[112] = nan;
  const auto found = find_stretches(c.s, c.speed, c.ratio);  // cut at 73 mm into 13 and 15 mm
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].last, 109u);
  EXPECT_EQ(found[1].first, 113u);
  EXPECT_TRUE(find_stretches({}, {}, {}).empty());
}

}  // namespace
}  // namespace slipfront::fronts::testing
