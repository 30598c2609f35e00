// SPDX-License-Identifier: BSD-3-Clause
// Two deformable bodies on each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <vector>

#include "motion/stepper.hpp"
#include "motion/support.hpp"
#include "statics/prestress.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {
namespace {

using support::UnderWay;

constexpr double p0_Pa = 1e6;
const solid::Material pmma{};
/// Slower by a factor of 2.3, lighter, hardly damped.
const solid::Material gel{.youngs_modulus_Pa = 0.3e9,
                          .poissons_ratio = 0.45,
                          .density_kg_per_m3 = 800,
                          .stiffness_damping_s = 0.02e-6};

mesh::Mesh free_plate(double width_m = 0.02, double height_m = 0.01) {
  auto plate = support::plate_of(width_m, height_m, 1e-3);
  plate.top = mesh::Top::free;
  return mesh::make_plate(plate);
}

TimeStepping stepping(int substeps) {
  return {.interface_rows = substeps > 1 ? 2 : 1, .interface_substeps = substeps};
}

/// A rupture from the middle of PMMA on another body, under a shear traction below the strength.
struct Rupture {
  mesh::Mesh mesh = free_plate(), mesh_below;
  UnderWay way;

  Rupture(const solid::Material& below, int substeps,
          interface::ContactAlgorithm algorithm = interface::ContactAlgorithm::direct,
          double height_below_m = 0.012, double light_Pa = 0)
      : mesh_below(free_plate(0.02, height_below_m)),
        way(begun({BodySource{mesh, pmma}, BodySource{mesh_below, below},
                   support::with_algorithm(support::gentle_law, algorithm), stepping(substeps)},
                  light_Pa)) {}

  const Body& body(int b) { return way.stepper.bodies()[b]; }
  std::span<const double> p_Pa() { return way.stepper.interface_state().p_Pa; }

 private:
  UnderWay begun(Stepper stepper, double light_Pa) const {
    const std::size_t n = mesh.interface_nodes.size();
    const auto tractions = support::uniform_tractions(mesh, 1.2 * p0_Pa, p0_Pa);
    Loads loads{tractions.t_s_Pa, tractions.p_s_Pa};
    loads.light_Pa = light_Pa;
    loads.strength_fraction.assign(n, 1.0);
    for (std::size_t i = n / 3; i < n / 2; ++i) loads.strength_fraction[i] = 0;
    return {std::move(stepper), statics::prestressed(mesh, tractions, &mesh_below), 0, loads};
  }
};

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST(TwoBodies, OfOneKindMoveOppositelyUnderAnUnchangedPressure) {
  // Of one height: the reflection at the interface, with its sign changed, leaves the problem as it is.
  for (const int substeps : {1, 4}) {
    Rupture rupture(pmma, substeps, interface::ContactAlgorithm::direct, 0.01);
    rupture.way.advance(60);
    const auto& a = rupture.body(0).u_m();
    const auto& b = rupture.body(1).u_m();
    const double u = largest(a.x);
    EXPECT_GT(u, 1e-7);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_NEAR(b.x[k], -a.x[k], 1e-12 * u);
      EXPECT_NEAR(b.y[k], -a.y[k], 1e-12 * u);  // upside down: both to the same side
    }
    for (const double p : rupture.p_Pa()) EXPECT_NEAR(p, p0_Pa, 1e-9 * p0_Pa);
    EXPECT_GT(rupture.way.n_onsets(), 5U);
  }
}

TEST(TwoBodies, LightNodesDoNotCountAsInContact) {
  for (const double light_Pa : {0.0, 0.99 * p0_Pa, 1.01 * p0_Pa}) {
    Rupture rupture(pmma, 1, interface::ContactAlgorithm::direct, 0.01, light_Pa);
    rupture.way.advance(5);
    const auto rates = rupture.way.stepper.slip_rates();
    EXPECT_GT(rates.fastest_m_per_s, 0);
    EXPECT_EQ(rates.fastest_in_contact_m_per_s, light_Pa < p0_Pa ? rates.fastest_m_per_s : 0);
  }
}

TEST(TwoBodies, ExchangeTheirMomentum) {
  for (const auto algorithm : support::algorithms) {
    Rupture rupture(gel, 1, algorithm);
    rupture.way.advance(200);
    EXPECT_GT(rupture.way.n_onsets(), 5U);
    double sum_x = 0, sum_y = 0, all = 0;
    for (int b = 0; b < 2; ++b) {
      const auto& body = rupture.body(b);
      const double sign_y = b == 0 ? 1 : -1;
      for (std::size_t k = 0; k < body.u_m().size(); ++k) {
        const double m = body.op().mass_kg[k];
        sum_x += m * body.v_m_per_s().x[k];
        sum_y += sign_y * m * body.v_m_per_s().y[k];
        all += m * std::hypot(body.v_m_per_s().x[k], body.v_m_per_s().y[k]);
      }
    }
    EXPECT_LT(std::abs(sum_x), 1e-12 * all);
    EXPECT_LT(std::abs(sum_y), 1e-12 * all);
  }
}

