// SPDX-License-Identifier: BSD-3-Clause
#include "motion/event.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "interface/friction/coulomb.hpp"
#include "motion/observers/history_rows.hpp"
#include "motion/ramp.hpp"
#include "motion/support.hpp"
#include "motion/trigger_zone.hpp"
#include "support/interruption.hpp"

namespace slipfront::motion {
namespace {

using mesh::Corner;
using support::mu_s;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool always(std::int64_t, std::int64_t) {
  return true;
}

const statics::Loading tilted_plate{.tilt_left_m = 0.37e-3, .tilt_right_m = 0.037e-3, .edge_margin_m = 10e-3};

/// The paper's plate with 5 mm cells.
class EventRun : public ::testing::Test {
 protected:
  mesh::Mesh mesh_ = support::make_plate(0.2, 0.1, 5e-3, Corner::none);
  solid::Material material_{.stiffness_damping_s = 0.1e-6};
  statics::Statics statics_{mesh_, material_, tilted_plate, mu_s};
  statics::Equilibrium calm_ = statics_.shear_to(0.5);
  double c_L_ = solid::longitudinal_speed_m_per_s(material_);
  Waves waves_{c_L_, solid::shear_modulus_Pa(material_) / solid::shear_speed_m_per_s(material_)};
  TimeStepping time_{.interface_substeps = 4, .end_s = 60e-6, .quiet_s = 1};
  double history_interval_s_ = 0.5e-6, energy_interval_s_ = 20e-6;
  record::History history_;  ///< of the last run
  double loads_settle_s_ = 0;

