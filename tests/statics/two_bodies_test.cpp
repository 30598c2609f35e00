// SPDX-License-Identifier: BSD-3-Clause
// Static equilibria of the plate on an elastic base.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "equilibria.hpp"
#include "statics/condensed_interface.hpp"

namespace slipfront::statics {
namespace {

using mesh::Corner;
using test::max_abs;

TopDisplacement tilted_and_sheared(const mesh::Mesh& mesh) {
  TopDisplacement top;
  for (const auto n : mesh.far_edge_nodes) {
    top.u_x_m.push_back(1e-4);
    top.u_y_m.push_back(-2e-4 + 5e-3 * mesh.x_m[n]);
  }
  return top;
}

Support bonded(const mesh::Mesh& mesh) {
  const std::size_t n = mesh.interface_nodes.size();
  return {std::vector<Contact>(n, Contact::stick), std::vector<double>(n, 0.0), std::vector<double>(n, 0.0),
          uniform_mu_s(mesh)};
}

TEST(TwoBodies, BondedAreOneOfTheirHeight) {
  const double height_m = 0.014, base_height_m = 0.01, h = 1e-3;
  const auto whole = test::make_plate(0.02, height_m + base_height_m, h, Corner::none);
  const auto plate = test::make_plate(0.02, height_m, h, Corner::none);
  const auto base = test::make_plate(0.02, base_height_m, h, Corner::none);
  const auto displacement = [](PlateSolver& solver, const mesh::Mesh& mesh, double shear) {
    const auto load_case =
        solver.load_case(TopConstraint::both, tilted_and_sheared(mesh), EdgeMotion::along_x, nullptr, 0);
    load_case->solve(bonded(mesh), 0);
    return load_case->displacement(shear);
  };
  for (const double shear : {0.0, 1e-4}) {
    const auto one =
        displacement(*make_plate_solver({whole, pmma}, StaticSolver::direct), whole, shear).above;
    const auto two = displacement(
        *make_plate_solver({plate, pmma}, StaticSolver::automatic, ElasticBody{base, pmma}), plate, shear);
    const double tolerance = 1e-9 * max_abs(one);
    const int rows = base.grid.rows;
    for (int j = 0; j <= whole.grid.rows; ++j)
      for (int i = 0; i <= whole.grid.columns; ++i) {
        const auto n = whole.grid.node(i, j);
        if (j >= rows) {
          const auto above = plate.grid.node(i, j - rows);
          EXPECT_NEAR(two.above.x[above], one.x[n], tolerance);
          EXPECT_NEAR(two.above.y[above], one.y[n], tolerance);
        }
        if (j <= rows) {
          const auto below = base.grid.node(i, rows - j);
          EXPECT_NEAR(two.below.x[below], one.x[n], tolerance);
          EXPECT_NEAR(two.below.y[below], -one.y[n], tolerance);
        }
      }
  }
}

struct Pair {
  std::string name;
  mesh::Mesh plate, base;
  solid::Material base_material;
  TopEdge top = TopEdge::held;
  /// Shares of mu_s to shear to: 1 is reached only where slip does not spread from an edge before.
  std::vector<double> shares = {0.7, 0.999, 1.001};
};

mesh::Mesh graded_base() {
  return mesh::make_plate({.width_m = 0.2,
                           .height_m = 0.096,
                           .element_size_m = 4e-3,
                           .coarsenings = 1,
                           .fine_height_m = 16e-3,
                           .corner = Corner::none});
}

std::vector<Pair> pairs() {
  const auto plate = test::make_plate(0.2, 0.1, 4e-3, Corner::relief);
  const auto square = test::make_plate(0.2, 0.06, 4e-3, Corner::none);
  return {{"equal", plate, plate, pmma},
          {"gel", plate, square, gel, TopEdge::held, {0.5, 0.7}},
          {"graded", plate, graded_base(), pmma},
          {"free_top", plate, square, pmma, TopEdge::free}};
}

class OnABase : public ::testing::TestWithParam<Pair> {
 protected:
  const mesh::Mesh& plate_ = GetParam().plate;
  const mesh::Mesh& base_ = GetParam().base;
  Statics statics_{{plate_, pmma},
                   ElasticBody{base_, GetParam().base_material},
                   {.top_during_tilt = GetParam().top},
                   uniform_mu_s(plate_)};

  std::vector<double> relative_x_m(const Equilibrium& e) const {
    std::vector<double> x;
    for (std::size_t k = 0; k < e.contact.size(); ++k)
      x.push_back(e.u_m.x[plate_.interface_nodes[k]] - e.below_u_m.x[base_.interface_nodes[k]]);
    return x;
  }

