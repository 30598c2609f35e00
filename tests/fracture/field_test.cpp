// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace slipfront::fracture {
namespace {

using std::numbers::pi;

const solid::Material m{.youngs_modulus_Pa = 5.65e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 1180};

struct Setting {
  Bodies bodies;
  double speed_m_per_s;
};

/// Equal bodies and the rigid plane, in both planes, slow to fast.
std::vector<Setting> settings() {
  std::vector<Setting> all;
  for (const auto plane : {solid::Plane::stress, solid::Plane::strain})
    for (const double share : {0.2, 0.7, 0.95}) {
      auto of = m;
      of.plane = plane;
      for (const auto& bodies : {Bodies(of), Bodies(of, of)})
        all.push_back({bodies, share * limiting_speed_m_per_s(bodies)});
    }
  return all;
}

/// d/dx or d/dy by a central difference of fourth order.
template <class Of>
double slope(const Of& of, double h) {
  return (8 * (of(h) - of(-h)) - (of(2 * h) - of(-2 * h))) / (12 * h);
}

// Of strains, div stress = rho V^2 u_xx = rho V^2 (d strain_xx/dx, 2 d strain_xy/dx - d strain_xx/dy): the
// particles' acceleration.
TEST(TipField, IsInDynamicEquilibrium) {
  for (const auto& [bodies, v] : settings())
    for (const int along_x : {1, -1})
      for (const double angle : {0.2, 1.0, 2.0, 3.0, -0.7, -2.5}) {
        if (!bodies.below && angle < 0) continue;
        const TipField field(bodies, v, along_x);
        const double x = std::cos(angle), y = std::sin(angle), h = 1e-3;
        const auto dx = [&](auto of) { return slope([&](double d) { return of(x + d, y); }, h); };
        const auto dy = [&](auto of) { return slope([&](double d) { return of(x, y + d); }, h); };
        const auto s = [&](double PlaneTensor::*c) {
          return [&field, c](double px, double py) { return field.stress_per_K(px, py).*c; };
        };
        const auto e = [&](double PlaneTensor::*c) {
          return [&field, c](double px, double py) { return field.strain_per_K(px, py).*c; };
        };
        const double inertia = bodies.above.density_kg_per_m3 * v * v;
        // Its terms are of the size of inertia times d strain/dx, and up to the stresses' slopes.
        const double size = std::abs(dx(s(&PlaneTensor::xx))) + std::abs(dy(s(&PlaneTensor::xy)));
        EXPECT_NEAR(dx(s(&PlaneTensor::xx)) + dy(s(&PlaneTensor::xy)), inertia * dx(e(&PlaneTensor::xx)),
                    1e-8 * size);
        EXPECT_NEAR(dx(s(&PlaneTensor::xy)) + dy(s(&PlaneTensor::yy)),
                    inertia * (2 * dx(e(&PlaneTensor::xy)) - dy(e(&PlaneTensor::xx))), 1e-8 * size);
      }
}

TEST(TipField, TractionsOnTheInterface) {
  for (const auto& [bodies, v] : settings())
    for (const int along_x : {1, -1}) {
      const TipField field(bodies, v, along_x);
      for (const double r : {1e-3, 0.5}) {
        EXPECT_NEAR(field.stress_per_K(along_x * r, 0).xy * std::sqrt(2 * pi * r), 1, 1e-12);
        for (const double y : {0.0, -0.0}) {
          const auto behind = field.stress_per_K(-along_x * r, y);
          const double size = std::abs(behind.xx);
          EXPECT_NEAR(behind.xy, 0, 1e-12 * size);
          if (!bodies.below) continue;
          EXPECT_NEAR(behind.yy, 0, 1e-12 * size);
          EXPECT_NEAR(field.stress_per_K(along_x * r, y).yy, 0, 1e-12 * size);
        }
      }
    }
}

TEST(TipField, RigidPlaneHoldsTheBodyUp) {
  const Bodies bodies(m);
  const TipField field(bodies, 800);
  // u_y = 0 at y = 0: 2 strain_xy = du_x/dy, whose slope along x is that of strain_xx upwards.
  const double h = 1e-4, size = field.strain_per_K(0.5, 0).xy;
  for (const double x : {-0.5, 0.5}) {
    const double along = slope([&](double d) { return 2 * field.strain_per_K(x + d, 0).xy; }, h);
    // One-sided, of second order.
    const auto up = [&](double y) { return field.strain_per_K(x, y).xx; };
    const double upwards = (4 * up(h) - up(2 * h) - 3 * up(0)) / (2 * h);
    EXPECT_NEAR(along, upwards, 1e-6 * size);
  }
  EXPECT_TRUE(std::isnan(field.stress_per_K(0.5, -0.1).xy));
}

/// The bodies' slip, whose slope is what their edges' strain_xx differs by, is that of tip.hpp: so is the
/// energy that flows to the tip, K times this slip.
TEST(TipField, SlipIsThatOfTheEnergyReleaseRate) {
  for (const auto& [bodies, v] : settings())
    for (const int along_x : {1, -1}) {
      const TipField field(bodies, v, along_x);
      const double r = 0.01, x = -along_x * r;
      const double below = bodies.below ? field.strain_per_K(x, -0.0).xx : 0;
      const double slope_per_K =
          field.strain_per_K(x, 0).xx - below;  // slip = 2 r times this, towards the tip
      const double slip_per_K = -along_x * slope_per_K * 2 * r;
      const double G = energy_release_rate_J_per_m2(bodies, v, 1);
      EXPECT_GT(slip_per_K, 0);
      EXPECT_NEAR(slip_per_K * slip_per_K / (slip_squared_per_G_and_distance(bodies, v) * G * r), 1, 1e-9);
    }
}

TEST(TipField, AtRestAsInTextbooks) {
  const TipField field(Bodies(m, m), 0);
  for (const double angle : {-2.5, -1.0, 0.3, 1.5, 3.0}) {
    const auto s = field.stress_per_K(std::cos(angle), std::sin(angle));
    const double sine = std::sin(angle / 2), cosine = std::cos(angle / 2), size = 1 / std::sqrt(2 * pi);
    const double third_s = std::sin(1.5 * angle), third_c = std::cos(1.5 * angle);
    EXPECT_NEAR(s.xx, -size * sine * (2 + cosine * third_c), 1e-7);
    EXPECT_NEAR(s.yy, size * sine * cosine * third_c, 1e-7);
    EXPECT_NEAR(s.xy, size * cosine * (1 - sine * third_s), 1e-7);
  }
}

TEST(TipField, HasNoneBeyondTheLimitOrBetweenUnequalBodies) {
  auto stiff = m;
  stiff.youngs_modulus_Pa *= 2;
  const Bodies alike(m, m);
  EXPECT_TRUE(std::isnan(TipField(alike, 1.001 * limiting_speed_m_per_s(alike)).stress_per_K(1, 1).xx));
  EXPECT_TRUE(std::isnan(TipField(Bodies(m, stiff), 500).stress_per_K(1, 1).xx));
}

}  // namespace
}  // namespace slipfront::fracture
