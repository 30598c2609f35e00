// SPDX-License-Identifier: BSD-3-Clause
#include "motion/stepper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <tuple>

#include "base/error.hpp"
#include "motion/event.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using mesh::Corner;
using support::gentle_law;
using support::in_flight;
using support::max_abs;
using support::max_difference;
using support::mu_s;
using support::one_substep;
using support::paper_law;
using support::tiny_plate;
using support::touches;
using support::UnderWay;

const solid::Material undamped{.stiffness_damping_s = 0};

/// High above the plane.
statics::Equilibrium random_flight(const mesh::Mesh& mesh, double amplitude_m, double lift_m) {
  return support::random_flight(mesh, 11, amplitude_m, 1, lift_m);
}

class FreeFlight : public ::testing::TestWithParam<Corner> {};
INSTANTIATE_TEST_SUITE_P(Corners, FreeFlight, ::testing::Values(Corner::relief, Corner::fillet),
                         [](const auto& corner) { return support::name_of(corner.param); });

TEST_P(FreeFlight, TheStableStepIsSharp) {
  // The step is a lower bound within 0.05 %.
  const auto mesh = tiny_plate(GetParam());
  for (const double damping_s : {0.0, 1e-6}) {
    for (const double factor : {0.999, 1.005}) {
      UnderWay way({mesh, {.stiffness_damping_s = damping_s}, paper_law, one_substep(factor)},
                   random_flight(mesh, 1e-6, 1e-2), 1);
      // Below the limit the energy taken half a step apart swings up to 1 / (1 - factor^2) = 500 times its
      // mean.
      const double limit = 1e3 * way.stepper.energy_J_per_m();
      bool grows = false;
      for (int step = 0; step < 2000 && !grows; ++step) {
        way.advance(1);
        grows = way.stepper.energy_J_per_m() > limit;
      }
      EXPECT_EQ(grows, factor > 1) << damping_s << " " << factor;
    }
  }
}

TEST(SubcycledFlight, EnergyStaysBounded) {
  // A symplectic scheme conserves an energy near its own, which shows as a swing without growth. The swing is
  // that of a leapfrog whose displacements and velocities are half a step apart, omega dt/2 = 0.031 for the
  // lowest mode, which the smooth start excites most; a random start swings more but not increasingly.
  for (const auto corner : {Corner::relief, Corner::fillet}) {
    SCOPED_TRACE(support::name_of(corner));
    const auto mesh = tiny_plate(corner);
    solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
    std::ranges::fill(u.y, 0.01);
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      const double depth = std::sin(std::numbers::pi * (0.01 - mesh.y_m[n]) / 0.02);
      v.x[n] = depth;
      v.y[n] = 0.3 * depth * std::cos(200 * mesh.x_m[n]);
    }
    UnderWay way({mesh, undamped, paper_law, {}}, in_flight(mesh, u, v), 1);
    auto& stepper = way.stepper;
    const double lowest = std::numbers::pi * solid::longitudinal_speed_m_per_s({}) / (2 * 0.01);
    const double swing = lowest * stepper.step_s() / 2;
    const double before = stepper.energy_J_per_m();
    double least = before, most = before;
    for (int step = 0; step < 20000; ++step) {
      way.advance(1);
      if (step % 7 != 0) continue;
      least = std::min(least, stepper.energy_J_per_m());
      most = std::max(most, stepper.energy_J_per_m());
    }
    EXPECT_LT(most / before, 1 + swing);
    EXPECT_GT(least / before, 1 - swing);

    const auto rough = random_flight(mesh, 0, 0.01);
    stepper.start(rough, 1);
    const auto largest_of = [&](int n_steps) {
      double largest = 0;
      for (int step = 0; step < n_steps; ++step) {
        way.advance(1);
        if (step % 3 == 0) largest = std::max(largest, stepper.energy_J_per_m());
      }
      return largest;
    };
    const double early = largest_of(1000);
    way.advance(8000);
    EXPECT_LT(largest_of(1000), early);  // the early swing, of phases yet in order, is never reached again
    ASSERT_FALSE(touches(stepper));
  }
}

TEST(Stepper, CountsTheNodesItMoves) {
  const auto mesh = tiny_plate(Corner::none);
  const Stepper stepper(mesh, {}, paper_law, {.interface_rows = 4, .interface_substeps = 18});
  EXPECT_EQ(stepper.node_updates_per_step(), 21 * (5 + 5 * 18));
  EXPECT_DOUBLE_EQ(stepper.step_s(), 0.9 * stepper.stable_step_s());
  EXPECT_DOUBLE_EQ(stepper.substep_s(), stepper.step_s() / 18);
}

TEST(Stepper, RefusesALayerAsHighAsThePlate) {
  const auto mesh = tiny_plate(Corner::none);
  EXPECT_THAT([&] { Stepper(mesh, {}, paper_law, {.interface_rows = 10}); },
              ::testing::ThrowsMessage<UserError>(::testing::HasSubstr(
                  "time.interface_rows = 10 needs 11 rows of elements at the interface, the plate has 10")));
}

