// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "solve/grid_level.hpp"

// K times a vector on a grid level, row by row, in single or double precision.
namespace slipfront::solve {

/// A vector field on a grid level.
template <class T>
struct GridField {
  std::vector<T> x, y;
  GridField() = default;
  explicit GridField(std::size_t n) : x(n, T(0)), y(n, T(0)) {}
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

/// Products of the block rows with (x, y), into out[2 r] and out[2 r + 1].
template <class T, class In>
void multiply_blocks(const solid::BlockRows& rows, const std::vector<std::array<T, 4>>& blocks, const In* x,
                     const In* y, std::vector<T>& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    T ax = 0, ay = 0;
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const auto& b = blocks[k];
      const T wx = static_cast<T>(x[rows.neighbour[k]]), wy = static_cast<T>(y[rows.neighbour[k]]);
      ax += b[0] * wx + b[1] * wy;
      ay += b[2] * wx + b[3] * wy;
    }
    out[2 * r] = ax;
    out[2 * r + 1] = ay;
  }
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

/// Buffers of one row and of the block rows' products.
template <class T>
struct ProductBuffer {
  std::vector<T> x, y;    ///< [columns + 1]
  std::vector<T> blocks;  ///< [2 block rows]
  explicit ProductBuffer(const GridLevel& level)
      : x(level.stride(), T(0)), y(level.stride(), T(0)), blocks(2 * level.block.size(), T(0)) {}
};

/// Row j of K times (x, y) into the buffer; 0 at unused grid numbers. The block rows' products must be in the
/// buffer.
template <class T, class In>
void product_row(const GridLevel& level, int j, const In* x, const In* y, ProductBuffer<T>& buffer) {
  const std::ptrdiff_t stride = level.stride(), at = j * stride;
  int filled = 0;
  const auto clear = [&](int to) {
    std::fill(buffer.x.begin() + filled, buffer.x.begin() + to, T(0));
    std::fill(buffer.y.begin() + filled, buffer.y.begin() + to, T(0));
  };
  for (auto k = level.first_span[j]; k < level.first_span[j + 1]; ++k) {
    const auto span = level.span[k];
    clear(span.begin);
    multiply_stencil_row(level.stencil, span, x + at - stride, y + at - stride, x + at, y + at,
                         x + at + stride, y + at + stride, buffer.x.data(), buffer.y.data());
    filled = span.end;
  }
  clear(level.stride());
  for (auto r = level.first_block[j]; r < level.first_block[j + 1]; ++r) {
    buffer.x[level.block.node[r] - at] = buffer.blocks[2 * r];
    buffer.y[level.block.node[r] - at] = buffer.blocks[2 * r + 1];
  }
}

}  // namespace slipfront::solve
