// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/lanes.hpp"
#include "solid/operator.hpp"
#include "solid/stencil_product.hpp"

// The explicit step over plain arrays: the kick of one node by functions for any processor, and loops over
// them, one grid row at a time. Every pointer points to column 0 of its row; rows of w never alias the rows
// that are written.
namespace slipfront::solid {

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

/// For squares below the node instead of above, or to the left instead of to the right.
inline EdgeStencil mirrored(EdgeStencil s) {
  s.shear = -s.shear;
  s.twist = -s.twist;
  return s;
}

/// w = u + factor v over columns [0, n).
template <class Real>
void combine_row(int n, double factor, const Real* __restrict u_x, const Real* __restrict u_y,
                 const Real* __restrict v_x, const Real* __restrict v_y, Real* __restrict w_x,
                 Real* __restrict w_y) {
  const auto f = static_cast<Real>(factor);
  for (int i = 0; i < n; ++i) w_x[i] = u_x[i] + f * v_x[i];
  for (int i = 0; i < n; ++i) w_y[i] = u_y[i] + f * v_y[i];
}

/// Between single and double precision, over columns [0, n).
template <class From, class To>
void convert_row(int n, const From* __restrict from, To* __restrict to) {
  for (int i = 0; i < n; ++i) to[i] = static_cast<To>(from[i]);
}

/// Kick of a node amid four squares.
inline Pair interior_kick(const InteriorStencil& s, int i, ConstRow south, ConstRow middle, ConstRow north) {
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
  for (int i = span.begin; i < span.end; ++i) {
    const Pair d = interior_kick(s, i, south, middle, north);
    v_x[i] += d.x;
    v_y[i] += d.y;
  }
}

/// Sums over nodes of products with a kick d of the velocity: w d, v d with v before the kick, d d.
struct KickSums {
  double w_d = 0, v_d = 0, d_d = 0;
};

/// Adds an interior row as add_interior_row does, and u += dt v. Rows of w are read up to lanes_of<Real>
/// columns before the span and up to twice as many after it; what stands there does not matter.
template <bool with_sums, class Real>
void push_interior_row(const InteriorStencil& stencil, Span span, double time_step_s, ConstRowOf<Real> south,
                       ConstRowOf<Real> middle, ConstRowOf<Real> north, Real* __restrict v_x,
                       Real* __restrict v_y, Real* __restrict u_x, Real* __restrict u_y, KickSums& sums) {
  constexpr int n_lanes = lanes_of<Real>;
  using V = SimdVectorOf<Real>;
  const StencilOf<Real> s(stencil);
  const auto dt = static_cast<Real>(time_step_s);
  const auto terms = [&](int i) { return stencil_terms<V>(s, i, south, middle, north); };
  V w_d{}, v_d{}, d_d{};
  int i = span.begin;
  auto left = terms(i - n_lanes), here = terms(i);
  for (; i + n_lanes <= span.end; i += n_lanes) {
    const auto right = terms(i + n_lanes);
    const auto d = stencil_product(left, here, right);
    const V before_x = load(v_x + i), before_y = load(v_y + i);
    const V after_x = before_x + d.x, after_y = before_y + d.y;
    store(v_x + i, after_x);
    store(v_y + i, after_y);
    store(u_x + i, load(u_x + i) + dt * after_x);
    store(u_y + i, load(u_y + i) + dt * after_y);
    if constexpr (with_sums) {
      w_d += here.w_x * d.x + here.w_y * d.y;
      v_d += before_x * d.x + before_y * d.y;
      d_d += d.x * d.x + d.y * d.y;
    }
    left = here;
    here = right;
  }
  if (i < span.end) {
    const auto d = stencil_product(left, here, terms(i + n_lanes));
    for (int k = 0; i < span.end; ++i, ++k) {
      if constexpr (with_sums) {
        sums.w_d += middle.x[i] * d.x[k] + middle.y[i] * d.y[k];
        sums.v_d += v_x[i] * d.x[k] + v_y[i] * d.y[k];
        sums.d_d += d.x[k] * d.x[k] + d.y[k] * d.y[k];
      }
      v_x[i] += d.x[k];
      v_y[i] += d.y[k];
      u_x[i] += dt * v_x[i];
      u_y[i] += dt * v_y[i];
    }
  }
  if constexpr (with_sums)
    for (int k = 0; k < n_lanes; ++k) {
      sums.w_d += w_d[k];
      sums.v_d += v_d[k];
      sums.d_d += d_d[k];
    }
}

/// Three rows of w that roll with the sweep, padded by more than a vector at both ends, column 1 on a cache
/// line.
template <class Real>
class RollingRowsOf {
 public:
  explicit RollingRowsOf(int columns)
      : pitch_((columns + 2 * n_lanes + per_line - 1) / per_line * per_line),
        values_(6 * static_cast<std::size_t>(pitch_) + 2 * per_line, Real(0)) {}

