// SPDX-License-Identifier: BSD-3-Clause
#include "processes/tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace slipfront {
namespace {

/// A process and all below it, in the order in which their answers are joined.
std::vector<int> with_all_below(int rank, int size) {
  std::vector<int> all = {rank};
  for (const int below : children_in_tree(rank, size))
    for (const int each : with_all_below(below, size)) all.push_back(each);
  return all;
}

TEST(Tree, ReachesEachProcessOnceInTheOrderOfNumbers) {
  for (int size = 1; size < 70; ++size) {
    std::vector<int> all;
    for (int rank = 0; rank < size; ++rank) all.push_back(rank);
    EXPECT_EQ(with_all_below(0, size), all);
  }
}

TEST(Tree, AboveIsWhereItIsBelowAndNoProcessHasMoreNeighboursThanDigits) {
  constexpr int size = 10'000;
  const auto digits = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(size - 1)));
  for (int rank = 0; rank < size; ++rank) {
    EXPECT_LE(children_in_tree(rank, size).size() + (rank > 0 ? 1 : 0), digits) << rank;
    if (rank > 0) {
      EXPECT_THAT(children_in_tree(parent_in_tree(rank), size), testing::Contains(rank));
    }
  }
}

}  // namespace
}  // namespace slipfront
