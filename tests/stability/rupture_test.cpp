// SPDX-License-Identifier: BSD-3-Clause
#include "stability/rupture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>

#include "interface/friction/rate_and_state.hpp"

namespace slipfront::stability {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The rock of SCEC's TPV3: 2670 kg/m3, 6000 and 3464 m/s.
solid::Material rock() {
  const double G = 2670 * 3464.0 * 3464.0;
  return {.youngs_modulus_Pa = 2.5 * G,
          .poissons_ratio = 0.25,
          .density_kg_per_m3 = 2670,
          .plane = solid::Plane::strain};
}

/// Its fault: strength 81.24, traction 70, residual strength 63 MPa, d_c 0.4 m.
const NodeBefore tpv3 = {70e6, 81.24e6, 63e6, 0.4};

TEST(Rupture, TheModulusIsThatOfThePlaneState) {
  auto m = rock();
  EXPECT_NEAR(modulus_Pa({m, m}), m.youngs_modulus_Pa / (2 * (1 - 0.0625)), 1);
  m.plane = solid::Plane::stress;
  EXPECT_NEAR(modulus_Pa({m, m}), m.youngs_modulus_Pa / 2, 1);
  // On the rigid plane one body takes the whole slip and cannot move away; a base ever stiffer comes to that.
  EXPECT_NEAR(modulus_Pa(m), 8 * solid::shear_modulus_Pa(m) / (3 - m.poissons_ratio), 1);
  auto stiff = m;
  stiff.youngs_modulus_Pa *= 1e9;
  EXPECT_NEAR(modulus_Pa({m, stiff}) / modulus_Pa(m), 1, 1e-8);
}

TEST(Rupture, TheProcessZoneIsThePublishedOne) {
  // Day et al. (2005), for this problem in mode II: 827 m.
  EXPECT_NEAR(process_zone_m(modulus_Pa({rock(), rock()}), 81.24e6 - 63e6, 0.4), 827, 1);
}

/// Smallest eigenvalue of the static stiffness of a slip zone of half-length 1 under mu* = 1, in n elements
/// of constant slip.
double smallest_stiffness(int n) {
  const double e = 1.0 / n;  // half an element
  Eigen::MatrixXd stiffness(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double d = 2 * e * (i - j);
      stiffness(i, j) = (1 / (d + e) - 1 / (d - e)) / (2 * std::numbers::pi);
    }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues()(0);
}

TEST(Rupture, TheNucleationLengthIsWhereWeakeningOutrunsTheStiffness) {
  // Elements of constant slip are stiff by half an element at each tip: extrapolated to none.
  const double coarse = smallest_stiffness(40), fine = smallest_stiffness(80);
  EXPECT_NEAR(nucleation_length_m(1, 1, 1) / 2, 2 * fine - coarse, 0.001);
}

TEST(Rupture, GriffithsLengthIsAndrews) {
  // Andrews (1976): 8 G (lambda + G)/(pi (lambda + 2 G)) times the energy of one face over the drop squared.
  const auto m = rock();
  const double G = solid::shear_modulus_Pa(m), lambda = G;  // nu = 0.25
  const double face_J_per_m2 = 0.25 * (81.24e6 - 63e6) * 0.4;
  const double andrews_m =
      8 * G * (lambda + G) / (std::numbers::pi * (lambda + 2 * G)) * face_J_per_m2 / 49e12;
  EXPECT_NEAR(griffith_half_length_m(modulus_Pa({m, m}), 81.24e6 - 63e6, 0.4, 7e6) / andrews_m, 1, 1e-12);
  EXPECT_EQ(griffith_half_length_m(1, 1, 1, 0), infinity);
}

TEST(Rupture, FrontsPassTheShearSpeedBelowTheCriticalExcess) {
  EXPECT_NEAR(supershear_half_length_m(2, 0.77), 19.6, 1e-9);
  EXPECT_EQ(supershear_half_length_m(2, 1.77), infinity);
}

TEST(Rupture, LengthsOfALawWithAState) {
  // Problem R-A of docs/friction/rate_and_state.md: L_b = 7.5 mm, a/b = 1/2.
  const solid::Material m{.youngs_modulus_Pa = 3e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 1180};
  const interface::RateAndStateAging law;
  NodeBefore node{2.65e6, 3.3e6, 2.4e6, {}, 5e6, interface::state_response(law, 0)};
  const auto o = outlook({m, m}, {node, node});
  const double L_b_m = 7.5e-3, pi = std::numbers::pi;
  EXPECT_NEAR(*o.nucleation_length_m, 8 * L_b_m / pi, 1e-9);
  EXPECT_NEAR(*o.unstable_wavelength_m, 2 * pi * L_b_m, 1e-9);
  EXPECT_NEAR(*o.process_zone_m, 9 * pi / 32 * L_b_m, 1e-9);
  EXPECT_THAT(o.regime, StartsWith("unknown"));
  node.state->b = 0.03;
  EXPECT_NEAR(nucleation_length_m(1.5e9, *node.state, 5e6), 2.7548 * 1.5e9 * 0.4e-6 / 0.15e6, 1e-9);
  node.state->b = 0.008;
  EXPECT_EQ(unstable_wavelength_m(1.5e9, *node.state, 5e6), infinity);
  EXPECT_EQ(nucleation_length_m(1.5e9, *node.state, 5e6), infinity);
}

TEST(Rupture, StrengthExcess) {
  EXPECT_NEAR(strength_excess(tpv3), 11.24 / 7, 1e-12);
  EXPECT_EQ(strength_excess({60e6, 81.24e6, 63e6, {}}), infinity);
}

TEST(Rupture, SpreadHasTheMedian) {
  const auto odd = spread_of({3, 1, 2}), even = spread_of({4, 1, 2, 3});
  EXPECT_EQ(odd.least, 1);
  EXPECT_EQ(odd.median, 2);
  EXPECT_EQ(odd.largest, 3);
  EXPECT_EQ(even.median, 2.5);
  EXPECT_TRUE(std::isnan(spread_of({}).median));
}

TEST(Rupture, OutlookOfAFault) {
  const auto o = outlook({rock(), rock()}, {tpv3, tpv3, {75e6, 81.24e6, 63e6, 0.4}});
  EXPECT_EQ(o.n_nodes, 3);
  EXPECT_EQ(o.n_driven, 3);
  EXPECT_NEAR(o.S.median, 11.24 / 7, 1e-12);
  EXPECT_NEAR(o.S.least, 6.24 / 12, 1e-12);
  EXPECT_NEAR(o.drop_ratio.median, 1 / (1 + 11.24 / 7), 1e-12);
  EXPECT_NEAR(*o.process_zone_m, 827, 1);
  EXPECT_NEAR(*o.griffith_half_length_m, 2025, 5);
  EXPECT_THAT(o.regime, StartsWith("S < 1.77: fronts above c_S can form"));
}

TEST(Rupture, OutlookSaysWhatRuns) {
  constexpr NodeBefore safe = {60e6, 81e6, 63e6, 0.4}, strong = {67e6, 81e6, 63e6, 0.4};
  const struct {
    Bodies bodies;
    NodeBefore node;
    const char* regime;
  } cases[] = {
      {rock(), safe, "nowhere below t"},
      {rock(), {60e6, 81e6, 81e6, {}}, "does not weaken"},
      {rock(), {70e6, 81e6, 63e6, {}}, "without a length in the law"},
      {rock(), {64e6, 81e6, 63e6, 0.4}, "beyond 10 at all nodes"},
      // A rigid plane lets fronts pass c_S whatever S.
      {{rock(), rock()}, strong, "sub-Rayleigh"},
      {rock(), strong, "they can pass c_S all the same"},
  };
  for (const auto& c : cases) {
    const auto o = outlook(c.bodies, {c.node});
    EXPECT_THAT(o.regime, HasSubstr(c.regime));
    EXPECT_FALSE(o.nucleation_length_m && !c.node.d_c_m);
  }
  const auto between = outlook(rock(), {safe, safe, tpv3});
  EXPECT_EQ(between.n_barriers, 2);
  EXPECT_NEAR(between.S.largest, 11.24 / 7, 1e-12);
}

}  // namespace
}  // namespace slipfront::stability
