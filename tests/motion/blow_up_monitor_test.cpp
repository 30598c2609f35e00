// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observers/blow_up_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "interface/friction/coulomb.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/support.hpp"
#include "statics/prestress.hpp"
#include "support/state.hpp"

namespace slipfront::motion {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A plate at rest under a pressure of 1 MPa.
class Monitored : public ::testing::Test {
 protected:
  mesh::Mesh mesh_ = support::tiny_plate(mesh::Corner::none);
  solid::Material material_;
  double c_L_ = solid::longitudinal_speed_m_per_s(material_);

  Stepper pressed(double t_Pa = 0, double step_factor = 0.9) {
    Stepper stepper(mesh_, material_, {interface::Coulomb{.mu = 0.5}}, {.step_factor = step_factor});
    const auto tractions = support::uniform_tractions(mesh_, t_Pa, 1e6);
    stepper.start(statics::prestressed(mesh_, tractions), 0, {tractions.t_s_Pa, tractions.p_s_Pa});
    return stepper;
  }

  /// @param now  what it leaves open is put down to damping
  std::string failure(const record::Energies& start, record::Energies now, double t_Pa = 0,
                      double step_factor = 0.9) {
    now.damping_work += record::imbalance_J_per_m(now, start);
    return failure_of_open(start, now, t_Pa, step_factor);
  }
  std::string failure_of_open(const record::Energies& start, const record::Energies& now, double t_Pa = 0,
                              double step_factor = 0.9) {
    Stepper stepper = pressed(t_Pa, step_factor);
    BlowUpMonitor monitor(stepper, c_L_, Precision::double_precision, start);
    return failure(monitor, stepper, now);
  }

  static std::string failure(BlowUpMonitor& monitor, Stepper& stepper,
                             const std::optional<record::Energies>& known) {
    Pause pause(stepper, known);
    monitor.at_pause(pause);
    const auto end = monitor.end(pause);
    EXPECT_TRUE(!end || end->why == EventEnd::blow_up);
    return end ? end->reason : "";
  }
};

TEST_F(Monitored, RoundingIsNoEnergyFromNowhere) {
  // 1 MPa changes the velocity of the lowest nodes by about 1 m/s a step where nothing balances it.
  const Stepper stepper = pressed();
  double mass_kg = 0;
  for (const double m : stepper.plate().mass_kg) mass_kg += m;
  const auto failure_at = [&](double v_m_per_s) {
    return failure({}, {.kinetic = 0.5 * mass_kg * v_m_per_s * v_m_per_s});
  };
  EXPECT_THAT(failure_at(1e-16), IsEmpty());
  EXPECT_THAT(failure_at(1e-10), IsEmpty());
  EXPECT_THAT(failure_at(1e-4), HasSubstr("the energy has grown to"));
  EXPECT_THAT(failure_at(1e-4), HasSubstr("reduce time.step_factor"));
}

TEST_F(Monitored, AStartBelowNothingTakesNothingFromWhatIsSupplied) {
  EXPECT_THAT(failure({.strain = -1}, {.kinetic = 0.5, .trigger_work = 0.5, .coupling_work = 0.1}),
              IsEmpty());
}

TEST_F(Monitored, TheCouplingMayGiveATenthOfWhatIsSupplied) {
  EXPECT_THAT(failure({}, {.kinetic = 1.009, .trigger_work = 1}), IsEmpty());
  EXPECT_THAT(failure({}, {.kinetic = 1.02, .trigger_work = 1, .coupling_work = 0.015}), IsEmpty());
  EXPECT_THAT(failure({}, {.kinetic = 1.12, .trigger_work = 1, .coupling_work = 0.2}), Not(IsEmpty()));
}

TEST_F(Monitored, TheBalanceCloses) {
  const record::Energies start{.strain = 2}, now{.kinetic = 0.5, .strain = 1, .friction_work = -0.5};
  EXPECT_THAT(failure_of_open(start, now), IsEmpty());
  for (const double left_open : {0.01, -0.01, std::numeric_limits<double>::infinity()}) {
    auto open = now;
    open.friction_work -= left_open;
    EXPECT_THAT(failure_of_open(start, open), HasSubstr("J/m of energy are left open; start a new run"));
  }
}

TEST_F(Monitored, OverloadIsNotBlamedOnTheStep) {
  Stepper stepper = pressed(1e10);
  BlowUpMonitor monitor(stepper, c_L_, Precision::double_precision, stepper.energies());
  Recorder recorder(
      statics::prestressed(mesh_, {stepper.interface_state().u_y_m, stepper.interface_state().t_Pa,
                                   stepper.interface_state().p_Pa}),
      0.5, 0);
  while (monitor.after_step(stepper.now(), stepper.slip_rates()) && stepper.step() < 100)
    stepper.advance(recorder);
  const auto message = failure(monitor, stepper, {});
  EXPECT_THAT(message,
              HasSubstr("above c_L; the work of the loads accounts for the energy: reduce prestress.t_Pa"));
  EXPECT_THAT(message, Not(HasSubstr("step_factor")));
}

TEST_F(Monitored, TheStrongestLoadIsNamed) {
  for (const auto& [load, key] : {std::pair(&record::Energies::far_edge_work, "loading.shear_speed_m_per_s"),
                                  std::pair(&record::Energies::trigger_work, "event.trigger_over_missing"),
                                  std::pair(&record::Energies::prestress_work, "prestress.t_Pa"),
                                  std::pair(&record::Energies::strain, "loading.tilt_left_m")}) {
    record::Energies start{.strain = 1}, now{.kinetic = std::numeric_limits<double>::quiet_NaN()};
    start.*load = now.*load = 2;
    EXPECT_THAT(failure(start, now), HasSubstr(key));
  }
}

TEST_F(Monitored, AnUnstableStepIsBlamedWhateverTheEnergy) {
  EXPECT_THAT(failure({}, {.kinetic = std::numeric_limits<double>::quiet_NaN()}, 1e10, 1.2),
              HasSubstr("reduce time.step_factor"));
}

TEST_F(Monitored, LooksAtTheEnergyEveryHundredSteps) {
  Stepper stepper = pressed();
  BlowUpMonitor monitor(stepper, c_L_, Precision::double_precision, stepper.energies());
  EXPECT_EQ(monitor.steps_to_pause({60, 1e-7}), 40);
  Recorder recorder(
      statics::prestressed(mesh_, {stepper.interface_state().u_y_m, stepper.interface_state().t_Pa,
                                   stepper.interface_state().p_Pa}),
      0.5, 0);
  stepper.advance(recorder, 70);
  EXPECT_THAT(failure(monitor, stepper, {}), IsEmpty());
  EXPECT_EQ(monitor.steps_to_pause({70, 1e-7}), 30);
  EXPECT_THAT(failure(monitor, stepper, stepper.energies()), IsEmpty());  // known for another purpose
  EXPECT_EQ(monitor.steps_to_pause({70, 1e-7}), 100);

  BlowUpMonitor restored(stepper, c_L_, Precision::double_precision, {});
  test::copy_state(monitor, restored);
  EXPECT_EQ(restored.steps_to_pause({70, 1e-7}), 100);
  Pause pause(stepper);
  restored.restored(pause);
  BlowUpMonitor of_another(stepper, c_L_, Precision::double_precision, {.strain = 1});
  EXPECT_THROW(of_another.restored(pause), StateError);
}

}  // namespace
}  // namespace slipfront::motion
