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

using support::gentle_law;
using support::mu_s;
using support::UnderWay;

constexpr double rigid = infinity;

struct Sample {
  const char* name;
  boundary::Machine machine;
};

constexpr double kg_per_m2 = 50;  // four times the plate's

const Sample samples[] = {{"Springs", {5e12, 1e13}},
                          {"Mass", {5e12, 1e13, {}, kg_per_m2}},
                          {"PushedByMass", {2.5e13, 0, {1e-3, 5e-3}, kg_per_m2}},
                          {"DeadLoad", {rigid, 0}},
                          {"PushedBySpring", {2.5e13, rigid, {1e-3, 5e-3}}},
                          {"PushedUnderDeadLoad", {2.5e13, 0, {1e-3, 5e-3}}}};

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
  UnderWay way({bodies(), gentle_law, time_}, state_, 0);
  way.advance(200);
  EXPECT_LT(test::max_difference(way.stepper.u_m(), state_.u_m), 1e-12 * test::max_abs(state_.u_m));
}

TEST_P(AMachine, GivesThePlateTheWorkThatIsLeft) {
  UnderWay way({bodies(), gentle_law, time_}, state_, 0.2, support::left_trigger(state_, mesh_, mu_s));
  const auto balance = way.balance_of(400);
  EXPECT_GT(way.n_onsets(), 5);
  EXPECT_GT(std::abs(balance.last.machine), 1e-6 * balance.largest_J);
  EXPECT_GT(std::abs(balance.last.far_edge_work), 1e-6 * balance.largest_J);
  EXPECT_LE(balance.worst_J, 1e-12 * balance.largest_J);
}

TEST_P(AMachine, GoesBackAsItCame) {
  material_.stiffness_damping_s = 0;
  const auto flying = support::random_flight(mesh_, 5, 1e-8, 1e-2, 1e-4);
  UnderWay way({bodies(), {interface::Coulomb{0}}, time_}, flying, 1);
  way.advance(50);
  EXPECT_GT(test::max_difference(way.stepper.u_m(), flying.u_m), 1e-8);
  way.stepper.reverse(way.recorder);
  way.advance(50);
  EXPECT_LT(test::max_difference(way.stepper.u_m(), flying.u_m), 1e-12);
}

TEST(Machine, LetsABlockSwingOnItsSpring) {
  constexpr double K_Pa = 4e6;
  const auto mesh = mesh::make_plate(support::plate_of(0.02, 0.01, 1e-3));
  const solid::Material material{.stiffness_damping_s = 0};
  const double block_kg_per_m2 = material.density_kg_per_m3 * 0.01;
  for (const double mass_kg_per_m2 : {0.0, 3 * block_kg_per_m2}) {
    const double omega = std::sqrt(K_Pa / (0.02 * (block_kg_per_m2 + mass_kg_per_m2)));
    solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
    std::ranges::fill(u.y, 1e-3);  // in the air
    std::ranges::fill(v.x, 2.0);   // beyond the machine by 1 m/s
    const boundary::Machine machine{K_Pa / 0.02, rigid, {}, mass_kg_per_m2};
    const std::vector<BodySource> body = {{mesh, material, nullptr, nullptr, machine}};
    UnderWay way({body, {interface::Coulomb{0}}, support::one_substep()}, support::in_flight(mesh, u, v), 1);
    way.advance_to(0.8 * 2 * std::numbers::pi / omega);
    const double end_s = way.stepper.time_s();
    // The spring is at one edge of the block, which is a spring, too: K H/(G W), 1/1000 of this one.
    for (const double u_x_m : way.stepper.u_m().x)
      EXPECT_NEAR(u_x_m - end_s, std::sin(omega * end_s) / omega, 5e-3 / omega);
  }
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
  UnderWay way({body_on(1e12), gentle_law, support::one_substep(1)}, state, 0);
  way.advance(5000);
  EXPECT_LT(test::max_difference(way.stepper.u_m(), state.u_m), 1e-10 * test::max_abs(state.u_m));
}

}  // namespace
}  // namespace slipfront::motion