  Real* x(int row) {
    const auto address = reinterpret_cast<std::uintptr_t>(values_.data()) + sizeof(Real) * (n_lanes + 1);
    const auto offset = (line - address % line) % line / sizeof(Real);
    return values_.data() + offset + n_lanes + static_cast<std::ptrdiff_t>(row % 3) * 2 * pitch_;
  }
  Real* y(int row) { return x(row) + pitch_; }

 private:
  static constexpr std::size_t line = 64;
  static constexpr int n_lanes = lanes_of<Real>, per_line = line / sizeof(Real);
  int pitch_;
  std::vector<Real> values_;
};
using RollingRows = RollingRowsOf<double>;

/// Kick of a node on an edge; `north` is the row on the side of the squares.
inline Pair edge_kick(const EdgeStencil& s, int i, ConstRow middle, ConstRow north) {
  return {s.centre_x * middle.x[i] + s.side_x * (middle.x[i - 1] + middle.x[i + 1]) + s.up_x * north.x[i] +
              s.corner_x * (north.x[i - 1] + north.x[i + 1]) + s.shear * (middle.y[i + 1] - middle.y[i - 1]) +
              s.twist * (north.y[i + 1] - north.y[i - 1]),
          s.centre_y * middle.y[i] + s.side_y * (middle.y[i - 1] + middle.y[i + 1]) + s.up_y * north.y[i] +
              s.corner_y * (north.y[i - 1] + north.y[i + 1]) - s.shear * (middle.x[i + 1] - middle.x[i - 1]) +
              s.twist * (north.x[i + 1] - north.x[i - 1])};
}

/// v += stencil(w) over the span of an edge; `north` is the row on the side of the squares.
inline void add_edge_row(const EdgeStencil& s, Span span, ConstRow middle, ConstRow north,
                         double* __restrict v_x, double* __restrict v_y) {
  for (int i = span.begin; i < span.end; ++i) {
    const Pair d = edge_kick(s, i, middle, north);
    v_x[i] += d.x;
    v_y[i] += d.y;
  }
}

/// The kicks d of an edge's nodes, and the sums of u d and v d over them.
inline Pair kick_edge_row(const EdgeStencil& s, Span span, ConstRow middle, ConstRow north, ConstRow u,
                          ConstRow v, double* __restrict kick_x, double* __restrict kick_y) {
  double u_d = 0, v_d = 0;
#pragma omp simd reduction(+ : u_d, v_d)
  for (int i = span.begin; i < span.end; ++i) {
    const Pair d = edge_kick(s, i, middle, north);
    kick_x[i] = d.x;
    kick_y[i] = d.y;
    u_d += u.x[i] * d.x + u.y[i] * d.y;
    v_d += v.x[i] * d.x + v.y[i] * d.y;
  }
  return {u_d, v_d};
}

/// Puts the products of the nodes [at, ...) of a row of own stencils, in these columns, into a.
/// @return at of the next ones
inline std::size_t multiply_own(const StencilRow& row, std::size_t at, Span span, ConstRow south,
                                ConstRow middle, ConstRow north, double* a_x, double* a_y) {
  const ConstRow around[] = {south, middle, north};
  const int first = row.squares == Squares::above ? 1 : 0, end = row.squares == Squares::below ? 2 : 3;
  const auto n = row.n_own;
  for (int i = span.begin; i < span.end; i += lanes) {
    const double* entry = row.own.data() + at + (i - span.begin);
    SimdVector x{}, y{};
    for (int j = first; j < end; ++j) {
#pragma GCC unroll 3
      for (int column = i - 1; column <= i + 1; ++column) {
        const SimdVector w_x = load(around[j].x + column), w_y = load(around[j].y + column);
        x += load(entry) * w_x + load(entry + n) * w_y;
        y += load(entry + 2 * n) * w_x + load(entry + 3 * n) * w_y;
        entry += 4 * n;
      }
    }
    const int count = span.end - i;
    if (count < lanes) {
      store_partial(a_x + (i - span.begin), x, count);
      store_partial(a_y + (i - span.begin), y, count);
    } else {
      store(a_x + (i - span.begin), x);
      store(a_y + (i - span.begin), y);
    }
  }
  return at + static_cast<std::size_t>(span.end - span.begin);
}

/// Kick of a node with squares to the right (inner = 1) or to the left (inner = -1, mirrored stencil) of it.
template <class Real>
Pair side_kick(const EdgeStencil& s, int i, int inner, ConstRowOf<Real> south, ConstRowOf<Real> middle,
               ConstRowOf<Real> north) {
  const int k = i + inner;
  return {s.centre_y * middle.x[i] + s.side_y * (south.x[i] + north.x[i]) + s.up_y * middle.x[k] +
              s.corner_y * (south.x[k] + north.x[k]) - s.shear * (north.y[i] - south.y[i]) +
              s.twist * (north.y[k] - south.y[k]),
          s.centre_x * middle.y[i] + s.side_x * (south.y[i] + north.y[i]) + s.up_x * middle.y[k] +
              s.corner_x * (south.y[k] + north.y[k]) + s.shear * (north.x[i] - south.x[i]) +
              s.twist * (north.x[k] - south.x[k])};
}

/// v += kick, u += dt v of such a node, which has half the mass of those in the sums.
template <class Real>
void kick_side_node(const EdgeStencil& s, int i, int inner, double dt, ConstRowOf<Real> south,
                    ConstRowOf<Real> middle, ConstRowOf<Real> north, Real* __restrict v_x,
                    Real* __restrict v_y, Real* __restrict u_x, Real* __restrict u_y, KickSums& sums) {
  const Pair d = side_kick(s, i, inner, south, middle, north);
  sums.w_d += 0.5 * (middle.x[i] * d.x + middle.y[i] * d.y);
  sums.v_d += 0.5 * (v_x[i] * d.x + v_y[i] * d.y);
  sums.d_d += 0.5 * (d.x * d.x + d.y * d.y);
  v_x[i] += static_cast<Real>(d.x);
  v_y[i] += static_cast<Real>(d.y);
  u_x[i] += static_cast<Real>(dt * v_x[i]);
  u_y[i] += static_cast<Real>(dt * v_y[i]);
}

/// v += kick over the span.
inline void kick_row(Span span, const double* __restrict kick_x, const double* __restrict kick_y,
                     double* __restrict v_x, double* __restrict v_y) {
  for (int i = span.begin; i < span.end; ++i) v_x[i] += kick_x[i];
  for (int i = span.begin; i < span.end; ++i) v_y[i] += kick_y[i];
}

/// Sum of m (a . b) over the span.
inline double row_product(Span span, const double* __restrict m, ConstRow a, ConstRow b) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = span.begin; i < span.end; ++i) sum += m[i] * (a.x[i] * b.x[i] + a.y[i] * b.y[i]);
  return sum;
}

