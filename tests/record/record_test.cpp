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
  for (const int node : {-1, 2}) {
    SlipRecord bad = good;
    bad.onsets[0].node = node;
    EXPECT_FALSE(is_consistent(bad)) << node;
    bad = good;
    bad.stops[0].node = node;
    EXPECT_FALSE(is_consistent(bad)) << node;
  }
  SlipRecord bad = good;
  bad.around.resize(2);
  EXPECT_FALSE(is_consistent(bad));
  bad = good;
  bad.halo = -1;
  EXPECT_FALSE(is_consistent(bad));
}

}  // namespace
}  // namespace slipfront::record
