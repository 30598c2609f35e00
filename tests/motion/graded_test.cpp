// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "base/error.hpp"
#include "mesh/reorder.hpp"
#include "motion/event.hpp"
#include "motion/stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using mesh::Corner;
using support::max_difference;
using support::mu_s;
using support::UnderWay;

/// 24 mm x 24 mm in elements of 1, 2 and 4 mm: rows 4, 3 and 2 of them.
mesh::Plate graded_plate(Corner corner, int coarsenings = 2) {
  auto plate = support::plate_of(0.024, 0.024, 1e-3, corner);
  plate.relief_length_m = 3e-3;
  plate.relief_height_m = 0.3e-3;
  plate.relief_depth_m = 8e-3;
  plate.coarsenings = coarsenings;
  plate.fine_height_m = 4e-3;
  return plate;
}

const statics::Loading graded_loading{.tilt_left_m = 0.12e-3, .tilt_right_m = 0.05e-3, .edge_margin_m = 2e-3};

TimeStepping stepping(int substeps, bool local) {
  return {.interface_rows = 3, .interface_substeps = substeps, .local_steps = local};
}

/// Corner, sub-steps at the interface, local steps.
class GradedPlate : public ::testing::TestWithParam<std::tuple<Corner, int, bool>> {
 protected:
  mesh::Mesh mesh_ = mesh::make_plate(graded_plate(std::get<0>(GetParam())));
  TimeStepping time_ = stepping(std::get<1>(GetParam()), std::get<2>(GetParam()));
};

INSTANTIATE_TEST_SUITE_P(Levels, GradedPlate,
                         ::testing::Values(std::tuple(Corner::none, 1, false),
                                           std::tuple(Corner::none, 5, true),
                                           std::tuple(Corner::relief, 5, false),
                                           std::tuple(Corner::relief, 1, true)));

TEST_P(GradedPlate, LargerElementsTakeLargerSteps) {
  for (const double damping_s : {0.0, 1e-7}) {
    const Stepper stepper(mesh_, {.stiffness_damping_s = damping_s}, support::paper_law, time_);
    const auto grids = mesh::blocks(mesh_);
    ASSERT_EQ(grids.size(), 3);
    const double lowest_s = 0.9 * stepper.stable_step_s();
    for (int k = 1; k < 3; ++k) {
      const auto n = grids[k].node(2, grids[k].rows - 1);
      EXPECT_DOUBLE_EQ(stepper.step_s(n), (time_.local_steps && damping_s > 0 ? 1 << k : 1) * lowest_s);
    }
    EXPECT_DOUBLE_EQ(stepper.step_s(mesh_.interface_nodes[4]), lowest_s / time_.interface_substeps);
    EXPECT_DOUBLE_EQ(stepper.lowest_step_s(), lowest_s);
  }
}

TEST(GradedSteps, AreNoLargerThanTheCellsAllow) {
  // Without lateral contraction a free cell of a transition has a larger frequency than a square below it.
  const auto mesh = mesh::make_plate(graded_plate(Corner::none));
  const Stepper stepper(mesh, {.poissons_ratio = 0, .stiffness_damping_s = 1e-7}, support::paper_law,
                        stepping(1, true));
  const auto grids = mesh::blocks(mesh);
  EXPECT_DOUBLE_EQ(stepper.step_s(grids[1].node(2, 1)), stepper.lowest_step_s());
  EXPECT_DOUBLE_EQ(stepper.step_s(grids[2].node(2, 1)), 4 * stepper.lowest_step_s());
}

TEST_P(GradedPlate, TheBooksCloseWithEverythingOn) {
  const auto e = statics::Statics(mesh_, {}, graded_loading, mu_s).shear_to(0.9);
  for (const auto algorithm : support::algorithms) {
    UnderWay way({mesh_, {}, support::with_algorithm(support::gentle_law, algorithm), time_}, e, 0.2,
                 support::left_trigger(e, mesh_, mu_s));
    const auto balance = way.balance_of(300);
    EXPECT_GT(way.n_onsets(), 5);
    EXPECT_LT(balance.last.friction_work, -1e-6 * balance.largest_J);
    EXPECT_LT(balance.last.damping_work, -1e-6 * balance.largest_J);
    EXPECT_EQ(balance.last.coupling_work != 0, time_.interface_substeps > 1 || time_.local_steps);
    EXPECT_LE(balance.worst_J, 1e-12 * balance.largest_J);  // as on plain plates, see energies_test
  }
}