/// Puts w of a row, filled in its columns, where its neighbours look beyond a period.
inline void repeat_row(const NodeRow& row, RollingRows& w, int j) {
  if (row.period == 0) return;
  for (double* values : {w.x(j), w.y(j)}) {
    values[-1] = values[row.period - 1];
    values[row.period] = values[0];
  }
}

/// Calls f(row, product, w) with M^-1 K w of each stencil row. @param w_of_row  puts w of a row into arrays
template <class W, class F>
void for_each_stencil_product(const Operator& op, const PartialStiffness& part, W&& w_of_row, F&& f) {
  if (part.stencil.empty()) return;
  RollingRows w(op.widest_row());
  Field product(static_cast<std::size_t>(op.widest_row()));
  int next = 0;
  for (const auto& row : part.stencil) {
    const auto read = rows_read(row);
    for (next = std::max(next, read.begin); next < read.end; ++next) {
      w_of_row(next, w.x(next), w.y(next));
      repeat_row(op.rows[next], w, next);
    }
    for (auto* values : {&product.x, &product.y}) std::ranges::fill(*values, 0.0);
    const auto of_row = [&](int j) { return ConstRow{w.x(j), w.y(j)}; };
    const int j = row.row;
    add_stencil_row(op, row, of_row(j + 2), of_row(j), of_row(j + 1), product.x.data(), product.y.data());
    f(row, ConstRow{product.x.data(), product.y.data()}, of_row(j));
  }
}

}  // namespace slipfront::solid