/// A larger plate in a static state under a moving edge.
class Substeps : public ::testing::TestWithParam<int> {
 protected:
  solid::Material material_;
  statics::Equilibrium state(const mesh::Mesh& mesh, double shear_m) const {
    return statics::Statics(mesh, material_, {.tilt_left_m = 0.08e-3, .tilt_right_m = 0.06e-3}, mu_s)
        .shear_by(shear_m);
  }
  /// After 500 steps.
  UnderWay moved(const mesh::Mesh& mesh, const statics::Equilibrium& e, double speed_m_per_s) const {
    UnderWay way({mesh, material_, paper_law, {.interface_substeps = GetParam()}}, e, speed_m_per_s);
    way.advance(500);
    EXPECT_TRUE(speed_m_per_s > 0 || way.n_onsets() == 0);
    return way;
  }
};
INSTANTIATE_TEST_SUITE_P(OneAndMany, Substeps, ::testing::Values(1, 18));

TEST_P(Substeps, APlateAtRestStaysAtRest) {
  const auto mesh = support::make_plate(0.04, 0.02, 1e-3, Corner::relief);
  const auto e = state(mesh, 0.02e-3);
  ASSERT_EQ(std::ranges::count(e.contact, statics::Contact::slip), 0);
  const double p_max = std::ranges::max(e.tractions.p_s_Pa);
  const auto [stepper, recorder] = moved(mesh, e, 0);
  const auto& s = stepper.interface_state();
  // The static solution's residual (1e-11 of the forces) is all that moves.
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_NEAR(s.t_Pa[k], e.tractions.t_s_Pa[k], 1e-9 * p_max) << k;
    EXPECT_NEAR(s.p_Pa[k], e.tractions.p_s_Pa[k], 1e-9 * p_max) << k;
  }
  EXPECT_LE(max_difference(stepper.u_m(), e.u_m), 1e-10 * max_abs(e.u_m));
}

TEST_P(Substeps, StuckPlateFollowsTheTop) {
  // Started with the static motion under a moving edge, the stuck plate keeps to the static solution.
  const auto mesh = support::make_plate(0.04, 0.02, 1e-3, Corner::none);
  const auto e = state(mesh, 0.01e-3);
  ASSERT_EQ(std::ranges::count(e.contact, statics::Contact::stick), 41);
  const double speed = 1e-3;
  const auto [stepper, recorder] = moved(mesh, e, speed);
  auto expected = e.u_m;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    expected.x[n] += speed * stepper.time_s() * e.u_per_shear.x[n];
    expected.y[n] += speed * stepper.time_s() * e.u_per_shear.y[n];
  }
  // A uniform motion from the start would be exact; the stiffness damping shifts the force by beta_R v, which
  // the stress takes up within the displacement v beta_R. Between two pushes, the force of the coarse cells
  // lags by up to a step: v step.
  const double lag_s = material_.stiffness_damping_s + (GetParam() > 1 ? stepper.step_s() : 0);
  EXPECT_LE(max_difference(stepper.u_m(), expected), speed * lag_s);
  EXPECT_GT(speed * stepper.time_s(), 200 * speed * lag_s);
}

/// Rows of bands that threads and steps of one sweep share; relief and fillet make the first band irregular.
class Execute
    : public ::testing::TestWithParam<std::tuple<Corner, int, interface::ContactAlgorithm, Precision>> {};
INSTANTIATE_TEST_SUITE_P(
    Cases, Execute,
    ::testing::Values(
        std::tuple(Corner::none, 1, interface::ContactAlgorithm::direct, Precision::single_precision),
        std::tuple(Corner::relief, 4, interface::ContactAlgorithm::direct, Precision::double_precision),
        std::tuple(Corner::fillet, 1, interface::ContactAlgorithm::predictor_corrector,
                   Precision::double_precision),
        std::tuple(Corner::fillet, 4, interface::ContactAlgorithm::predictor_corrector,
                   Precision::single_precision)));

TEST_P(Execute, GivesTheSameNumbersWithAnyThreadsAndDepth) {
  const auto [corner, n_substeps, algorithm, arithmetic] = GetParam();
  const TimeStepping time{.precision = arithmetic, .interface_substeps = n_substeps};
  const auto mesh = support::make_plate(0.2, 0.01, 0.5e-3, corner);
  const auto law = support::with_algorithm(gentle_law, algorithm);
  const auto e = random_flight(mesh, 1e-6, 0);
  constexpr int n_steps = 50;
  const auto run = [&](const Execution& execution, int block) {
    Stepper stepper(mesh, {}, law, time, execution);
    stepper.start(e, 0,
                  {.trigger_force_N_per_m = std::vector<double>(mesh.interface_nodes.size(), 1.0),
                   .trigger = {.ramp_s = 1e-6}});
    support::RowRecorder recorder(e, mu_s, 1);
    record::History history;
    recorder.to_row = [&] { return &history; };
    while (stepper.step() < n_steps) {
      const auto before = stepper.step();
      const auto most = std::min<std::int64_t>(block, n_steps - before);
      EXPECT_EQ(stepper.advance(recorder, most), most);
      EXPECT_EQ(stepper.step(), before + most);
    }
    EXPECT_GT(std::ranges::max(history.p_Pa), 0);
    EXPECT_EQ(history.time_s.size(), n_steps);
    const auto onsets = recorder.record().onsets.size();
    EXPECT_GT(onsets, 0);
    const auto energies = stepper.energies();
    return std::tuple(stepper.u_m().x, stepper.u_m().y, stepper.v_m_per_s().x, stepper.v_m_per_s().y,
                      energies.damping_work, energies.strain, energies.work(), onsets);
  };
  const auto plain = run({1, 1}, 1);
  for (const auto& [threads, depth, block] :
       {std::tuple{1, 4, 50}, {1, 16, 7}, {2, 1, 50}, {2, 3, 50}, {3, 2, 20}})
    EXPECT_TRUE(run({threads, depth}, block) == plain) << threads << " " << depth;
}

