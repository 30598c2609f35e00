// SPDX-License-Identifier: BSD-3-Clause
#include "statics/statics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "boundary/machine.hpp"
#include "equilibria.hpp"
#include "support/files.hpp"
#include "support/interruption.hpp"
#include "support/plate.hpp"

namespace slipfront::statics {
namespace {

using mesh::Corner;
using test::error_of;
using test::flat;
using test::max_abs;
using ::testing::HasSubstr;

mesh::Mesh paper_plate(double element_m, Corner corner = Corner::relief) {
  return test::make_plate(0.2, 0.1, element_m, corner);
}

/// Forces on all nodes that the displacement needs: K u.
Eigen::VectorXd force(const mesh::Mesh& mesh, const Equilibrium& e) {
  return test::assembled_stiffness(mesh, {}) * flat(e.u_m);
}

void expect_equilibrium(const mesh::Mesh& mesh, const Equilibrium& e) {
  const double tolerance_N = 1e-10 * pmma.youngs_modulus_Pa * max_abs(e.u_m);
  expect_body_in_equilibrium(mesh, pmma, e.u_m, e, mesh::tributary_lengths_m(mesh), -1, tolerance_N);
}

/// `start_x`: where a sticking node was put down.
void expect_complementarity(const mesh::Mesh& mesh, const Equilibrium& e, const std::vector<double>& start_x,
                            double ratio) {
  std::vector<double> moved_m, gap_m;
  for (const auto n : mesh.interface_nodes) {
    moved_m.push_back(e.u_m.x[n] - start_x[moved_m.size()]);
    gap_m.push_back(mesh.y_m[n] + e.u_m.y[n]);
  }
  expect_complementarity(e, moved_m, gap_m, ratio, mu_s, 1e-3);
}

std::vector<double> lower_x(const mesh::Mesh& mesh, const Equilibrium& e) {
  std::vector<double> x;
  for (const auto n : mesh.interface_nodes) x.push_back(e.u_m.x[n]);
  return x;
}

TEST(Statics, UniformCompressionIsExact) {
  const auto mesh = paper_plate(0.01, Corner::none);
  solid::Material m{.poissons_ratio = 0};
  const double pressed = 0.2e-3;
  const Statics statics(mesh, m, {.tilt_left_m = pressed, .tilt_right_m = pressed}, mu_s);
  const auto& e = statics.tilted();
  const double p = 2.6e9 * pressed / 0.1;
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_EQ(e.contact[k], Contact::stick);
    EXPECT_NEAR(e.tractions.p_s_Pa[k] / p, 1, 1e-12);
    EXPECT_NEAR(e.tractions.t_s_Pa[k] / p, 0, 1e-12);
  }
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    EXPECT_NEAR(e.u_m.x[n], 0, 1e-12 * pressed);
    EXPECT_NEAR(e.u_m.y[n], -pressed * mesh.y_m[n] / 0.1, 1e-12 * pressed);
  }
}

class PaperTilt : public ::testing::Test {
 protected:
  const mesh::Mesh mesh_ = paper_plate(4e-3);
  const Statics statics_{mesh_, {}, tilted, mu_s};
};

TEST_F(PaperTilt, StatesObeyContactAndEquilibrium) {
  expect_equilibrium(mesh_, statics_.tilted());
  expect_complementarity(mesh_, statics_.tilted(), std::vector<double>(mesh_.interface_nodes.size(), 0.0),
                         mu_s);
  const auto put_down = lower_x(mesh_, statics_.tilted());
  for (const double ratio : {0.9 * mu_s, 0.999 * mu_s, 1.001 * mu_s}) {
    SCOPED_TRACE(ratio);
    const auto e = statics_.shear_to(ratio / mu_s);
    expect_equilibrium(mesh_, e);
    expect_complementarity(mesh_, e, put_down, ratio);
    // All kinds of states are there to be checked; slip only at an edge of contact, near the critical shear.
    EXPECT_GT(std::ranges::count(e.contact, Contact::open), 0);
    EXPECT_GT(std::ranges::count(e.contact, Contact::stick), 0);
    EXPECT_EQ(std::ranges::count(e.contact, Contact::slip) > 0, ratio > 0.9 * mu_s);
    for (std::size_t k = 0; k < mesh_.interface_nodes.size(); ++k)
      EXPECT_FALSE(e.contact[k] == Contact::slip && e.is_inside(e.tractions.x_m[k]));
  }
}

