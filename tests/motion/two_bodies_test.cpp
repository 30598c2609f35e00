// SPDX-License-Identifier: BSD-3-Clause
// Two deformable bodies on each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/stepper.hpp"
#include "motion/support.hpp"
#include "statics/prestress.hpp"
#include "statics/statics.hpp"

namespace slipfront::motion {
namespace {

using support::mu_s;

constexpr double p0_Pa = 1e6;
const solid::Material pmma{};
/// Slower by a factor of 2.3, lighter, hardly damped.
const solid::Material gel{.youngs_modulus_Pa = 0.3e9,
                          .poissons_ratio = 0.45,
                          .density_kg_per_m3 = 800,
                          .stiffness_damping_s = 0.02e-6};

mesh::Mesh free_plate(double width_m = 0.02, double height_m = 0.01, mesh::Sides sides = mesh::Sides::free) {
  auto plate = support::plate_of(width_m, height_m, 1e-3);
  plate.sides = sides;
  plate.top = mesh::Top::free;
  return mesh::make_plate(plate);
}

TimeStepping stepping(int substeps) {
  return {.interface_rows = substeps > 1 ? 2 : 1, .interface_substeps = substeps};
}

/// A rupture from the middle, under a shear traction below the strength.
class Rupture {
 public:
  Rupture(const solid::Material& above, const solid::Material* below, const TimeStepping& time,
          interface::ContactAlgorithm algorithm = interface::ContactAlgorithm::direct,
          double height_below_m = 0.012, double light_Pa = 0)
      : mesh_(free_plate()), mesh_below_(free_plate(0.02, height_below_m)) {
    const auto law = support::with_algorithm(support::gentle_law, algorithm);
    stepper_ = below == nullptr ? std::make_unique<Stepper>(mesh_, above, law, time)
                                : std::make_unique<Stepper>(BodySource{mesh_, above},
                                                            BodySource{mesh_below_, *below}, law, time);
    const std::size_t n = mesh_.interface_nodes.size();
    const auto tractions = support::uniform_tractions(mesh_, 1.2 * p0_Pa, p0_Pa);
    auto state = statics::prestressed(mesh_, tractions);
    state.below_u_m = state.below_u_per_shear = solid::Field(mesh_below_.n_nodes());
    Loads loads{tractions.t_s_Pa, tractions.p_s_Pa};
    loads.light_Pa = light_Pa;
    loads.strength_fraction.assign(n, 1.0);
    for (std::size_t i = n / 3; i < n / 2; ++i) loads.strength_fraction[i] = 0;
    stepper_->start(state, 0, loads);
    recorder_ = std::make_unique<Recorder>(state, mu_s, 0);
  }

  void advance(int steps) {
    for (int k = 0; k < steps; ++k) stepper_->advance(*recorder_);
  }
  Stepper& stepper() { return *stepper_; }
  const Body& body(int b) { return stepper_->bodies()[b]; }
  std::size_t n_onsets() const { return recorder_->record_until(stepper_->time_s()).onsets.size(); }

