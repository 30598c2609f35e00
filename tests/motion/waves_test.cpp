// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "motion/stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

constexpr double lift_m = 1e-5;

TEST(StandingWave, OfAPlateWithoutPoissonEffectIsTheChainsRecurrence) {
  // nu = 0: the sides do not matter, and sin(k (H - y)) with k = (2 m + 1) pi / (2 H) is an exact mode of the
  // free lower edge under the held top: a single oscillator.
  const auto mesh = support::make_plate(0.02, 0.02, 1e-3, mesh::Corner::none);
  for (const auto& [mode, damping_s] : {std::pair(3, 0.0), {0, 1e-7}, {3, 1e-7}, {0, 1e-6}}) {
    SCOPED_TRACE(testing::Message() << "mode " << mode << ", damping " << damping_s << " s");
    const solid::Material material{.poissons_ratio = 0, .stiffness_damping_s = damping_s};
    const double k = (2 * mode + 1) * std::numbers::pi / (2 * 0.02), amplitude = 1e-6;
    solid::Field u(mesh.n_nodes());
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
      u.y[n] = lift_m + amplitude * std::sin(k * (0.02 - mesh.y_m[n]));
    support::UnderWay way({mesh, material, support::paper_law, support::one_substep()},
                          support::in_flight(mesh, u, solid::Field(mesh.n_nodes())), 0);
    const double dt = way.stepper.step_s();
    const double omega = 2 * solid::longitudinal_speed_m_per_s(material) / 1e-3 * std::sin(k * 1e-3 / 2);
    double q = amplitude, rate = 0, worst = 0, least = amplitude, lateral = 0;
    const double sign = mode % 2 == 0 ? 1 : -1;
    for (int step = 0; step < 2000; ++step) {
      rate -= dt * omega * omega * (q + damping_s * rate);
      q += dt * rate;
      way.advance(1);
      least = std::min(least, q);
      for (const auto n : mesh.interface_nodes) {
        worst = std::max(worst, std::abs(way.stepper.u_m().y[n] - lift_m - sign * q));
        lateral = std::max(lateral, std::abs(way.stepper.u_m().x[n]));
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
