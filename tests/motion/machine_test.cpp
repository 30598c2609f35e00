// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "interface/friction/coulomb.hpp"
#include "motion/plain_stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using support::Balance;
using support::gentle_law;
using support::mu_s;

constexpr double rigid = infinity;

struct Sample {
  const char* name;
  boundary::Machine machine;
};

const Sample samples[] = {{"Springs", {1e11, 2e11}},
                          {"DeadLoad", {rigid, 0}},
                          {"PushedBySpring", {1e11, rigid, {1e-3, 5e-3}}},
                          {"PushedUnderDeadLoad", {1e11, 0, {1e-3, 5e-3}}}};

statics::Statics statics_of(const mesh::Mesh& mesh, const solid::Material& material,
                            const boundary::Machine& machine) {
  return {
      {mesh, material, machine}, {}, support::tilted, std::vector<double>(mesh.interface_nodes.size(), mu_s)};
}

class AMachine : public ::testing::TestWithParam<std::tuple<Sample, int>> {
 protected:
  mesh::Mesh mesh_ = mesh::make_plate(support::plate_of(0.02, 0.01, 1e-3));
  solid::Material material_;
  boundary::Machine machine_ = std::get<0>(GetParam()).machine;
  TimeStepping time_{.interface_rows = 2, .interface_substeps = std::get<1>(GetParam())};
  statics::Equilibrium state_ = statics_of(mesh_, material_, machine_).shear_to(0.9);
  std::vector<BodySource> bodies() const { return {{mesh_, material_, nullptr, nullptr, machine_}}; }
};
INSTANTIATE_TEST_SUITE_P(Samples, AMachine,
                         ::testing::Combine(::testing::ValuesIn(samples), ::testing::Values(1, 5)),
                         [](const auto& p) {
                           return std::get<0>(p.param).name + std::to_string(std::get<1>(p.param));
                         });

TEST_P(AMachine, HoldsAPlateAtRest) {
  Stepper stepper(bodies(), gentle_law, time_);
  stepper.start(state_, 0);
  Recorder recorder(state_, mu_s, 0);
  for (int step = 0; step < 200; ++step) stepper.advance(recorder);
  EXPECT_LT(test::max_difference(stepper.u_m(), state_.u_m), 1e-12 * test::max_abs(state_.u_m));
}

TEST_P(AMachine, GivesThePlateTheWorkThatIsLeft) {
  Stepper stepper(bodies(), gentle_law, time_);
  stepper.start(state_, 0.2, support::left_trigger(state_, mesh_, mu_s));
  Recorder recorder(state_, mu_s, 0);
  Balance balance{stepper.energies()};
  for (int step = 0; step < 400; ++step) {
    stepper.advance(recorder);
    balance.look(stepper.energies());
  }
  EXPECT_GT(recorder.record_until(stepper.time_s()).onsets.size(), 5);
  EXPECT_GT(std::abs(balance.last.machine), 1e-6 * balance.largest_J);
  EXPECT_GT(std::abs(balance.last.far_edge_work), 1e-6 * balance.largest_J);
  EXPECT_LE(balance.worst_J, 1e-12 * balance.largest_J);
}

TEST_P(AMachine, GoesBackAsItCame) {
  material_.stiffness_damping_s = 0;
  Stepper stepper(bodies(), {interface::Coulomb{0}}, time_);
  auto flying = support::random_flight(mesh_, 5, 1e-8, 1e-2, 1e-4);
  stepper.start(flying, 1);
  Recorder recorder(flying, mu_s, 0);
  for (int step = 0; step < 50; ++step) stepper.advance(recorder);
  EXPECT_GT(test::max_difference(stepper.u_m(), flying.u_m), 1e-8);
  stepper.reverse(recorder);
  for (int step = 0; step < 50; ++step) stepper.advance(recorder);
  EXPECT_LT(test::max_difference(stepper.u_m(), flying.u_m), 1e-12);
}

