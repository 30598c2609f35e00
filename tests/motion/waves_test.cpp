// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "motion/stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using mesh::Corner;
using support::in_flight;
using support::one_substep;

constexpr double lift_m = 1e-5;

/// Longitudinal or shear.
class PlaneWave : public ::testing::TestWithParam<bool> {
 protected:
  static constexpr double h_ = 1e-3;
  mesh::Mesh mesh_ = support::make_plate(0.2, 0.1, h_, Corner::none);
  solid::Material material_{.stiffness_damping_s = 0};
  Stepper stepper_{mesh_, material_, support::paper_law, one_substep()};
  bool shear_ = GetParam();
  double c_ = shear_ ? solid::shear_speed_m_per_s(material_) : solid::longitudinal_speed_m_per_s(material_);

  /// Moves down from 55 mm, in a wide plate in the air.
  statics::Equilibrium pulse_ =
      support::GaussianPulse{shear_, false, 0.055, -c_, lift_m}.on(mesh_, stepper_.step_s());

  /// Displacement in the middle column, where nothing from the sides has arrived yet, from below.
  std::vector<double> column() const {
    std::vector<double> u;
    for (int j = 0; j <= mesh_.grid.rows; ++j) {
      const auto n = mesh_.grid.node(mesh_.grid.columns / 2, j);
      u.push_back(shear_ ? stepper_.u_m().x[n] : stepper_.u_m().y[n] - lift_m);
    }
    return u;
  }
  double centroid() const {
    double sum = 0, moment = 0;
    const auto u = column();
    for (std::size_t j = 0; j < u.size(); ++j) sum += u[j], moment += h_ * static_cast<double>(j) * u[j];
    return moment / sum;
  }
  std::complex<double> transform(double k) const {
    std::complex<double> sum = 0;
    const auto u = column();
    for (std::size_t j = 0; j < u.size(); ++j)
      sum += u[j] * std::polar(1.0, -k * h_ * static_cast<double>(j));
    return sum;
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, PlaneWave, ::testing::Bool());

TEST_P(PlaneWave, TravelsAtItsSpeed) {
  stepper_.start(pulse_, 1);
  Recorder recorder(pulse_, 1.3, 0);
  const double before = centroid();
  while (c_ * stepper_.time_s() < 0.02) stepper_.advance(recorder);
  // The centroid moves with the group velocity of infinite wavelength, which no scheme of second order
  // disperses. What remains are the Gaussian's tails beyond eight widths below, and six above where the faint
  // wave that the discrete start sends back has gone.
  EXPECT_NEAR((before - centroid()) / stepper_.time_s() / c_, 1, 1e-6);
}

TEST_P(PlaneWave, DispersesAsTheSchemeMust) {
  // Uniform motion across makes the rows a chain: sin(omega dt/2) = (c dt/h) sin(k h/2). With
  // u(t) = A e^(i omega t) + B e^(-i omega t), cos(omega T) = (u(t - T) + u(t + T)) / (2 u(t)).
  Recorder recorder(pulse_, 1.3, 0);
  for (const double kh : {0.1, 0.2, 0.4}) {
    SCOPED_TRACE(kh);
    stepper_.start(pulse_, 1);
    std::array<std::complex<double>, 3> u;
    const int n_steps = shear_ ? 6 : 4;
    for (auto& value : u) {
      for (int step = 0; step < n_steps; ++step) stepper_.advance(recorder);
      value = transform(kh / h_);
    }
    const std::complex<double> cosine = (u[0] + u[2]) / (2.0 * u[1]);
    EXPECT_NEAR(cosine.imag(), 0, 1e-8);
    const double omega = std::acos(cosine.real()) / (n_steps * stepper_.step_s());
    const double expected = 2 / stepper_.step_s() * std::asin(c_ * stepper_.step_s() / h_ * std::sin(kh / 2));
    EXPECT_NEAR(omega / expected, 1, 1e-7);
    // Slower than c by (k h)^2 / 24 at most.
    EXPECT_LT(omega / (kh / h_ * c_), 1);
    EXPECT_GT(omega / (kh / h_ * c_), 1 - kh * kh / 24);
  }
}

TEST(StandingWave, OfAPlateWithoutPoissonEffectIsTheChainsRecurrence) {
  // nu = 0: the sides do not matter, and sin(k (H - y)) with k = (2 m + 1) pi / (2 H) is an exact mode of the
  // free lower edge under the held top: a single oscillator.
  const auto mesh = support::make_plate(0.02, 0.02, 1e-3, Corner::none);
  for (const auto& [mode, damping_s] : {std::pair(3, 0.0), {0, 1e-7}, {3, 1e-7}, {0, 1e-6}}) {
    SCOPED_TRACE(testing::Message() << "mode " << mode << ", damping " << damping_s << " s");
    const solid::Material material{.poissons_ratio = 0, .stiffness_damping_s = damping_s};
    Stepper stepper(mesh, material, support::paper_law, one_substep());
    const double k = (2 * mode + 1) * std::numbers::pi / (2 * 0.02), amplitude = 1e-6;
    solid::Field u(mesh.n_nodes());
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
      u.y[n] = lift_m + amplitude * std::sin(k * (0.02 - mesh.y_m[n]));
    const auto e = in_flight(mesh, u, solid::Field(mesh.n_nodes()));
    stepper.start(e, 0);
    Recorder recorder(e, 1.3, 0);
    const double dt = stepper.step_s();
    const double omega = 2 * solid::longitudinal_speed_m_per_s(material) / 1e-3 * std::sin(k * 1e-3 / 2);
    double q = amplitude, rate = 0, worst = 0, least = amplitude, lateral = 0;
    const double sign = mode % 2 == 0 ? 1 : -1;
    for (int step = 0; step < 2000; ++step) {
      rate -= dt * omega * omega * (q + damping_s * rate);
      q += dt * rate;
      stepper.advance(recorder);
      least = std::min(least, q);
      for (const auto n : mesh.interface_nodes) {
        worst = std::max(worst, std::abs(stepper.u_m().y[n] - lift_m - sign * q));
        lateral = std::max(lateral, std::abs(stepper.u_m().x[n]));
      }
    }
    EXPECT_LE(worst, 1e-9 * amplitude);  // rounding of two thousand steps
    EXPECT_LE(lateral, 1e-9 * amplitude);
    EXPECT_LT(least, -0.1 * amplitude);  // it oscillates
    // The damping is no small thing: the amplitude falls by exp(-beta_R omega^2 t / 2).
    EXPECT_TRUE(std::abs(q) < 1e-3 * amplitude || mode == 0 || damping_s == 0);
  }
}

}  // namespace
}  // namespace slipfront::motion
