// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "statics/statics.hpp"
#include "support/matrices.hpp"

namespace slipfront::statics {

constexpr double mu_s = 1.3;
inline const solid::Material pmma{};
inline const solid::Material gel{
    .youngs_modulus_Pa = 0.3e9, .poissons_ratio = 0.45, .density_kg_per_m3 = 800};

/// That of Kammer et al. (2012).
inline const Loading tilted{.tilt_left_m = 0.37e-3, .tilt_right_m = 0.037e-3, .edge_margin_m = 10e-3};

inline std::vector<double> uniform_mu_s(const mesh::Mesh& mesh) {
  return std::vector<double>(mesh.interface_nodes.size(), mu_s);
}

inline double largest_pressure(const Equilibrium& e) {
  return *std::ranges::max_element(e.tractions.p_s_Pa);
}

/// Forces that a displacement takes: none but at the interface, where they are the tractions over the plate's
/// tributary length, t times `sign_of_t`, and at the far edge, which they balance.
inline void expect_body_in_equilibrium(const mesh::Mesh& mesh, const solid::Material& material,
                                       const solid::Field& u, const Equilibrium& e,
                                       const std::vector<double>& tributary_m, int sign_of_t,
                                       double tolerance_N) {
  Eigen::VectorXd f = test::assembled_stiffness(mesh, material) * test::flat(u);
  double f_x_N = 0, f_y_N = 0, moment_N_m = 0;
  const auto take = [&](mesh::Node n) {
    f_x_N += f(2 * n);
    f_y_N += f(2 * n + 1);
    moment_N_m += mesh.x_m[n] * f(2 * n + 1) - mesh.y_m[n] * f(2 * n);
    f.segment<2>(2 * n).setZero();
  };
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    const auto n = mesh.interface_nodes[k];
    EXPECT_NEAR(f(2 * n), sign_of_t * e.tractions.t_s_Pa[k] * tributary_m[k], tolerance_N) << k;
    EXPECT_NEAR(f(2 * n + 1), e.tractions.p_s_Pa[k] * tributary_m[k], tolerance_N) << k;
    take(n);
  }
  EXPECT_GT(f_y_N, 1e3 * tolerance_N);
  for (const auto n : mesh.far_edge_nodes) take(n);
  EXPECT_LE(test::max_abs(f), tolerance_N);
  for (const double sum : {f_x_N, f_y_N, moment_N_m})
    EXPECT_NEAR(sum, 0, 100 * tolerance_N);  // some hundred nodes
}

/// Each node's tractions and motion are those its contact state allows. The states are set with a tolerance
/// of 1e-9 of the largest pressure and displacement, of which nodes in contact are held to the part `held`.
/// `inside`, `outside`: the largest |t|/p of a sticking node where the shear ends by it, and elsewhere.
inline void expect_complementarity(const Equilibrium& e, const std::vector<double>& moved_m,
                                   const std::vector<double>& gap_m, double inside, double outside,
                                   double held) {
  const double p_tolerance = 2e-9 * largest_pressure(e),
               u_tolerance = 2e-9 * test::max_abs(test::flat(e.u_m));
  for (std::size_t k = 0; k < e.contact.size(); ++k) {
    SCOPED_TRACE(k);
    const double t = e.tractions.t_s_Pa[k], p = e.tractions.p_s_Pa[k];
    if (e.contact[k] == Contact::open) {
      EXPECT_EQ(t, 0);
      EXPECT_EQ(p, 0);
      EXPECT_GE(gap_m[k], -u_tolerance);
      continue;
    }
    EXPECT_NEAR(gap_m[k], 0, held * u_tolerance);
    EXPECT_GE(p, -p_tolerance);
    if (e.contact[k] == Contact::stick) {
      EXPECT_LE(std::abs(t), (e.is_inside(e.tractions.x_m[k]) ? inside : outside) * p + p_tolerance);
      EXPECT_NEAR(moved_m[k], 0, held * u_tolerance);
    } else {
      EXPECT_NEAR(std::abs(t), mu_s * p, 1e-3 * p_tolerance);
      EXPECT_GE(t * moved_m[k], -p_tolerance * u_tolerance);  // friction opposes the motion
    }
  }
}

inline void expect_near(const solid::Field& a, const solid::Field& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LE(test::max_difference(a, b), tolerance);
}

/// Of two solvers: the same contact, and the same numbers to eight digits.
inline void expect_same(const Equilibrium& a, const Equilibrium& b) {
  EXPECT_EQ(a.contact, b.contact);
  EXPECT_NEAR(a.shear_m, b.shear_m, 1e-8 * a.shear_m);
  const double u = test::max_abs(a.u_m);
  expect_near(a.u_m, b.u_m, 1e-8 * u);
  expect_near(a.below_u_m, b.below_u_m, 1e-8 * u);
  expect_near(a.u_per_shear, b.u_per_shear, 1e-8);
  expect_near(a.below_u_per_shear, b.below_u_per_shear, 1e-8);
  for (std::size_t k = 0; k < a.contact.size(); ++k) {
    EXPECT_NEAR(a.tractions.t_s_Pa[k], b.tractions.t_s_Pa[k], 1e-8 * largest_pressure(a));
    EXPECT_NEAR(a.tractions.p_s_Pa[k], b.tractions.p_s_Pa[k], 1e-8 * largest_pressure(a));
  }
}

/// `u_per_shear` is the slope of the displacement at a shear, so little below another one that no contact
/// changes between: only the rounding of u, `rounding`, is magnified by u over the increment.
inline void expect_slope_of_displacement(const Statics& statics, double share, double rounding) {
  const auto e = statics.shear_to(share);
  const double increment_m = 1e-6 * e.shear_m;
  const auto further = statics.shear_by(e.shear_m + increment_m);
  ASSERT_EQ(further.contact, e.contact);
  const auto expect_slope = [&](const solid::Field& to, const solid::Field& from, const solid::Field& slope) {
    EXPECT_LE(test::max_abs((test::flat(to) - test::flat(from)) / increment_m - test::flat(slope)),
              rounding * 1e6);
  };
  expect_slope(further.u_m, e.u_m, e.u_per_shear);
  expect_slope(further.below_u_m, e.below_u_m, e.below_u_per_shear);
}

}  // namespace slipfront::statics