TEST(Statics, ASlippedPlateIsTheOneBeforeUnderLessShear) {
  // All nodes have slipped as far as the edge has moved on: nothing else has changed.
  const auto mesh = paper_plate(4e-3);
  Statics statics(mesh, {}, tilted, mu_s);
  const double slip_m = 1e-5;
  const auto before = statics.shear_to(0.999);
  auto u_x_m = lower_x(mesh, statics.tilted());
  for (double& u : u_x_m) u += slip_m;
  statics.hold(statics.tilted().contact, u_x_m);
  const auto after = statics.shear_to(0.999);
  EXPECT_NEAR(after.shear_m, before.shear_m + slip_m, 1e-12 * before.shear_m);
  EXPECT_EQ(after.contact, before.contact);
  const double p_max = *std::ranges::max_element(before.tractions.p_s_Pa);
  for (std::size_t k = 0; k < u_x_m.size(); ++k) {
    EXPECT_NEAR(after.tractions.t_s_Pa[k], before.tractions.t_s_Pa[k], 1e-9 * p_max);
    EXPECT_NEAR(after.tractions.p_s_Pa[k], before.tractions.p_s_Pa[k], 1e-9 * p_max);
  }
  expect_complementarity(mesh, after, u_x_m, mu_s);
}

TEST(Statics, SlipOfPartOfAPlateLowersItsShearAndRaisesThatBeside) {
  const auto mesh = paper_plate(4e-3);
  Statics statics(mesh, {}, tilted, mu_s);
  const auto before = statics.shear_to(0.5);
  auto u_x_m = lower_x(mesh, statics.tilted());
  const auto slipped = [&](std::size_t k) { return mesh.x_m[mesh.interface_nodes[k]] < 0.1; };
  for (std::size_t k = 0; k < u_x_m.size(); ++k)
    if (slipped(k)) u_x_m[k] += 2e-6;
  statics.hold(statics.tilted().contact, u_x_m);
  const auto after = statics.shear_by(before.shear_m);
  expect_equilibrium(mesh, after);
  expect_complementarity(mesh, after, u_x_m, mu_s);
  for (std::size_t k = 2; k + 2 < u_x_m.size(); ++k) {
    if (before.contact[k] != Contact::stick || after.contact[k] != Contact::stick) continue;
    const double change = after.tractions.t_s_Pa[k] - before.tractions.t_s_Pa[k];
    EXPECT_EQ(change < 0, slipped(k)) << k;
  }
}

TEST(Statics, APushedPlateBearsAtItsInterfaceWhatThePusherGives) {
  const auto mesh = test::make_plate(0.2, 0.1, 4e-3, mesh::Corner::none);
  const boundary::Machine machine{.pusher = {8e-3, 24e-3}};
  const auto pushed = boundary::pushed_nodes(mesh, machine.pusher);
  ASSERT_EQ(pushed.size(), 5U);
  Loading loading;
  loading.tilt_left_m = loading.tilt_right_m = 1e-4;
  const solid::Material material;
  const Statics statics({mesh, material, machine}, {}, loading,
                        std::vector<double>(mesh.interface_nodes.size(), 0.5));
  const auto e = statics.shear_to(0.999);
  const auto rows = solid::assemble_rows(mesh, material, pushed);
  double pushed_N_per_m = 0, largest_N_per_m = 0;
  solid::for_each_row_product(rows, e.u_m, [&](std::size_t, double x, double) { pushed_N_per_m += x; });
  const auto top = solid::assemble_rows(mesh, material, std::vector<mesh::Node>(mesh.far_edge_nodes));
  solid::for_each_row_product(top, e.u_m, [&](std::size_t, double x, double y) {
    largest_N_per_m = std::max(largest_N_per_m, std::abs(y));
    EXPECT_NEAR(x, 0, 1e-6 * pushed_N_per_m);  // rolls
  });
  EXPECT_GT(largest_N_per_m, 0);
  const auto force = contact_force(e, mesh::tributary_lengths_m(mesh));
  EXPECT_NEAR(force.shear_N_per_m, pushed_N_per_m, 1e-9 * pushed_N_per_m);
  for (const auto n : pushed)
    EXPECT_NEAR(e.u_m.x[n] - statics.tilted().u_m.x[n], e.shear_m, 1e-12 * e.shear_m);
  for (const auto n : mesh.far_edge_nodes) EXPECT_DOUBLE_EQ(e.u_m.y[n], -1e-4);
  EXPECT_LT(e.peak_x_m, 0.05);  // slip begins near the pusher
}

