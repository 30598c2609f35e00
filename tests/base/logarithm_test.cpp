// SPDX-License-Identifier: BSD-3-Clause
#include "base/logarithm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace slipfront {
namespace {

/// All scales of normal numbers, those next to 1, and where the exponent taken out changes.
std::vector<double> arguments() {
  std::vector<double> x = {0x1p-1022, 0x1.fffffffffffffp1023, 1, 1 - 0x1p-53, 1 + 0x1p-52};
  for (const double edge : {std::sqrt(0.5), 1.0, std::sqrt(2.0)})
    for (int k = -1000; k < 1000; ++k)
      for (const int ulps : {-1, 0, 1}) x.push_back(std::ldexp(edge * (1 + ulps * 0x1p-52), k));
  std::mt19937_64 random(1);
  for (const double spread : {1e-9, 1e-3, 0.4}) {
    std::uniform_real_distribution<double> about_1(1 - spread, 1 + spread);
    for (int k = 0; k < 100000; ++k) x.push_back(about_1(random));
  }
  std::uniform_real_distribution<double> power(-700, 700);
  for (int k = 0; k < 100000; ++k) x.push_back(std::exp(power(random)));
  return x;
}

TEST(Logarithm, IsExactToTwoUnitsInTheLastPlace) {
  double worst = 0;
  for (const double x : arguments()) {
    const long double exact = std::log(static_cast<long double>(x));
    const int exponent = exact == 0 ? -1074 + 52 : std::ilogb(static_cast<double>(exact));
    worst = std::max(worst,
                     static_cast<double>(std::abs(logarithm(x) - exact) / std::ldexp(1.0L, exponent - 52)));
  }
  EXPECT_LT(worst, 2);
  EXPECT_EQ(logarithm(1.0), 0);
}

TEST(Logarithm, OfLanesIsThatOfDoubles) {
  const auto x = arguments();
  for (std::size_t i = 0; i + lanes <= x.size(); i += lanes) {
    const SimdVector together = logarithm(load(x.data() + i));
    for (int k = 0; k < lanes; ++k) ASSERT_EQ(bits_of(together[k]), bits_of(logarithm(x[i + k])));
  }
}

}  // namespace
}  // namespace slipfront
