// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verification.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <limits>

namespace slipfront::verification {
namespace {

class Quick : public ::testing::TestWithParam<Verification> {};

TEST_P(Quick, Holds) {
  const auto outcome = GetParam().run(Effort::quick);
  EXPECT_FALSE(outcome.checks.empty());
  for (const auto& c : outcome.checks)
    EXPECT_TRUE(c.holds()) << fmt::format("{}: {:.10g} {}, expected {:.10g} +- {:.3g}", c.quantity,
                                          c.measured, c.unit, c.expected, c.tolerance);
  for (const auto& chart : outcome.charts)
    for (const auto& curve : chart.curves) {
      EXPECT_FALSE(curve.x.empty()) << curve.label;
      EXPECT_EQ(curve.x.size(), curve.y.size()) << curve.label;
    }
}

INSTANTIATE_TEST_SUITE_P(Verifications, Quick, ::testing::ValuesIn(verifications()),
                         [](const auto& v) { return v.param.name; });

TEST(Check, HoldsWithinItsToleranceOnly) {
  Check check{.quantity = "q", .measured = 1.5, .expected = 1, .tolerance = 0.5};
  EXPECT_TRUE(check.holds());
  for (const double outside : {1.6, 0.4, std::numeric_limits<double>::quiet_NaN()}) {
    check.measured = outside;
    EXPECT_FALSE(check.holds());
  }
  EXPECT_FALSE(Outcome{}.holds());  // without checks
}

}  // namespace
}  // namespace slipfront::verification
