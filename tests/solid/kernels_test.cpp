// SPDX-License-Identifier: BSD-3-Clause
#include "solid/kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slipfront::solid {
namespace {

constexpr int columns = 40;
constexpr InteriorStencil stencil{-3.0, 0.5, 0.25, 0.125, 0.375};
constexpr double dt = 0.1;

/// v_x, v_y, u_x, u_y of a row of nodes, and what has been added up of them.
template <class T>
struct Motion {
  std::vector<T> at[4];
  KickSums sums;

  Motion() {
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < columns; ++i) at[k].push_back(static_cast<T>(std::sin((0.3 + 0.2 * k) * i + k)));
  }
  template <bool with_sums = true>
  void push(Span span, RollingRowsOf<T>& w) {
    const auto row = [&](int j) { return ConstRowOf<T>{w.x(j), w.y(j)}; };
    push_interior_row<with_sums>(stencil, span, dt, row(0), row(1), row(2), at[0].data(), at[1].data(),
                                 at[2].data(), at[3].data(), sums);
  }
};

template <class T>
void expect_near(const Motion<T>& a, const Motion<double>& b, double rounding) {
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < columns; ++i) EXPECT_NEAR(a.at[k][i], b.at[k][i], rounding);
}

void expect_near(const KickSums& a, const KickSums& b, double rounding) {
  EXPECT_NEAR(a.w_d, b.w_d, rounding);
  EXPECT_NEAR(a.v_d, b.v_d, rounding);
  EXPECT_NEAR(a.d_d, b.d_d, rounding);
}

class PushRow : public ::testing::TestWithParam<Span> {
 protected:
  PushRow() {
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < columns; ++i) {
        w_.x(row)[i] = std::sin(1.0 + 3 * i + 7 * row);
        w_.y(row)[i] = std::cos(2.0 + 5 * i + 11 * row);
      }
  }
  Span span_ = GetParam();
  RollingRows w_{columns};
};

INSTANTIATE_TEST_SUITE_P(Spans, PushRow, ::testing::Values(Span{1, 39}, Span{1, 2}, Span{5, 5}, Span{3, 20}),
                         [](const auto& p) {
                           return "from" + std::to_string(p.param.begin) + "to" + std::to_string(p.param.end);
                         });

TEST_P(PushRow, IsTheStencilThenTheMoveWithItsSums) {
  const Motion<double> before;
  Motion<double> expected;
  auto& [v_x, v_y, u_x, u_y] = expected.at;
  const auto row = [&](int j) { return ConstRow{w_.x(j), w_.y(j)}; };
  add_interior_row(stencil, span_, row(0), row(1), row(2), v_x.data(), v_y.data());
  for (int i = span_.begin; i < span_.end; ++i) {
    u_x[i] += dt * v_x[i];
    u_y[i] += dt * v_y[i];
    const double d_x = v_x[i] - before.at[0][i], d_y = v_y[i] - before.at[1][i];
    expected.sums.w_d += w_.x(1)[i] * d_x + w_.y(1)[i] * d_y;
    expected.sums.v_d += before.at[0][i] * d_x + before.at[1][i] * d_y;
    expected.sums.d_d += d_x * d_x + d_y * d_y;
  }
  constexpr double rounding = 1e-14;  // the terms are of order 1 and added in another order
  Motion<double> with_sums, without;
  with_sums.push(span_, w_);
  without.push<false>(span_, w_);
  expect_near(with_sums, expected, rounding);
  expect_near(without, expected, rounding);
  expect_near(with_sums.sums, expected.sums, columns * rounding);
}

TEST_P(PushRow, InSinglePrecisionIsTheSameButForRounding) {
  RollingRowsOf<float> single(columns);
  for (int row = 0; row < 3; ++row) {
    convert_row(columns, w_.x(row), single.x(row));
    convert_row(columns, w_.y(row), single.y(row));
  }
  Motion<double> expected;
  Motion<float> rounded;
  expected.push(span_, w_);
  rounded.push(span_, single);
  constexpr double rounding = 2e-6;  // some ten terms of order 1 to 3, each rounded to 6e-8
  expect_near(rounded, expected, rounding);
  expect_near(rounded.sums, expected.sums, columns * 5 * rounding);
}

TEST_P(PushRow, DoesNotLookAtWhatStandsBeyondTheNeighbours) {
  if (span_.begin == span_.end) return;
  Motion<double> a, b;
  a.push(span_, w_);
  for (int row = 0; row < 3; ++row)
    for (int i = -lanes; i < columns + lanes; ++i)
      if (i < span_.begin - 1 || i > span_.end)
        w_.x(row)[i] = w_.y(row)[i] = std::numeric_limits<double>::quiet_NaN();
  b.push(span_, w_);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(a.at[k], b.at[k]);
  EXPECT_EQ(a.sums.w_d, b.sums.w_d);
}

}  // namespace
}  // namespace slipfront::solid
