// SPDX-License-Identifier: BSD-3-Clause
#include "setup/loads.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "setup/cases.hpp"

namespace slipfront::setup {
namespace {

using interface::EventKind;
using problem::make_problem;
using statics::Contact;
using test::error_of;
using test::go_on;
using ::testing::HasSubstr;

/// A plate under 5 MPa as far as triggered events; `change` makes the row's body, contact or solver of it.
struct Row {
  const char* name;
  std::function<void(input::Case&)> change;
  bool opens = false;       ///< a part of the interface that has no gap
  double tolerance = 1e-9;  ///< of tractions: the rounding of a factorisation, or of forces what
                            ///< equilibria by iteration leave in the norm of energies, 1e-10
};

void stand_on_steel(input::Case& c) {
  c.base.kind = input::BaseKind::body;
  c.base.plate.height_m = 0.06;
  c.base.material = {2e11, 0.3, 7800, c.material.plane, 0};
}

void tilt_until_it_opens(input::Case& c) {
  c.loading.tilt_difference_m = 0.7e-3;
  c.loading.edge_margin_m = 0.05;
}

const Row loads_of_rows[] = {
    {"level", [](input::Case& c) { c.plate.corner = mesh::Corner::none; }},
    {"relieved corners", [](input::Case&) {}},
    {"tilted", [](input::Case& c) { c.loading.tilt_difference_m = 0.3e-3; }},
    {"tilted the other way", [](input::Case& c) { c.loading.tilt_difference_m = -0.3e-3; }},
    {"tilted until it opens", tilt_until_it_opens, true},
    {"free top",
     [](input::Case& c) {
       c.loading.tilt_difference_m = 0.3e-3;
       c.loading.top_during_tilt = statics::TopEdge::free;
     }},
    {"on steel", stand_on_steel},
    {"graded",
     [](input::Case& c) {
       c.plate.coarsenings = 1;
       c.plate.fine_height_m = 0.02;
     }},
    {"iterative",
     [](input::Case& c) {
       c.loading.solver = statics::StaticSolver::iterative;
       c.loading.tilt_difference_m = 0.3e-3;
     },
     false, 1e-7},
    {"iterative, tilted until it opens",
     [](input::Case& c) {
       tilt_until_it_opens(c);
       c.loading.solver = statics::StaticSolver::iterative;
     },
     true, 1e-7},
    {"iterative on steel",
     [](input::Case& c) {
       stand_on_steel(c);
       c.loading.solver = statics::StaticSolver::iterative;
     },
     false, 1e-7},
};

constexpr double p_Pa = 5e6;

input::Case case_of(const Row& row) {
  auto c = test::coarse_case(EventKind::left);
  c.loading.mean_pressure_Pa = p_Pa;
  c.loading.shear_over_critical = 0.9;
  row.change(c);
  return c;
}

double sum(const std::vector<double>& traction_Pa, const std::vector<double>& tributary_m) {
  double force = 0;
  for (std::size_t k = 0; k < tributary_m.size(); ++k) force += traction_Pa[k] * tributary_m[k];
  return force;
}

/// The compressed state, before any shear.
statics::Equilibrium compressed(const input::Case& c, const InitialState& initial) {
  const auto base_material = input::base_material(c);
  std::optional<statics::ElasticBody> base;
  if (initial.base) base.emplace(statics::ElasticBody{*initial.base, base_material});
  const std::vector<double> mu_s(initial.tributary_m.size(), interface::static_coefficient(c.friction));
  return statics::Statics({initial.mesh, c.material}, base, c.loading, mu_s).tilted();
}

void expect_same_state(const statics::Equilibrium& a, const statics::Equilibrium& b, double tolerance) {
  EXPECT_EQ(a.contact, b.contact);
  EXPECT_NEAR(a.shear_m, b.shear_m, tolerance * std::abs(b.shear_m));
  for (std::size_t k = 0; k < b.contact.size(); ++k) {
    EXPECT_NEAR(a.tractions.p_s_Pa[k], b.tractions.p_s_Pa[k], tolerance * p_Pa) << k;
    EXPECT_NEAR(a.tractions.t_s_Pa[k], b.tractions.t_s_Pa[k], tolerance * p_Pa) << k;
  }
}

TEST(Loads, TheInterfaceBearsTheForcesThatAreAsked) {
  for (const auto& row : loads_of_rows) {
    SCOPED_TRACE(row.name);
    const auto c = case_of(row);
    const auto initial = make_initial_state(make_problem(c), go_on);
    ASSERT_TRUE(initial.loads);
    const auto& loads = *initial.loads;
    const auto before = compressed(c, initial);
    const double asked = p_Pa * c.plate.width_m;
    EXPECT_NEAR(sum(before.tractions.p_s_Pa, initial.tributary_m), asked, 1e-9 * asked);
    EXPECT_NEAR(loads.normal_force_N_per_m, asked, 1e-9 * asked);
    EXPECT_NEAR(loads.mean_pressure_Pa, p_Pa, 1e-9 * p_Pa);
    EXPECT_NEAR(loads.tilt_left_m - loads.tilt_right_m, c.loading.tilt_difference_m, 1e-15);
    EXPECT_GT(loads.tilt_left_m + loads.tilt_right_m, 0);
    std::size_t n_open = 0;
    for (std::size_t k = 0; k < before.contact.size(); ++k)
      n_open += before.contact[k] == Contact::open && initial.mesh.y_m[initial.mesh.interface_nodes[k]] == 0;
    EXPECT_EQ(n_open > 0, row.opens);

    const double sheared = 0.9 * loads.critical_shear_force_N_per_m;
    EXPECT_NEAR(sum(initial.subcritical.tractions.t_s_Pa, initial.tributary_m), sheared, 1e-9 * sheared);
    EXPECT_NEAR(loads.shear_force_N_per_m, sheared, 1e-9 * sheared);
    EXPECT_EQ(loads.shear_m, initial.subcritical.shear_m);
    EXPECT_EQ(loads.critical_shear_m, initial.critical_shear_m);
    EXPECT_LT(loads.shear_m, loads.critical_shear_m);
  }
}

TEST(Loads, OfOneStateMayBeGivenInEveryWay) {
  for (const auto& row : loads_of_rows) {
    SCOPED_TRACE(row.name);
    const auto c = case_of(row);
    const auto expected = make_initial_state(make_problem(c), go_on);
    const auto& loads = *expected.loads;
    auto forces = c;
    forces.loading.mean_pressure_Pa = forces.loading.shear_over_critical = {};
    forces.loading.normal_force_N_per_m = loads.normal_force_N_per_m;
    forces.loading.shear_force_N_per_m = loads.shear_force_N_per_m;
    expect_same_state(make_initial_state(make_problem(forces), go_on).subcritical, expected.subcritical,
                      row.tolerance);
    // By the displacements that were found.
    auto displaced = forces;
    displaced.loading.normal_force_N_per_m = {};
    displaced.loading.tilt_left_m = loads.tilt_left_m;
    displaced.loading.tilt_right_m = loads.tilt_right_m;
    expect_same_state(compressed(displaced, expected), compressed(c, expected), row.tolerance);
    const auto by_displacements = make_initial_state(make_problem(displaced), go_on);
    expect_same_state(by_displacements.subcritical, expected.subcritical, row.tolerance);
    EXPECT_NEAR(by_displacements.critical_shear_m, expected.critical_shear_m,
                row.tolerance * expected.critical_shear_m);
  }
}

TEST(Loads, SolversFindTheSame) {
  for (const auto& row : loads_of_rows) {
    if (row.tolerance < 1e-8) continue;  // those of a factorisation
    SCOPED_TRACE(row.name);
    auto c = case_of(row);
    const auto iterative = make_initial_state(make_problem(c), go_on);
    c.loading.solver = statics::StaticSolver::direct;
    expect_same_state(iterative.subcritical, make_initial_state(make_problem(c), go_on).subcritical,
                      row.tolerance);
  }
}

TEST(Loads, TheWholeCriticalOneIsThatOfTheMargin) {
  auto c = case_of(loads_of_rows[2]);
  c.loading.shear_over_critical = 1;
  const auto whole = make_initial_state(make_problem(c), go_on);
  EXPECT_NEAR(whole.subcritical.shear_m, whole.critical_shear_m, 1e-9 * whole.critical_shear_m);
  EXPECT_NEAR(whole.subcritical.peak_ratio, test::law(c).mu_s, 1e-9);
  // t/p at the peak grows with the shear up to it.
  c.loading.shear_over_critical = {};
  const auto below = make_initial_state(make_problem(c), go_on);
  EXPECT_EQ(below.critical_shear_m, whole.critical_shear_m);
  EXPECT_NEAR(below.subcritical.peak_ratio, (1 - c.loading.critical_margin) * test::law(c).mu_s, 1e-9);
  EXPECT_LT(below.subcritical.shear_m, whole.subcritical.shear_m);
}

TEST(Loads, LevelCompressionOfAColumnIsUniform) {
  // Without Poisson's effect the stress is uniform, p = u E/H.
  auto c = case_of(loads_of_rows[0]);
  c.material.poissons_ratio = 0;
  const auto initial = make_initial_state(make_problem(c), go_on);
  const double u_m = p_Pa * c.plate.height_m / c.material.youngs_modulus_Pa;
  EXPECT_NEAR(initial.loads->tilt_left_m, u_m, 1e-12 * u_m);
  EXPECT_NEAR(initial.loads->tilt_right_m, u_m, 1e-12 * u_m);
}

TEST(Loads, WhatNoShearGivesIsRefused) {
  const auto refusal_of = [](double shear_N_per_m, double tilt_difference_m) {
    auto c = case_of(loads_of_rows[1]);
    c.loading.shear_over_critical = {};
    c.loading.shear_force_N_per_m = shear_N_per_m;
    c.loading.tilt_difference_m = tilt_difference_m;
    return error_of([&] { make_initial_state(make_problem(c), go_on); });
  };
  EXPECT_THAT(refusal_of(1e7, 0),
              HasSubstr("loading.shear_force_N_per_m is 10000000 N/m, beyond the critical"));
  EXPECT_THAT(refusal_of(1, 0.3e-3), HasSubstr("before any shear"));
}

TEST(Loads, ARampBeginsUnderTheForce) {
  auto c = test::ramped_case();
  c.loading.mean_pressure_Pa = p_Pa;
  const auto initial = make_initial_state(make_problem(c), go_on);
  ASSERT_TRUE(initial.loads && initial.ramp);
  EXPECT_NEAR(initial.loads->mean_pressure_Pa, p_Pa, 1e-9 * p_Pa);
  EXPECT_EQ(initial.loads->shear_m, initial.subcritical.shear_m);
}

TEST(Loads, AreThoseWithoutARunAndOfNoOtherCase) {
  auto c = case_of(loads_of_rows[2]);
  const auto expected = *make_initial_state(make_problem(c), go_on).loads;
  const auto loaded = loaded_state(make_problem(c), check(make_problem(c)));
  ASSERT_TRUE(loaded);
  const auto* found = &loaded->loads;
  EXPECT_EQ(found->tilt_left_m, expected.tilt_left_m);
  EXPECT_EQ(found->shear_m, expected.shear_m);
  EXPECT_EQ(found->critical_shear_force_N_per_m, expected.critical_shear_force_N_per_m);
  const auto of_tilt = make_problem(test::coarse_case());
  EXPECT_FALSE(loaded_state(of_tilt, check(of_tilt)));
  EXPECT_FALSE(make_initial_state(make_problem(test::coarse_case()), go_on).loads);
}

TEST(Loads, EventsShareTheStateOfTheirForces) {
  const auto c = case_of(loads_of_rows[1]);
  auto right = c, sheared = c, pressed = c;
  right.event = EventKind::right;
  sheared.loading.shear_over_critical = 0.8;
  pressed.loading.mean_pressure_Pa = 4e6;
  EXPECT_EQ(make_problem(right).source.state_key, make_problem(c).source.state_key);
  EXPECT_NE(make_problem(sheared).source.state_key, make_problem(c).source.state_key);
  EXPECT_NE(make_problem(pressed).source.state_key, make_problem(c).source.state_key);
}

}  // namespace
}  // namespace slipfront::setup
