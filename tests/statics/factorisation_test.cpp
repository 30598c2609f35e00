// SPDX-License-Identifier: BSD-3-Clause
#include "statics/factorisation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "statics/dissection.hpp"
#include "support/matrices.hpp"

namespace slipfront::statics {
namespace {

using mesh::Corner;
using test::flat;
using test::max_abs;

class FactorisedPlate : public ::testing::TestWithParam<Corner> {
 protected:
  const mesh::Mesh mesh_ = test::tiny_plate(GetParam());
  solid::Material material_;
  test::Sparse K_ = test::assembled_stiffness(mesh_, material_);
  Eigen::Index n_interface_ = static_cast<Eigen::Index>(2 * mesh_.interface_nodes.size());

  std::vector<Eigen::Index> interface_unknowns() const {
    std::vector<Eigen::Index> d;
    for (const auto n : mesh_.interface_nodes) d.insert(d.end(), {2 * n, 2 * n + 1});
    return d;
  }

  /// Unknowns that are neither prescribed nor of the interface.
  std::vector<Eigen::Index> inner_unknowns(TopConstraint top) const {
    const auto orphan = mesh::orphans(mesh_);
    std::vector<Eigen::Index> d;
    for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) {
      if (orphan[n] || std::ranges::count(mesh_.interface_nodes, n) > 0) continue;
      const bool is_loaded = std::ranges::count(mesh_.far_edge_nodes, n) > 0;
      if (!is_loaded || top == TopConstraint::vertical) d.push_back(2 * n);
      if (!is_loaded) d.push_back(2 * n + 1);
    }
    return d;
  }
};

INSTANTIATE_TEST_SUITE_P(Corners, FactorisedPlate, ::testing::Values(Corner::relief, Corner::fillet),
                         [](const auto& corner) { return test::name_of(corner.param); });

TEST_P(FactorisedPlate, DissectionIsAPermutationWithTheInterfaceLast) {
  const auto order = dissect(mesh_, mesh_.interface_nodes).nodes;
  const auto orphan = mesh::orphans(mesh_);
  std::vector<int> times(mesh_.n_nodes(), 0);
  for (const auto n : order) ++times[n];
  for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) EXPECT_EQ(times[n], orphan[n] ? 0 : 1) << n;
  const std::vector<mesh::Node> tail(order.end() - static_cast<std::ptrdiff_t>(mesh_.interface_nodes.size()),
                                     order.end());
  EXPECT_EQ(tail, mesh_.interface_nodes);
  EXPECT_EQ(order, dissect(mesh_, mesh_.interface_nodes).nodes);
}

TEST_P(FactorisedPlate, CondensedStiffnessIsTheSchurComplement) {
  for (const auto top : {TopConstraint::both, TopConstraint::vertical}) {
    const Factorisation f({mesh_, material_}, top);
    const auto i = interface_unknowns(), m = inner_unknowns(top);
    EXPECT_EQ(f.n_unknowns(), static_cast<std::int64_t>(i.size() + m.size()));
    const Eigen::MatrixXd K = K_;
    const Eigen::MatrixXd K_im = K(i, m), K_mm = K(m, m);
    const Eigen::MatrixXd S = K(i, i) - K_im * K_mm.ldlt().solve(K_im.transpose());
    // Two direct solutions of a system whose condition number is of the order of 1e3.
    EXPECT_LE(max_abs(f.condensed_stiffness() - S), 1e-12 * max_abs(S));
    EXPECT_EQ(max_abs(f.condensed_stiffness() - f.condensed_stiffness().transpose()), 0);
  }
}

TEST_P(FactorisedPlate, DisplacementIsInEquilibrium) {
  Random random(7);
  TopDisplacement edge;
  for (std::size_t k = 0; k < mesh_.far_edge_nodes.size(); ++k) {
    edge.u_x_m.push_back(random());
    edge.u_y_m.push_back(random());
  }
  const Eigen::VectorXd u_i = Eigen::VectorXd::NullaryExpr(n_interface_, [&] { return random(); });
  for (const auto top : {TopConstraint::both, TopConstraint::vertical}) {
    const Factorisation f({mesh_, material_}, top);
    const auto load = f.load(edge);
    const solid::Field u = f.displacement(load, u_i);
    const Eigen::VectorXd force = K_ * flat(u);
    // Rounding of a direct solution, against the stiffness times the displacement.
    const double tolerance = 1e-11 * material_.youngs_modulus_Pa * max_abs(flat(u));
    for (const auto d : inner_unknowns(top)) EXPECT_NEAR(force(d), 0, tolerance);
    const auto i = interface_unknowns();
    const Eigen::VectorXd expected = f.condensed_stiffness() * u_i - load.g_N;
    for (Eigen::Index k = 0; k < n_interface_; ++k) {
      EXPECT_NEAR(flat(u)(i[k]), u_i(k), 1e-11);
      EXPECT_NEAR(force(i[k]), expected(k), tolerance);
    }
    for (std::size_t k = 0; k < mesh_.far_edge_nodes.size(); ++k) {
      EXPECT_EQ(u.y[mesh_.far_edge_nodes[k]], load.top.u_y_m[k]);
      if (top == TopConstraint::both) {
        EXPECT_EQ(u.x[mesh_.far_edge_nodes[k]], load.top.u_x_m[k]);
      }
    }
  }
}

TEST(Factorisation, OfSeveralThreadsAtOnceIsThatOfOne) {
  const auto mesh = test::make_plate(0.2, 0.1, 2e-3, Corner::relief);
  const auto solved = [&] {
    const Factorisation f({mesh, {}}, TopConstraint::both);
    const std::vector<double> sheared(mesh.far_edge_nodes.size(), 1e-4);
    const Eigen::VectorXd force = f.load({sheared, sheared}).g_N;
    return std::pair<Eigen::MatrixXd, Eigen::VectorXd>(f.condensed_stiffness(), force);
  };
  const auto alone = solved();
  std::atomic<int> differing = 0;
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([&] {
      for (int k = 0; k < 2; ++k)
        if (solved() != alone) ++differing;
    });
  threads.clear();  // waits for them
  EXPECT_EQ(differing, 0);
}

}  // namespace
}  // namespace slipfront::statics