TEST_P(GradedPlate, FlightDoesNotGrow) {
  // A rough start, which excites all resonances between levels; with the least damping that local steps need.
  const double undamped_s =
      Stepper(mesh_, {.stiffness_damping_s = 0}, support::paper_law, time_).lowest_step_s();
  Stepper stepper(mesh_, {.stiffness_damping_s = 0.05 * undamped_s}, support::paper_law, time_);
  ASSERT_EQ(stepper.step_s() > stepper.lowest_step_s(), time_.local_steps);
  const auto rough = support::random_flight(mesh_, 11, 0, 1, 0.01);
  UnderWay way(std::move(stepper), rough, 1);
  double last = std::numeric_limits<double>::infinity();
  for (int block = 0; block < 6; ++block) {
    double largest = 0;
    for (int step = 0; step < 1000; ++step) {
      way.advance(1);
      largest = std::max(largest, way.stepper.energy_J_per_m());
    }
    EXPECT_LT(largest, last);
    last = largest;
  }
}

TEST_P(GradedPlate, ThreadsAndStepsPerSweepDoNotMatter) {
  // Several rows of the largest elements.
  const auto mesh = mesh::make_plate(graded_plate(std::get<0>(GetParam()), 1));
  const auto e = statics::Statics(mesh, {}, graded_loading, mu_s).shear_by(0.02e-3);
  const auto run = [&](const Execution& execution) {
    UnderWay way({mesh, {}, support::gentle_law, time_, execution}, e, 0.2,
                 support::left_trigger(e, mesh, mu_s));
    auto& stepper = way.stepper;
    EXPECT_EQ(stepper.advance(way.recorder, 60), 60);
    return std::tuple(stepper.u_m().x, stepper.u_m().y, stepper.energies().stored(),
                      stepper.energies().work());
  };
  const auto alone = run({.threads = 1, .steps_per_sweep = 1});
  EXPECT_EQ(run({.threads = 1, .steps_per_sweep = 5}), alone);
  EXPECT_EQ(run({.threads = 3, .steps_per_sweep = 2}), alone);
}

TEST(Graded, SinglePrecisionOfTheCoarsestBlockDiffersByRounding) {
  // 0.1 m x 0.1 m: 100 and 50 columns, above them a block of rows that can be in single precision.
  auto plate = graded_plate(Corner::none, 1);
  plate.width_m = plate.height_m = 0.1;
  const auto mesh = mesh::make_plate(plate);
  auto e = support::random_flight(mesh, 5, 0, 1, 20e-6);
  for (const auto n : mesh.far_edge_nodes) e.u_m.y[n] = 0;
  solid::Field v[2];
  constexpr int n_steps = 40;
  for (const int k : {0, 1}) {
    auto time = stepping(4, true);
    time.precision = k == 0 ? Precision::double_precision : Precision::single_precision;
    UnderWay way({mesh, {}, support::paper_law, time}, e, 1);
    EXPECT_EQ(way.stepper.advance(way.recorder, n_steps), n_steps);
    v[k] = way.stepper.v_m_per_s();
  }
  // Rounding of u (20 um, turned into velocities by 1/dt) and v (1 m/s), 6e-8 of each in every step.
  const double dt = 8e-7, difference = max_difference(v[1], v[0]);
  EXPECT_LE(difference, n_steps * 6e-8 * (1 + 20e-6 / dt));
  EXPECT_GT(difference, 1e-10);
}

TEST(Graded, RefusesAnInterfaceLayerAboveTheSmallestElements) {
  auto time = stepping(5, true);
  time.interface_rows = 4;
  const auto mesh = mesh::make_plate(graded_plate(Corner::none));
  EXPECT_THAT([&] { Stepper(mesh, {}, support::paper_law, time); },
              ::testing::ThrowsMessage<UserError>(::testing::HasSubstr("plate.fine_height_m")));
}

