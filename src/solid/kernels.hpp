// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "solid/operator.hpp"

// The loops of the explicit step over plain arrays, one grid row at a time. Every pointer points to column 0
// of its row; rows of w never alias the rows that are written.
namespace slipfront::solid {

/// A row of a vector field.
struct ConstRow {
  const double* __restrict x;
  const double* __restrict y;
};

inline InteriorStencil scaled(InteriorStencil s, double factor) {
  for (double* c : {&s.centre, &s.along, &s.across, &s.corner, &s.twist}) *c *= factor;
  return s;
}

inline EdgeStencil scaled(EdgeStencil s, double factor) {
  for (double* c : {&s.centre_x, &s.side_x, &s.up_x, &s.corner_x, &s.centre_y, &s.side_y, &s.up_y,
                    &s.corner_y, &s.shear, &s.twist})
    *c *= factor;
  return s;
}

/// For squares below the node instead of above.
inline EdgeStencil mirrored(EdgeStencil s) {
  s.shear = -s.shear;
  s.twist = -s.twist;
  return s;
}

/// w = u + factor v over columns [0, n).
inline void combine_row(int n, double factor, const double* __restrict u_x, const double* __restrict u_y,
                        const double* __restrict v_x, const double* __restrict v_y, double* __restrict w_x,
                        double* __restrict w_y) {
  for (int i = 0; i < n; ++i) w_x[i] = u_x[i] + factor * v_x[i];
  for (int i = 0; i < n; ++i) w_y[i] = u_y[i] + factor * v_y[i];
}

/// stencil(w) at column i.
inline Pair interior_product(const InteriorStencil& s, int i, ConstRow south, ConstRow middle,
                             ConstRow north) {
  const double corners_x = (south.x[i - 1] + south.x[i + 1]) + (north.x[i - 1] + north.x[i + 1]);
  const double corners_y = (south.y[i - 1] + south.y[i + 1]) + (north.y[i - 1] + north.y[i + 1]);
  const double twist_x = (north.x[i + 1] - north.x[i - 1]) - (south.x[i + 1] - south.x[i - 1]);
  const double twist_y = (north.y[i + 1] - north.y[i - 1]) - (south.y[i + 1] - south.y[i - 1]);
  return {s.centre * middle.x[i] + s.along * (middle.x[i - 1] + middle.x[i + 1]) +
              s.across * (south.x[i] + north.x[i]) + s.corner * corners_x + s.twist * twist_y,
          s.centre * middle.y[i] + s.across * (middle.y[i - 1] + middle.y[i + 1]) +
              s.along * (south.y[i] + north.y[i]) + s.corner * corners_y + s.twist * twist_x};
}

/// v += stencil(w) over the span.
inline void add_interior_row(const InteriorStencil& s, Span span, ConstRow south, ConstRow middle,
                             ConstRow north, double* __restrict v_x, double* __restrict v_y) {
#pragma omp simd
  for (int i = span.begin; i < span.end; ++i) {
    const auto [x, y] = interior_product(s, i, south, middle, north);
    v_x[i] += x;
    v_y[i] += y;
  }
}

/// Sums over nodes of products with a kick d of the velocity: w d, v d with v before the kick, d d.
struct KickSums {
  double w_d = 0, v_d = 0, d_d = 0;
};

/// The same, and adds to the sums.
inline void add_interior_row(const InteriorStencil& s, Span span, ConstRow south, ConstRow middle,
                             ConstRow north, double* __restrict v_x, double* __restrict v_y, KickSums& sums) {
  double w_d = 0, v_d = 0, d_d = 0;
#pragma omp simd reduction(+ : w_d, v_d, d_d)
  for (int i = span.begin; i < span.end; ++i) {
    const auto [x, y] = interior_product(s, i, south, middle, north);
    w_d += middle.x[i] * x + middle.y[i] * y;
    v_d += v_x[i] * x + v_y[i] * y;
    d_d += x * x + y * y;
    v_x[i] += x;
    v_y[i] += y;
  }
  sums.w_d += w_d;
  sums.v_d += v_d;
  sums.d_d += d_d;
}

/// v += stencil(w) over the span of an edge; `north` is the row on the side of the squares.
inline void add_edge_row(const EdgeStencil& s, Span span, ConstRow middle, ConstRow north,
                         double* __restrict v_x, double* __restrict v_y) {
  for (int i = span.begin; i < span.end; ++i) {
    v_x[i] += s.centre_x * middle.x[i] + s.side_x * (middle.x[i - 1] + middle.x[i + 1]) +
              s.up_x * north.x[i] + s.corner_x * (north.x[i - 1] + north.x[i + 1]) +
              s.shear * (middle.y[i + 1] - middle.y[i - 1]) + s.twist * (north.y[i + 1] - north.y[i - 1]);
    v_y[i] += s.centre_y * middle.y[i] + s.side_y * (middle.y[i - 1] + middle.y[i + 1]) +
              s.up_y * north.y[i] + s.corner_y * (north.y[i - 1] + north.y[i + 1]) -
              s.shear * (middle.x[i + 1] - middle.x[i - 1]) + s.twist * (north.x[i + 1] - north.x[i - 1]);
  }
}

/// u += dt v over the span.
inline void move_row(Span span, double dt, const double* __restrict v_x, const double* __restrict v_y,
                     double* __restrict u_x, double* __restrict u_y) {
  for (int i = span.begin; i < span.end; ++i) u_x[i] += dt * v_x[i];
  for (int i = span.begin; i < span.end; ++i) u_y[i] += dt * v_y[i];
}

/// Sum of m (a . b) over the span.
inline double row_product(Span span, const double* __restrict m, ConstRow a, ConstRow b) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = span.begin; i < span.end; ++i) sum += m[i] * (a.x[i] * b.x[i] + a.y[i] * b.y[i]);
  return sum;
}

}  // namespace slipfront::solid
