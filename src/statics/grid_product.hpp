// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "base/lanes.hpp"
#include "solid/stencil_product.hpp"
#include "statics/grid_level.hpp"
#include "threads/team.hpp"

// K times a vector on a grid level, row by row, in single or double precision.
namespace slipfront::statics {

/// A vector field on a grid level.
template <class T>
struct GridField {
  std::vector<T> x, y;
  GridField() = default;
  explicit GridField(std::size_t n) : x(n, T(0)), y(n, T(0)) {}
  std::size_t size() const { return x.size(); }
};

/// Rows of a vector field on a grid level: all of them, or as a ring the last few of a sweep.
template <class T>
struct Rows {
  T* x_begin;
  T* y_begin;
  std::ptrdiff_t stride;
  int mask = -1;  ///< of a row's number: -1 for all rows, their number less 1 for a ring of 2^n rows
  T* x(int j) const { return x_begin + (j & mask) * stride; }
  T* y(int j) const { return y_begin + (j & mask) * stride; }
  solid::ConstRowOf<std::remove_const_t<T>> row(int j) const { return {x(j), y(j)}; }
  Rows<const T> as_const() const { return {x_begin, y_begin, stride, mask}; }
};

template <class F>
auto all_rows(F& field, const GridLevel& level) {
  return Rows<std::remove_reference_t<decltype(field.x[0])>>{field.x.data(), field.y.data(), level.stride()};
}

/// A ring of rows.
template <class T>
class RowRing {
 public:
  RowRing() = default;
  RowRing(int min_rows, int longest_row) {
    while (rows_ < min_rows) rows_ *= 2;
    field_ = GridField<T>(static_cast<std::size_t>(rows_) * longest_row);
  }
  Rows<T> on(const GridLevel& level) { return {field_.x.data(), field_.y.data(), level.stride(), rows_ - 1}; }

 private:
  int rows_ = 1;
  GridField<T> field_;
};

/// Copies of the rows next to a part of a field's rows, where the neighbouring part is changed meanwhile.
template <class T>
class RowsBeside {
 public:
  RowsBeside() = default;
  RowsBeside(int max_rows, int longest_row) : field_(2UL * max_rows * longest_row) {}
  /// Copies up to n rows before and after the part.
  void copy(const GridLevel& level, const Rows<const T>& from, threads::LoopChunk part, int n) {
    part_ = part;
    n_ = n;
    stride_ = level.stride();
    for (int j = std::max(0, part.begin - n); j < std::min(level.rows + 1, part.end + n); ++j) {
      if (j >= part.begin && j < part.end) continue;
      std::copy_n(from.x(j), stride_, field_.x.data() + place(j));
      std::copy_n(from.y(j), stride_, field_.y.data() + place(j));
    }
  }
  /// The row of the field itself within the part, the copy beside it.
  const T* x(const Rows<const T>& field, int j) const {
    return j >= part_.begin && j < part_.end ? field.x(j) : field_.x.data() + place(j);
  }
  const T* y(const Rows<const T>& field, int j) const {
    return j >= part_.begin && j < part_.end ? field.y(j) : field_.y.data() + place(j);
  }

 private:
  std::ptrdiff_t place(int j) const {
    return (j < part_.begin ? j - part_.begin + n_ : n_ + j - part_.end) * stride_;
  }
  threads::LoopChunk part_{0, 0, 1};
  int n_ = 0;
  std::ptrdiff_t stride_ = 0;
  GridField<T> field_;
};

/// A sum in double precision of products computed in the precision T, in an order that only depends on the
/// columns.
template <class T>
class RowSum {
 public:
  /// Adds a b.
  template <class V>
  void add(const V& a, const V& b) {
    if constexpr (std::is_arithmetic_v<V>) {
      one_ += static_cast<double>(a) * static_cast<double>(b);
    } else {
      several_ += __builtin_convertvector(a, Doubles) * __builtin_convertvector(b, Doubles);
    }
  }
  double value() const {
    double sum = one_;
    for (int k = 0; k < lanes_of<T>; ++k) sum += several_[k];
    return sum;
  }