/// Largest difference, in the lower part of a plate of 1 mm elements, between a plate that is coarsened above
/// four wavelengths and one that is not, after a packet of plane waves has met the transition; over the
/// amplitude that damping leaves.
double reflection(bool shear, int elements_per_wave, bool local) {
  const double h = 1e-3, wave_m = elements_per_wave * h;
  const double join_m = 4 * wave_m, middle_m = 2.5 * wave_m, width_m = 0.5 * wave_m;
  auto plate = support::plate_of(8 * h, 10 * wave_m, h);
  plate.sides = mesh::Sides::periodic;
  plate.top = mesh::Top::free;
  plate.fine_height_m = join_m;
  const solid::Material material{.stiffness_damping_s = 0.05 * 0.6e-6};
  const double c = shear ? solid::shear_speed_m_per_s(material) : solid::longitudinal_speed_m_per_s(material);
  const double k = 2 * std::numbers::pi / wave_m;
  const auto run = [&](int coarsenings) {
    plate.coarsenings = coarsenings;
    const auto mesh = mesh::make_plate(plate);
    solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      const double s = mesh.y_m[n] - middle_m;
      const double window = 1e-6 * std::exp(-s * s / (2 * width_m * width_m));
      (shear ? u.x[n] : u.y[n]) = window * std::sin(k * s);
      (shear ? v.x[n] : v.y[n]) =
          -c * window * (k * std::cos(k * s) - std::sin(k * s) * s / (width_m * width_m));
      u.y[n] += 0.01;
    }
    UnderWay way({mesh, material, support::paper_law, stepping(1, local)}, support::in_flight(mesh, u, v), 1);
    const auto& stepper = way.stepper;
    EXPECT_EQ(stepper.step_s() > stepper.lowest_step_s(), local && coarsenings > 0);
    // Until what comes back is where it began; both plates at the same time, the steps being of two lengths.
    const int n_steps = static_cast<int>(2 * (join_m - middle_m) / (c * 2 * stepper.lowest_step_s())) * 2;
    way.advance_to((n_steps - 0.5) * stepper.lowest_step_s());
    std::vector<double> values;
    for (int j = 0; j < static_cast<int>(3.8 * elements_per_wave); ++j) {
      const auto n = mesh.grid.node(2, j);
      values.push_back(shear ? stepper.u_m().x[n] : stepper.u_m().y[n]);
    }
    return values;
  };
  const auto plain = run(0), graded = run(1);
  double largest = 0;
  for (std::size_t j = 0; j < plain.size(); ++j) largest = std::max(largest, std::abs(plain[j] - graded[j]));
  const double decay_per_s = 0.5 * material.stiffness_damping_s * k * k * c * c;
  return largest / (1e-6 * std::exp(-decay_per_s * 2 * (join_m - middle_m) / c));
}

TEST(Graded, TheTransitionReflectsLittle) {
  for (const bool local : {false, true})
    for (const bool shear : {false, true})
      for (const int elements : {40, 80}) {
        const double reflected = reflection(shear, elements, local), kh = 2 * std::numbers::pi / elements;
        if (local) {
          // The join of two steps acts as if the larger element, 2 h, were thinner by less than a tenth.
          EXPECT_LT(reflected, 0.1 * kh);
        } else {
          // A chain of elements h has the impedance cos(k h/2)/cos(omega dt/2) of the continuum's; of two
          // chains with one step, half the logarithm of the ratio is reflected.
          EXPECT_NEAR(reflected / (3.0 / 16 * kh * kh), 1, 0.1);
        }
      }
}

/// Any numbering and the general rows give the motion of the plain plate.
TEST(GeneralMesh, MovesAsThePlainPlate) {
  const auto mesh = mesh::make_plate(graded_plate(Corner::relief, 0));
  auto general = mesh;
  const auto number = mesh::near_numbers(mesh);
  mesh::renumber(general, number);
  const auto e = statics::Statics(mesh, {}, graded_loading, mu_s).shear_to(0.9);
  auto renumbered = e;
  for (std::size_t n = 0; n < number.size(); ++n) {
    renumbered.u_m.x[number[n]] = e.u_m.x[n];
    renumbered.u_m.y[number[n]] = e.u_m.y[n];
    renumbered.u_per_shear.x[number[n]] = e.u_per_shear.x[n];
    renumbered.u_per_shear.y[number[n]] = e.u_per_shear.y[n];
  }
  // The frequency is found up to 1e-3 from a start vector that depends on the numbers.
  auto time = stepping(5, true);
  const double stable_step_s = Stepper(mesh, {}, support::gentle_law, time).stable_step_s();
  const auto run = [&](const mesh::Mesh& m, const statics::Equilibrium& state) {
    time.step_factor = 0.9 * stable_step_s / Stepper(m, {}, support::gentle_law, time).stable_step_s();
    UnderWay way({m, {}, support::gentle_law, time}, state, 0.2, support::left_trigger(state, m, mu_s));
    const auto balance = way.balance_of(40);
    EXPECT_LE(balance.worst_J, 1e-12 * balance.last.stored());
    return way.stepper.u_m();
  };
  const auto plain = run(mesh, e), other = run(general, renumbered);
  double worst = 0;
  for (std::size_t n = 0; n < number.size(); ++n)
    worst = std::max(
        {worst, std::abs(plain.x[n] - other.x[number[n]]), std::abs(plain.y[n] - other.y[number[n]])});
  EXPECT_LE(worst, 1e-15);  // rounding of some ten steps, displacements of 0.1 mm; see stepper_test
}

}  // namespace
}  // namespace slipfront::motion
