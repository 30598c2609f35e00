// SPDX-License-Identifier: BSD-3-Clause
#include "solid/operator.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference.hpp"

namespace slipfront::solid {
namespace {

using reference::flat;
using reference::Form;
using reference::random_field;
using reference::small_plate;

class OnPlate : public ::testing::TestWithParam<Form> {
 protected:
  mesh::Mesh mesh_ = small_plate(GetParam());
  Material material_;
  Operator op_ = make_operator(mesh_, material_);
  std::size_t n_ = static_cast<std::size_t>(mesh_.n_nodes());

  /// M apply(w), and the force of op.top on the loaded edge: K w over all nodes.
  Eigen::VectorXd force(const Field& w) const {
    Field a(n_);
    apply(op_, w, a);
    Eigen::VectorXd f = flat(a);
    for (std::size_t n = 0; n < n_; ++n) f.segment<2>(2 * n) *= op_.mass_kg[n];
    for_each_row_product(op_.far_edge_rows, w, [&](std::size_t r, double x, double y) {
      f(2 * op_.far_edge_rows.node[r]) += x;
      f(2 * op_.far_edge_rows.node[r] + 1) += y;
    });
    return f;
  }
};

INSTANTIATE_TEST_SUITE_P(Forms, OnPlate,
                         ::testing::Values(Form::none, Form::relief, Form::fillet, Form::graded,
                                           Form::shuffled, Form::distorted),
                         [](const auto& form) { return reference::name_of(form.param); });

TEST_P(OnPlate, EqualsTheAssembledStiffness) {
  for (const auto plane : {Plane::stress, Plane::strain}) {
    material_.plane = plane;
    op_ = make_operator(mesh_, material_);
    const auto K = reference::assembled_stiffness(mesh_, material_);
    const Field w = random_field(n_, 1);
    const Eigen::VectorXd expected = K * flat(w), f = force(w);
    // Rounding of nine blocks a node, against the largest force.
    EXPECT_LE(reference::max_abs(f - expected), 1e-14 * reference::max_abs(expected));
    const double energy = flat(w).dot(f);
    EXPECT_NEAR(strain_energy_J_per_m(op_, w), 0.5 * energy, 1e-13 * energy);
  }
}

TEST_P(OnPlate, LeavesTheLoadedEdgeAndOrphansAlone) {
  const Field w = random_field(n_, 2);
  Field a = random_field(n_, 3);
  apply(op_, w, a);
  const auto orphan = mesh::orphans(mesh_);
  int n_orphans = 0;
  for (std::size_t n = 0; n < n_; ++n) {
    if (!orphan[n] && !op_.is_far_edge[n]) continue;
    EXPECT_EQ(a.x[n], 0);
    EXPECT_EQ(a.y[n], 0);
    n_orphans += orphan[n];
  }
  EXPECT_EQ(n_orphans > 0, GetParam() == Form::fillet);
}

TEST_P(OnPlate, EachMovingNodeHasAStencilOrAGeneralRow) {
  std::vector<int> times(n_, 0);
  int n_stencils = 0;
  for (const auto& row : op_.whole.stencil)
    for (const auto& span : row.spans)
      for (int i = span.begin; i < span.end; ++i)
        ++times[op_.rows[row.row].first + i], n_stencils += row.n_own == 0;
  for (const auto n : op_.whole.general.node()) ++times[n];
  for (std::size_t n = 0; n < n_; ++n)
    EXPECT_EQ(times[n], op_.is_far_edge[n] || op_.mass_kg[n] == 0 ? 0 : 1) << "node " << n;
  // 39 inner columns and the sides above the plane; 20 rows below the loaded edge. The graded plate's lowest
  // block has 6 rows.
  EXPECT_EQ(n_stencils == 39 * 20 + 2 * 19, GetParam() == Form::none);
  if (GetParam() >= Form::shuffled) {
    EXPECT_EQ(n_stencils, 0);
  } else {
    EXPECT_GT(n_stencils, GetParam() == Form::graded ? 39 * 6 / 2 : 39 * 20 / 2);
  }
  EXPECT_EQ(op_.whole.general.size() > 0, GetParam() >= Form::graded || GetParam() == Form::fillet);
  if (GetParam() >= Form::shuffled) {
    EXPECT_EQ(op_.whole.general.n_shared_stiffnesses(), GetParam() == Form::shuffled ? 1 : 0);
  }
}

TEST_P(OnPlate, PartsAddUpToTheWhole) {
  // The lowest rows of cells and the rest, once divided at a row with edge stencils and once at any cells.
  const Field w = random_field(n_, 4);
  Field whole(n_);
  apply(op_, w, whole);
  const int edge_row = 4;
  for (const bool along_a_row : {true, false}) {
    std::vector<bool> first(mesh_.cells.size()), second(mesh_.cells.size());
    for (std::size_t c = 0; c < first.size(); ++c) {
      first[c] = along_a_row ? c / 40 < edge_row : c % 3 == 0;
      second[c] = !first[c];
    }
    Field sum(n_);
    int n_edges = 0;
    for (const auto& in_part : {first, second}) {
      const PartialStiffness part = make_partial_stiffness(mesh_, material_, op_, in_part, edge_row);
      for (const auto& row : part.stencil) n_edges += row.row == edge_row && row.squares != Squares::all;
      Field one(n_);
      add_partial_product(op_, part, w, one);
      add_partial_product(op_, part, w, sum);
      EXPECT_GT(reference::max_abs(flat(one)), 0.1 * reference::max_abs(flat(whole)));
    }
    EXPECT_EQ(n_edges >= 2, along_a_row && GetParam() < Form::shuffled);
    EXPECT_LE(reference::max_abs(flat(sum) - flat(whole)), 1e-13 * reference::max_abs(flat(whole)));
  }
}

TEST_P(OnPlate, GeneralForcesAreThoseOfTheCellsAlone) {
  // Of fewer rows, with other cells beside them in a vector, to the last bit.
  const auto& all = op_.whole.general;
  const std::vector<bool> every_cell(mesh_.cells.size(), true);
  const Field u = random_field(n_, 7), v = random_field(n_, 8);
  const auto products = [&](const GeneralRows& rows) {
    Field a(rows.size());
    auto space = rows.workspace();
    rows.multiply(u, 0.3, v, space, a.x.data(), a.y.data());
    return a;
  };
  const Field of_all = products(all);
  for (std::size_t begin = 0; begin < all.size(); begin += 1 + all.size() / 9) {
    const auto end = std::min(begin + 1 + all.size() / 3, all.size());
    const GeneralRows some(mesh_, material_,
                           {all.node().begin() + static_cast<std::ptrdiff_t>(begin),
                            all.node().begin() + static_cast<std::ptrdiff_t>(end)},
                           op_.mass_kg, every_cell);
    const Field a = products(some);
    for (std::size_t r = begin; r < end; ++r) {
      EXPECT_EQ(a.x[r - begin], of_all.x[r]);
      EXPECT_EQ(a.y[r - begin], of_all.y[r]);
    }
  }
}

TEST_P(OnPlate, EnergiesOfUniformStrainAndMotion) {
  const Eigen::Vector3d strain(1e-3, -2e-3, 0.5e-3);
  Field u(n_), v(n_);
  for (std::size_t n = 0; n < n_; ++n) {
    u.x[n] = strain(0) * mesh_.x_m[n] + strain(2) * mesh_.y_m[n];
    u.y[n] = strain(1) * mesh_.y_m[n];
    v.x[n] = 3;
    v.y[n] = -4;
  }
  const double area = reference::area_m2(mesh_);
  const double expected = 0.5 * strain.dot(reference::elasticity(material_) * strain) * area;
  EXPECT_NEAR(strain_energy_J_per_m(op_, u) / expected, 1, 1e-11);  // differences of large displacements
  const double kinetic = 0.5 * material_.density_kg_per_m3 * area * 25;
  EXPECT_NEAR(kinetic_energy_J_per_m(op_, v) / kinetic, 1, 1e-13);
}

}  // namespace
}  // namespace slipfront::solid
