// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace slipfront {

// Ranks as a binomial tree: what rank 0 tells all others passes on from each rank to some others, and answers
// come back the same way, so that none has more neighbours than the number of ranks has binary digits. Those
// below a rank, with itself, have numbers one after the other.

/// Parent of each rank but 0.
inline int parent_in_tree(int rank) {
  return rank & (rank - 1);
}

/// Ascending; those below each of them come before the next one.
inline std::vector<int> children_in_tree(int rank, int size) {
  std::vector<int> below;
  for (long distance = 1; rank + distance < size && (rank & distance) == 0; distance *= 2)
    below.push_back(static_cast<int>(rank + distance));
  return below;
}

}  // namespace slipfront
