// SPDX-License-Identifier: BSD-3-Clause
#include "base/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace slipfront {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// All scales of x for which exp(-x) is a normal number, and the places where k, the nearest multiple of
/// ln 2, changes.
std::vector<double> arguments() {
  std::vector<double> x = {0.0, 0x1p-1074, 0x1p-1022, 1e-300, 1e-17, 0x1p-53, 0x1p-52, 707.9999999999999};
  for (int k = 0; k < 1021; ++k) {
    const double edge = (k + 0.5) * std::log(2.0);
    for (const double ulps : {-2, -1, 0, 1, 2}) x.push_back(edge + ulps * 0x1p-52 * edge);
    x.push_back(k * std::log(2.0));
  }
  std::mt19937_64 random(1);
  for (const double top : {1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 708.0}) {
    std::uniform_real_distribution<double> within(0, top);
    for (int k = 0; k < 100000; ++k) x.push_back(within(random));
  }
  return x;
}

/// Distance in units in the last place of a double of the exact value's size.
double ulps(double value, long double exact) {
  const int exponent = std::ilogb(static_cast<double>(exact));
  return static_cast<double>(std::abs(value - exact) / std::ldexp(1.0L, exponent - 52));
}

TEST(Decay, IsExactToAboutOneUnitInTheLastPlace) {
  double left_worst = 0, lost_worst = 0;
  for (const double x : arguments()) {
    if (!(x < 708)) continue;
    const auto [left, lost] = decay(x);
    left_worst = std::max(left_worst, ulps(left, std::exp(-static_cast<long double>(x))));
    if (x >= 0x1p-1022)
      lost_worst = std::max(lost_worst, ulps(lost, -std::expm1(-static_cast<long double>(x))));
  }
  // Half a unit by the last sum; the roundings of r and q before it, half a unit of q each and some less of
  // its terms, are at most as much in units of the result.
  EXPECT_LT(left_worst, 1.5);
  EXPECT_LT(lost_worst, 1.5);
}

TEST(Decay, IsExactAtTheEndsOfItsRange) {
  EXPECT_EQ(decay(0.0).left, 1);
  EXPECT_EQ(decay(0.0).lost, 0);
  EXPECT_EQ(decay(0x1p-1074).left, 1);
  EXPECT_EQ(decay(0x1p-1074).lost, 0x1p-1074);
  for (const double x : {708.0, 709.0, 745.0, 746.0, 1e4, 1e15, 0x1p52, 1e300, infinite}) {
    EXPECT_EQ(decay(x).left, 0) << x;
    EXPECT_EQ(decay(x).lost, 1) << x;
  }
  EXPECT_GT(decay(std::nextafter(708.0, 0.0)).left, std::numeric_limits<double>::min());
  EXPECT_TRUE(std::isnan(decay(std::nan("")).left));
  EXPECT_TRUE(std::isnan(decay(std::nan("")).lost));
}

TEST(Decay, OfLanesIsThatOfDoublesBitByBit) {
  auto x = arguments();
  for (const double special : {708.0, 1e300, infinite, std::nan("")}) x.push_back(special);
  while (x.size() % lanes != 0) x.push_back(1);
  for (std::size_t i = 0; i < x.size(); i += lanes) {
    const auto [left, lost] = decay(load(&x[i]));
    for (int k = 0; k < lanes; ++k) {
      const auto one = decay(x[i + k]);
      ASSERT_EQ(bits_of(left[k]), bits_of(one.left)) << x[i + k];
      ASSERT_EQ(bits_of(lost[k]), bits_of(one.lost)) << x[i + k];
    }
    ASSERT_EQ(bits_of(exp_minus(load(&x[i]))[0]), bits_of(exp_minus(x[i])));
  }
}

}  // namespace
}  // namespace slipfront
