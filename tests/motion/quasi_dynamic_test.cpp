// SPDX-License-Identifier: BSD-3-Clause
#include "motion/quasi_dynamic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "interface/friction/rate_and_state.hpp"
#include "solid/operator.hpp"
#include "support.hpp"

namespace slipfront::motion {
namespace {

constexpr double damping = 1.07e6, edge_speed_m_per_s = 1e-6;

/// A block of PMMA that is pressed onto the plane.
class SlowBlock : public ::testing::Test {
 protected:
  SlowBlock() {
    law_.f0 = 0.2;
    law_.b = 0.004;
    law_.d_c_m = 1e-6;
  }
  interface::QuasiDynamicFriction friction() const {
    return {{law_}, tributary_m_.size(), damping};
  }
  QuasiDynamicSlip started() const {
    QuasiDynamicSlip slip(statics_, friction(), tributary_m_, edge_speed_m_per_s);
    slip.start(0, 0, contact_, std::vector<double>(contact_.size()), friction().initial_states());
    return slip;
  }

  interface::RateAndStateAging law_;
  const solid::Material material_{.poissons_ratio = 0};  // pressed without any shear
  const mesh::Mesh mesh_ = support::make_plate(0.04, 0.012, 4e-3, mesh::Corner::none);
  const statics::Statics statics_{mesh_, material_, {.tilt_left_m = 1.2e-5, .tilt_right_m = 1.2e-5}, 2};
  const std::vector<double> tributary_m_ = mesh::tributary_lengths_m(mesh_);
  const std::vector<statics::Contact> contact_ =
      std::vector<statics::Contact>(mesh_.interface_nodes.size(), statics::Contact::stick);
};

bool go_on() {
  return true;
}

/// Slip rates and psi by the classical scheme of fourth order, whose tractions are those of whole bodies.
TEST_F(SlowBlock, FollowsTheEquationsOfMotion) {
  const double end_s = 20;
  auto slip = started();
  EXPECT_FALSE(slip.slip_until(end_s, infinity, go_on));
  EXPECT_EQ(slip.state().time_s, end_s);
  EXPECT_GT(slip.state().u_x_m.back(), 5 * law_.d_c_m);

  const std::size_t n = contact_.size();
  using Values = std::vector<double>;
  const auto law = friction();
  const auto rates = [&](const Values& y, double time_s) {
    const auto e = statics_.slid_to(contact_, Values(y.begin(), y.begin() + std::ssize(contact_)), {},
                                    edge_speed_m_per_s * time_s);
    const Values psi(y.begin() + std::ssize(contact_), y.end());
    Values V(n);
    interface::LawStates per_s(1, V);
    law.balance(e.tractions.t_s_Pa, e.tractions.p_s_Pa, {psi}, nan, V, per_s);
    V.insert(V.end(), per_s[0].begin(), per_s[0].end());
    return V;
  };
  const auto moved = [](Values y, const Values& by, double factor) {
    for (std::size_t k = 0; k < y.size(); ++k) y[k] += factor * by[k];
    return y;
  };
  Values y(n);
  for (const double psi : law.initial_states()[0]) y.push_back(psi);
  const int n_steps = 8000;
  const double dt_s = end_s / n_steps;
  for (int step = 0; step < n_steps; ++step) {
    const double t = step * dt_s;
    const auto k1 = rates(y, t), k2 = rates(moved(y, k1, dt_s / 2), t + dt_s / 2);
    const auto k3 = rates(moved(y, k2, dt_s / 2), t + dt_s / 2), k4 = rates(moved(y, k3, dt_s), t + dt_s);
    for (const auto& [k, factor] : {std::pair{&k1, 1.0}, {&k2, 2.0}, {&k3, 2.0}, {&k4, 1.0}})
      y = moved(std::move(y), *k, factor * dt_s / 6);
  }
  for (std::size_t k = 0; k < n; ++k) {
    EXPECT_NEAR(slip.state().u_x_m[k], y[k], 1e-3 * law_.d_c_m) << k;
    EXPECT_NEAR(slip.state().law_states[0][k], y[n + k], 1e-3 * law_.a) << k;
  }
}

TEST_F(SlowBlock, EnergyBalances) {
  auto slip = started();
  const auto plate = solid::make_operator(mesh_, material_);
  const auto strain = [&] {
    const auto& s = slip.state();
    return solid::strain_energy_J_per_m(plate, statics_.slid_to(s.contact, s.u_x_m, {}, s.shear_m).u_m);
  };
  const double before = strain();
  slip.slip_until(40, infinity, go_on);
  const auto& w = slip.works();
  const double change = strain() - before;
  EXPECT_NEAR(w.of_load_J_per_m + w.of_friction_J_per_m + w.of_contact_J_per_m - w.radiated_J_per_m, change,
              1e-11 * w.of_load_J_per_m);
  EXPECT_LT(w.of_friction_J_per_m, 0);
  EXPECT_GT(w.radiated_J_per_m, 0);
}

TEST_F(SlowBlock, EndsWhereTheFastestNodeReachesASlipRate) {
  auto slip = started();
  for (const double rate : {1e-9, 1e-8, 1e-7}) {
    EXPECT_TRUE(slip.slip_until(1e4, rate, go_on));
    EXPECT_GE(slip.state().fastest_m_per_s(), rate);
    EXPECT_LE(slip.state().fastest_m_per_s(), 1.1 * rate);
  }
  EXPECT_FALSE(slip.slip_until(infinity, 1, [] { return false; }));
}

/// A plate that is pushed over opens at its heel, and lies down again when it is let go.
TEST(QuasiDynamicSlip, ContactOpensAndCloses) {
  interface::RateAndStateAging law;
  law.f0 = 1.5;
  const auto mesh = support::make_plate(0.04, 0.04, 4e-3, mesh::Corner::none);
  const statics::Statics statics(mesh, {}, {.tilt_left_m = 2e-5, .tilt_right_m = 2e-5}, 2);
  const auto tributary_m = mesh::tributary_lengths_m(mesh);
  const std::size_t n = tributary_m.size();
  const interface::QuasiDynamicFriction friction({law}, n, damping);
  const auto plate = solid::make_operator(mesh, {});
  const auto run = [&](double speed_m_per_s, const QuasiDynamicState* from) {
    QuasiDynamicSlip slip(statics, friction, tributary_m, speed_m_per_s);
    if (from == nullptr)
      slip.start(0, 0, statics.tilted().contact, std::vector<double>(n), friction.initial_states());
    else
      slip.start(0, from->shear_m, from->contact, from->u_x_m, from->law_states);
    const auto strain = [&] {
      const auto& s = slip.state();
      return solid::strain_energy_J_per_m(plate, statics.slid_to(s.contact, s.u_x_m, {}, s.shear_m).u_m);
    };
    const double before = strain();
    slip.slip_until(40, infinity, go_on);
    const auto& w = slip.works();
    EXPECT_NEAR(w.of_load_J_per_m + w.of_friction_J_per_m + w.of_contact_J_per_m - w.radiated_J_per_m,
                strain() - before, 1e-9 * std::abs(w.of_load_J_per_m));
    return slip.state();
  };
  const auto n_open = [](const QuasiDynamicState& s) {
    return std::ranges::count(s.contact, statics::Contact::open);
  };
  const auto pushed = run(edge_speed_m_per_s, nullptr);
  EXPECT_GT(n_open(pushed), 0);
  for (std::size_t k = 0; k < n; ++k) {
    EXPECT_GE(pushed.p_Pa[k], -1) << k;
    EXPECT_GE(pushed.gap_m[k], -1e-6 * law.d_c_m) << k;
  }
  EXPECT_LT(n_open(run(-edge_speed_m_per_s, &pushed)), n_open(pushed));
}

}  // namespace
}  // namespace slipfront::motion
