// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "boundary/boundary.hpp"
#include "statics/equilibria.hpp"

namespace slipfront::statics {
namespace {

constexpr double rigid = infinity;

struct Sample {
  const char* name;
  double shear_Pa, normal_Pa;
  bool is_pushed = false;
  int coarsenings = 0;
  bool is_uneven = false;  ///< its pressure on the far edge
};

const Sample samples[] = {{"Springs", 2e9, 5e9},
                          {"DeadLoad", rigid, 0},
                          {"DeadLoadOnSpring", 3e8, 0},
                          {"Vertical", rigid, 1e10},
                          {"Along", 1e10, rigid},
                          {"PushedBySpring", 5e8, rigid, true},
                          {"PushedUnderDeadLoad", rigid, 0, true},
                          {"PushedBySpringUnderSpring", 5e8, 1e10, true},
                          {"GradedPushed", 5e8, 0, true, 1},
                          {"UnevenOnSpring", 3e8, 0, false, 0, true},
                          {"UnevenHeldAlong", rigid, 0, false, 1, true},
                          {"PushedUneven", 5e8, 0, true, 0, true}};

mesh::Plate plate_of(const Sample& sample) {
  mesh::Plate plate{.width_m = 0.08, .height_m = 0.04, .element_size_m = 2e-3, .corner = mesh::Corner::none};
  plate.coarsenings = sample.coarsenings;
  return plate;
}

boundary::Machine machine_of(const Sample& sample) {
  const boundary::Pusher pusher{4e-3, 20e-3};
  const double width_m = plate_of(sample).width_m,
               moved_m = sample.is_pushed ? pusher.to_m - pusher.from_m : width_m;
  return {sample.shear_Pa / moved_m, sample.normal_Pa / width_m,
          sample.is_pushed ? pusher : boundary::Pusher{}};
}

Statics statics_of(const mesh::Mesh& mesh, const boundary::Machine& machine, const Loading& loading,
                   const solid::Material& material = pmma, const std::optional<ElasticBody>& base = {}) {
  return {{mesh, material, machine}, base, loading, std::vector<double>(mesh.interface_nodes.size(), 0.5)};
}

const TopPressure uneven{{0.02, 0.03, 0.07}, {2e6, 4e6, 3e6}};

Loading loading(bool is_uneven = false) {
  Loading loading{.tilt_left_m = 3e-5, .tilt_right_m = 5e-5};
  loading.edge_margin_m = 6e-3;
  if (is_uneven) loading.top_pressure = uneven;
  return loading;
}

/// Length of an edge that belongs to its nodes.
template <class At>
std::vector<double> lengths_m(const std::vector<mesh::Node>& nodes, At&& at_m) {
  std::vector<double> all(nodes.size(), 0);
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
    for (const auto end : {k, k + 1}) all[end] += 0.5 * (at_m(nodes[k + 1]) - at_m(nodes[k]));
  return all;
}

class AMachine : public ::testing::TestWithParam<Sample> {
 protected:
  mesh::Mesh mesh_ = mesh::make_plate(plate_of(GetParam()));
  solid::Material material_ = pmma;
  boundary::Boundary boundary_ = boundary::make_boundary(mesh_, machine_of(GetParam()));
  Statics statics_ = statics_of(mesh_, machine_of(GetParam()), loading(GetParam().is_uneven), material_);