 private:
  mesh::Mesh mesh_, mesh_below_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Recorder> recorder_;
};

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST(TwoBodies, OfOneKindMoveOppositelyUnderAnUnchangedPressure) {
  // Of one height: the reflection at the interface, with its sign changed, leaves the problem as it is.
  for (const int substeps : {1, 4}) {
    Rupture rupture(pmma, &pmma, stepping(substeps), interface::ContactAlgorithm::direct, 0.01);
    rupture.advance(60);
    const auto& a = rupture.body(0).u_m();
    const auto& b = rupture.body(1).u_m();
    const double u = largest(a.x);
    EXPECT_GT(u, 1e-7);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_NEAR(b.x[k], -a.x[k], 1e-12 * u);
      EXPECT_NEAR(b.y[k], -a.y[k], 1e-12 * u);  // upside down: both to the same side
    }
    for (const double p : rupture.stepper().interface_state().p_Pa) EXPECT_NEAR(p, p0_Pa, 1e-9 * p0_Pa);
    EXPECT_GT(rupture.n_onsets(), 5U);
  }
}

TEST(TwoBodies, LightNodesDoNotCountAsInContact) {
  for (const double light_Pa : {0.0, 0.99 * p0_Pa, 1.01 * p0_Pa}) {
    Rupture rupture(pmma, &pmma, stepping(1), interface::ContactAlgorithm::direct, 0.01, light_Pa);
    rupture.advance(5);
    const auto rates = rupture.stepper().slip_rates();
    EXPECT_GT(rates.fastest_m_per_s, 0);
    EXPECT_EQ(rates.fastest_in_contact_m_per_s, light_Pa < p0_Pa ? rates.fastest_m_per_s : 0);
  }
}

TEST(TwoBodies, ExchangeTheirMomentum) {
  for (const auto algorithm : support::algorithms) {
    Rupture rupture(pmma, &gel, stepping(1), algorithm);
    rupture.advance(200);
    EXPECT_GT(rupture.n_onsets(), 5U);
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
    Stepper stepper(BodySource{above, pmma}, BodySource{below, gel},
                    support::with_algorithm(support::gentle_law, algorithm), stepping(1));
    stepper.start(state, 1);
    const auto sum_kg_m = [&] {
      double sum = 0;
      for (int b = 0; b < 2; ++b) {
        const auto& body = stepper.bodies()[b];
        for (std::size_t k = 0; k < body.u_m().size(); ++k)
          sum += (b == 0 ? 1 : -1) * body.op().mass_kg[k] * body.u_m().y[k];  // upside down
      }
      return sum;
    };
    const double start_kg_m = sum_kg_m(), momentum = -start_kg_m / 1e-6;
    Recorder recorder(state, mu_s, 0);
    while (stepper.time_s() < 5e-6) stepper.advance(recorder);
    EXPECT_TRUE(support::touches(stepper));
    const double way_kg_m = momentum * stepper.time_s();
    EXPECT_NEAR(sum_kg_m(), start_kg_m + way_kg_m, 1e-12 * std::abs(way_kg_m));
  }
}

TEST(TwoBodies, EnergyIsBalanced) {
  for (const auto algorithm : support::algorithms)
    for (const int substeps : {1, 5}) {
      Rupture rupture(pmma, &gel, stepping(substeps), algorithm);
      support::Balance balance{rupture.stepper().energies()};
      for (int k = 0; k < 150; ++k) {
        rupture.advance(1);
        balance.look(rupture.stepper().energies());
      }
      EXPECT_GT(balance.largest_J, 1e-4);
      EXPECT_LT(balance.worst_J, 1e-12 * balance.largest_J) << substeps;
      EXPECT_LT(balance.last.friction_work, -1e-4);
      EXPECT_GT(rupture.n_onsets(), 5U);
    }
}

TEST(TwoBodies, TheSlowerOneTakesLongerSteps) {
  Rupture rupture(pmma, &gel, stepping(6));
  EXPECT_EQ(rupture.body(0).period(), 6);
  EXPECT_EQ(rupture.body(1).period(), 12);
  EXPECT_NEAR(rupture.stepper().step_s(), 2 * rupture.stepper().lowest_step_s(),
              1e-15 * rupture.stepper().step_s());
}

TEST(TwoBodies, OnABaseEverStifferAndDenserComeToTheRigidPlane) {
  const auto slip_of = [&](double factor) {
    auto base = pmma;
    base.youngs_modulus_Pa *= factor;
    base.density_kg_per_m3 *= factor;
    Rupture rupture(pmma, factor > 0 ? &base : nullptr, stepping(3));
    while (rupture.stepper().time_s() < 10e-6) rupture.advance(1);
    auto slip_m = rupture.stepper().interface_state().slip_m;
    EXPECT_GT(rupture.n_onsets(), 5U);
    return slip_m;
  };
  const auto rigid = slip_of(0);
  std::vector<double> errors;
  for (const double factor : {100, 1000}) {
    const auto slip_m = slip_of(factor);
    double error = 0;
    for (std::size_t i = 0; i < rigid.size(); ++i) error = std::max(error, std::abs(slip_m[i] - rigid[i]));
    errors.push_back(error / largest(rigid));
  }
  // The base's compliance is the plate's over the factor, and so is its part in the slip.
  EXPECT_LT(errors[0], 3.0 / 100);
  EXPECT_NEAR(errors[0] / errors[1], 10, 1);
}

/// A plane pulse that falls from above onto the bonded interface of two tall bodies.
class Pulse : public ::testing::TestWithParam<std::tuple<bool, int>> {
 protected:
  /// Momentum along one axis.
  static double momentum(const Body& body, bool shear) {
    double sum = 0;
    const auto& v = shear ? body.v_m_per_s().x : body.v_m_per_s().y;
    for (std::size_t k = 0; k < v.size(); ++k) sum += body.op().mass_kg[k] * v[k];
    return sum;
  }
};
INSTANTIATE_TEST_SUITE_P(Waves, Pulse, ::testing::Combine(::testing::Bool(), ::testing::Values(1, 4)));

TEST_P(Pulse, IsReflectedAndTransmittedByTheImpedances) {
  const bool shear = std::get<0>(GetParam());
  const int substeps = std::get<1>(GetParam());
  auto above = pmma, below = gel;
  above.stiffness_damping_s = below.stiffness_damping_s = 0;
  const auto speed = [&](const solid::Material& m) {
    return shear ? solid::shear_speed_m_per_s(m) : solid::longitudinal_speed_m_per_s(m);
  };
  const auto mesh = free_plate(3e-3, 0.2, mesh::Sides::periodic);
  Stepper stepper(BodySource{mesh, above}, BodySource{mesh, below},
                  interface::ContactModel{interface::Coulomb{100.0}}, stepping(substeps));
  // v = c F', u = F of y + c t: behind the pulse the body has moved.
  const double c = speed(above), middle_m = 0.1, width_m = 0.02, peak_m_per_s = 0.01;
  solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
  for (mesh::Node k = 0; k < mesh.n_nodes(); ++k) {
    const double x = (mesh.y_m[k] - middle_m) / width_m;
    (shear ? v.x : v.y)[k] = peak_m_per_s * std::exp(-x * x);
    (shear ? u.x : u.y)[k] = peak_m_per_s / c * width_m * std::sqrt(M_PI) / 2 * (1 + std::erf(x));
  }
  auto state = support::in_flight(mesh, u, v);
  state.contact.assign(mesh.interface_nodes.size(), statics::Contact::stick);
  state.tractions = support::uniform_tractions(mesh, 0, p0_Pa);
  state.below_u_m = state.below_u_per_shear = solid::Field(mesh.n_nodes());
  stepper.start(state, 1, {state.tractions.t_s_Pa, state.tractions.p_s_Pa});
  Recorder recorder(state, 100, 0);
  const double incident = momentum(stepper.bodies()[0], shear);
  // Until both have left the interface, and none has come to an end.
  const double time_s = middle_m / c + 0.1 / std::max(c, speed(below));
  while (stepper.time_s() < time_s) stepper.advance(recorder);
  const double Z_1 = above.density_kg_per_m3 * c, Z_2 = below.density_kg_per_m3 * speed(below);
  EXPECT_NEAR(momentum(stepper.bodies()[0], shear) / incident, (Z_1 - Z_2) / (Z_1 + Z_2), 1e-6);
  // Upside down: y is reversed.
  EXPECT_NEAR((shear ? 1 : -1) * momentum(stepper.bodies()[1], shear) / incident, 2 * Z_2 / (Z_1 + Z_2),
              1e-6);
  EXPECT_TRUE(recorder.record_until(stepper.time_s()).onsets.empty());
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
                                 std::vector<double>(mesh.interface_nodes.size(), mu_s));
  const auto e = statics.shear_by(0.02e-3);
  EXPECT_GT(std::ranges::count(e.contact, statics::Contact::open), 0);
  ASSERT_EQ(std::ranges::count(e.contact, statics::Contact::slip), 0);
  Stepper stepper(BodySource{mesh, pmma}, BodySource{base, material}, support::paper_law, stepping(substeps));
  stepper.start(e, 0);
  Recorder recorder(e, mu_s, 0);
  double v_m_per_s = 0;
  for (int step = 0; step < 500; ++step) {
    stepper.advance(recorder);
    for (const auto& body : stepper.bodies())
      v_m_per_s = std::max({v_m_per_s, largest(body.v_m_per_s().x), largest(body.v_m_per_s().y)});
  }
  EXPECT_EQ(recorder.record_until(stepper.time_s()).onsets.size(), 0U);
  const double strain = loading.tilt_left_m / 0.02;
  EXPECT_LE(v_m_per_s, 1e-12 * strain * solid::longitudinal_speed_m_per_s(pmma));
  const double p_max = largest(e.tractions.p_s_Pa);
  const auto& s = stepper.interface_state();
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_NEAR(s.t_Pa[k], e.tractions.t_s_Pa[k], 1e-9 * p_max) << k;
    EXPECT_NEAR(s.p_Pa[k], e.tractions.p_s_Pa[k], 1e-9 * p_max) << k;
  }
}

}  // namespace
}  // namespace slipfront::motion
