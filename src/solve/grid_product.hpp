// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "solve/grid_level.hpp"
#include "solve/team.hpp"

// K times a vector on a grid level, row by row, in single or double precision.
namespace slipfront::solve {

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
  RowRing(int least_rows, int longest_row) {
    while (rows_ < least_rows) rows_ *= 2;
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
  RowsBeside(int most_rows, int longest_row) : field_(2UL * most_rows * longest_row) {}
  /// Copies up to n rows before and after the part.
  void copy(const GridLevel& level, const Rows<const T>& from, PartOf part, int n) {
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
  PartOf part_{0, 0, 1};
  int n_ = 0;
  std::ptrdiff_t stride_ = 0;
  GridField<T> field_;
};

/// Blocks of a level's block rows in the precision of the product.
template <class T>
std::vector<std::array<T, 4>> blocks_as(const solid::BlockRows& rows) {
  std::vector<std::array<T, 4>> blocks;
  blocks.reserve(rows.block.size());
  for (const auto& b : rows.block)
    blocks.push_back(
        {static_cast<T>(b[0]), static_cast<T>(b[1]), static_cast<T>(b[2]), static_cast<T>(b[3])});
  return blocks;
}

/// Product of the stencil over columns [begin, end) of a row; all pointers to column 0 of their rows.
template <class T, class In>
void multiply_stencil_row(const solid::InteriorStencil& stencil, solid::Span span,
                          const In* __restrict south_x, const In* __restrict south_y,
                          const In* __restrict middle_x, const In* __restrict middle_y,
                          const In* __restrict north_x, const In* __restrict north_y, T* __restrict out_x,
                          T* __restrict out_y) {
  const T centre = static_cast<T>(stencil.centre), along = static_cast<T>(stencil.along),
          across = static_cast<T>(stencil.across), corner = static_cast<T>(stencil.corner),
          twist = static_cast<T>(stencil.twist);
  const auto at = [](const In* w, int i) { return static_cast<T>(w[i]); };
  for (int i = span.begin; i < span.end; ++i) {
    const T west_x = at(south_x, i - 1) + at(north_x, i - 1),
            east_x = at(south_x, i + 1) + at(north_x, i + 1);
    const T west_y = at(south_y, i - 1) + at(north_y, i - 1),
            east_y = at(south_y, i + 1) + at(north_y, i + 1);
    const T twist_x = (at(north_x, i + 1) - at(south_x, i + 1)) - (at(north_x, i - 1) - at(south_x, i - 1));
    const T twist_y = (at(north_y, i + 1) - at(south_y, i + 1)) - (at(north_y, i - 1) - at(south_y, i - 1));
    out_x[i] = centre * at(middle_x, i) + along * (at(middle_x, i - 1) + at(middle_x, i + 1)) +
               across * (at(south_x, i) + at(north_x, i)) + corner * (west_x + east_x) + twist * twist_y;
    out_y[i] = centre * at(middle_y, i) + across * (at(middle_y, i - 1) + at(middle_y, i + 1)) +
               along * (at(south_y, i) + at(north_y, i)) + corner * (west_y + east_y) + twist * twist_x;
  }
}

/// One row of K times a field. [columns + 1]
template <class T>
struct ProductRow {
  std::vector<T> x, y;
  explicit ProductRow(int longest_row = 0) : x(longest_row, T(0)), y(longest_row, T(0)) {}
};

/// Row j of K times `field` into `out`; 0 at unused grid numbers.
template <class T, class In>
void multiply_row(const GridLevel& level, const std::vector<std::array<T, 4>>& blocks, int j,
                  const Rows<const In>& field, ProductRow<T>& out) {
  int filled = 0;
  const auto clear = [&](int to) {
    std::fill(out.x.begin() + filled, out.x.begin() + to, T(0));
    std::fill(out.y.begin() + filled, out.y.begin() + to, T(0));
  };
  for (auto k = level.first_span[j]; k < level.first_span[j + 1]; ++k) {
    const auto span = level.span[k];
    clear(span.begin);
    multiply_stencil_row(level.stencil, span, field.x(j - 1), field.y(j - 1), field.x(j), field.y(j),
                         field.x(j + 1), field.y(j + 1), out.x.data(), out.y.data());
    filled = span.end;
  }
  clear(level.stride());
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
    const auto i = rows.node[r] - j * level.stride();
    out.x[i] = sum_x;
    out.y[i] = sum_y;
  }
}

/// Adds friction to row j of a product: f_x + slip f_y at the block rows, whose slip is not 0 where a node
/// slips.
template <class T>
void add_friction(const GridLevel& level, const std::vector<T>& slip, int j, ProductRow<T>& out) {
  for (auto r = level.first_block[j]; r < level.first_block[j + 1]; ++r) {
    const auto i = level.block.node[r] - j * level.stride();
    out.x[i] += slip[r] * out.y[i];
  }
}

}  // namespace slipfront::solve
