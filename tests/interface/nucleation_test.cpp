// SPDX-License-Identifier: BSD-3-Clause
#include "interface/nucleation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slipfront::interface {
namespace {

constexpr Nucleation patch{.x_m = 0.2, .half_length_m = 0.02, .taper_m = 0.01};

TEST(Nucleation, ProfileIsFlatThenAHalfCosine) {
  const auto B = [](double along) { return nucleation_profile(patch, patch.x_m + along); };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(B(0), 1);
    EXPECT_EQ(B(side * 0.0199), 1);
    EXPECT_NEAR(B(side * 0.0225), 0.5 * (1 + std::sqrt(0.5)), 1e-12);
    EXPECT_NEAR(B(side * 0.025), 0.5, 1e-12);
    EXPECT_NEAR(B(side * 0.0275), 0.5 * (1 - std::sqrt(0.5)), 1e-12);
    EXPECT_EQ(B(side * 0.0301), 0);
  }
}

TEST(Nucleation, WithoutTaperItIsAStep) {
  Nucleation step = patch;
  step.taper_m = 0;
  EXPECT_EQ(nucleation_profile(step, 0.2199), 1);
  EXPECT_EQ(nucleation_profile(step, 0.2201), 0);
}

TEST(Nucleation, SmoothProfileIsThatOfTPV101) {
  Nucleation smooth = patch;
  smooth.profile = NucleationProfile::smooth;
  EXPECT_EQ(nucleation_profile(smooth, 0.2), 1);
  EXPECT_NEAR(nucleation_profile(smooth, 0.21), std::exp(-1.0 / 3), 1e-14);  // 1/(1 - 4) at half the length
  EXPECT_LT(nucleation_profile(smooth, 0.2 + 0.01999), 1e-200);
  EXPECT_EQ(nucleation_profile(smooth, 0.22), 0);
  EXPECT_EQ(smooth.reach_m(), 0.02);
  EXPECT_NEAR(nucleation_profile(smooth, 0.2 + 0.5 * smooth.length_m()), 0.5, 1e-12);
  EXPECT_NEAR(nucleation_profile(patch, 0.2 + 0.5 * patch.length_m()), 0.5, 1e-12);
}

TEST(Nucleation, ThePatchRepeatsWithThePlate) {
  Nucleation edge = patch;
  edge.x_m = 0.01;
  for (const double x : {0.0, 0.005, 0.032, 0.1, 0.2, 0.3, 0.375, 0.385, 0.395})
    EXPECT_NEAR(nucleation_profile(edge, x, 0.4),
                std::max(nucleation_profile(edge, x), nucleation_profile(edge, x - 0.4)), 1e-12)
        << x;
  EXPECT_EQ(nucleation_profile(edge, 0.395, 0.4), 1);
  EXPECT_EQ(nucleation_profile(edge, 0.395), 0);
}

}  // namespace
}  // namespace slipfront::interface
