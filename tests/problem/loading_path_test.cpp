// SPDX-License-Identifier: BSD-3-Clause
#include "problem/loading_path.hpp"

#include <gtest/gtest.h>

namespace slipfront::problem {
namespace {

TEST(LoadingPath, IsStraightWithoutTimes) {
  constexpr double speed = 1e-3;
  const LoadingPath path({}, speed);
  EXPECT_EQ(path.end_s(), infinity);
  EXPECT_DOUBLE_EQ(path.shear_m(3), 3 * speed);
  EXPECT_DOUBLE_EQ(path.time_s(3 * speed, 0), 3);
  EXPECT_EQ(path.time_s(3 * speed, 4), 4);
  EXPECT_EQ(path.part_end_s(3), infinity);
  EXPECT_EQ(path.speed_m_per_s(3, 0), speed);
}

TEST(LoadingPath, GoesFromPlaceToPlace) {
  input::Sequence sequence;
  sequence.path = {{2, 10, 11}, {4e-6, 4e-6, 10e-6}};  // slide, hold, slide
  const LoadingPath path(sequence, 1);
  EXPECT_EQ(path.end_s(), 11);
  EXPECT_DOUBLE_EQ(path.shear_m(1), 2e-6);
  EXPECT_DOUBLE_EQ(path.shear_m(5), 4e-6);
  EXPECT_DOUBLE_EQ(path.shear_m(10.5), 7e-6);
  EXPECT_DOUBLE_EQ(path.shear_m(12), 10e-6);
  EXPECT_EQ(path.time_s(0, 0), 0);
  EXPECT_DOUBLE_EQ(path.time_s(4e-6, 0), 2);
  EXPECT_DOUBLE_EQ(path.time_s(7e-6, 0), 10.5);
  EXPECT_EQ(path.time_s(11e-6, 0), infinity);
  EXPECT_EQ(path.part_end_s(0), 2);
  EXPECT_EQ(path.part_end_s(2), 10);
  // Somewhat ahead of the path, it waits.
  EXPECT_DOUBLE_EQ(path.speed_m_per_s(2, 4.8e-6), -1e-7);
  sequence.end_s = 10.5;
  EXPECT_EQ(LoadingPath(sequence, 1).end_s(), 10.5);
  EXPECT_EQ(LoadingPath(sequence, 1).part_end_s(10), 10.5);
}

}  // namespace
}  // namespace slipfront::problem
