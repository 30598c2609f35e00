// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/error.hpp"
#include "mesh/reorder.hpp"
#include "solve/event.hpp"
#include "solve/stepper.hpp"
#include "support.hpp"

namespace slipfront::solve {
namespace {

using mesh::Corner;
using support::flat;
using support::max_abs;

constexpr double mu_s = 1.3;

/// 24 mm x 24 mm in elements of 1, 2 and 4 mm: rows 4, 3 and 2 of them.
mesh::Plate graded_plate(Corner corner, int coarsenings = 2) {
  mesh::Plate plate;
  plate.width_m = 0.024;
  plate.height_m = 0.024;
  plate.element_size_m = 1e-3;
  plate.corner = corner;
  plate.relief_length_m = 3e-3;
  plate.relief_height_m = 0.3e-3;
  plate.relief_depth_m = 8e-3;
  plate.coarsenings = coarsenings;
  plate.fine_height_m = 4e-3;
  return plate;
}

TimeStepping stepping(int substeps, bool local) {
  TimeStepping time;
  time.interface_rows = 3;
  time.interface_substeps = substeps;
  time.local_steps = local;
  return time;
}

/// Corner, sub-steps at the interface, local steps.
class GradedPlate : public ::testing::TestWithParam<std::tuple<Corner, int, bool>> {
 protected:
  mesh::Mesh mesh_ = mesh::make_plate(graded_plate(std::get<0>(GetParam())));
  TimeStepping time_ = stepping(std::get<1>(GetParam()), std::get<2>(GetParam()));
  bool is_plain() const { return time_.interface_substeps == 1 && !time_.local_steps; }
};

INSTANTIATE_TEST_SUITE_P(Levels, GradedPlate,
                         ::testing::Combine(::testing::Values(Corner::none, Corner::relief),
                                            ::testing::Values(1, 5), ::testing::Bool()));

TEST_P(GradedPlate, LargerElementsTakeLargerSteps) {
  const Stepper stepper(mesh_, {.stiffness_damping_s = 0}, support::paper_law, time_);
  const auto grids = mesh::blocks(mesh_);
  ASSERT_EQ(grids.size(), 3);
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const auto n = grids[k].node(2, grids[k].rows - 1);  // above the interface rows and the transition
    if (k == 0) continue;
    const double expected = (time_.local_steps ? 1 << k : 1) * 0.9 * stepper.stable_step_s();
    EXPECT_DOUBLE_EQ(stepper.step_s(n), expected);
  }
  EXPECT_DOUBLE_EQ(stepper.step_s(mesh_.lower[4]), 0.9 * stepper.stable_step_s() / time_.interface_substeps);
  EXPECT_DOUBLE_EQ(stepper.lowest_step_s(), 0.9 * stepper.stable_step_s());
}

TEST_P(GradedPlate, TheBooksCloseWithEverythingOn) {
  const Loading loading{.tilt_left_m = 0.12e-3, .tilt_right_m = 0.05e-3, .edge_margin_m = 2e-3};
  const Statics statics(mesh_, {}, loading, mu_s);
  const auto e = statics.shear_to(0.9 * mu_s);
  for (const auto algorithm :
       {interface::ContactAlgorithm::direct, interface::ContactAlgorithm::predictor_corrector}) {
    Stepper stepper(mesh_, {}, support::with_algorithm(support::gentle_law, algorithm), time_);
    stepper.start(e, 0.2);
    const interface::Trigger trigger { .zone_m = 3e-3, .ramp_s = 1e-6 };
    stepper.set_trigger(trigger, trigger_forces(e, mesh::tributary_lengths_m(mesh_),
                                                interface::EventKind::left, trigger, mu_s));
    Recorder recorder(e, mu_s, 0);
    const Energies start = stepper.energies();
    double worst_J = 0, largest_J = 0;
    Energies now;
    for (int step = 0; step < 300; ++step) {
      stepper.advance(recorder);
      now = stepper.energies();
      worst_J = std::max(worst_J, std::abs(now.stored() - start.stored() - now.work()));
      for (const double term : {now.kinetic, now.strain, now.top_work, now.trigger_work, now.friction_work})
        largest_J = std::max(largest_J, std::abs(term));
    }
    EXPECT_GT(recorder.take(stepper.time_s()).onsets.size(), 5);
    EXPECT_LT(now.friction_work, -1e-6 * largest_J);
    EXPECT_LT(now.damping_work, -1e-6 * largest_J);
    EXPECT_EQ(now.coupling_work != 0, !is_plain());
    EXPECT_LE(worst_J, 1e-12 * largest_J);  // as on plain plates, see energies_test
  }
}

TEST_P(GradedPlate, AtRestStaysAtRest) {
  const Statics statics(mesh_, {}, {.tilt_left_m = 0.08e-3, .tilt_right_m = 0.06e-3, .edge_margin_m = 2e-3},
                        mu_s);
  const auto e = statics.shear_by(0.02e-3);
  Stepper stepper(mesh_, {}, support::paper_law, time_);
  stepper.start(e, 0);
  Recorder recorder(e, mu_s, 0);
  for (int step = 0; step < 500; ++step) stepper.advance(recorder);
  EXPECT_EQ(recorder.take(0).onsets.size(), 0);
  // The static solution's residual (1e-11 of the forces) is all that moves.
  EXPECT_LE(max_abs(flat(stepper.u_m()) - flat(e.u_m)), 1e-10 * max_abs(flat(e.u_m)));
}

TEST_P(GradedPlate, UndampedFlightNeitherGrowsNorDecays) {
  // As SubcycledFlight.EnergyStaysBounded for the interface layer: a rough start, which every resonance
  // between levels would feed.
  Stepper stepper(mesh_, {.stiffness_damping_s = 0}, support::paper_law, time_);
  support::Random random(11);
  solid::Field u(mesh_.n_nodes()), v(mesh_.n_nodes());
  std::ranges::fill(u.y, 0.01);
  for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) v.x[n] = random(), v.y[n] = random();
  for (const auto n : mesh_.top) v.x[n] = v.y[n] = 0;
  const auto rough = support::in_flight(mesh_, u, v);
  stepper.start(rough, 1);
  Recorder recorder(rough, mu_s, 0);
  const auto extremes_of = [&](int n_steps) {
    double least = 1e300, largest = 0;
    for (int step = 0; step < n_steps; ++step) {
      stepper.advance(recorder);
      least = std::min(least, stepper.energy_J_per_m());
      largest = std::max(largest, stepper.energy_J_per_m());
    }
    return std::pair(least, largest);
  };
  const auto early = extremes_of(1000);
  for (int step = 0; step < 10000; ++step) stepper.advance(recorder);
  const auto late = extremes_of(1000);
  // The swing of displacements and velocities half a step apart, which only changes its phases.
  EXPECT_LT(late.second, 1.1 * early.second);
  EXPECT_GT(late.first, 0.9 * early.first);
}