  Event run(const statics::Equilibrium& state, const Monitor& monitor = always) {
    history_ = {};
    return run(state, monitor, [this](const record::History& row) {
      record::append_rows(members_of(history_), members_of(row));
    });
  }
  Event run(const statics::Equilibrium& state, const Monitor& monitor,
            const std::function<void(const record::History&)>& take) {
    Stepper stepper(mesh_, material_, support::paper_law, time_);
    stepper.start(state, 1e-6 * c_L_);
    const EventSetup setup = {
        state, mu_s, waves_, loads_settle_s_, time_, history_interval_s_, energy_interval_s_, 2};
    Observers observers;
    observers.push_back(std::make_unique<HistoryRows>(history_interval_s_, take));
    return motion::EventRun(stepper, setup, monitor, std::move(observers)).run();
  }
  double step_s() { return Stepper(mesh_, material_, support::paper_law, time_).step_s(); }
};

TEST_F(EventRun, EndsAtItsEnd) {
  // A time so far that it is never.
  energy_interval_s_ = 1e300;
  const Event event = run(calm_);
  EXPECT_EQ(event.end, EventEnd::end_time);
  EXPECT_EQ(event.steps, static_cast<std::int64_t>(std::ceil(60e-6 / step_s())));
  EXPECT_DOUBLE_EQ(event.time_s, static_cast<double>(event.steps) * step_s());
  EXPECT_GE(event.time_s, 60e-6);
  EXPECT_EQ(event.record.end_time_s, event.time_s);
  EXPECT_EQ(event.record.halo, 2);
  EXPECT_TRUE(event.record.onsets.empty());
  EXPECT_EQ(event.energies.size(), 2);
}

TEST_F(EventRun, EnergiesMayBeAskedForAtEveryStep) {
  // Multiples of the step that are rounded: a row for each step all the same.
  time_.end_s = 2e-3;
  for (const double interval_s : {1e-12, step_s()}) {
    energy_interval_s_ = interval_s;
    history_interval_s_ = interval_s;
    const Event event = run(calm_);
    ASSERT_GT(event.steps, 500);
    EXPECT_EQ(std::ssize(event.energies), event.steps + 1);
    EXPECT_EQ(std::ssize(history_.time_s), event.steps);
  }
}

TEST_F(EventRun, EndsWhenNothingMoves) {
  // No node slips, so the time counts from when the loads settle; to the next step.
  time_.quiet_s = 10e-6;
  for (const double from_s : {7e-6, 40e-6}) {
    loads_settle_s_ = from_s;
    const Event event = run(calm_);
    EXPECT_EQ(event.end, EventEnd::quiet);
    EXPECT_GT(event.time_s, from_s + 10e-6);
    EXPECT_LE(event.time_s, from_s + 10e-6 + step_s() * (1 + 1e-9));
  }
}

TEST_F(EventRun, WavesKeepItGoing) {
  // Slip pauses for longer than the quiet time while the plate rings, and begins again.
  time_.quiet_s = 20e-6;
  time_.end_s = 600e-6;
  const Event event = run(statics_.shear_to(1.001));
  EXPECT_EQ(event.end, EventEnd::end_time);
  const auto& onsets = event.record.onsets;
  double longest_pause_s = 0;
  for (std::size_t k = 1; k < onsets.size(); ++k)
    longest_pause_s = std::max(longest_pause_s, onsets[k].time_s - onsets[k - 1].time_s);
  EXPECT_GT(longest_pause_s, time_.quiet_s);
}

TEST_F(EventRun, EndsWhenTheMonitorSaysSo) {
  time_.end_s = 1e-3;
  std::vector<std::int64_t> asked;
  std::int64_t total = 0;
  const Event event = run(calm_, [&](std::int64_t step, std::int64_t n_steps) {
    asked.push_back(step);
    total = n_steps;
    return step < 150;
  });
  EXPECT_EQ(event.end, EventEnd::interrupted);
  EXPECT_THAT(asked, ElementsAre(50, 100, 150));
  EXPECT_EQ(event.steps, 150);
  EXPECT_EQ(total, static_cast<std::int64_t>(std::ceil(1e-3 / step_s())));
}

TEST_F(EventRun, IsInterruptedAfterAnyStep) {
  time_.end_s = 1e-3;
  energy_interval_s_ = 1e300;
  for (const int steps : {1, 49, 73}) {
    const test::InterruptionAfter after(steps - 1);
    std::int64_t asked_at = 0;
    const Event event = run(calm_, [&](std::int64_t step, std::int64_t) {
      asked_at = step;
      return !after.is_wanted();
    });
    EXPECT_EQ(event.end, EventEnd::interrupted);
    EXPECT_EQ(event.steps, steps);
    EXPECT_EQ(asked_at, steps);
  }
}

TEST_F(EventRun, IsInterruptedWithinAStepOfManySubSteps) {
  time_.interface_substeps = 5000;
  const test::InterruptionAfter after(2);
  EXPECT_THROW(run(calm_), Interrupted);
  EXPECT_EQ(after.asked(), 3);
}

TEST_F(EventRun, EndsWhenItBlowsUp) {
  time_.step_factor = 1.3;
  time_.allow_unstable = true;
  time_.end_s = 1;
  const Event event = run(calm_);
  EXPECT_EQ(event.end, EventEnd::blow_up);
  EXPECT_THAT(event.reason, HasSubstr(fmt::format("the run blew up at step {} (t = ", event.steps)));
  EXPECT_THAT(event.reason, HasSubstr("time.step_factor"));
  EXPECT_LT(event.steps, 1000);
  // Seen before the numbers are lost.
  for (const double slip : history_.slip_m) ASSERT_TRUE(std::isfinite(slip));
}

TEST_F(EventRun, EndsWhenEnergyComesFromNowhere) {
  // Unstable by so little that the energy, looked at now and then, tells before any slip rate does.
  time_.step_factor = 1.02;
  time_.allow_unstable = true;
  time_.end_s = 1;
  const Event event = run(calm_);
  EXPECT_EQ(event.end, EventEnd::blow_up);
  EXPECT_THAT(event.reason, HasSubstr("the energy has grown to"));
  EXPECT_LT(event.time_s, 1);
}

TEST_F(EventRun, SamplesAreSpacedAsAsked) {
  history_interval_s_ = 7e-6;
  const Event event = run(calm_);
  const double step = step_s();
  ASSERT_LT(step, 7e-6);
  ASSERT_EQ(history_.time_s.size(), 9);  // 0, 7, ... 56 us
  for (std::size_t k = 0; k < 9; ++k) {
    // The first step at or after the time.
    const double asked = 7e-6 * static_cast<double>(k);
    EXPECT_GE(history_.time_s[k], asked * (1 - 1e-12));
    EXPECT_LT(history_.time_s[k], asked + step);
  }
  for (const auto& field : record::history_fields)
    EXPECT_EQ((history_.*field.member).size(), 9 * mesh_.interface_nodes.size());

  history_interval_s_ = 0.1 * step;  // no finer than the steps
  const auto n_steps = run(calm_).steps;
  EXPECT_EQ(n_steps, std::ssize(history_.time_s));
}

TEST_F(EventRun, AFailingOutputEndsTheEvent) {
  int n_rows = 0;
  const auto has_room_for_five = [&](const record::History&) {
    if (n_rows == 5) throw std::runtime_error("no room");
    ++n_rows;
  };
  EXPECT_THROW(run(calm_, always, has_room_for_five), std::runtime_error);
  EXPECT_EQ(n_rows, 5);
}

/// Six nodes 10 mm apart, the outermost two open; mu_s p_s - t_s = 3, 6, 9, 12 Pa inside.
statics::Equilibrium six_nodes() {
  statics::Equilibrium e;
  e.tractions.x_m = {0, 0.01, 0.02, 0.03, 0.04, 0.05};
  e.tractions.p_s_Pa = {0, 10, 10, 10, 10, 0};
  e.tractions.t_s_Pa = {0, 10, 7, 4, 1, 0};
  e.contact = {statics::Contact::open, statics::Contact::stick, statics::Contact::stick,
               statics::Contact::slip, statics::Contact::stick, statics::Contact::open};
  return e;
}

using interface::EventKind;
using interface::TriggerForm;

/// mu_s p_s = 13 Pa inside. Tributary lengths 0.5, 1, 1, 2, 1, 0.5 m.
std::vector<double> forces(const statics::Equilibrium& state, EventKind kind, TriggerForm form,
                           double amount = 2) {
  const std::vector<double> tributary_m = {0.5, 1, 1, 2, 1, 0.5};
  return trigger_forces(state, tributary_m, kind, {.form = form, .zone_m = 0.01, .amount = amount}, mu_s);
}

TEST(TriggerForces, FillTheZoneFromTheEdgeOfContact) {
  auto beyond = six_nodes();
  beyond.tractions.t_s_Pa[1] = 14;
  struct Case {
    statics::Equilibrium state;
    EventKind kind;
    TriggerForm form;
    double amount;
    std::vector<double> expected;
  };
  for (const auto& [state, kind, form, amount, expected] : std::initializer_list<Case>{
           {six_nodes(), EventKind::left, TriggerForm::added, 2, {0, 2 * 3, 2 * 6, 0, 0, 0}},
           {six_nodes(), EventKind::right, TriggerForm::added, 2, {0, 0, 0, 2 * 9 * 2, 2 * 12, 0}},
           {six_nodes(), EventKind::left, TriggerForm::raised, 2, {0, 2 * 13 - 10, 2 * 13 - 7, 0, 0, 0}},
           // To 0.6 * 13 = 7.8 Pa: between the 10 and 7 Pa that are there, of which none is lowered.
           {six_nodes(), EventKind::left, TriggerForm::raised, 0.6, {0, 0, 0.8, 0, 0, 0}},
           {beyond, EventKind::left, TriggerForm::added, 2, {0, 0, 2 * 6, 0, 0, 0}}}) {
    const auto force = forces(state, kind, form, amount);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(force[k], expected[k], expected[k] == 0 ? 0 : 1e-13) << k;
  }
  EXPECT_THAT(forces(six_nodes(), EventKind::left, TriggerForm::raised, 0.5), Each(0));
  EXPECT_THAT(forces(six_nodes(), EventKind::left, TriggerForm::weakened), Each(0));  // left to the friction
  EXPECT_THAT(forces(six_nodes(), EventKind::spontaneous, TriggerForm::added), Each(0));
  EXPECT_EQ(forces(six_nodes(), EventKind::none, TriggerForm::added), std::vector<double>(6, 0.0));
  EXPECT_THAT(trigger_zone(six_nodes(), EventKind::left, 0.01), ElementsAre(1, 2));
  EXPECT_THAT(trigger_zone(six_nodes(), EventKind::right, 0.02), ElementsAre(2, 3, 4));
  EXPECT_THAT(trigger_zone(six_nodes(), EventKind::spontaneous, 0.02), ::testing::IsEmpty());
}

TEST(TriggerForces, GoByTheStrengthOfEachNode) {
  const auto state = six_nodes();
  const std::vector<double> tributary_m(6, 1.0), of_each = {1, 1.1, 1.4, 1, 1, 1};
  const auto force = trigger_forces(state, tributary_m, EventKind::left,
                                    {.form = TriggerForm::raised, .zone_m = 0.01, .amount = 2}, of_each);
  for (const std::size_t k : {1, 2})
    EXPECT_DOUBLE_EQ(force[k], 2 * of_each[k] * state.tractions.p_s_Pa[k] - state.tractions.t_s_Pa[k]);
}

TEST(TriggerForces, ActInTheDirectionInWhichTheZoneIsLoaded) {
  auto there = six_nodes();
  there.tractions.t_s_Pa[2] = -3;  // against its neighbour, which outweighs it
  auto back = there, idle = there;
  for (double& t : back.tractions.t_s_Pa) t = -t;
  for (double& t : idle.tractions.t_s_Pa) t = 0;
  for (const auto form : {TriggerForm::added, TriggerForm::raised}) {
    const auto to_right = forces(there, EventKind::left, form), to_left = forces(back, EventKind::left, form);
    EXPECT_GT(to_right[1], 0);
    EXPECT_GT(to_right[2], to_right[1]);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(to_left[k], -to_right[k]) << k;
    EXPECT_DOUBLE_EQ(forces(idle, EventKind::left, form)[1], 2 * 13.0);
  }
}

TEST(Halo, ReachesPastTheDistanceAhead) {
  const auto mesh = support::make_plate(0.2, 0.1, 2e-3, Corner::none);
  // l* = 0.67 mm on cells of 0.667 mm is one cell.
  for (const auto& [ahead_m, halo] : {std::pair(2e-3, 2), {0.67e-3, 2}, {2.01e-3, 2}, {3e-3, 3}, {6e-3, 4}})
    EXPECT_EQ(halo_for(mesh, ahead_m), halo) << ahead_m;
}

Ramp run_ramp(Stepper& stepper, const statics::Equilibrium& tilted, double top_speed_m_per_s,
              double c_L_m_per_s, double expected_shear_m, const Monitor& monitor) {
  stepper.start(tilted, top_speed_m_per_s);
  return RampRun(stepper, {tilted, tilted_plate, mu_s, top_speed_m_per_s, c_L_m_per_s, expected_shear_m},
                 monitor)
      .run();
}

TEST(Ramp, ReachesTheStaticStates) {
  // Under Coulomb's law, which does not weaken nodes that slip at the edges. The edge moves ten times faster
  // than the paper's, on a coarse mesh: inertia and damping change stresses by rho c v, 1e-3 of p at most.
  const auto mesh = support::make_plate(0.2, 0.1, 10e-3, Corner::none);
  const solid::Material material;
  const auto& loading = tilted_plate;
  const statics::Statics statics(mesh, material, loading, mu_s);
  const auto expected = statics.shear_to(1 - loading.critical_margin);
  const auto tilted = statics.shear_by(0);
  TimeStepping time;
  time.interface_substeps = 1;
  Stepper stepper(mesh, material, {interface::Coulomb{.mu = mu_s}}, time);
  const double c_L = solid::longitudinal_speed_m_per_s(material), speed = 1e-5 * c_L;
  const Ramp ramp = run_ramp(stepper, tilted, speed, c_L, expected.shear_m, always);
  EXPECT_FALSE(ramp.interrupted);
  EXPECT_NEAR(ramp.subcritical.shear_m / expected.shear_m, 1, 2e-3);
  EXPECT_EQ(ramp.subcritical.peak_x_m, expected.peak_x_m);
  EXPECT_GE(ramp.subcritical.peak_ratio, (1 - loading.critical_margin) * mu_s);
  EXPECT_GE(ramp.supercritical.peak_ratio, (1 - ramp_handover) * mu_s);
  EXPECT_GT(ramp.supercritical.shear_m, ramp.subcritical.shear_m);
  const double p_max = *std::ranges::max_element(expected.tractions.p_s_Pa);
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) {
    EXPECT_NEAR(ramp.subcritical.tractions.t_s_Pa[k], expected.tractions.t_s_Pa[k], 2e-3 * p_max) << k;
    EXPECT_NEAR(ramp.subcritical.tractions.p_s_Pa[k], expected.tractions.p_s_Pa[k], 2e-3 * p_max) << k;
  }

  // It can be interrupted, and tells when mu_s is out of reach.
  EXPECT_TRUE(
      run_ramp(stepper, tilted, speed, c_L, expected.shear_m, [](auto, auto) { return false; }).interrupted);
  {
    const test::InterruptionAfter after(72);
    const auto begun = run_ramp(stepper, tilted, speed, c_L, expected.shear_m,
                                [&](auto, auto) { return !after.is_wanted(); });
    EXPECT_TRUE(begun.interrupted);
    EXPECT_EQ(begun.steps, 73);
  }
  EXPECT_THAT([&] { run_ramp(stepper, tilted, speed, c_L, 0.1 * expected.shear_m, always); },
              ::testing::ThrowsMessage<UserError>(
                  HasSubstr("the ramp does not bring t/p inside the interface to mu_s")));
}

}  // namespace
}  // namespace slipfront::motion