TEST_F(PaperTilt, MotionUnderShearIsTheDerivativeOfTheDisplacement) {
  expect_slope_of_displacement(statics_, 0.999, 1e-11);
  const auto e = statics_.shear_to(0.999);
  for (const auto n : mesh_.far_edge_nodes) {
    EXPECT_EQ(e.u_per_shear.x[n], 1);
    EXPECT_EQ(e.u_per_shear.y[n], 0);
  }
}

TEST(Statics, CriticalShearOfACoarsePlateByDenseSolution) {
  // The whole plate without condensation: every unknown of every node, with the contact states found.
  for (const auto corner : {Corner::none, Corner::relief}) {
    SCOPED_TRACE(test::name_of(corner));
    auto plate = test::plate_of(0.2, 0.1, 0.01, corner);
    plate.relief_length_m = 0.01;
    plate.relief_height_m = 2e-6;  // so shallow that it closes
    plate.relief_depth_m = 0.01;
    const auto mesh = mesh::make_plate(plate);
    const Statics statics(mesh, {}, tilted, mu_s);
    const auto e = statics.shear_to(0.999);
    const auto put_down = lower_x(mesh, statics.tilted());

    const Eigen::MatrixXd K = test::assembled_stiffness(mesh, {});
    Eigen::MatrixXd A = K;  // A u = b0 + shear b1
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(K.rows(), 2);
    const auto prescribe = [&](Eigen::Index d, double u0, double u1) {
      A.row(d).setZero();
      A(d, d) = K(d, d);
      b(d, 0) = K(d, d) * u0;
      b(d, 1) = K(d, d) * u1;
    };
    for (const auto n : mesh.far_edge_nodes) {
      prescribe(2 * n, 0, 1);
      prescribe(2 * n + 1, -(0.37e-3 + (0.037e-3 - 0.37e-3) * mesh.x_m[n] / 0.2), 0);
    }
    for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
      const auto n = mesh.interface_nodes[k];
      if (e.contact[k] == Contact::open) continue;
      if (e.contact[k] == Contact::stick) prescribe(2 * n, put_down[k], 0);
      if (e.contact[k] == Contact::slip)
        A.row(2 * n) += (e.tractions.t_s_Pa[k] > 0 ? 1 : -1) * mu_s * K.row(2 * n + 1);
      prescribe(2 * n + 1, -mesh.y_m[n], 0);
    }
    const Eigen::MatrixXd u = A.partialPivLu().solve(b);
    const Eigen::MatrixXd f = K * u;
    double shear = 1;
    for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
      const auto n = mesh.interface_nodes[k];
      const double x = mesh.x_m[n], r = 0.999 * mu_s;
      if (!e.is_inside(x)) continue;
      // -(f_x0 + s f_x1) = r (f_y0 + s f_y1)
      const double rise = -f(2 * n, 1) - r * f(2 * n + 1, 1);
      if (rise > 0) shear = std::min(shear, (r * f(2 * n + 1, 0) + f(2 * n, 0)) / rise);
    }
    EXPECT_NEAR(e.shear_m / shear, 1, 1e-10);
    EXPECT_LE(max_abs(flat(e.u_m) - u.col(0) - shear * u.col(1)), 1e-10 * shear);
    EXPECT_LE(max_abs(flat(e.u_per_shear) - u.col(1)), 1e-10);
    expect_complementarity(mesh, e, put_down, 0.999 * mu_s);
    EXPECT_GT(std::ranges::count(e.contact, Contact::open), 0);
  }
}