class SinglePrecision : public ::testing::TestWithParam<std::tuple<Corner, int>> {};
INSTANTIATE_TEST_SUITE_P(Cases, SinglePrecision,
                         ::testing::Values(std::tuple(Corner::none, 1), std::tuple(Corner::fillet, 4)));

TEST_P(SinglePrecision, MovesAsDoublePrecisionDoesButForRounding) {
  const auto [corner, substeps] = GetParam();
  const auto mesh = support::make_plate(0.1, 0.02, 0.5e-3, corner);
  const auto e = random_flight(mesh, 1e-6, 10e-6);
  constexpr int n_steps = 40;
  support::Balance balance[2];
  solid::Field u[2], v[2];
  for (const int k : {0, 1}) {
    const auto precision = k == 0 ? Precision::double_precision : Precision::single_precision;
    UnderWay way({mesh, {}, gentle_law, {.precision = precision, .interface_substeps = substeps}}, e, 1);
    balance[k] = {way.stepper.energies()};
    EXPECT_EQ(way.stepper.advance(way.recorder, n_steps), n_steps);
    balance[k].look(way.stepper.energies());
    u[k] = way.stepper.u_m();
    v[k] = way.stepper.v_m_per_s();
  }
  // Each step rounds u and v to 6e-8 of themselves, u at some 10 um, v at some 1 m/s; what is rounded adds up
  // over the steps, and forces turn errors of u into errors of v by 1/dt.
  const double eps = 6e-8, dt = 1e-7;
  const double limit_v = n_steps * eps * (1 + 20e-6 / dt);
  EXPECT_LE(max_difference(v[1], v[0]), limit_v);
  EXPECT_LE(max_difference(u[1], u[0]), n_steps * dt * limit_v + n_steps * eps * 20e-6);
  // And it is another computation.
  EXPECT_GT(max_difference(v[1], v[0]), 1e-9);
  EXPECT_LE(balance[0].worst_J, 1e-12 * balance[0].start.stored());
  EXPECT_LE(balance[1].worst_J, n_steps * 10 * eps * balance[0].start.stored());
}

TEST(Stepper, ANewStartForgetsTheWorks) {
  const auto mesh = tiny_plate(Corner::none);
  const auto e = statics::Statics(mesh, {}, support::tilted, mu_s).shear_to(0.9);
  UnderWay way({mesh, {}, gentle_law, {}}, e, 0.2, support::left_trigger(e, mesh, mu_s));
  way.advance(40);
  const auto works = way.stepper.energies();
  for (const auto work : {works.trigger_work, works.far_edge_work, works.friction_work, works.damping_work})
    EXPECT_NE(work, 0);
  way.stepper.start(e, 0);
  EXPECT_EQ(way.stepper.energies().work(), 0);
}

TEST(Stepper, SamplesBelongToTheBeginningOfTheStep) {
  const auto mesh = tiny_plate(Corner::none);
  const solid::Material material;
  const auto e = statics::Statics(mesh, material, support::tilted, mu_s).shear_to(0.5);
  Stepper stepper(mesh, material, paper_law, {});
  stepper.start(e, 0);
  support::RowRecorder recorder(e, mu_s, 0);
  record::History history;
  recorder.to_row = [&] { return stepper.step() == 1 ? nullptr : &history; };
  for (int step = 0; step < 3; ++step) stepper.advance(recorder);
  ASSERT_EQ(history.time_s.size(), 2);
  EXPECT_EQ(history.time_s[0], 0);
  EXPECT_DOUBLE_EQ(history.time_s[1], 2 * stepper.step_s());
  EXPECT_EQ(history.t_Pa.size(), 2 * mesh.interface_nodes.size());
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_EQ(history.slip_m[k], 0);
    EXPECT_NEAR(history.t_Pa[k], e.tractions.t_s_Pa[k], 1e-9 * e.tractions.p_s_Pa[0]);
    EXPECT_NEAR(history.p_Pa[k], e.tractions.p_s_Pa[k], 1e-9 * e.tractions.p_s_Pa[0]);
  }
}

}  // namespace
}  // namespace slipfront::motion
