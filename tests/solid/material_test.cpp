// SPDX-License-Identifier: BSD-3-Clause
#include "solid/material.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reference.hpp"

namespace slipfront::solid {
namespace {

constexpr double rounding = 1e-14;  // a handful of operations

TEST(Material, WaveSpeedsOfPmmaInPlaneStress) {
  const Material pmma;
  // Kammer et al. 2012 give E, nu and rho; c_L = sqrt(E / (rho (1 - nu^2))), c_S = sqrt(E / (2 rho (1 +
  // nu))).
  EXPECT_NEAR(longitudinal_speed_m_per_s(pmma) / std::sqrt(2.6e9 / (1200 * (1 - 0.1369))), 1, rounding);
  EXPECT_NEAR(shear_speed_m_per_s(pmma) / std::sqrt(2.6e9 / (1200 * 2.74)), 1, rounding);
  EXPECT_NEAR(longitudinal_speed_m_per_s(pmma), 1584, 0.5);
  EXPECT_NEAR(shear_speed_m_per_s(pmma), 889, 0.5);
  EXPECT_NEAR(rayleigh_speed_m_per_s(pmma), 820, 0.5);
}

TEST(Material, PlaneStrainIsPlaneStressWithOtherConstants) {
  const Material strain{.poissons_ratio = 0.3, .plane = Plane::strain};
  Material stress = strain;
  stress.plane = Plane::stress;
  stress.youngs_modulus_Pa = strain.youngs_modulus_Pa / (1 - 0.09);
  stress.poissons_ratio = 0.3 / 0.7;
  EXPECT_NEAR(longitudinal_modulus_Pa(strain) / longitudinal_modulus_Pa(stress), 1, rounding);
  EXPECT_NEAR(shear_modulus_Pa(strain) / shear_modulus_Pa(stress), 1, rounding);
  EXPECT_NEAR(rayleigh_speed_m_per_s(strain) / rayleigh_speed_m_per_s(stress), 1, 1e-12);
  // The textbook's c_L of a large body.
  EXPECT_NEAR(longitudinal_modulus_Pa(strain) / (2.6e9 * 0.7 / (1.3 * 0.4)), 1, rounding);
}

TEST(Material, RayleighSpeedWhereItHasAClosedForm) {
  // c_L^2 = 3 c_S^2: c_R^2 / c_S^2 = 2 - 2/sqrt(3); c_L^2 = 2 c_S^2: 3 - sqrt(5). The bisection is good to
  // rounding; the root's condition costs a few digits.
  const auto ratio = [](const Material& m) { return rayleigh_speed_m_per_s(m) / shear_speed_m_per_s(m); };
  const double three = std::sqrt(2 - 2 / std::sqrt(3.0)), two = std::sqrt(3 - std::sqrt(5.0));
  EXPECT_NEAR(ratio({.poissons_ratio = 0.25, .plane = Plane::strain}), three, 1e-12);
  EXPECT_NEAR(ratio({.poissons_ratio = 1.0 / 3, .plane = Plane::stress}), three, 1e-12);
  EXPECT_NEAR(ratio({.poissons_ratio = 0, .plane = Plane::strain}), two, 1e-12);
  EXPECT_NEAR(ratio({.poissons_ratio = 0, .plane = Plane::stress}), two, 1e-12);
}

TEST(Material, UniaxialStressIsThatOfAFreeColumn) {
  Material m;
  EXPECT_NEAR(uniaxial_modulus_Pa(m), 2.6e9, 1e-3);
  m.plane = Plane::strain;
  EXPECT_NEAR(uniaxial_modulus_Pa(m), 2.6e9 / (1 - 0.37 * 0.37), 1e-3);
}

TEST(Material, ElasticityInvertsTheCompliance) {
  for (const auto plane : {Plane::stress, Plane::strain}) {
    const Material m{.poissons_ratio = 0.31, .plane = plane};
    const auto D = elasticity_Pa(m);
    const Eigen::Matrix3d expected = reference::elasticity(m);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(D[k], expected(k / 3, k % 3), 1e-13 * m.youngs_modulus_Pa) << k;
  }
}

}  // namespace
}  // namespace slipfront::solid