TEST(Statics, FreeLoadedEdgeCarriesNoHorizontalForceDuringTheTilt) {
  const auto mesh = paper_plate(4e-3);
  const Statics held(mesh, {}, {}, mu_s);
  const Statics free(mesh, {}, {.top_during_tilt = TopEdge::free}, mu_s);
  const Eigen::VectorXd f_held = force(mesh, held.tilted()), f_free = force(mesh, free.tilted());
  double max_held = 0;
  for (const auto n : mesh.far_edge_nodes) {
    max_held = std::max(max_held, std::abs(f_held(2 * n)));
    EXPECT_NEAR(f_free(2 * n), 0, 1e-10 * max_abs(f_free)) << n;
    EXPECT_EQ(held.tilted().u_m.x[n], 0);
  }
  EXPECT_GT(max_held, 1e-3 * max_abs(f_held));
  expect_equilibrium(mesh, free.tilted());
  expect_complementarity(mesh, free.tilted(), std::vector<double>(mesh.interface_nodes.size(), 0.0), mu_s);

  // The shear starts from where the edge stands.
  const auto put_down = lower_x(mesh, free.tilted());
  const auto e = free.shear_to(0.999);
  for (const auto n : mesh.far_edge_nodes) EXPECT_NEAR(e.u_m.x[n], free.tilted().u_m.x[n] + e.shear_m, 1e-15);
  expect_equilibrium(mesh, e);
  expect_complementarity(mesh, e, put_down, 0.999 * mu_s);
}

TEST(Statics, CanBeInterruptedBetweenSolutions) {
  const auto mesh = paper_plate(4e-3);
  int asked = 0;
  const auto solve_statics = [&](int last) {
    asked = 0;
    Statics(mesh, {}, tilted, mu_s, "friction.mu_s", [&] { return asked++ < last; }).shear_to(1);
  };
  solve_statics(1000);
  const int all = asked;
  EXPECT_GT(all, 2);
  for (int last = 0; last < all; ++last) {
    EXPECT_THROW(solve_statics(last), Interrupted) << last;
    EXPECT_EQ(asked, last + 1);
  }
}

TEST(Statics, IsInterruptedWithinASolution) {
  const auto mesh = paper_plate(4e-3);
  for (const auto solver : {StaticSolver::direct, StaticSolver::iterative}) {
    const test::InterruptionAfter after(5);
    EXPECT_THROW(Statics(mesh, {}, {.solver = solver}, mu_s), Interrupted);
    EXPECT_EQ(after.asked(), 6);
  }
}

TEST(Statics, TellsTheUserWhatCannotBe) {
  const auto mesh = paper_plate(0.01, Corner::none);
  EXPECT_THAT(error_of([&] { Statics(mesh, {}, {.tilt_left_m = -1e-4, .tilt_right_m = -1e-4}, mu_s); }),
              HasSubstr("leaves the plate without contact; increase loading.tilt_left_m"));
  const Statics statics(mesh, {}, tilted, mu_s);
  EXPECT_THAT(error_of([&] { statics.shear_to(0.01 / mu_s); }), HasSubstr("the tilt alone brings t/p"));
  const Statics nothing_inside(mesh, {}, {.edge_margin_m = 0.15}, mu_s);
  EXPECT_THAT(error_of([&] { nothing_inside.shear_to(1); }), HasSubstr("no shear brings t/p inside"));
}

class FrictionAlong : public ::testing::Test {
 protected:
  /// mu_s as a function of x.
  Statics statics(const std::function<double(double)>& mu) {
    mu_s_.clear();
    for (const auto n : mesh_.interface_nodes) mu_s_.push_back(mu(mesh_.x_m[n]));
    return {{mesh_, pmma}, std::nullopt, tilted, mu_s_};
  }
  /// t/(mu_s p) of a node in contact.
  double share(const Equilibrium& e, std::size_t k) const {
    return e.tractions.t_s_Pa[k] / e.tractions.p_s_Pa[k] / mu_s_[k];
  }
  bool is_inside(const Equilibrium& e, std::size_t k) const {
    return e.contact[k] != Contact::open && e.is_inside(e.tractions.x_m[k]);
  }