/// Of a lifted body that moves with `v`: displacements after a time, at a speed of 1 m/s of the machine.
solid::Field after(const mesh::Mesh& mesh, const solid::Material& material, const boundary::Machine& machine,
                   solid::Field v, double time_s, double& end_s) {
  const BodySource body{mesh, material, nullptr, nullptr, machine};
  Stepper stepper(std::span(&body, 1), {interface::Coulomb{0}}, support::one_substep());
  solid::Field u(mesh.n_nodes());
  for (double& y : u.y) y = 1e-3;
  const auto e = support::in_flight(mesh, u, std::move(v));
  stepper.start(e, 1);
  Recorder recorder(e, mu_s, 0);
  while (stepper.time_s() < time_s) stepper.advance(recorder);
  end_s = stepper.time_s();
  return stepper.u_m();
}

TEST(Machine, LetsABlockSwingOnItsSpring) {
  constexpr double K_Pa = 4e6;
  const auto mesh = mesh::make_plate(support::plate_of(0.02, 0.01, 1e-3));
  const solid::Material material{.stiffness_damping_s = 0};
  const double omega = std::sqrt(K_Pa / (material.density_kg_per_m3 * 0.02 * 0.01));
  solid::Field v(mesh.n_nodes());
  std::ranges::fill(v.x, 2.0);  // beyond the machine by 1 m/s
  double end_s = 0;
  const auto u = after(mesh, material, {K_Pa, rigid}, v, 0.8 * 2 * std::numbers::pi / omega, end_s);
  // The spring is at one edge of the block, which is a spring, too: K H/(G W), 1/1000 of this one.
  for (const double u_x_m : u.x) EXPECT_NEAR(u_x_m - end_s, std::sin(omega * end_s) / omega, 5e-3 / omega);
}

TEST(Machine, LetsAColumnSwingUpAndDown) {
  // Free below, on a spring above: u = cos(k y) sin(omega t), E k tan(k H) = K/W, without lateral strain.
  constexpr double K_Pa = 6e9, H_m = 0.01, W_m = 0.02;
  const solid::Material material{.poissons_ratio = 1e-12, .stiffness_damping_s = 0};
  const double E_Pa = material.youngs_modulus_Pa, c = std::sqrt(E_Pa / material.density_kg_per_m3);
  double below = 0, k = 0.5 * std::numbers::pi / H_m, above = k;
  for (int bisection = 0; bisection < 60; ++bisection) {
    k = 0.5 * (below + above);
    (E_Pa * k * std::tan(k * H_m) < K_Pa / W_m ? below : above) = k;
  }
  const double omega = k * c;
  double off_before = infinity;
  for (const int rows : {10, 20}) {
    const auto mesh = mesh::make_plate(support::plate_of(W_m, H_m, H_m / rows));
    solid::Field v(mesh.n_nodes());
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) v.y[n] = std::cos(k * mesh.y_m[n]);
    for (const auto n : mesh.far_edge_nodes) v.x[n] = 0;
    double end_s = 0, off = 0;
    const auto u = after(mesh, material, {rigid, K_Pa}, v, 1.7 * std::numbers::pi / omega, end_s);
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
      off = std::max(off, std::abs(omega * (u.y[n] - 1e-3) - v.y[n] * std::sin(omega * end_s)));
    EXPECT_LT(off, 0.3 * off_before);  // of second order
    off_before = off;
  }
  EXPECT_LT(off_before, 0.01);
}

TEST(Machine, ASpringTakesItsShareOfTheStableStep) {
  const solid::Material material;
  const auto mesh = mesh::make_plate(support::plate_of(0.02, 0.01, 1e-3));
  const auto body_on = [&](double stiffness_Pa) {
    return std::vector<BodySource>{{mesh, material, nullptr, nullptr, {rigid, stiffness_Pa}}};
  };
  const auto step_of = [&](double stiffness_Pa) {
    return Stepper(body_on(stiffness_Pa), gentle_law, support::one_substep()).stable_step_s();
  };
  const double soft_s = step_of(0), stiff_s = step_of(1e12);
  EXPECT_LT(stiff_s, 0.95 * soft_s);
  // A plate on it stays where it is up to that step.
  const auto state = statics_of(mesh, material, {rigid, 1e12}).shear_to(0.9);
  Stepper stepper(body_on(1e12), gentle_law, support::one_substep(1));
  stepper.start(state, 0);
  Recorder recorder(state, mu_s, 0);
  for (int step = 0; step < 5000; ++step) stepper.advance(recorder);
  EXPECT_LT(test::max_difference(stepper.u_m(), state.u_m), 1e-10 * test::max_abs(state.u_m));
}

}  // namespace
}  // namespace slipfront::motion
