// SPDX-License-Identifier: BSD-3-Clause
#include "record/record.hpp"

#include <gtest/gtest.h>

namespace slipfront::record {
namespace {

TEST(Record, IsConsistentWhereItsNodesAndLengthsAre) {
  SlipRecord good;
  good.x_m = {0, 1};
  good.halo = 1;
  good.onsets = {{1, 0.5}};
  good.around.resize(3);
  good.stops = {{0, 1}};
  EXPECT_TRUE(is_consistent(good));
  const auto expect_bad = [&](auto spoil) {
    SlipRecord bad = good;
    spoil(bad);
    EXPECT_FALSE(is_consistent(bad));
  };
  for (const int node : {-1, 2}) {
    expect_bad([&](SlipRecord& r) { r.onsets[0].node = node; });
    expect_bad([&](SlipRecord& r) { r.stops[0].node = node; });
  }
  expect_bad([](SlipRecord& r) { r.around.resize(2); });
  expect_bad([](SlipRecord& r) { r.halo = -1; });
}

}  // namespace
}  // namespace slipfront::record