TEST(TwoBodies, LandingLeavesTheirCentreOfMassOnItsWay) {
  for (const auto algorithm : support::algorithms) {
    const auto above = free_plate(), below = free_plate(0.02, 0.012);
    solid::Field u(above.n_nodes()), v(above.n_nodes());
    std::ranges::fill(u.y, 1e-6);
    std::ranges::fill(v.y, -1.0);
    auto state = support::in_flight(above, u, v);
    state.below_u_m = state.below_u_per_shear = solid::Field(below.n_nodes());
    UnderWay way({BodySource{above, pmma}, BodySource{below, gel},
                  support::with_algorithm(support::gentle_law, algorithm), stepping(1)},
                 state, 1);
    const auto sum_kg_m = [&] {
      double sum = 0;
      for (int b = 0; b < 2; ++b) {
        const auto& body = way.stepper.bodies()[b];
        for (std::size_t k = 0; k < body.u_m().size(); ++k)
          sum += (b == 0 ? 1 : -1) * body.op().mass_kg[k] * body.u_m().y[k];  // upside down
      }
      return sum;
    };
    const double start_kg_m = sum_kg_m(), momentum = -start_kg_m / 1e-6;
    way.advance_to(5e-6);
    EXPECT_TRUE(support::touches(way.stepper));
    const double way_kg_m = momentum * way.stepper.time_s();
    EXPECT_NEAR(sum_kg_m(), start_kg_m + way_kg_m, 1e-12 * std::abs(way_kg_m));
  }
}

TEST(TwoBodies, EnergyIsBalanced) {
  for (const auto algorithm : support::algorithms)
    for (const int substeps : {1, 5}) {
      Rupture rupture(gel, substeps, algorithm);
      const auto balance = rupture.way.balance_of(150);
      EXPECT_GT(balance.largest_J, 1e-4);
      EXPECT_LT(balance.worst_J, 1e-12 * balance.largest_J) << substeps;
      EXPECT_LT(balance.last.friction_work, -1e-4);
      EXPECT_GT(rupture.way.n_onsets(), 5U);
    }
}

TEST(TwoBodies, TheSlowerOneTakesLongerSteps) {
  Rupture rupture(gel, 6);
  const auto& stepper = rupture.way.stepper;
  EXPECT_EQ(rupture.body(0).period(), 6);
  EXPECT_EQ(rupture.body(1).period(), 12);
  EXPECT_NEAR(stepper.step_s(), 2 * stepper.lowest_step_s(), 1e-15 * stepper.step_s());
}

/// A tilted and sheared plate on a base of another height, graded or of another material, without slip.
class AtRest : public ::testing::TestWithParam<std::tuple<bool, int>> {};
INSTANTIATE_TEST_SUITE_P(Bases, AtRest, ::testing::Combine(::testing::Bool(), ::testing::Values(1, 6)));

TEST_P(AtRest, StaticEquilibriumOfTwoBodiesStaysAtRest) {
  const auto [graded, substeps] = GetParam();
  const auto& material = graded ? pmma : gel;
  const auto mesh = support::make_plate(0.04, 0.02, 1e-3, mesh::Corner::relief);
  auto plate_below = support::plate_of(0.04, 0.024, 1e-3);
  plate_below.coarsenings = graded ? 2 : 0;
  plate_below.fine_height_m = 4e-3;
  const auto base = mesh::make_plate(plate_below);
  const statics::Loading loading{.tilt_left_m = 0.08e-3, .tilt_right_m = 0.06e-3};
  const statics::Statics statics({mesh, pmma}, statics::ElasticBody{base, material}, loading,
                                 std::vector<double>(mesh.interface_nodes.size(), support::mu_s));
  const auto e = statics.shear_by(0.02e-3);
  EXPECT_GT(std::ranges::count(e.contact, statics::Contact::open), 0);
  ASSERT_EQ(std::ranges::count(e.contact, statics::Contact::slip), 0);
  UnderWay way({BodySource{mesh, pmma}, BodySource{base, material}, support::paper_law, stepping(substeps)},
               e, 0);
  double v_m_per_s = 0;
  for (int step = 0; step < 500; ++step) {
    way.advance(1);
    for (const auto& body : way.stepper.bodies())
      v_m_per_s = std::max({v_m_per_s, largest(body.v_m_per_s().x), largest(body.v_m_per_s().y)});
  }
  EXPECT_EQ(way.n_onsets(), 0U);
  const double strain = loading.tilt_left_m / 0.02;
  EXPECT_LE(v_m_per_s, 1e-12 * strain * solid::longitudinal_speed_m_per_s(pmma));
  const double p_max = largest(e.tractions.p_s_Pa);
  const auto& s = way.stepper.interface_state();
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_NEAR(s.t_Pa[k], e.tractions.t_s_Pa[k], 1e-9 * p_max) << k;
    EXPECT_NEAR(s.p_Pa[k], e.tractions.p_s_Pa[k], 1e-9 * p_max) << k;
  }
}

}  // namespace
}  // namespace slipfront::motion
