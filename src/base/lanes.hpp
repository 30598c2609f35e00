// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/host_device.hpp"

// Arithmetic that is written once for a value type V: a double, or the processor's vector of them, Lanes. The
// operators are the compiler's; the functions here stand in for what they lack. Both branches of a select are
// evaluated.
namespace slipfront {

SLIPFRONT_HOST_DEVICE inline double select(bool condition, double yes, double no) {
  return condition ? yes : no;
}
SLIPFRONT_HOST_DEVICE inline bool any(bool condition) {
  return condition;
}
SLIPFRONT_HOST_DEVICE inline double absolute(double a) {
  return std::fabs(a);
}
SLIPFRONT_HOST_DEVICE inline double copy_sign(double magnitude, double sign) {
  return std::copysign(magnitude, sign);
}
SLIPFRONT_HOST_DEVICE inline std::uint64_t bits_of(double a) {
  return __builtin_bit_cast(std::uint64_t, a);
}
SLIPFRONT_HOST_DEVICE inline double from_bits(std::uint64_t bits) {
  return __builtin_bit_cast(double, bits);
}

#ifndef __CUDACC__

#ifdef __AVX512F__
inline constexpr int lanes = 8;
#else
inline constexpr int lanes = 4;
#endif

/// Consecutive values of an array.
using Lanes = double __attribute__((vector_size(lanes * sizeof(double))));
/// What a comparison of Lanes gives: all bits of a lane where it is true, none where not.
using LanesMask = std::int64_t __attribute__((vector_size(lanes * sizeof(double))));
using LanesBits = std::uint64_t __attribute__((vector_size(lanes * sizeof(double))));

/// The same anywhere in memory: packed, so that no alignment is promised.
struct __attribute__((packed, may_alias)) LanesInMemory {
  Lanes values;
};
inline Lanes load(const double* from) {
  return reinterpret_cast<const LanesInMemory*>(from)->values;
}
inline void store(double* to, Lanes values) {
  reinterpret_cast<LanesInMemory*>(to)->values = values;
}

/// The first `count` values, 1 <= count < lanes, and their last one in the other lanes.
inline Lanes load_part(const double* from, int count) {
#ifdef __AVX512F__
  const auto which = static_cast<__mmask8>((1 << count) - 1);
  return _mm512_mask_loadu_pd(_mm512_set1_pd(from[count - 1]), which, from);
#else
  Lanes values;
  for (int k = 0; k < lanes; ++k) values[k] = from[std::min(k, count - 1)];
  return values;
#endif
}
inline void store_part(double* to, Lanes values, int count) {
#ifdef __AVX512F__
  _mm512_mask_storeu_pd(to, static_cast<__mmask8>((1 << count) - 1), values);
#else
  for (int k = 0; k < count; ++k) to[k] = values[k];
#endif
}

/// Flags 0 or 1 as a mask, and back.
inline LanesMask load(const std::uint8_t* from) {
#ifdef __AVX512F__
  return LanesMask(_mm512_cvtepu8_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)))) != 0;
#else
  LanesMask flags;
  for (int k = 0; k < lanes; ++k) flags[k] = from[k];
  return flags != 0;
#endif
}
inline void store(std::uint8_t* to, LanesMask mask) {
#ifdef __AVX512F__
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm512_cvtepi64_epi8(reinterpret_cast<__m512i>(mask & 1)));
#else
  for (int k = 0; k < lanes; ++k) to[k] = mask[k] & 1;
#endif
}
inline LanesMask load_part(const std::uint8_t* from, int count) {
  std::uint8_t flags[lanes];
  for (int k = 0; k < lanes; ++k) flags[k] = from[std::min(k, count - 1)];
  return load(flags);
}
inline void store_part(std::uint8_t* to, LanesMask mask, int count) {
  std::uint8_t flags[lanes];
  store(flags, mask);
  std::copy_n(flags, count, to);
}

inline Lanes select(LanesMask condition, Lanes yes, Lanes no) {
  return condition ? yes : no;
}
inline bool any(LanesMask condition) {
#ifdef __AVX512F__
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(condition), reinterpret_cast<__m512i>(condition)) !=
         0;
#else
  std::int64_t found = 0;
  for (int k = 0; k < lanes; ++k) found |= condition[k];
  return found != 0;
#endif
}
inline LanesBits bits_of(Lanes a) {
  return reinterpret_cast<LanesBits>(a);
}
inline Lanes from_bits(LanesBits bits) {
  return reinterpret_cast<Lanes>(bits);
}
inline Lanes absolute(Lanes a) {
  return from_bits(bits_of(a) & ~(std::uint64_t{1} << 63));
}
inline Lanes copy_sign(Lanes magnitude, Lanes sign) {
  constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;
  return from_bits((bits_of(magnitude) & ~sign_bit) | (bits_of(sign) & sign_bit));
}

#endif

/// What a comparison of two V gives.
template <class V>
using Mask = decltype(V{} < V{});

/// max(0, a); 0 where a is not a number.
template <class V>
SLIPFRONT_HOST_DEVICE inline V positive_part(V a) {
  return select(a > 0, a, V{});
}

}  // namespace slipfront