TEST(Graded, RefusesAnInterfaceLayerAboveTheSmallestElements) {
  auto time = stepping(5, true);
  time.interface_rows = 4;
  const auto mesh = mesh::make_plate(graded_plate(Corner::none));
  EXPECT_THAT([&] { Stepper(mesh, {}, support::paper_law, time); },
              ::testing::ThrowsMessage<UserError>(::testing::HasSubstr("plate.fine_height_m")));
}

TEST(Graded, StaticsAreNearThoseOfTheUniformPlate) {
  const Loading loading{.tilt_left_m = 0.12e-3, .tilt_right_m = 0.09e-3, .edge_margin_m = 2e-3};
  auto plate = graded_plate(Corner::relief);
  const auto tractions = [&](const mesh::Plate& p) {
    const auto mesh = mesh::make_plate(p);
    return Statics(mesh, {}, loading, mu_s).shear_by(0.02e-3).tractions;
  };
  const auto coarse_above = tractions(plate);
  plate.coarsenings = 0;
  const auto uniform = tractions(plate);
  plate.element_size_m *= 2;
  const auto coarse = tractions(plate);
  const auto difference = [&](const fronts::StaticState& a, std::size_t stride) {
    double worst = 0;
    for (std::size_t k = 4; k + 4 < uniform.x_m.size(); k += 2)  // away from the edges
      worst = std::max(worst, std::abs(a.p_s_Pa[k / stride] / uniform.p_s_Pa[k] - 1));
    return worst;
  };
  const double graded = difference(coarse_above, 1), doubled = difference(coarse, 2);
  fmt::print("pressure against the uniform plate: graded {:.2g}, all elements doubled {:.2g}\n", graded,
             doubled);
  // Larger elements away from the interface must cost less than larger ones everywhere.
  EXPECT_LT(graded, doubled);
  EXPECT_GT(graded, 1e-6);
}