  Eigen::VectorXd forces(const Equilibrium& e) const {
    return test::assembled_stiffness(mesh_, material_) * test::flat(e.u_m);
  }
};
INSTANTIATE_TEST_SUITE_P(Samples, AMachine, ::testing::ValuesIn(samples),
                         [](const auto& sample) { return sample.param.name; });

TEST_P(AMachine, PullsEachNodeByItsShareOfTheSprings) {
  const auto& [name, shear_Pa, normal_Pa, is_pushed, coarsenings, is_uneven] = GetParam();
  const auto& tilted = statics_.tilted();
  const auto e = statics_.shear_to(0.98);
  const Eigen::VectorXd before = forces(tilted);
  Eigen::VectorXd now = forces(e);
  const double tolerance_N = 1e-10 * now.cwiseAbs().maxCoeff();
  const auto expect_grip = [&](Eigen::Index d, double k_N_per_m, double machine_m) {
    const double moved_m = test::flat(e.u_m)(d) - test::flat(tilted.u_m)(d);
    if (k_N_per_m == rigid)
      EXPECT_NEAR(moved_m, machine_m, 1e-12 * e.shear_m) << d;
    else
      EXPECT_NEAR(now(d), before(d) + k_N_per_m * (machine_m - moved_m), tolerance_N) << d;
  };
  const auto& top = mesh_.far_edge_nodes;
  const auto of_top_m = lengths_m(top, [&](mesh::Node n) { return mesh_.x_m[n]; });
  for (std::size_t k = 0; k < top.size(); ++k) {
    expect_grip(2 * top[k] + 1, of_top_m[k] / 0.08 * normal_Pa, 0);
    now(2 * top[k] + 1) = 0;
    if (is_pushed) continue;
    expect_grip(2 * top[k], of_top_m[k] / 0.08 * shear_Pa, e.shear_m);
    now(2 * top[k]) = 0;
  }
  const auto& pushed = boundary_.pushed;
  ASSERT_EQ(pushed.size() > 3, is_pushed);
  const auto of_pushed_m = lengths_m(pushed, [&](mesh::Node n) { return mesh_.y_m[n]; });
  for (std::size_t k = 0; k < pushed.size(); ++k) {
    const double all_m = mesh_.y_m[pushed.back()] - mesh_.y_m[pushed.front()];
    expect_grip(2 * pushed[k], of_pushed_m[k] / all_m * shear_Pa, e.shear_m);
    now(2 * pushed[k]) = 0;
  }
  const auto tributary_m = mesh::tributary_lengths_m(mesh_);
  for (std::size_t k = 0; k < tributary_m.size(); ++k) {
    const auto n = mesh_.interface_nodes[k];
    EXPECT_NEAR(now(2 * n), -e.tractions.t_s_Pa[k] * tributary_m[k], tolerance_N);
    EXPECT_NEAR(now(2 * n + 1), e.tractions.p_s_Pa[k] * tributary_m[k], tolerance_N);
    now.segment<2>(2 * n).setZero();
  }
  EXPECT_LE(now.cwiseAbs().maxCoeff(), tolerance_N);
}

TEST_P(AMachine, DoesTheWorkThatPlateAndMachineStore) {
  const auto op = solid::make_operator(mesh_, material_, boundary_.edge_sets());
  const auto stored = [&](const Equilibrium& e) {
    return solid::strain_energy_J_per_m(op, e.u_m) + statics_.machine_energy_J_per_m(e);
  };
  const auto a = statics_.shear_to(0.6), b = statics_.shear_to(0.9);
  const auto tributary_m = mesh::tributary_lengths_m(mesh_);
  double work = 0.5 * (b.shear_m - a.shear_m) *
                (contact_force(a, tributary_m).shear_N_per_m + contact_force(b, tributary_m).shear_N_per_m);
  for (std::size_t k = 0; k < tributary_m.size(); ++k) {
    const auto n = mesh_.interface_nodes[k];
    const double half_m = 0.5 * tributary_m[k];
    work -= half_m * (a.tractions.t_s_Pa[k] + b.tractions.t_s_Pa[k]) * (b.u_m.x[n] - a.u_m.x[n]);
    work += half_m * (a.tractions.p_s_Pa[k] + b.tractions.p_s_Pa[k]) * (b.u_m.y[n] - a.u_m.y[n]);
  }
  EXPECT_GT(work, 1e-4 * stored(a));
  EXPECT_NEAR(stored(b) - stored(a), work, 1e-11 * std::max(stored(a), stored(b)));
  EXPECT_EQ(statics_.machine_energy_J_per_m(statics_.tilted()), 0);
}

TEST_P(AMachine, MovesThePlateAsItsDisplacementGrows) {
  expect_slope_of_displacement(statics_, 0.9, 1e-10);
}

TEST(Machine, PressesAsItIsGivenAlongX) {
  // Of trapezia, and their moments about x = 0.
  double force_N_per_m = 0, moment_N = 0;
  const std::vector<double> x_m = {0, 0.02, 0.03, 0.07, 0.08}, p_Pa = {2e6, 2e6, 4e6, 3e6, 3e6};
  for (std::size_t k = 0; k + 1 < x_m.size(); ++k) {
    const double a = x_m[k], b = x_m[k + 1], p = p_Pa[k], q = p_Pa[k + 1];
    force_N_per_m += 0.5 * (p + q) * (b - a);
    moment_N += (b - a) / 6 * (p * (2 * a + b) + q * (a + 2 * b));
  }
  EXPECT_NEAR(uneven.force_N_per_m(0.08), force_N_per_m, 1e-12 * force_N_per_m);
  for (const auto& sample : samples) {
    if (!sample.is_uneven) continue;
    SCOPED_TRACE(sample.name);
    const auto mesh = mesh::make_plate(plate_of(sample));
    for (const std::optional<ElasticBody>& base : {std::optional<ElasticBody>{}, {{mesh, gel}}}) {
      const auto statics = statics_of(mesh, machine_of(sample), loading(true), pmma, base);
      const auto& tilted = statics.tilted();
      const Eigen::VectorXd f = test::assembled_stiffness(mesh, pmma) * test::flat(tilted.u_m);
      const double tolerance = 1e-9 * force_N_per_m;
      double force_of_top = 0, moment_of_top = 0, shear_moment = 0, force_of_p = 0, moment_of_p = 0;
      for (const auto n : mesh.far_edge_nodes) {
        force_of_top -= f(2 * n + 1);
        moment_of_top -= f(2 * n + 1) * mesh.x_m[n];
        shear_moment += f(2 * n) * mesh.y_m[n];
      }
      EXPECT_NEAR(force_of_top, force_N_per_m, tolerance);
      EXPECT_NEAR(moment_of_top, moment_N, tolerance * 0.08);
      EXPECT_EQ(std::abs(shear_moment) < tolerance * 0.08, sample.is_pushed);  // else held along x
      const auto lengths_m = mesh::tributary_lengths_m(mesh);
      for (std::size_t k = 0; k < lengths_m.size(); ++k) {
        force_of_p += tilted.tractions.p_s_Pa[k] * lengths_m[k];
        moment_of_p += tilted.tractions.p_s_Pa[k] * lengths_m[k] * tilted.tractions.x_m[k];
      }
      EXPECT_NEAR(force_of_p, force_N_per_m, tolerance);
      EXPECT_NEAR(moment_of_p, moment_N + shear_moment, tolerance * 0.08);
      EXPECT_EQ(tilted.shear_m, 0);
      EXPECT_EQ(statics.loading().tilt_left_m, -tilted.u_m.y[mesh.far_edge_nodes.front()]);
      EXPECT_EQ(statics.loading().tilt_right_m, -tilted.u_m.y[mesh.far_edge_nodes.back()]);
    }
  }
}

TEST(Machine, KeepsTheForceOfABodyOnABase) {
  const auto mesh = mesh::make_plate(plate_of(samples[2]));
  const auto statics = statics_of(mesh, machine_of(samples[2]), loading(), pmma, ElasticBody{mesh, gel});
  const auto tributary_m = mesh::tributary_lengths_m(mesh);
  const auto force = [&](const Equilibrium& e) { return contact_force(e, tributary_m); };
  const auto e = statics.shear_to(0.98);
  const double before = force(statics.tilted()).normal_N_per_m;
  EXPECT_NEAR(force(e).normal_N_per_m, before, 1e-10 * before);
  EXPECT_GT(force(e).shear_N_per_m, 0.01 * before);
}

}  // namespace
}  // namespace slipfront::statics
