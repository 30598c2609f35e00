// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/static_crack.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "stability/rupture.hpp"

namespace slipfront::fracture {
namespace {

const solid::Material m{.youngs_modulus_Pa = 3e9, .poissons_ratio = 0.33};

std::vector<double> places(std::size_t n, double h_m) {
  std::vector<double> x_m;
  for (std::size_t k = 0; k < n; ++k) x_m.push_back(static_cast<double>(k) * h_m);
  return x_m;
}

CrackLoads uniform(std::size_t n, double t_Pa, double p_Pa, double coefficient) {
  return {std::vector(n, t_Pa), std::vector(n, p_Pa), std::vector(n, coefficient), std::vector(n, 0.0)};
}

TEST(StaticCrack, InteriorCrackBetweenHalfSpaces) {
  // G = drop^2 pi a/E' between alike bodies; a is half the length.
  const double h = 1e-3, drop = 2e5;
  const std::size_t n = 401;
  const auto response = response_of_half_spaces(Bodies(m, m), places(n, h));
  const auto loads = uniform(n, 1e6, 2e6, 0.4);
  StaticCrack crack(response, loads);
  crack.begin(200);
  for (int k = 1; k <= 160; ++k) {
    const double G = drop * drop * std::numbers::pi * k * h / m.youngs_modulus_Pa;
    EXPECT_NEAR(crack.energy_release_rate_J_per_m2(1), G, 1e-9 * G);
    EXPECT_NEAR(crack.energy_release_rate_J_per_m2(-1), G, 1e-9 * G);
    crack.release(1);
    crack.release(-1);
  }
}

TEST(StaticCrack, IsThatOfTheWholeEquations) {
  // Slip and energy by a dense solution of each crack, with pressure that slip changes.
  const std::size_t n = 41;
  const auto response = response_of_half_spaces(Bodies(m), places(n, 1e-3));
  auto loads = uniform(n, 1e6, 2e6, 0.35);
  for (std::size_t k = 0; k < n; ++k) loads.t_Pa[k] += 1e3 * static_cast<double>(k * k % 7);
  StaticCrack crack(response, loads);
  crack.begin(20);
  std::vector<Eigen::Index> nodes = {20};
  for (const int side : {1, 1, -1, 1, -1, -1, -1, 1}) {
    const auto next = crack.next(side);
    const auto solve = [&](const std::vector<Eigen::Index>& of) {
      Eigen::MatrixXd A(std::ssize(of), std::ssize(of));
      Eigen::VectorXd r(std::ssize(of));
      for (Eigen::Index i = 0; i < r.size(); ++i) {
        for (Eigen::Index j = 0; j < r.size(); ++j)
          A(i, j) = -response.t_per_slip(of[i], of[j]) + 0.35 * response.p_per_slip(of[i], of[j]);
        r(i) = loads.t_Pa[of[i]] - 0.35 * loads.p_Pa[of[i]];
      }
      return Eigen::VectorXd(A.partialPivLu().solve(r));
    };
    const auto before = solve(nodes);
    double t_Pa = loads.t_Pa[next], p_Pa = loads.p_Pa[next];
    for (Eigen::Index j = 0; j < before.size(); ++j) {
      t_Pa += response.t_per_slip(next, nodes[j]) * before(j);
      p_Pa += response.p_per_slip(next, nodes[j]) * before(j);
    }
    nodes.push_back(next);
    const double slip_m = solve(nodes)(before.size());
    const double expected = 0.5 * (t_Pa - 0.35 * p_Pa) * slip_m;
    EXPECT_NEAR(crack.energy_release_rate_J_per_m2(side), expected, 1e-10 * expected);
    crack.release(side);
  }
}

TEST(StaticCrack, NucleationLengthIsUenishiAndRices) {
  // 1.158 mu*/W; mu* = E/2 of alike bodies in plane stress. Pressure has a part on the rigid plane: there the
  // coefficient is 0.
  const std::size_t n = 201;
  const double h = 1e-3, weakening = 2e10;
  for (const auto& bodies : {Bodies(m, m), Bodies(m)}) {
    const double expected_m = stability::nucleation_length_m(stability::modulus_Pa(bodies), weakening, 1);
    for (const std::size_t node : {100, 0}) {  // half-spaces go on beyond the last node
      const double found_m = nucleation_length_m(response_of_half_spaces(bodies, places(n, h)),
                                                 std::vector(n, 0.0), std::vector(n, weakening), node);
      EXPECT_NEAR(found_m, expected_m, 0.55 * h);
    }
  }
  EXPECT_TRUE(std::isnan(nucleation_length_m(response_of_half_spaces(Bodies(m, m), places(n, h)),
                                             std::vector(n, 0.0), std::vector(n, 1e8), 100)));
}

TEST(StaticCrack, NoEnergyWithoutDropAndNoneBeyondTheEnds) {
  const std::size_t n = 5;
  const auto response = response_of_half_spaces(Bodies(m, m), places(n, 1e-3));
  const auto loads = uniform(n, 0.7e6, 2e6, 0.4);
  StaticCrack crack(response, loads);
  crack.begin(1);
  EXPECT_EQ(crack.energy_release_rate_J_per_m2(1), 0);
  crack.release(-1);
  EXPECT_EQ(crack.next(-1), -1);
  EXPECT_TRUE(std::isnan(crack.energy_release_rate_J_per_m2(-1)));
}

}  // namespace
}  // namespace slipfront::fracture
