// SPDX-License-Identifier: BSD-3-Clause
// Uniform sliding of one half-space on another.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "stability/modes.hpp"
#include "stability/verdict.hpp"

namespace slipfront::stability {
namespace {

using interface::Relaxed;

solid::Material undamped_with(double youngs_modulus_Pa, double poissons_ratio, double density_kg_per_m3) {
  return {.youngs_modulus_Pa = youngs_modulus_Pa,
          .poissons_ratio = poissons_ratio,
          .density_kg_per_m3 = density_kg_per_m3,
          .stiffness_damping_s = 0};
}

const auto pmma = undamped_with(2.6e9, 0.37, 1200);
const auto stiffer = undamped_with(5.0e9, 0.33, 1500);
const auto steel = undamped_with(210e9, 0.3, 7800);
const auto aluminium = undamped_with(70e9, 0.33, 2700);

/// Slope of mu for which weakening is m times the pair's radiation damping at a pressure of 1 MPa.
Sliding weakening(const Bodies& bodies, double mu, double m) {
  return {.mu = mu, .slope_s_per_m = -m * radiation_damping_Pa_s_per_m(bodies) / 1e6, .pressure_Pa = 1e6};
}

/// (u_x, u_y) of an edge y = 0 per (sigma_xy, sigma_yy) there, in a body y > 0 or y < 0.
Eigen::MatrixXcd displacement_per_stress(const solid::Material& material, double k, Complex s, bool above) {
  const Complex damped = 1.0 + material.stiffness_damping_s * s;
  const Complex M = damped * solid::longitudinal_modulus_Pa(material);
  const Complex G = damped * solid::shear_modulus_Pa(material);
  const Complex lambda = M - 2.0 * G, inertia = material.density_kg_per_m3 * s * s;
  const Complex ik{0, k};
  // Stresses in units of kG, lengths of 1/k.
  const Complex unit = k * G;
  Eigen::MatrixXcd d_dy(4, 4);
  d_dy << 0, -ik, unit / G, 0,           //
      -ik * lambda / M, 0, 0, unit / M,  //
      (inertia + k * k * (M - lambda * lambda / M)) / unit, 0, 0, -ik * lambda / M, 0, inertia / unit, -ik, 0;
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(d_dy / k);
  Eigen::MatrixXcd u(2, 2), stress(2, 2);
  int n = 0;
  for (int j = 0; j < 4; ++j) {
    if ((solver.eigenvalues()(j).real() < 0) != above) continue;
    u.col(n) = solver.eigenvectors().col(j).head(2);
    stress.col(n++) = solver.eigenvectors().col(j).tail(2) * unit;
  }
  return u * stress.inverse();
}

/// A function of p = s/(k c_S), c_S of the body above, that is zero where two half-spaces have a mode: the
/// equations of motion as a first-order system in y, whose eigenvectors that decay are found by numbers.
/// Nothing is shared with the relation under test.
Complex pair_by_eigenvectors(const Bodies& bodies, const Sliding& sliding, double k, Complex p) {
  const Complex s = p * k * solid::shear_speed_m_per_s(bodies.above);
  const Eigen::MatrixXcd relative =
      displacement_per_stress(bodies.above, k, s, true) - displacement_per_stress(*bodies.below, k, s, false);
  const Complex delay = sliding.relaxed == interface::Relaxed::none
                            ? Complex{1}
                            : sliding.relaxation_rate_per_s / (sliding.relaxation_rate_per_s + s);
  const Complex of_slip = sliding.pressure_Pa * (sliding.slope_s_per_m * s + sliding.slip_slope_per_m);
  const bool all_delayed = sliding.relaxed == interface::Relaxed::strength;
  // Conditions on (sigma_xy, sigma_yy), with p = -sigma_yy: nothing opens; the strength is sigma_xy.
  const double unit = k * solid::shear_modulus_Pa(bodies.above);
  Eigen::MatrixXcd conditions(2, 2);
  conditions.row(0) = relative.row(1) * unit;
  conditions.row(1) = -(all_delayed ? delay : Complex{1}) * of_slip * relative.row(0);
  conditions(1, 0) += 1.0;
  conditions(1, 1) += sliding.mu * delay;
  return conditions.determinant();
}

TEST(GeneralisedRayleighSpeed, OfThePairInTheReference) {
  const auto speed = generalised_rayleigh_speed_m_per_s(pmma, stiffer);
  ASSERT_TRUE(speed);
  EXPECT_NEAR(*speed, 888.04, 0.005);  // all digits given
  EXPECT_DOUBLE_EQ(*generalised_rayleigh_speed_m_per_s(stiffer, pmma), *speed);
  auto damped = pmma;
  damped.stiffness_damping_s = 1e-6;
  EXPECT_EQ(*generalised_rayleigh_speed_m_per_s(damped, stiffer), *speed);
  // A neutral mode without friction, on the branch of a vanishing growth.
  const double c_S = solid::shear_speed_m_per_s(pmma);
  const auto f = [&](double c) {
    return std::abs(pair_by_eigenvectors({pmma, stiffer}, {}, 100, {1e-13, -c / c_S}));
  };
  EXPECT_LT(f(*speed), 1e-6 * f(0.99 * *speed));
}

TEST(GeneralisedRayleighSpeed, OfEqualBodiesIsTheRayleighSpeed) {
  for (const auto& m : {pmma, steel}) {
    const auto speed = generalised_rayleigh_speed_m_per_s(m, m);
    ASSERT_TRUE(speed);
    EXPECT_NEAR(*speed, solid::rayleigh_speed_m_per_s(m), 1e-10 * *speed);
  }
}

TEST(GeneralisedRayleighSpeed, DoesNotExistForBodiesThatDifferMuch) {
  EXPECT_FALSE(generalised_rayleigh_speed_m_per_s(pmma, steel));
  EXPECT_FALSE(generalised_rayleigh_speed_m_per_s(aluminium, pmma));
}

TEST(TwoHalfSpaces, ConstantCoefficientGrowsAsInTheReference) {
  // Growth over k and phase speed, m/s, of a boundary integral code, to all digits given.
  const struct {
    double f, growth, growth_digit, speed;
  } known[] = {{0.3, 8.085, 5e-4, 892.4}, {0.6, 22.68, 5e-3, 898.8}};
  const double k = 314;
  for (const auto& [f, growth, growth_digit, speed] : known) {
    const auto mode = fastest_growing_mode({pmma, stiffer}, {.mu = f, .pressure_Pa = 5e6}, k);
    ASSERT_TRUE(mode) << f;
    EXPECT_NEAR(mode->growth_per_s() / k, growth, growth_digit);
    EXPECT_NEAR(mode->velocity_m_per_s(k), speed, 0.05);
  }
}

TEST(TwoHalfSpaces, BaseEverStifferAndDenserIsTheRigidPlane) {
  for (const double m : {0.0, 0.5}) {
    const auto sliding = weakening(pmma, 1.3, m);
    const Complex rigid = fastest_growing_mode(pmma, sliding, 100)->s_per_s;
    const auto error = [&](double factor) {
      auto base = stiffer;
      base.youngs_modulus_Pa *= factor;
      base.density_kg_per_m3 *= factor;
      return std::abs(fastest_growing_mode({pmma, base}, sliding, 100)->s_per_s / rigid - 1.0);
    };
    // In proportion to the base's compliance, but for terms of second order.
    EXPECT_NEAR(error(1e4) / error(1e5), 10, 0.01);
    EXPECT_LT(error(1e13), 1e-11);
  }
}

TEST(TwoHalfSpaces, OfOneKindLeaveThePressureUnchanged) {
  for (const double mu : {0.1, 0.6, 1.0, 1.3, 3.0})
    EXPECT_TRUE(growing_modes({pmma, pmma}, {.mu = mu, .pressure_Pa = 5e6}, 100).empty()) << mu;
  // With weakening the coefficient itself has no effect, and neither direction is distinguished.
  const auto low = growing_modes({pmma, pmma}, weakening({pmma, pmma}, 0.1, 0.5), 100);
  const auto high = growing_modes({pmma, pmma}, weakening({pmma, pmma}, 1.3, 0.5), 100);
  ASSERT_EQ(low.size(), 2u);
  ASSERT_EQ(high.size(), 2u);
  EXPECT_LT(std::abs(low[0].s_per_s - std::conj(low[1].s_per_s)), 1e-9 * std::abs(low[0].s_per_s));
  for (const auto& mode : low)
    EXPECT_LT(std::min(std::abs(high[0].s_per_s - mode.s_per_s), std::abs(high[1].s_per_s - mode.s_per_s)),
              1e-9 * std::abs(mode.s_per_s));
}

struct PairCase {
  const char* name;
  Bodies bodies;
  double mu, m;  ///< m: weakening over radiation damping
  Relaxed relaxed = Relaxed::none;
  double damping = 0, slip_slope = 0;  ///< beta_R k c_S of both; minus d mu/d slip p0/(G k)
};

class SecondWay : public testing::TestWithParam<PairCase> {};

TEST_P(SecondWay, HasTheSameModes) {
  const auto& c = GetParam();
  const double k = 200, rate_per_s = k * solid::shear_speed_m_per_s(c.bodies.above);
  Bodies bodies = c.bodies;
  bodies.above.stiffness_damping_s = bodies.below->stiffness_damping_s = c.damping / rate_per_s;
  auto sliding = weakening(bodies, c.mu, c.m);
  sliding.slip_slope_per_m = -c.slip_slope * solid::shear_modulus_Pa(bodies.above) * k / sliding.pressure_Pa;
  sliding.relaxed = c.relaxed;
  sliding.relaxation_rate_per_s = rate_per_s;
  const auto other = [&](Complex p) { return pair_by_eigenvectors(bodies, sliding, k, p); };
  // Next to the axis the eigenvectors that decay cannot be told from those that do not.
  const double counted = 1e-3;
  const auto expected =
      zeros_by_argument_principle(other, {.min_modulus = 0.1, .max_modulus = 30, .min_growth = counted});
  std::vector<Complex> modes;
  for (const auto& mode : growing_modes(bodies, sliding, k)) {
    const Complex p = mode.s_per_s / rate_per_s;
    EXPECT_LT(std::abs(other(p)), 1e-9 * std::abs(other(1.01 * p))) << p;
    if (p.real() > counted * std::abs(p)) modes.push_back(p);
  }
  ASSERT_EQ(modes.size(), expected.size());
  EXPECT_FALSE(modes.empty());
  for (std::size_t j = 0; j < modes.size(); ++j)
    EXPECT_LT(std::abs(modes[j] - expected[j]), 1e-8 * std::abs(modes[j]));
}

INSTANTIATE_TEST_SUITE_P(
    Pairs, SecondWay,
    testing::Values(PairCase{"alike_constant", {pmma, stiffer}, 0.3, 0},
                    PairCase{"alike_drop", {pmma, stiffer}, 0.6, 2},
                    PairCase{"alike_damped", {pmma, stiffer}, 1.3, 0.5, Relaxed::none, 0.02},
                    PairCase{"alike_pressure", {pmma, stiffer}, 0.6, 0.5, Relaxed::pressure, 0.01},
                    PairCase{"on_steel_weakening", {pmma, steel}, 1.0, 0.3},
                    PairCase{"on_steel_strength", {pmma, steel}, 1.3, 2, Relaxed::strength, 0.01},
                    PairCase{"above_stiffer_weakening", {aluminium, pmma}, 0.9, 0.3},
                    PairCase{"above_stiffer_slip", {aluminium, pmma}, 0.6, 0, Relaxed::none, 0, 0.05}),
    [](const auto& instance) { return instance.param.name; });

TEST(TwoHalfSpaces, AreJudgedByTheRadiationDampingOfBoth) {
  const interface::VelocityWeakening law { .mu_s = 0.9, .mu_k = 0.5 };
  const double p_Pa = 5e6, h_m = 1e-3, width_m = 0.2;
  const auto rigid = well_posedness(pmma, law, p_Pa, h_m, width_m);
  const auto equal = well_posedness({pmma, pmma}, law, p_Pa, h_m, width_m);
  EXPECT_NEAR(equal.weakening_over_radiation, 2 * rigid.weakening_over_radiation,
              1e-12 * rigid.weakening_over_radiation);
  // The wave's time across an element is that of the faster body; the damping that of the weaker.
  auto damped = steel;
  damped.stiffness_damping_s = 1e-7;
  auto damped_pmma = pmma;
  damped_pmma.stiffness_damping_s = 1e-7;
  const auto w = well_posedness({damped_pmma, damped}, law, p_Pa, h_m, width_m);
  EXPECT_FALSE(w.unbounded);
  EXPECT_DOUBLE_EQ(w.damping_length_m, 1e-7 * solid::longitudinal_speed_m_per_s(pmma));
  EXPECT_DOUBLE_EQ(w.growth_in_crossing,
                   w.fastest_growth_per_s * h_m / solid::longitudinal_speed_m_per_s(steel));
}

TEST(TwoHalfSpaces, AtConstantFrictionAreIllPosedUnlessEqualOrDamped) {
  const interface::Coulomb law { 0.3 };
  const auto judged = [&](const Bodies& bodies) { return well_posedness(bodies, law, 5e6, 1e-3, 0.2); };
  EXPECT_FALSE(judged(pmma).unbounded);
  EXPECT_FALSE(judged({pmma, pmma}).unbounded);
  const auto pair = judged({pmma, stiffer}), turned = judged({stiffer, pmma});
  EXPECT_TRUE(pair.unbounded);
  EXPECT_TRUE(turned.unbounded);
  EXPECT_NEAR(pair.growth_at_grid_per_s, turned.growth_at_grid_per_s, 1e-9 * pair.growth_at_grid_per_s);
  auto above = pmma, below = stiffer;
  above.stiffness_damping_s = below.stiffness_damping_s = 1e-7;
  const auto damped = judged({above, below});
  EXPECT_FALSE(damped.unbounded);
  EXPECT_GT(damped.fastest_growth_per_s, 0);
  EXPECT_GT(damped.fastest_wavelength_m, 0);
}

/// A body alone on the rigid plane, and two.
TEST(WellPosedness, LimitsAgreeWithGrowthFollowedToShortWaves) {
  auto damped = pmma;
  damped.stiffness_damping_s = 1e-7;
  auto slightly_damped = stiffer, as_damped = stiffer;
  slightly_damped.stiffness_damping_s = 3e-8;
  as_damped.stiffness_damping_s = 1e-7;
  const std::pair<Bodies, double> cases[] = {{pmma, 0.6},
                                             {damped, 0.6},
                                             {{pmma, stiffer}, 0.3},
                                             {{damped, slightly_damped}, 0.3},
                                             {{pmma, as_damped}, 0.3}};
  for (const auto& [bodies, low] : cases)
    for (const auto relaxed : {Relaxed::none, Relaxed::strength, Relaxed::pressure})
      for (const double mu : {low, 1.3})
        for (const double m : {0.0, 0.5, 2.0}) {
          auto sliding = weakening(bodies, mu, m);
          sliding.relaxed = relaxed;
          sliding.relaxation_rate_per_s = 1e6;
          const auto growth = [&, &of = bodies](double k) {
            const auto mode = fastest_growing_mode(of, sliding, k);
            return mode ? mode->growth_per_s() : 0;
          };
          // Both ends lie far beyond the rates 1e6 and 1e7 per second, k c_S = 1e10 and 1e12. Unbounded
          // growth rises in proportion to k at least; bounded growth does not rise tenfold over two decades.
          EXPECT_EQ(growth_is_unbounded(bodies, sliding), growth(1e9) > 10 * growth(1e7))
              << static_cast<int>(relaxed) << " two bodies " << bodies.below.has_value() << " mu " << mu
              << " m " << m << ": " << growth(1e7) << ", " << growth(1e9);
        }
}

}  // namespace
}  // namespace slipfront::stability
