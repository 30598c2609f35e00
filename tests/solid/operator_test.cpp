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

class OnPlainPlate : public OnPlate {};

INSTANTIATE_TEST_SUITE_P(Corners, OnPlainPlate, ::testing::Values(Form::none, Form::relief, Form::fillet),
                         [](const auto& form) { return reference::name_of(form.param); });

TEST_P(OnPlate, EqualsTheAssembledStiffness) {
  for (const auto plane : {Plane::stress, Plane::strain}) {
    material_.plane = plane;
    op_ = make_operator(mesh_, material_);
    const auto K = reference::assembled_stiffness(mesh_, material_);
    const Field w = random_field(n_, 1);
    // Rounding of nine blocks a node, against the largest force.
    const Eigen::VectorXd expected = K * flat(w);
    EXPECT_LE(reference::max_abs(force(w) - expected), 1e-14 * reference::max_abs(expected));
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

TEST_P(OnPlate, EachMovingNodeHasAStencilOrBlockRows) {
  std::vector<int> times(n_, 0);
  int n_stencils = 0;
  for (const auto& row : op_.whole.stencil)
    for (const auto& span : row.spans)
      for (int i = span.begin; i < span.end; ++i) ++times[op_.rows[row.row].first + i], ++n_stencils;
  for (const auto n : op_.whole.irregular.node) ++times[n];
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
  EXPECT_EQ(op_.whole.general.size() > 0, GetParam() >= Form::graded);
  if (GetParam() >= Form::shuffled) {
    EXPECT_EQ(op_.whole.general.n_shared_stiffnesses(), GetParam() == Form::shuffled ? 1 : 0);
  }
}

TEST_P(OnPlainPlate, StencilsEqualTheAssembledBlockRows) {
  std::vector<mesh::Node> with_stencil;
  std::vector<Squares> squares;
  for (const auto& row : op_.whole.stencil)
    for (const auto& span : row.spans)
      for (int i = span.begin; i < span.end; ++i) {
        with_stencil.push_back(op_.grid.node(i, row.row));
        squares.push_back(row.squares);
      }
  const BlockRows rows = assemble_rows(mesh_, material_, with_stencil, op_.mass_kg);
  const int stride = op_.grid.stride();
  const auto& s = op_.interior;
  const auto& e = op_.edge;
  const double tolerance = 1e-13 * s.centre;  // four elements' rounding
  const auto expect_block = [&](const std::array<double, 4>& block, std::array<double, 4> expected) {
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(block[k], expected[k], tolerance);
  };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto n = rows.node[r];
    const bool lower = n < stride;
    const bool side = squares[r] == Squares::right || squares[r] == Squares::left;
    ASSERT_EQ(rows.first[r + 1] - rows.first[r], lower || side ? 6 : 9);
    for (auto k = rows.first[r]; k < rows.first[r + 1]; ++k) {
      const int di = rows.neighbour[k] % stride - n % stride, dj = rows.neighbour[k] / stride - n / stride;
      const auto& block = rows.block[k];
      if (lower) {
        if (di == 0 && dj == 0) expect_block(block, {e.centre_x, 0, 0, e.centre_y});
        if (di == 0 && dj == 1) expect_block(block, {e.up_x, 0, 0, e.up_y});
        if (di != 0 && dj == 0) expect_block(block, {e.side_x, di * e.shear, -di * e.shear, e.side_y});
        if (di != 0 && dj == 1) expect_block(block, {e.corner_x, di * e.twist, di * e.twist, e.corner_y});
      } else if (side) {
        EXPECT_NE(di, squares[r] == Squares::right ? -1 : 1);
        if (di == 0 && dj == 0) expect_block(block, {e.centre_y, 0, 0, e.centre_x});
        if (di != 0 && dj == 0) expect_block(block, {e.up_y, 0, 0, e.up_x});
        const int in = squares[r] == Squares::right ? 1 : -1;
        const double shear = in * dj * e.shear, twist = in * dj * e.twist;
        if (di == 0 && dj != 0) expect_block(block, {e.side_y, -shear, shear, e.side_x});
        if (di != 0 && dj != 0) expect_block(block, {e.corner_y, twist, twist, e.corner_x});
      } else {
        if (di == 0 && dj == 0) expect_block(block, {s.centre, 0, 0, s.centre});
        if (di != 0 && dj == 0) expect_block(block, {s.along, 0, 0, s.across});
        if (di == 0 && dj != 0) expect_block(block, {s.across, 0, 0, s.along});
        if (di != 0 && dj != 0)
          expect_block(block, {s.corner, di * dj * s.twist, di * dj * s.twist, s.corner});
      }
    }
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

TEST_P(OnPlate, IsSymmetricAndPositive) {
  const Field u = random_field(n_, 5), v = random_field(n_, 6);
  const double forth = flat(u).dot(force(v)), back = flat(v).dot(force(u)), energy = flat(u).dot(force(u));
  EXPECT_GT(energy, 0);
  EXPECT_NEAR(forth, back, 1e-13 * energy);
  EXPECT_NEAR(strain_energy_J_per_m(op_, u), 0.5 * energy, 1e-13 * energy);
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
  // The whole edge's force: the side edges' halves at its two corners cancel.
  const double shear_Pa = (reference::elasticity(material_) * strain)(2);
  EXPECT_NEAR(top_force_x_N_per_m(op_, u), shear_Pa * 0.04, 1e-12 * material_.youngs_modulus_Pa * 0.04);
  const double kinetic = 0.5 * material_.density_kg_per_m3 * area * 25;
  EXPECT_NEAR(kinetic_energy_J_per_m(op_, v) / kinetic, 1, 1e-13);
}

}  // namespace
}  // namespace slipfront::solid
