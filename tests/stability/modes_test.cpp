// SPDX-License-Identifier: BSD-3-Clause
#include "stability/modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "stability/rupture.hpp"
#include "stability/verdict.hpp"

namespace slipfront::stability {
namespace {

using interface::Relaxed;

const solid::Material undamped{.stiffness_damping_s = 0};

/// p0 for which a slope of -1 s/m is minus the radiation damping G/c_S.
double radiation_pressure_Pa(const solid::Material& m) {
  return solid::shear_modulus_Pa(m) / solid::shear_speed_m_per_s(m);
}

std::vector<Complex> rates(const std::vector<Mode>& modes) {
  std::vector<Complex> s;
  for (const auto& mode : modes) s.push_back(mode.s_per_s);
  return s;
}

/// Distance of the nearest of all.
double nearest(const std::vector<Complex>& all, Complex s) {
  double distance = 1e300;
  for (const auto& other : all) distance = std::min(distance, std::abs(other - s));
  return distance;
}

/// Slow slip has no inertia: a S^2 + (a - b + K) S + K = 0 (Rice and Ruina 1983), S = s d_c/V, K = mu* k
/// d_c/(2 p); radiation adds S V/d_c times the damping to K, of relative size 1e-3 here.
TEST(State, SlowWavesGrowAsWithoutInertia) {
  const auto m = undamped;
  const interface::RateAndStateAging law;
  const double V = 1e-3, p_Pa = 5e6, rate = V / law.d_c_m;
  const auto sliding = uniform_sliding(law, V, p_Pa);
  for (const double share : {0.1, 0.5, 0.9}) {
    const double K = share * (law.b - law.a);
    const double k = 2 * K * p_Pa / (modulus_Pa({m, m}) * law.d_c_m);
    const double half = 0.5 * (law.b - law.a - K) / law.a;
    const Complex below = half * half - K / law.a;
    const Complex expected = rate * (half + std::sqrt(below));
    const auto mode = fastest_growing_mode({m, m}, sliding, k);
    ASSERT_TRUE(mode);
    const Complex s = {mode->s_per_s.real(), std::abs(mode->s_per_s.imag())};
    EXPECT_LT(std::abs(s - expected), 0.02 * std::abs(expected)) << share << " " << s << " " << expected;
  }
  const double k_stable = 1.1 * 2 * (law.b - law.a) * p_Pa / (modulus_Pa({m, m}) * law.d_c_m);
  EXPECT_FALSE(fastest_growing_mode({m, m}, sliding, k_stable));
}

TEST(State, TheVerdictIsThatOfTheLongestWave) {
  const auto m = undamped;
  interface::RateAndStateAging law;
  const double p_Pa = 5e6,
               critical_m = unstable_wavelength_m(modulus_Pa({m, m}), *state_response(law, 0), p_Pa);
  EXPECT_EQ(well_posedness({m, m}, law, p_Pa, 1e-3, 0.99 * critical_m).fastest_growth_per_s, 0);
  const auto long_waves = well_posedness({m, m}, law, p_Pa, 1e-3, 1e4 * critical_m);
  EXPECT_NEAR(long_waves.fastest_growth_per_s, (law.b - law.a) / law.a * law.V_i_m_per_s / law.d_c_m, 1e-6);
  law.b = 0.5 * law.a;
  EXPECT_EQ(well_posedness({m, m}, law, p_Pa, 1e-3, 1e3).statement,
            "well-posed: friction strengthens with the slip rate");
}

TEST(HalfSpace, ConstantCoefficientGrowsAsInTheReference) {
  // Growth Re s/(k c_S), given to three decimals.
  const struct { double f, growth; } known[] = {{1.1, 0.040}, {1.3, 0.106}, {2, 0.275}};
  const auto& m = undamped;
  const double k = 314;
  for (const auto& [f, growth] : known) {
    const auto modes = growing_modes(m, {.mu = f, .pressure_Pa = 5e6}, k);
    ASSERT_EQ(modes.size(), 1u) << f;
    EXPECT_NEAR(modes[0].growth_per_s() / (k * solid::shear_speed_m_per_s(m)), growth, 5e-4);
    EXPECT_GT(modes[0].velocity_m_per_s(k), 0) << "travels with the sliding";
  }
}

TEST(HalfSpace, UnitCoefficientIsNeutralAtRootTwo) {
  const auto& m = undamped;
  EXPECT_TRUE(growing_modes(m, {.mu = 0.99}, 100).empty());
  EXPECT_TRUE(growing_modes(m, {.mu = 0.3}, 100).empty());
  // The square roots' branch is that of a vanishing growth; |F| changes by about that growth.
  EXPECT_LT(std::abs(half_space_relation(m, {.mu = 1}, 100, {1e-12, -std::numbers::sqrt2})), 1e-10);
  const auto modes = growing_modes(m, {.mu = 1.001}, 100);
  ASSERT_EQ(modes.size(), 1u);
  // Near neutrality the mode moves in proportion to f - 1, by about a third of it (0.040 at 1.1).
  EXPECT_NEAR(modes[0].velocity_m_per_s(100) / solid::shear_speed_m_per_s(m), std::numbers::sqrt2, 1e-3);
}

TEST(HalfSpace, WeakeningBeyondRadiationDampingGrows) {
  const auto& m = undamped;
  Sliding sliding{.mu = 0.6, .slope_s_per_m = -1, .pressure_Pa = radiation_pressure_Pa(m)};
  sliding.slope_s_per_m = -0.99;
  EXPECT_TRUE(growing_modes(m, sliding, 100).empty());
  sliding.slope_s_per_m = -1.01;
  EXPECT_EQ(growing_modes(m, sliding, 100).size(), 1u);
  // Without a length scale growth is proportional to k.
  const double slow = fastest_growing_mode(m, sliding, 100)->growth_per_s();
  EXPECT_NEAR(fastest_growing_mode(m, sliding, 700)->growth_per_s() / slow, 7, 1e-9);
}

TEST(HalfSpace, LongWavesFollowTheShearWaveImpedance) {
  // k -> 0: motion uniform in x. Delayed strength: G/c_S s = -mu' p0 s r/(r + s), so s = r (|m| - 1).
  const auto& m = undamped;
  Sliding sliding{.mu = 0, .slope_s_per_m = -3, .pressure_Pa = radiation_pressure_Pa(m)};
  sliding.relaxed = Relaxed::strength;
  sliding.relaxation_rate_per_s = 1e6;
  // With mu = 0 the correction is of second order in k c_S/r = 9e-4.
  EXPECT_NEAR(fastest_growing_mode(m, sliding, 1)->s_per_s.real(), 2e6, 2e6 * 1e-5);
  // Damped, at once: sqrt(1 + beta s) = |m|.
  solid::Material damped;
  sliding.relaxed = Relaxed::none;
  EXPECT_NEAR(fastest_growing_mode(damped, sliding, 1)->s_per_s.real(), 8 / damped.stiffness_damping_s,
              8 / damped.stiffness_damping_s * 1e-5);
}

/// The zeros that Newton's method reaches from starts even in log p, |p| from 1e-3 to 1e4, with a growth of
/// more than 1e-3 |p|, fastest first.
template <class F>
std::vector<Complex> zeros_by_starts(F&& f) {
  constexpr int n_modulus = 150, n_angle = 31;
  const auto at = [&](Complex z) { return f(std::exp(z)); };
  std::vector<Complex> zeros;
  for (int start = 0; start < n_modulus * n_angle; ++start) {
    Complex z{std::log(1e-3) + std::log(1e7) * (start % n_modulus + 0.5) / n_modulus,
              std::numbers::pi * ((start / n_modulus + 0.5) / n_angle - 0.5)};
    double last_move = 1;
    for (int k = 0; k < 60 && last_move > 1e-12 && std::abs(z.imag()) < std::numbers::pi / 2; ++k) {
      // The difference must not reach over the imaginary axis, where branch points are.
      const double step = std::min(1e-5, 0.1 * (std::numbers::pi / 2 - std::abs(z.imag())));
      const Complex move = -at(z) * 2.0 * step / (at(z + step) - at(z - step));
      last_move = std::abs(move);
      z += std::min(1.0, 0.5 / last_move) * move;
    }
    const Complex p = std::exp(z);
    if (!(last_move <= 1e-12 && p.real() > 1e-3 * std::abs(p) && std::abs(p) > 1e-3 && std::abs(p) < 1e4))
      continue;
    if (nearest(zeros, p) > 1e-7 * std::abs(p)) zeros.push_back(p);
  }
  std::ranges::sort(zeros, [](Complex a, Complex b) { return a.real() > b.real(); });
  return zeros;
}

TEST(HalfSpace, NoModeIsMissed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int n_modes = 0;
  for (int trial = 0; trial < 60; ++trial) {
    solid::Material m = trial % 2 ? undamped : solid::Material{};
    m.poissons_ratio = 0.1 + 0.35 * unit(random);
    const double k = std::pow(10.0, 1 + 4 * unit(random));
    Sliding s;
    s.mu = 2.5 * unit(random);
    s.pressure_Pa = radiation_pressure_Pa(m);
    s.slope_s_per_m = 6 * (unit(random) - 0.7);
    s.slip_slope_per_m = trial % 5 ? 0 : -k * 900 * unit(random);
    s.relaxed = static_cast<Relaxed>(trial % 3);
    s.relaxation_rate_per_s = k * 900 * std::pow(10.0, 2 * unit(random) - 1);
    const auto f = [&](Complex p) { return half_space_relation(m, s, k, p); };
    // Next to the axis the relation has branch points, which Newton's method alone cannot pass.
    const auto by_argument = zeros_by_argument_principle(f, {.min_growth = 1e-3});
    const auto by_starts = zeros_by_starts(f);
    ASSERT_EQ(by_argument.size(), by_starts.size())
        << "trial " << trial << ", fastest " << (by_argument.empty() ? 0.0 : by_argument[0]);
    for (std::size_t i = 0; i < by_starts.size(); ++i)
      EXPECT_LT(std::abs(by_argument[i] - by_starts[i]), 1e-8 * std::abs(by_starts[i])) << "trial " << trial;
    n_modes += static_cast<int>(by_starts.size());
  }
  EXPECT_GT(n_modes, 30) << "the trials say little";
}

TEST(Roots, KnownZerosWithMultiplicity) {
  const auto f = [](Complex p) {
    const Complex twice = p - Complex{1, 2};
    return (p - 3.0) * twice * twice * (p + 1.0) * (p - Complex{1e-4, -5e-2});
  };
  const auto zeros = zeros_by_argument_principle(f, {.min_modulus = 1e-6, .max_modulus = 1e6});
  ASSERT_EQ(zeros.size(), 4u);
  EXPECT_NEAR(std::abs(zeros[0] - 3.0), 0, 1e-10);
  // Half the digits of a double zero.
  EXPECT_NEAR(std::abs(zeros[1] - Complex{1, 2}), 0, 1e-6);
  EXPECT_NEAR(std::abs(zeros[2] - Complex{1, 2}), 0, 1e-6);
  EXPECT_NEAR(std::abs(zeros[3] - Complex{1e-4, -5e-2}), 0, 1e-10);
}

TEST(Layer, TendsToTheHalfSpace) {
  const auto& m = undamped;
  const Sliding sliding{.mu = 2, .pressure_Pa = 5e6};
  const double k = 100;
  const Complex s = fastest_growing_mode(m, sliding, k)->s_per_s;
  const double c_S = solid::shear_speed_m_per_s(m);
  const Complex p = s / (k * c_S);
  const double decay = std::sqrt(1.0 + p * p).real();  // of the shear potential, which reaches farther
  for (const double kH : {8.0, 14.0, 20.0}) {
    // The upper edge is felt through a wave that goes up and back; its factor is of order one.
    const auto modes = rates(growing_layer_modes(m, sliding, k, kH / k, 4 * k * c_S));
    EXPECT_LT(nearest(modes, s) / std::abs(s), 5 * std::exp(-2 * decay * kH)) << kH;
  }
}

TEST(Layer, ColumnInClosedForm) {
  // k -> 0 and mu = 0: coth(s H/c_S) = |m|, with s H/c_S = atanh(1/|m|) + i pi n.
  const auto& m = undamped;
  const double H = 0.1;
  const double rate = solid::shear_speed_m_per_s(m) / H;
  const Sliding sliding{.mu = 0, .slope_s_per_m = -2, .pressure_Pa = radiation_pressure_Pa(m)};
  const auto modes = growing_layer_modes(m, sliding, 1e-3 / H, H, 8 * rate);
  // n from -2 to 2, the last of |s| H/c_S = 6.31.
  ASSERT_EQ(modes.size(), 5u);
  for (const auto& mode : modes) {
    const double n = std::round(mode.s_per_s.imag() / rate / std::numbers::pi);
    const Complex expected{std::atanh(0.5), n * std::numbers::pi};
    // Second order in kH = 1e-3.
    EXPECT_LT(std::abs(mode.s_per_s / rate - expected), 1e-5);
  }
}

/// Eigenvalues s, 1/s, of the layer for exp(i k x) with n linear finite elements in y and lumped mass:
/// nothing is shared with the relation under test.
std::vector<Complex> layer_eigenvalues_by_elements(const solid::Material& material, const Sliding& sliding,
                                                   double k, double height_m, int n) {
  const double P = solid::longitudinal_modulus_Pa(material);
  const double G = solid::shear_modulus_Pa(material);
  const double lambda = P - 2 * G;
  const double h = height_m / n;
  const Complex ik{0, k};
  // Degrees of freedom: u_x, u_y of nodes 0 to n; the top and u_y at the interface are dropped afterwards.
  Eigen::MatrixXcd K = Eigen::MatrixXcd::Zero(2 * (n + 1), 2 * (n + 1));
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(2 * (n + 1));
  const double a[2][2] = {{h / 3, h / 6}, {h / 6, h / 3}};    // integral of N_i N_j
  const double b[2][2] = {{-0.5, 0.5}, {-0.5, 0.5}};          // of N_i N_j'
  const double c[2][2] = {{1 / h, -1 / h}, {-1 / h, 1 / h}};  // of N_i' N_j'
  for (int e = 0; e < n; ++e)
    for (int i = 0; i < 2; ++i) {
      mass(2 * (e + i)) += material.density_kg_per_m3 * h / 2;
      mass(2 * (e + i) + 1) += material.density_kg_per_m3 * h / 2;
      for (int j = 0; j < 2; ++j) {
        K(2 * (e + i), 2 * (e + j)) += P * k * k * a[i][j] + G * c[i][j];
        K(2 * (e + i) + 1, 2 * (e + j) + 1) += P * c[i][j] + G * k * k * a[i][j];
        K(2 * (e + i), 2 * (e + j) + 1) += ik * (G * b[j][i] - lambda * b[i][j]);
        K(2 * (e + i) + 1, 2 * (e + j)) += ik * (lambda * b[j][i] - G * b[i][j]);
      }
    }
  std::vector<int> kept = {0};
  for (int d = 2; d < 2 * n; ++d) kept.push_back(d);
  const int m = static_cast<int>(kept.size());
  const bool strength = sliding.relaxed == interface::Relaxed::strength;
  const bool pressure = sliding.relaxed == interface::Relaxed::pressure;
  const int size = 2 * m + (strength || pressure ? 1 : 0);
  // x = (u, v/R, z), s x = A x; z is the delayed strength or pressure over G k.
  const double R = solid::shear_speed_m_per_s(material) / height_m;
  const double beta = material.stiffness_damping_s;
  const double r = sliding.relaxation_rate_per_s;
  const double direct = sliding.pressure_Pa;
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(size, size);
  Eigen::RowVectorXcd friction = Eigen::RowVectorXcd::Zero(size);  // strength at once, in terms of x
  Eigen::RowVectorXcd reaction = Eigen::RowVectorXcd::Zero(size);  // pressure, in terms of x
  for (int i = 0; i < m; ++i) {
    A(i, m + i) = R;
    for (int j = 0; j < m; ++j) {
      A(m + i, j) = -K(kept[i], kept[j]) / (mass(kept[i]) * R);
      A(m + i, m + j) = -beta * K(kept[i], kept[j]) / mass(kept[i]);
    }
    reaction(i) = K(1, kept[i]);
    reaction(m + i) = beta * R * K(1, kept[i]);
  }
  const double scale = G * k;
  if (!pressure) friction = sliding.mu * reaction;
  friction(0) += direct * sliding.slip_slope_per_m;
  friction(m) += direct * sliding.slope_s_per_m * R;
  if (pressure) {
    A.row(size - 1) = r * reaction / scale;
    A(size - 1, size - 1) -= r;
    friction(size - 1) = sliding.mu * scale;
  }
  if (strength) {
    A.row(size - 1) = r * friction / scale;
    A(size - 1, size - 1) -= r;
    friction.setZero();
    friction(size - 1) = scale;
  }
  A.row(m) -= friction / (mass(0) * R);
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(A, false);
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

struct LayerCase {
  const char* name;
  double kH, mu, slope, slip_slope_H, rate_H, beta_rate;
  Relaxed relaxed;
};

class LayerByElements : public testing::TestWithParam<LayerCase> {};

TEST_P(LayerByElements, SameModes) {
  const auto& c = GetParam();
  const double H = 0.1;
  solid::Material m;
  const double rate = solid::shear_speed_m_per_s(m) / H;
  m.stiffness_damping_s = c.beta_rate / rate;
  const double k = c.kH / H;
  const Sliding sliding{c.mu,     c.slope, c.slip_slope_H * rate, radiation_pressure_Pa(m), c.rate_H * rate,
                        c.relaxed};
  const double cap = 8 * rate;
  // Modes of little growth may have it or not with few elements: both sides leave them out.
  const double counted = 0.03 * rate;
  auto modes = rates(growing_layer_modes(m, sliding, k, H, cap));
  std::erase_if(modes, [&](Complex s) { return s.real() <= counted; });
  const auto coarse = layer_eigenvalues_by_elements(m, sliding, k, H, 32);
  const auto fine = layer_eigenvalues_by_elements(m, sliding, k, H, 64);
  ASSERT_FALSE(modes.empty());
  for (const auto& s : modes) {
    const double far = nearest(coarse, s), near = nearest(fine, s);
    // Linear elements and lumped mass err by (|s| H/c_S / n)^2 over about 10; halving the element divides
    // the error by four, exactly only in the limit.
    EXPECT_LT(near / std::abs(s), std::pow(std::abs(s) / rate / 64, 2)) << s / rate;
    EXPECT_GT(far / near, 3) << s / rate;
    EXPECT_LT(far / near, 5.5) << s / rate;
  }
  // And none of the elements' growing modes is missing. Errors move a mode by less than the margin.
  for (const auto& s : fine)
    if (s.real() > counted + 0.02 * rate && std::abs(s) < 0.95 * cap) {
      EXPECT_LT(nearest(modes, s), 0.05 * std::abs(s)) << s / rate;
    }
}

INSTANTIATE_TEST_SUITE_P(Laws, LayerByElements,
                         testing::Values(LayerCase{"constant_high", 3, 1.3, 0, 0, 0, 0, Relaxed::none},
                                         LayerCase{"weakening_damped", 2, 1.3, -0.7, 0, 0, 0.05,
                                                   Relaxed::none},
                                         LayerCase{"strength", 2, 1.3, -2, 0, 2, 0.02, Relaxed::strength},
                                         LayerCase{"pressure", 2, 1.3, -0.5, 0, 3, 0.02, Relaxed::pressure},
                                         LayerCase{"slip_weakening", 2, 0.8, 0, -6, 0, 0.01, Relaxed::none}),
                         [](const auto& instance) { return instance.param.name; });

TEST(UniformSliding, TakesTheRateAtTheSpeed) {
  const interface::Regularisation delay { Relaxed::pressure, 1e-6, 0.5, 4e-6 };
  const auto s = uniform_sliding(interface::Coulomb{0.7}, 0.25, 2e6, delay);
  EXPECT_DOUBLE_EQ(s.relaxation_rate_per_s, 0.75e6 + 0.25e6);
  EXPECT_EQ(s.relaxed, Relaxed::pressure);
  EXPECT_EQ(s.mu, 0.7);
  EXPECT_EQ(s.pressure_Pa, 2e6);
}

}  // namespace
}  // namespace slipfront::stability
