// SPDX-License-Identifier: BSD-3-Clause
#include "base/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace slipfront {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
const double special[] = {0.0,     -0.0,         1.5,           -2.5,     1e300,
                          -1e-310, std::nan(""), -std::nan(""), infinite, -infinite};

/// Calls f(a, b, lanes of a, lanes of b, k) for all pairs of special values, in each lane k.
template <class F>
void for_each_pair(F&& f) {
  for (const double a : special)
    for (const double b : special)
      for (int k = 0; k < lanes; ++k) {
        SimdVector many_a = SimdVector{} + 7, many_b = SimdVector{} - 3;
        many_a[k] = a;
        many_b[k] = b;
        f(a, b, many_a, many_b, k);
      }
}

TEST(SimdVector, FunctionsAreThoseOfDoublesBitByBit) {
  EXPECT_EQ(positive_part(std::nan("")), 0);
  EXPECT_EQ(positive_part(-1.0), 0);
  EXPECT_EQ(positive_part(2.0), 2);
  for_each_pair([](double a, double b, SimdVector many_a, SimdVector many_b, int k) {
    EXPECT_EQ(bits_of(absolute(many_a)[k]), bits_of(absolute(a)));
    EXPECT_EQ(bits_of(copy_sign(many_a, many_b)[k]), bits_of(copy_sign(a, b)));
    EXPECT_EQ(bits_of(positive_part(many_a)[k]), bits_of(positive_part(a)));
    EXPECT_EQ(bits_of(select(many_a < many_b, many_a, many_b)[k]), bits_of(select(a < b, a, b)));
    EXPECT_EQ(bits_of(select(!(many_a <= many_b), many_a, many_b)[k]), bits_of(select(!(a <= b), a, b)));
    EXPECT_EQ((many_a < many_b && many_b > 0)[k] != 0, a < b && b > 0);
    EXPECT_EQ((many_a != many_b || many_b > 0)[k] != 0, a != b || b > 0);
  });
}

TEST(SimdVector, AnySeesEachLane) {
  EXPECT_FALSE(any(SimdMask{}));
  for (int k = 0; k < lanes; ++k) {
    SimdVector one{};
    one[k] = 1;
    EXPECT_TRUE(any(one > 0)) << k;
  }
  EXPECT_TRUE(any(true));
  EXPECT_FALSE(any(false));
}

/// 1, 2, 3 ... from `first` on.
template <class V>
V counting(int first) {
  V values{};
  for (int k = 0; k < length<V>; ++k) values[k] = static_cast<float>(first + k);
  return values;
}

template <class Real>
class LanesOfEach : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(LanesOfEach, Precisions);

TYPED_TEST(LanesOfEach, AreLoadedAndStoredInEitherPrecision) {
  using V = SimdVectorOf<TypeParam>;
  constexpr int n = length<V>;
  static_assert(n == lanes_of<TypeParam> && n * sizeof(TypeParam) == vector_bytes);
  const auto check = [](auto number) {
    std::vector<decltype(number)> from(3 * n), to(3 * n);
    for (int i = 0; i < 3 * n; ++i) from[i] = static_cast<float>(i + 1);
    for (int begin = 0; begin <= n; ++begin) {
      std::ranges::fill(to, number);
      store(&to[begin], load_as<V>(&from[begin]));
      for (int i = 0; i < 3 * n; ++i) EXPECT_EQ(to[i], i >= begin && i < begin + n ? from[i] : number);
    }
    store(to.data(), load_as<TypeParam>(&from[1]));
    EXPECT_EQ(to[0], from[1]);
  };
  check(-1.0F);
  check(-1.0);
}

TYPED_TEST(LanesOfEach, AreShiftedAndInterleaved) {
  using V = SimdVectorOf<TypeParam>;
  constexpr int n = length<V>;
  const auto first = counting<V>(1), second = counting<V>(1 + n);
  const auto left = from_left(first, second), right = from_right(first, second);
  const auto [low, high] = interleaved(first, second);
  for (int k = 0; k < n; ++k) {
    EXPECT_EQ(left[k], n + k);
    EXPECT_EQ(right[k], 2 + k);
    EXPECT_EQ(low[k], k / 2 + 1 + (k % 2) * n);
    EXPECT_EQ(high[k], (n + k) / 2 + 1 + (k % 2) * n);
  }
  EXPECT_EQ(from_left(TypeParam(1), TypeParam(2)), 1);
  EXPECT_EQ(from_right(TypeParam(2), TypeParam(3)), 3);
}

TEST(SimdVector, PartsRepeatTheirLastValueAndLeaveTheRestAlone) {
  for (int count = 1; count < lanes; ++count) {
    // Just as long as needed, so that a read or write beyond the end shows under the sanitizers.
    std::vector<double> from(count), to(count, -1.0);
    std::vector<std::uint8_t> flags(count), flags_to(count, 9);
    for (int k = 0; k < count; ++k) {
      from[k] = k + 1;
      flags[k] = static_cast<std::uint8_t>((count - k) % 2);
    }
    const SimdVector values = load_partial(from.data(), count);
    const SimdMask mask = load_partial(flags.data(), count);
    for (int k = 0; k < lanes; ++k) {
      EXPECT_EQ(values[k], std::min(k + 1, count));
      EXPECT_EQ(mask[k], flags[std::min(k, count - 1)] != 0 ? -1 : 0);
    }
    store_partial(to.data(), values, count);
    store_partial(flags_to.data(), mask, count);
    EXPECT_EQ(to, from);
    EXPECT_EQ(flags_to, flags);
    std::vector<double> longer(lanes, -1.0);
    store_partial(longer.data(), values, count);
    for (int k = 0; k < lanes; ++k) EXPECT_EQ(longer[k], k < count ? k + 1 : -1);
  }
}

TEST(SimdVector, FlagsBecomeMasksAndBack) {
  for (int set = 0; set < lanes; ++set) {
    std::vector<std::uint8_t> flags(lanes), back(lanes, 9);
    flags[set] = 1;
    const SimdMask mask = load(flags.data());
    for (int k = 0; k < lanes; ++k) EXPECT_EQ(mask[k], k == set ? -1 : 0);
    store(back.data(), mask);
    EXPECT_EQ(back, flags);
  }
}

}  // namespace
}  // namespace slipfront
