// SPDX-License-Identifier: BSD-3-Clause
#include "solid/element.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "reference.hpp"

namespace slipfront::solid {
namespace {

constexpr CellCoordinates square = {0, 0, 1e-3, 0, 1e-3, 1e-3, 0, 1e-3};
constexpr CellCoordinates parallelogram = {1, 1, 3, 1.5, 3.4, 2.9, 1.4, 2.4};
constexpr CellCoordinates distorted = {0, 0, 2, 0.3, 2.4, 1.7, -0.2, 1.2};

Eigen::MatrixXd matrix(const CellStiffness& K) {
  return Eigen::Map<const Eigen::Matrix<double, 8, 8, Eigen::RowMajor>>(K.data());
}

TEST(Element, SquareHasTheTextbookStiffness) {
  // Bilinear square in plane stress, times E / (1 - nu^2): first row of the matrix, nodes counterclockwise.
  const Material m;
  const double nu = m.poissons_ratio, scale = m.youngs_modulus_Pa / (1 - nu * nu);
  const std::array<double, 8> row = {
      1.0 / 2 - nu / 6,  1.0 / 8 + nu / 8, -1.0 / 4 - nu / 12,  -1.0 / 8 + 3 * nu / 8, -1.0 / 4 + nu / 12,
      -1.0 / 8 - nu / 8, nu / 6,           1.0 / 8 - 3 * nu / 8};
  const auto K = cell_stiffness(square, m);
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(K[k] / scale, row[k], 1e-14) << k;
}

TEST(Element, EqualsTheReferenceIntegration) {
  for (const auto plane : {Plane::stress, Plane::strain}) {
    const Material m{.poissons_ratio = 0.29, .plane = plane};
    const double tolerance = 1e-13 * m.youngs_modulus_Pa;  // rounding of some ten operations an entry
    for (const auto& cell : {square, parallelogram, distorted})
      EXPECT_LE(reference::max_abs(matrix(cell_stiffness(cell, m)) - reference::stiffness(cell, m, 2)),
                tolerance);
    // On a parallelogram the integrand is a polynomial that two points a side integrate exactly.
    EXPECT_LE(reference::max_abs(matrix(cell_stiffness(parallelogram, m)) -
                                 reference::stiffness(parallelogram, m, 3)),
              tolerance);
  }
}

TEST(Element, APlaceIsFoundByItsShapeFunctions) {
  const CellCoordinates c = {0, 0, 1.2, 0.1, 1.4, 0.9, -0.1, 1.1};
  for (const double xi : {-1.0, -0.3, 0.0, 0.8, 1.0})
    for (const double eta : {-1.0, -0.7, 0.2, 1.0}) {
      const auto shape = cell_shape(c, xi, eta);
      double x = 0, y = 0;
      for (int a = 0; a < 4; ++a) x += shape.value[a] * c[2 * a], y += shape.value[a] * c[2 * a + 1];
      const auto found = cell_shape_at(c, x, y);
      ASSERT_TRUE(found) << xi << " " << eta;
      for (int a = 0; a < 4; ++a) {
        EXPECT_NEAR(found->value[a], shape.value[a], 1e-12);
        EXPECT_NEAR(found->d_dx[a], shape.d_dx[a], 1e-11);
        EXPECT_NEAR(found->d_dy[a], shape.d_dy[a], 1e-11);
      }
    }
  for (const auto& [x, y] : {std::pair(-0.2, 0.5), {1.5, 0.5}, {0.6, -0.01}, {0.6, 1.2}, {1e6, -1e6}})
    EXPECT_FALSE(cell_shape_at(c, x, y)) << x << " " << y;
}

TEST(Element, StressFollowsHookesLaw) {
  CellShape shape = cell_shape({0, 0, 1, 0, 1, 1, 0, 1}, 0.1, -0.2);
  // u_x = 3 x + y, u_y = 5 x - 2 y
  const std::array<double, 8> u_m = {0, 0, 3, 5, 4, 3, 1, -2};
  for (const auto plane : {Plane::stress, Plane::strain}) {
    const Material m{.plane = plane};
    const double E = m.youngs_modulus_Pa, nu = m.poissons_ratio;
    const auto e = strain(shape, u_m, m);
    EXPECT_NEAR(e.xx, 3, 1e-14);
    EXPECT_NEAR(e.yy, -2, 1e-14);
    EXPECT_NEAR(e.xy, 3, 1e-14);
    const auto s = stress_Pa(e, m);
    EXPECT_NEAR((s.xx - nu * (s.yy + s.zz)) / E, e.xx, 1e-13);
    EXPECT_NEAR((s.yy - nu * (s.xx + s.zz)) / E, e.yy, 1e-13);
    EXPECT_NEAR((s.zz - nu * (s.xx + s.yy)) / E, e.zz, 1e-13);
    EXPECT_NEAR(s.xy * (1 + nu) / E, e.xy, 1e-13);
    EXPECT_EQ(plane == Plane::stress ? s.zz : e.zz, 0);
    const auto back = strain_of(s, m);
    for (const auto c : {&PlaneTensor::xx, &PlaneTensor::yy, &PlaneTensor::zz, &PlaneTensor::xy})
      EXPECT_NEAR(back.*c, e.*c, 1e-13);
  }
}

TEST(Element, LumpedMassIsTheRowSumAndWeighsTheCell) {
  const Material m;
  for (const auto& cell : {square, parallelogram, distorted}) {
    Eigen::Vector4d expected = Eigen::Vector4d::Zero();
    reference::at_gauss_points(cell, 3, [&](const Eigen::Vector4d& N, const auto&, double w) {
      expected += m.density_kg_per_m3 * w * N;
    });
    const auto mass = cell_mass(cell, m);
    const double total = m.density_kg_per_m3 * reference::area_m2(cell);
    for (int a = 0; a < 4; ++a) EXPECT_NEAR(mass[a] / total, expected(a) / total, 1e-15);
    EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0) / total, 1, 1e-14);
  }
}

TEST(Element, PlatesWeighTheirArea) {
  const Material m;
  for (const auto corner : {mesh::Corner::none, mesh::Corner::relief, mesh::Corner::fillet}) {
    const auto mesh = reference::small_plate(corner);
    const auto mass = lumped_mass(mesh, m);
    const auto orphan = mesh::orphans(mesh);
    for (std::size_t n = 0; n < mass.size(); ++n) EXPECT_TRUE(orphan[n] ? mass[n] == 0 : mass[n] > 0) << n;
    const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
    EXPECT_NEAR(total / (m.density_kg_per_m3 * reference::area_m2(mesh)), 1, 1e-13);
  }
}

TEST(ElementDeathTest, RefusesATurnedCell) {
  const CellCoordinates clockwise = {0, 0, 0, 1, 1, 1, 1, 0};
  EXPECT_DEATH(cell_stiffness(clockwise, {}), "convex");
}

}  // namespace
}  // namespace slipfront::solid
