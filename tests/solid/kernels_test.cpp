// SPDX-License-Identifier: BSD-3-Clause
#include "solid/kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slipfront::solid {
namespace {

constexpr int columns = 40;
constexpr InteriorStencil stencil{-3.0, 0.5, 0.25, 0.125, 0.375};

class PushRow : public ::testing::TestWithParam<Span> {
 protected:
  PushRow() {
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < columns; ++i) {
        w_.x(row)[i] = std::sin(1.0 + 3 * i + 7 * row);
        w_.y(row)[i] = std::cos(2.0 + 5 * i + 11 * row);
      }
    for (int i = 0; i < columns; ++i) {
      v_x_[i] = std::sin(0.3 * i);
      v_y_[i] = std::cos(0.7 * i);
      u_x_[i] = std::sin(0.9 * i);
      u_y_[i] = std::cos(1.1 * i);
    }
  }
  ConstRow w(int row) { return {w_.x(row), w_.y(row)}; }

  RollingRows w_{columns};
  std::vector<double> v_x_ = std::vector<double>(columns), v_y_ = v_x_, u_x_ = v_x_, u_y_ = v_x_;
};

INSTANTIATE_TEST_SUITE_P(Spans, PushRow, ::testing::Values(Span{1, 39}, Span{1, 2}, Span{5, 5}, Span{3, 20}),
                         [](const auto& p) {
                           return "from" + std::to_string(p.param.begin) + "to" + std::to_string(p.param.end);
                         });

TEST_P(PushRow, IsTheStencilThenTheMoveWithItsSums) {
  const Span span = GetParam();
  constexpr double dt = 0.1;
  auto v_x = v_x_, v_y = v_y_, u_x = u_x_, u_y = u_y_;
  add_interior_row(stencil, span, w(0), w(1), w(2), v_x.data(), v_y.data());
  for (int i = span.begin; i < span.end; ++i) u_x[i] += dt * v_x[i], u_y[i] += dt * v_y[i];
  KickSums expected;
  for (int i = span.begin; i < span.end; ++i) {
    const double d_x = v_x[i] - v_x_[i], d_y = v_y[i] - v_y_[i];
    expected.w_d += w(1).x[i] * d_x + w(1).y[i] * d_y;
    expected.v_d += v_x_[i] * d_x + v_y_[i] * d_y;
    expected.d_d += d_x * d_x + d_y * d_y;
  }
  for (const bool with_sums : {false, true}) {
    auto a = v_x_, b = v_y_, c = u_x_, d = u_y_;
    KickSums sums;
    const auto push = with_sums ? push_interior_row<true, double> : push_interior_row<false, double>;
    push(stencil, span, dt, w(0), w(1), w(2), a.data(), b.data(), c.data(), d.data(), sums);
    // The terms are of order 1 and added in another order.
    constexpr double rounding = 1e-14;
    for (int i = 0; i < columns; ++i) {
      EXPECT_NEAR(a[i], v_x[i], rounding);
      EXPECT_NEAR(b[i], v_y[i], rounding);
      EXPECT_NEAR(c[i], u_x[i], rounding);
      EXPECT_NEAR(d[i], u_y[i], rounding);
    }
    if (!with_sums) continue;
    EXPECT_NEAR(sums.w_d, expected.w_d, columns * rounding);
    EXPECT_NEAR(sums.v_d, expected.v_d, columns * rounding);
    EXPECT_NEAR(sums.d_d, expected.d_d, columns * rounding);
  }
}

TEST_P(PushRow, InSinglePrecisionIsTheSameButForRounding) {
  const Span span = GetParam();
  constexpr double dt = 0.1;
  auto v_x = v_x_, v_y = v_y_, u_x = u_x_, u_y = u_y_;
  KickSums expected, sums;
  push_interior_row<true>(stencil, span, dt, w(0), w(1), w(2), v_x.data(), v_y.data(), u_x.data(), u_y.data(),
                          expected);
  RollingRowsOf<float> single(columns);
  for (int row = 0; row < 3; ++row) {
    convert_row(columns, w_.x(row), single.x(row));
    convert_row(columns, w_.y(row), single.y(row));
  }
  const auto row = [&](int j) { return ConstRowOf<float>{single.x(j), single.y(j)}; };
  const auto rounded = [](const std::vector<double>& values) {
    return std::vector<float>(values.begin(), values.end());
  };
  auto a = rounded(v_x_), b = rounded(v_y_), c = rounded(u_x_), d = rounded(u_y_);
  push_interior_row<true>(stencil, span, dt, row(0), row(1), row(2), a.data(), b.data(), c.data(), d.data(),
                          sums);
  // Some ten terms of order 1 to 3, each rounded to 6e-8.
  constexpr double rounding = 2e-6;
  for (int i = 0; i < columns; ++i) {
    EXPECT_NEAR(a[i], v_x[i], rounding);
    EXPECT_NEAR(b[i], v_y[i], rounding);
    EXPECT_NEAR(c[i], u_x[i], rounding);
    EXPECT_NEAR(d[i], u_y[i], rounding);
  }
  EXPECT_NEAR(sums.w_d, expected.w_d, columns * 5 * rounding);
  EXPECT_NEAR(sums.v_d, expected.v_d, columns * 5 * rounding);
  EXPECT_NEAR(sums.d_d, expected.d_d, columns * 5 * rounding);
}

TEST_P(PushRow, DoesNotLookAtWhatStandsBeyondTheNeighbours) {
  const Span span = GetParam();
  if (span.begin == span.end) return;
  auto a = v_x_, b = v_y_, c = u_x_, d = u_y_;
  KickSums sums;
  push_interior_row<true>(stencil, span, 0.1, w(0), w(1), w(2), a.data(), b.data(), c.data(), d.data(), sums);
  for (int row = 0; row < 3; ++row)
    for (int i = -lanes; i < columns + lanes; ++i)
      if (i < span.begin - 1 || i > span.end)
        w_.x(row)[i] = w_.y(row)[i] = std::numeric_limits<double>::quiet_NaN();
  auto e = v_x_, f = v_y_, g = u_x_, h = u_y_;
  KickSums again;
  push_interior_row<true>(stencil, span, 0.1, w(0), w(1), w(2), e.data(), f.data(), g.data(), h.data(),
                          again);
  EXPECT_EQ(e, a);
  EXPECT_EQ(f, b);
  EXPECT_EQ(g, c);
  EXPECT_EQ(h, d);
  EXPECT_EQ(again.w_d, sums.w_d);
}

}  // namespace
}  // namespace slipfront::solid
