// SPDX-License-Identifier: BSD-3-Clause
#include "base/budget.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace slipfront {
namespace {

const Budget two = {{"the mesh", 2e9, "a larger size"}, {"the rows", 3e9, "a larger interval"}};

std::string refusal(const Budget& budget, double available) {
  return test::error_of([&] {
    require_room(budget, available, "the run", "on disk", "out has 4 GB free", " or another folder");
  });
}

TEST(Budget, IsRefusedByItsLargestItemAndThatOnesRemedy) {
  EXPECT_EQ(refusal(two, 5e9), "(nothing thrown)");
  EXPECT_EQ(
      refusal(two, 4.999e9),
      "the run needs about 5 GB on disk, 3 GB of it for the rows, and out has 4 GB free; choose a larger "
      "interval or another folder");
  EXPECT_EQ(refusal({}, 0), "(nothing thrown)");
}

TEST(Budget, OfMemoryIsComparedWithWhatThereIs) {
  require_memory({{"a page", 4096, "less"}}, "the test");
  EXPECT_THROW(require_memory({{"all of it", 1e18, "less"}}, "the test"), UserError);
}

}  // namespace
}  // namespace slipfront