  void expect_equilibrium(const Equilibrium& e) const {
    const auto& of_base = GetParam().base_material;
    const double tolerance_N = 1e-10 * std::max(pmma.youngs_modulus_Pa * max_abs(e.u_m),
                                                of_base.youngs_modulus_Pa * max_abs(e.below_u_m));
    const auto tributary_m = mesh::tributary_lengths_m(plate_);
    expect_body_in_equilibrium(plate_, pmma, e.u_m, e, tributary_m, -1, tolerance_N);
    expect_body_in_equilibrium(base_, of_base, e.below_u_m, e, tributary_m, 1, tolerance_N);
    for (const auto n : base_.far_edge_nodes) {
      EXPECT_EQ(e.below_u_m.x[n], 0);
      EXPECT_EQ(e.below_u_m.y[n], 0);
    }
  }

  /// As on the rigid plane, with the relative motion.
  void expect_complementarity(const Equilibrium& e, const std::vector<double>& start_x_m) const {
    auto moved_m = relative_x_m(e);
    std::vector<double> gap_m;
    for (std::size_t k = 0; k < e.contact.size(); ++k) {
      const auto a = plate_.interface_nodes[k], b = base_.interface_nodes[k];
      moved_m[k] -= start_x_m[k];
      gap_m.push_back(plate_.y_m[a] + base_.y_m[b] + e.u_m.y[a] + e.below_u_m.y[b]);
    }
    statics::expect_complementarity(e, moved_m, gap_m, 1.001 * mu_s, 1.001 * mu_s, 1e-2);
  }
};
INSTANTIATE_TEST_SUITE_P(Pairs, OnABase, ::testing::ValuesIn(pairs()),
                         [](const auto& pair) { return pair.param.name; });

TEST_P(OnABase, StatesObeyContactAndEquilibriumOfBothBodies) {
  const auto& tilted = statics_.tilted();
  const auto put_down_m = relative_x_m(tilted);
  expect_equilibrium(tilted);
  expect_complementarity(tilted, std::vector<double>(put_down_m.size(), 0.0));
  for (const double share : GetParam().shares) {
    SCOPED_TRACE(share);
    const auto e = statics_.shear_to(share);
    EXPECT_NEAR(e.peak_ratio, share * mu_s, 1e-10);
    expect_equilibrium(e);
    expect_complementarity(e, put_down_m);
    EXPECT_GT(std::ranges::count(e.contact, Contact::stick), 0);
    EXPECT_GT(std::ranges::count(e.contact, Contact::open), 0);
  }
}

TEST_P(OnABase, MultigridFindsTheSameStates) {
  if (!base_.coarser.empty()) return;  // solved directly whatever is wanted
  const Statics iterative({plate_, pmma}, ElasticBody{base_, GetParam().base_material},
                          {.top_during_tilt = GetParam().top, .solver = StaticSolver::iterative},
                          uniform_mu_s(plate_));
  ASSERT_TRUE(iterative.solver().iterates());
  expect_same(statics_.tilted(), iterative.tilted());
  for (const double share : GetParam().shares) {
    SCOPED_TRACE(share);
    expect_same(statics_.shear_to(share), iterative.shear_to(share));
  }
}

TEST_P(OnABase, MotionUnderShearIsTheDerivativeOfTheDisplacement) {
  expect_slope_of_displacement(statics_, GetParam().shares[1], 1e-10);
}

TEST(TwoBodies, OnABaseEverStifferComeToTheRigidPlane) {
  const auto mesh = test::make_plate(0.2, 0.1, 4e-3, Corner::relief);
  const auto base = test::make_plate(0.2, 0.1, 4e-3, Corner::none);
  const auto rigid = Statics(mesh, pmma, {}, mu_s).shear_to(0.999);
  double last = 0;
  for (const double factor : {1e4, 1e6, 1e8}) {
    auto material = pmma;
    material.youngs_modulus_Pa *= factor;
    const auto e = Statics({mesh, pmma}, ElasticBody{base, material}, {}, uniform_mu_s(mesh)).shear_to(0.999);
    EXPECT_EQ(e.contact, rigid.contact);
    EXPECT_EQ(e.peak_x_m, rigid.peak_x_m);
    const double error = test::max_difference(e.u_m, rigid.u_m) / max_abs(rigid.u_m);
    EXPECT_LT(error, 10 / factor);
    // The base's compliance is the plate's over the factor, and so is its part in the displacement.
    if (last > 0) {
      EXPECT_NEAR(last / error, 100, 1) << factor;
    }
    last = error;
  }
}

TEST(TwoBodies, NeedABaseThatIsHeldAndFacesThePlate) {
  const auto mesh = test::tiny_plate(Corner::none);
  const auto free = mesh::make_plate({.width_m = 0.02,
                                      .height_m = 0.01,
                                      .element_size_m = 1e-3,
                                      .corner = Corner::none,
                                      .top = mesh::Top::free});
  const auto shorter = test::make_plate(0.019, 0.01, 1e-3, Corner::none);
  const auto solve = [&](const mesh::Mesh& base) {
    make_plate_solver({mesh, pmma}, StaticSolver::direct, ElasticBody{base, pmma});
  };
  EXPECT_DEATH(solve(free), "nothing holds");
  EXPECT_DEATH(solve(shorter), "different nodes");
}

}  // namespace
}  // namespace slipfront::statics