 private:
  using Doubles = Vector<double, lanes_of<T>>;
  double one_ = 0;
  Doubles several_{};
};

/// Calls f(i, a_x, a_y) with the stencil's products in columns [begin, end) of row j, of type SimdVectorOf<T>
/// for the columns from i on, or T.
template <class T, class In, class F>
void for_stencil_products(const solid::InteriorStencil& stencil, solid::Span span, int j,
                          const Rows<const In>& field, F&& f) {
  const solid::StencilOf<T> s(stencil);
  const auto south = field.row(j - 1), middle = field.row(j), north = field.row(j + 1);
  int i = span.begin;
  // Nothing is read beyond the neighbours: that may be beyond the field.
  constexpr int n_lanes = lanes_of<T>;
  if (i + 2 * n_lanes <= span.end + 1) {
    using V = SimdVectorOf<T>;
    const auto before = solid::stencil_terms<T>(s, i - 1, south, middle, north);
    solid::StencilTerms<V> left{};
    left.to_right_x[n_lanes - 1] = before.to_right_x;
    left.to_right_y[n_lanes - 1] = before.to_right_y;
    auto here = solid::stencil_terms<V>(s, i, south, middle, north);
    for (; i + 2 * n_lanes <= span.end + 1; i += n_lanes) {
      const auto right = solid::stencil_terms<V>(s, i + n_lanes, south, middle, north);
      const auto a = solid::stencil_product(left, here, right);
      f(i, a.x, a.y);
      left = here;
      here = right;
    }
  }
  if (i == span.end) return;
  auto left = solid::stencil_terms<T>(s, i - 1, south, middle, north);
  auto here = solid::stencil_terms<T>(s, i, south, middle, north);
  for (; i < span.end; ++i) {
    const auto right = solid::stencil_terms<T>(s, i + 1, south, middle, north);
    const auto a = solid::stencil_product(left, here, right);
    f(i, a.x, a.y);
    left = here;
    here = right;
  }
}

/// Row j of K times `field`, friction included: calls inside(i, a_x, a_y) as for_stencil_products does, and
/// other(i, r, a_x, a_y) for the block rows r; nothing for unused grid numbers. `slip`: factors of the block
/// rows by which f_y is added to f_x, or null.
template <class T, class In, class Inside, class Other>
void for_row_products(const GridLevel& level, const std::vector<std::array<T, 4>>& blocks, const T* slip,
                      int j, const Rows<const In>& field, Inside&& inside, Other&& other) {
  for (auto k = level.first_span[j]; k < level.first_span[j + 1]; ++k)
    for_stencil_products<T>(level.stencil_of(j), level.span[k], j, field, inside);
  const auto& rows = level.block;
  for (auto r = level.first_block[j]; r < level.first_block[j + 1]; ++r) {
    T sum_x = 0, sum_y = 0;
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const auto& b = blocks[k];
      const auto row = level.neighbour_row[k], column = level.neighbour_column[k];
      const T w_x = static_cast<T>(field.x(row)[column]), w_y = static_cast<T>(field.y(row)[column]);
      sum_x += b[0] * w_x + b[1] * w_y;
      sum_y += b[2] * w_x + b[3] * w_y;
    }
    if (slip != nullptr) sum_x += slip[r] * sum_y;
    other(rows.node[r] - j * level.stride(), r, sum_x, sum_y);
  }
}

/// Sets the numbers of row j without a node of the plate to 0.
template <class T>
void clear_unused(const GridLevel& level, int j, T* x, T* y) {
  if (level.unused.empty() || level.node(0, j) > level.unused.back()) return;
  for (auto n = std::ranges::lower_bound(level.unused, level.node(0, j));
       n != level.unused.end() && *n < level.node(0, j + 1); ++n)
    x[*n - level.node(0, j)] = y[*n - level.node(0, j)] = 0;
}

}  // namespace slipfront::statics