/// Largest difference, in the lower part of a plate of 1 mm elements, between a plate that is coarsened above
/// 160 mm and one that is not, after a packet of plane waves has met the transition; over its amplitude.
double reflection(bool shear, double wavelength_m, const TimeStepping& time) {
  const double h = 1e-3, packet_m = 3 * wavelength_m, middle_m = 0.1;
  mesh::Plate plate;
  plate.width_m = 8 * h;
  plate.height_m = 0.4;
  plate.element_size_m = h;
  plate.corner = Corner::none;
  plate.sides = mesh::Sides::periodic;
  plate.top = mesh::Top::free;
  plate.fine_height_m = 0.16;
  const solid::Material material{.stiffness_damping_s = 0};
  const double c = shear ? solid::shear_speed_m_per_s(material) : solid::longitudinal_speed_m_per_s(material);
  const auto run = [&](int coarsenings) {
    plate.coarsenings = coarsenings;
    const auto mesh = mesh::make_plate(plate);
    solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
    for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
      const double s = mesh.y_m[n] - middle_m, k = 2 * std::numbers::pi / wavelength_m;
      const double window = std::exp(-s * s / (2 * packet_m * packet_m / 9));
      const double slope =
          k * std::cos(k * s) - std::sin(k * s) * s / (packet_m * packet_m / 9);  // of sin times window
      auto& u_n = shear ? u.x[n] : u.y[n];
      auto& v_n = shear ? v.x[n] : v.y[n];
      u_n = 1e-6 * window * std::sin(k * s);
      v_n = -c * 1e-6 * window * slope;
      u.y[n] += 0.01;
    }
    const auto e = support::in_flight(mesh, u, v);
    Stepper stepper(mesh, material, support::paper_law, time);
    stepper.start(e, 1);
    Recorder recorder(e, mu_s, 0);
    // Until the packet is back where it began; the free top, 240 mm higher, has not yet answered.
    while (stepper.time_s() < 2 * (0.16 - middle_m) / c) stepper.advance(recorder);
    std::vector<double> values;
    for (int j = 0; j < 130; ++j) {
      const auto n = mesh.grid.node(2, j);
      values.push_back(shear ? stepper.u_m().x[n] : stepper.u_m().y[n]);
    }
    return values;
  };
  const auto plain = run(0), graded = run(1);
  double largest = 0;
  for (std::size_t j = 0; j < plain.size(); ++j) largest = std::max(largest, std::abs(plain[j] - graded[j]));
  return largest / 1e-6;
}

TEST(Graded, TheTransitionReflectsLittle) {
  for (const bool local : {false, true}) {
    auto time = stepping(1, local);
    for (const bool shear : {false, true}) {
      std::vector<double> of_length;
      for (const int elements : {10, 20, 40}) {
        of_length.push_back(reflection(shear, elements * 1e-3, time));
        fmt::print("{} wave of {} elements, {}: {:.2g} of the amplitude reflected\n",
                   shear ? "shear" : "pressure", elements, local ? "local steps" : "one step",
                   of_length.back());
      }
      // The impedance of a row of elements differs from the continuum's by a part of the order (k h)^2.
      const double kh = 2 * std::numbers::pi / 40;
      EXPECT_LT(of_length[2], kh * kh);
      EXPECT_LT(of_length[2], 0.5 * of_length[1]);
    }
  }
}

/// Any numbering and the general rows give the motion of the plain plate.
TEST(GeneralMesh, MovesAsThePlainPlate) {
  const Loading loading{.tilt_left_m = 0.12e-3, .tilt_right_m = 0.05e-3, .edge_margin_m = 2e-3};
  const auto mesh = mesh::make_plate(graded_plate(Corner::relief, 0));
  auto general = mesh;
  const auto number = mesh::near_numbers(mesh);
  mesh::renumber(general, number);
  const auto e = Statics(mesh, {}, loading, mu_s).shear_to(0.9 * mu_s);
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
  const auto run = [&](const mesh::Mesh& m, const Equilibrium& state) {
    time.step_factor = 0.9 * stable_step_s / Stepper(m, {}, support::gentle_law, time).stable_step_s();
    Stepper stepper(m, {}, support::gentle_law, time);
    stepper.start(state, 0.2);
    const interface::Trigger trigger { .zone_m = 3e-3, .ramp_s = 1e-6 };
    stepper.set_trigger(trigger, trigger_forces(state, mesh::tributary_lengths_m(m),
                                                interface::EventKind::left, trigger, mu_s));
    Recorder recorder(state, mu_s, 0);
    const Energies start = stepper.energies();
    for (int step = 0; step < 40; ++step) stepper.advance(recorder);
    const Energies now = stepper.energies();
    EXPECT_LE(std::abs(now.stored() - start.stored() - now.work()), 1e-12 * now.stored());
    return stepper.u_m();
  };
  const auto plain = run(mesh, e), other = run(general, renumbered);
  double worst = 0;
  for (std::size_t n = 0; n < number.size(); ++n)
    worst = std::max(
        {worst, std::abs(plain.x[n] - other.x[number[n]]), std::abs(plain.y[n] - other.y[number[n]])});
  EXPECT_LE(worst, 1e-15);  // rounding of some ten steps, displacements of 0.1 mm; see stepper_test
}

}  // namespace
}  // namespace slipfront::solve