  mesh::Mesh mesh_ = paper_plate(4e-3);
  std::vector<double> mu_s_;
};

TEST_F(FrictionAlong, AWeakPatchIsWhereSlipBegins) {
  const double strong = statics([](double) { return mu_s; }).shear_to(1).shear_m;
  const double weak = statics([](double) { return 0.5 * mu_s; }).shear_to(1).shear_m;
  for (const double from_m : {0.04, 0.15}) {
    const auto in_patch = [from_m](double x) { return x >= from_m && x <= from_m + 0.02; };
    const auto patched = statics([&](double x) { return (in_patch(x) ? 0.5 : 1) * mu_s; });
    const auto e = patched.shear_to(1);
    EXPECT_TRUE(in_patch(e.peak_x_m)) << e.peak_x_m;
    EXPECT_NEAR(e.peak_ratio, 0.5 * mu_s, 1e-11);
    EXPECT_LT(e.shear_m, strong);
    EXPECT_GE(e.shear_m, weak * (1 - 1e-12));
    // The first one of all, and only just.
    const auto before = patched.shear_by(0.99 * e.shear_m);
    for (std::size_t k = 0; k < mu_s_.size(); ++k) {
      if (!is_inside(e, k)) continue;
      EXPECT_LE(share(e, k), 1 + 1e-11) << k;
      EXPECT_EQ(e.contact[k], Contact::stick);
      EXPECT_LT(share(before, k), 1) << k;
    }
  }
}

TEST_F(FrictionAlong, ShearEndsWhereTheNodeNearestToSlipHasTheShareAskedFor) {
  for (const double slope_per_m : {0.0, 3.0}) {
    const auto with = statics([&](double x) { return mu_s * (slope_per_m > 0 ? 0.7 + slope_per_m * x : 1); });
    double shear_m = 0;
    for (const double at : {0.62, 0.999, 1.001}) {
      const auto e = with.shear_to(at);
      std::size_t peak = 0;
      double most = 0;
      for (std::size_t k = 0; k < mu_s_.size(); ++k)
        if (is_inside(e, k) && share(e, k) > most) most = share(e, k), peak = k;
      EXPECT_NEAR(most, at, 7e-12);
      EXPECT_EQ(e.peak_x_m, e.tractions.x_m[peak]);
      EXPECT_EQ(e.peak_ratio, e.tractions.t_s_Pa[peak] / e.tractions.p_s_Pa[peak]);
      for (std::size_t k = 0; k < mu_s_.size(); ++k) {
        if (e.contact[k] != Contact::slip) continue;
        EXPECT_NEAR(std::abs(e.tractions.t_s_Pa[k]), mu_s_[k] * e.tractions.p_s_Pa[k],
                    1e-12 * largest_pressure(e));
      }
      EXPECT_EQ(std::ranges::count(e.contact, Contact::slip) > 0, at > 0.9);
      EXPECT_GT(e.shear_m, shear_m);
      shear_m = e.shear_m;

      const auto same = with.shear_by(shear_m);
      expect_near(same.u_m, e.u_m, 1e-11 * shear_m);
      EXPECT_EQ(same.contact, e.contact);
    }
  }
}

TEST_F(FrictionAlong, MessagesNameSharesOfMuS) {
  const auto varying = statics([](double x) { return mu_s * (0.7 + 3 * x); });
  EXPECT_THAT(error_of([&] { varying.shear_to(0.01); }), HasSubstr(", not below 0.01 mu_s; raise friction"));
  const auto uniform = statics([](double) { return mu_s; });
  EXPECT_THAT(error_of([&] { uniform.shear_to(0.01); }), HasSubstr(", not below 0.013; raise friction.mu_s"));
}

}  // namespace
}  // namespace slipfront::statics
