// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>
#include <utility>

// Arithmetic that is written once for a value type V: a number, or the processor's vector of them, SimdVector
// of doubles or SimdVectorOf<float>. The operators are the compiler's; the functions here stand in for what
// they lack. Both branches of a select are evaluated.
namespace slipfront {

inline double select(bool condition, double yes, double no) {
  return condition ? yes : no;
}
inline bool any(bool condition) {
  return condition;
}
inline double absolute(double a) {
  return std::fabs(a);
}
inline double copy_sign(double magnitude, double sign) {
  return std::copysign(magnitude, sign);
}
inline std::uint64_t bits_of(double a) {
  return __builtin_bit_cast(std::uint64_t, a);
}
inline double from_bits(std::uint64_t bits) {
  return __builtin_bit_cast(double, bits);
}

#ifdef __AVX512F__
inline constexpr int vector_bytes = 64;
#else
inline constexpr int vector_bytes = 32;
#endif

template <class T, int n>
struct VectorOf {
  typedef T Type __attribute__((vector_size(n * sizeof(T))));
  /// A vector anywhere in memory: packed, so that no alignment is promised.
  struct __attribute__((packed, may_alias)) InMemory {
    Type values;
  };
};
/// n numbers side by side.
template <class T, int n>
using Vector = typename VectorOf<T, n>::Type;
template <class V>
inline constexpr int length = sizeof(V) / sizeof(std::declval<V>()[0]);

/// So many as the processor computes at a time.
template <class Real>
inline constexpr int lanes_of = vector_bytes / static_cast<int>(sizeof(Real));
template <class Real>
using SimdVectorOf = Vector<Real, lanes_of<Real>>;

inline constexpr int lanes = lanes_of<double>;
using SimdVector = SimdVectorOf<double>;
/// What a comparison of SimdVector gives: all bits of a lane where it is true, none where not.
using SimdMask = Vector<std::int64_t, lanes>;
using SimdBits = Vector<std::uint64_t, lanes>;

/// Consecutive values of an array in the type V: a vector, or one number.
template <class V, std::floating_point From>
inline V load_as(const From* from) {
  if constexpr (std::is_arithmetic_v<V>) {
    return static_cast<V>(*from);
  } else {
    using InMemory = typename VectorOf<From, length<V>>::InMemory;
    return __builtin_convertvector(reinterpret_cast<const InMemory*>(from)->values, V);
  }
}
template <std::floating_point Real>
inline SimdVectorOf<Real> load(const Real* from) {
  return load_as<SimdVectorOf<Real>>(from);
}
template <std::floating_point To, class V>
inline void store(To* to, const V& values) {
  if constexpr (std::is_arithmetic_v<V>) {
    *to = static_cast<To>(values);
  } else {
    using As = VectorOf<To, length<V>>;
    reinterpret_cast<typename As::InMemory*>(to)->values = __builtin_convertvector(values, typename As::Type);
  }
}

/// The first `count` values, 1 <= count < lanes, and their last one in the other lanes.
inline SimdVector load_partial(const double* from, int count) {
#ifdef __AVX512F__
  const auto which = static_cast<__mmask8>((1 << count) - 1);
  return _mm512_mask_loadu_pd(_mm512_set1_pd(from[count - 1]), which, from);
#else
  SimdVector values;
  for (int k = 0; k < lanes; ++k) values[k] = from[std::min(k, count - 1)];
  return values;
#endif
}
inline void store_partial(double* to, SimdVector values, int count) {
#ifdef __AVX512F__
  _mm512_mask_storeu_pd(to, static_cast<__mmask8>((1 << count) - 1), values);
#else
  for (int k = 0; k < count; ++k) to[k] = values[k];
#endif
}

/// Flags 0 or 1 as a mask, and back.
inline SimdMask load(const std::uint8_t* from) {
#ifdef __AVX512F__
  return SimdMask(_mm512_cvtepu8_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)))) != 0;
#else
  SimdMask flags;
  for (int k = 0; k < lanes; ++k) flags[k] = from[k];
  return flags != 0;
#endif
}
inline void store(std::uint8_t* to, SimdMask mask) {
#ifdef __AVX512F__
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm512_cvtepi64_epi8(reinterpret_cast<__m512i>(mask & 1)));
#else
  for (int k = 0; k < lanes; ++k) to[k] = mask[k] & 1;
#endif
}
inline SimdMask load_partial(const std::uint8_t* from, int count) {
  std::uint8_t flags[lanes];
  for (int k = 0; k < lanes; ++k) flags[k] = from[std::min(k, count - 1)];
  return load(flags);
}
inline void store_partial(std::uint8_t* to, SimdMask mask, int count) {
  std::uint8_t flags[lanes];
  store(flags, mask);
  std::copy_n(flags, count, to);
}

inline SimdVector select(SimdMask condition, SimdVector yes, SimdVector no) {
  return condition ? yes : no;
}
inline bool any(SimdMask condition) {
#ifdef __AVX512F__
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(condition), reinterpret_cast<__m512i>(condition)) !=
         0;
#else
  std::int64_t found = 0;
  for (int k = 0; k < lanes; ++k) found |= condition[k];
  return found != 0;
#endif
}
inline SimdBits bits_of(SimdVector a) {
  return reinterpret_cast<SimdBits>(a);
}
inline SimdVector from_bits(SimdBits bits) {
  return reinterpret_cast<SimdVector>(bits);
}
inline SimdVector absolute(SimdVector a) {
  return from_bits(bits_of(a) & ~(std::uint64_t{1} << 63));
}
inline SimdVector copy_sign(SimdVector magnitude, SimdVector sign) {
  constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;
  return from_bits((bits_of(magnitude) & ~sign_bit) | (bits_of(sign) & sign_bit));
}

inline double square_root(double a) {
  return std::sqrt(a);
}
inline SimdVector square_root(SimdVector a) {
  for (int k = 0; k < lanes; ++k) a[k] = std::sqrt(a[k]);
  return a;
}

/// Numbers [from, from + length) of two vectors one behind the other.
template <int from, class V, int... k>
inline V part_of(const V& first, const V& second, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(first, second, (from + k)...);
}
/// The values one place to the left of `here`, where `left` stands before it, and one to the right; of single
/// numbers the neighbours themselves.
template <class V>
inline V from_left(const V& left, const V& here) {
  if constexpr (std::is_arithmetic_v<V>)
    return left;
  else
    return part_of<length<V> - 1>(left, here, std::make_integer_sequence<int, length<V>>{});
}
template <class V>
inline V from_right(const V& here, const V& right) {
  if constexpr (std::is_arithmetic_v<V>)
    return right;
  else
    return part_of<1>(here, right, std::make_integer_sequence<int, length<V>>{});
}

/// even[0], odd[0], even[1], odd[1] ... in two vectors.
template <int from, class V, int... k>
inline V interleaved_from(const V& even, const V& odd, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(even, odd, ((from + k) / 2 + (k % 2) * length<V>)...);
}
template <class V>
inline std::pair<V, V> interleaved(const V& even, const V& odd) {
  constexpr auto all = std::make_integer_sequence<int, length<V>>{};
  return {interleaved_from<0>(even, odd, all), interleaved_from<length<V>>(even, odd, all)};
}

/// What a comparison of two V gives.
template <class V>
using Mask = decltype(V{} < V{});

/// max(0, a); 0 where a is not a number.
template <class V>
inline V positive_part(V a) {
  return select(a > 0, a, V{});
}

}  // namespace slipfront
