// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/lanes.hpp"

namespace slipfront {

/// exp(-x) and 1 - exp(-x), each to within 1.5 units in its last place.
template <class V>
struct Decay {
  V left, lost;
};

/// exp(-x) of x >= 0, for a double and for SimdVector bit by bit alike. exp(-x) is 0 from x = 708 on, where
/// it nears the smallest normal number, 2.2e-308.
///
/// x = k ln 2 - r with |r| <= ln 2 / 2, so that exp(-x) = 2^-k (1 + q), q = exp(r) - 1 = r + r^2/2! + ... +
/// r^13/13!; the next term is below 5e-18.
template <class V>
inline Decay<V> decay(V x) {
  // Adding 1.5 * 2^52 rounds to a whole number, which then stands in the lowest bits.
  constexpr double shift = 0x1.8p52;
  const V shifted = x * 1.4426950408889634 + shift;
  const V k = shifted - shift;
  // ln 2 in two parts, the first of 32 bits: k times it is exact.
  const V r = (k * 0x1.62e42feep-1 - x) + k * 0x1.a39ef35793c76p-33;
  const V scale = from_bits((1023 - bits_of(shifted)) << 52);  // 2^-k

  const V r2 = r * r, r4 = r2 * r2;
  const V terms_2_to_5 = (1.0 / 2 + r * (1.0 / 6)) + r2 * (1.0 / 24 + r * (1.0 / 120));
  const V terms_6_to_9 = (1.0 / 720 + r * (1.0 / 5040)) + r2 * (1.0 / 40320 + r * (1.0 / 362880));
  const V terms_10_to_13 =
      (1.0 / 3628800 + r * (1.0 / 39916800)) + r2 * (1.0 / 479001600 + r * (1.0 / 6227020800));
  const V q = r + r2 * (terms_2_to_5 + r4 * (terms_6_to_9 + r4 * terms_10_to_13));

  const auto is_gone = x >= 708;
  return {select(is_gone, V{}, scale + scale * q), select(is_gone, V{} + 1, (1 - scale) - scale * q)};
}

/// exp(-x), x >= 0; see decay.
template <class V>
inline V exp_minus(V x) {
  return decay(x).left;
}

}  // namespace slipfront
