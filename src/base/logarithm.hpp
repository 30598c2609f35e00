// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/lanes.hpp"

namespace slipfront {

/// ln x to within 2 units in its last place, of normal numbers x > 0, for a double and for SimdVector bit by
/// bit alike.
///
/// x = 2^e m with m from 1/sqrt(2) to sqrt(2), ln m = 2 artanh(s), s = (m - 1)/(m + 1), |s| < 0.172; the
/// first term left out of the series of artanh, s^25/25, is below 1e-17 of its first one.
template <class V>
inline V logarithm(V x) {
  constexpr std::uint64_t sqrt_half = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000;
  const auto exponent = (bits_of(x) + (one - sqrt_half)) >> 52;  // e + 1023
  const V m = from_bits(bits_of(x) - ((exponent - 1023) << 52));
  // Below 2^52 the lowest bits of 2^52 + n are n.
  const V e = from_bits(exponent | 0x4330000000000000) - (0x1p52 + 1023);
  const V s = (m - 1) / (m + 1);
  const V z = s * s, z2 = z * z, z4 = z2 * z2;
  const V terms_1_to_4 = (1.0 / 3 + z * (1.0 / 5)) + z2 * (1.0 / 7 + z * (1.0 / 9));
  const V terms_5_to_8 = (1.0 / 11 + z * (1.0 / 13)) + z2 * (1.0 / 15 + z * (1.0 / 17));
  const V terms_9_to_11 = (1.0 / 19 + z * (1.0 / 21)) + z2 * (1.0 / 23);
  const V series = z * (terms_1_to_4 + z4 * (terms_5_to_8 + z4 * terms_9_to_11));
  // ln 2 in two parts, the first of 32 bits: e times it is exact.
  return e * 0x1.62e42feep-1 + (2 * s + (2 * s * series + e * 0x1.a39ef35793c76p-33));
}

}  // namespace slipfront
