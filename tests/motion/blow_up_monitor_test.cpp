// SPDX-License-Identifier: BSD-3-Clause
#include "motion/blow_up_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "interface/friction/coulomb.hpp"
#include "motion/support.hpp"
#include "statics/prestress.hpp"

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
    TimeStepping time{.step_factor = step_factor};
    Stepper stepper(mesh_, material_, {interface::Coulomb{.mu = 0.5}}, time);
    record::StaticState tractions;
    for (const auto n : mesh_.interface_nodes) {
      tractions.x_m.push_back(mesh_.x_m[n]);
      tractions.t_s_Pa.push_back(t_Pa);
      tractions.p_s_Pa.push_back(1e6);
    }
    const auto rest = statics::prestressed(mesh_, tractions);
    stepper.start(rest, 0, {tractions.t_s_Pa, tractions.p_s_Pa});
    return stepper;
  }

  /// What a watch says of a plate that moves at a speed although nothing was supplied.
  std::string trouble_at(double speed_m_per_s) {
    Stepper stepper = pressed();
    BlowUpMonitor monitor(stepper, c_L_);
    record::Energies now;
    double mass_kg = 0;
    for (const double m : stepper.plate().mass_kg) mass_kg += m;
    now.kinetic = 0.5 * mass_kg * speed_m_per_s * speed_m_per_s;
    return monitor.failure(&now);
  }
};

TEST_F(Monitored, RoundingIsNoEnergyFromNowhere) {
  // 1 MPa changes the velocity of the lowest nodes by about 1 m/s a step where nothing balances it.
  EXPECT_THAT(trouble_at(1e-16), IsEmpty());
  EXPECT_THAT(trouble_at(1e-10), IsEmpty());
  EXPECT_THAT(trouble_at(1e-4), HasSubstr("the energy has grown to"));
  EXPECT_THAT(trouble_at(1e-4), HasSubstr("reduce time.step_factor"));
}

TEST_F(Monitored, AStartBelowNothingTakesNothingFromWhatIsSupplied) {
  Stepper stepper = pressed();
  record::Energies start, now;
  start.strain = -1;
  now.trigger_work = 0.5;
  now.coupling_work = 0.1;
  now.kinetic = 0.5;
  EXPECT_THAT(BlowUpMonitor(stepper, c_L_, start, 0).failure(&now), IsEmpty());
}

TEST_F(Monitored, TheCouplingMayGiveATenthOfWhatIsSupplied) {
  Stepper stepper = pressed();
  BlowUpMonitor monitor(stepper, c_L_);
  record::Energies now;
  now.trigger_work = 1;
  now.kinetic = 1.009;
  EXPECT_THAT(monitor.failure(&now), IsEmpty());
  now.kinetic = 1.02;
  now.coupling_work = 0.015;
  EXPECT_THAT(monitor.failure(&now), IsEmpty());
  now.kinetic = 1.12;
  now.coupling_work = 0.2;
  EXPECT_THAT(monitor.failure(&now), Not(IsEmpty()));
}

TEST_F(Monitored, OverloadIsNotBlamedOnTheStep) {
  Stepper stepper = pressed(1e10);
  BlowUpMonitor monitor(stepper, c_L_);
  Recorder recorder(
      statics::prestressed(mesh_, {stepper.interface_state().u_y_m, stepper.interface_state().t_Pa,
                                   stepper.interface_state().p_Pa}),
      0.5, 0);
  while (monitor.check(stepper.slip_rates()) && stepper.step() < 100) stepper.advance(recorder);
  const auto message = blow_up_message(stepper, monitor.failure(nullptr));
  EXPECT_THAT(message,
              HasSubstr("above c_L; the work of the loads accounts for the energy: reduce prestress.t_Pa"));
  EXPECT_THAT(message, Not(HasSubstr("step_factor")));
}

TEST_F(Monitored, TheStrongestLoadIsNamed) {
  Stepper stepper = pressed();
  for (const auto& [load, key] : {std::pair(&record::Energies::top_work, "loading.shear_speed_over_c_L"),
                                  std::pair(&record::Energies::trigger_work, "event.trigger_amount"),
                                  std::pair(&record::Energies::prestress_work, "prestress.t_Pa"),
                                  std::pair(&record::Energies::strain, "loading.tilt_left_m")}) {
    record::Energies start, now;
    start.strain = 1;
    start.*load = 2;
    now.*load = 2;
    now.kinetic = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(BlowUpMonitor(stepper, c_L_, start, 0).failure(&now), HasSubstr(key));
  }
}

TEST_F(Monitored, AnUnstableStepIsBlamedWhateverTheEnergy) {
  Stepper stepper = pressed(1e10, 1.2);
  BlowUpMonitor monitor(stepper, c_L_);
  record::Energies now;
  now.kinetic = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(monitor.failure(&now), HasSubstr("reduce time.step_factor"));
}

TEST_F(Monitored, GoesOnFromAnotherWatch) {
  Stepper stepper = pressed();
  record::Energies start;
  start.strain = 3;
  const BlowUpMonitor monitor(stepper, c_L_, start, -40);
  EXPECT_EQ(monitor.start().strain, 3);
  EXPECT_EQ(monitor.checked_step(), -40);
  EXPECT_EQ(monitor.steps_to_check(), 60);
}

}  // namespace
}  // namespace slipfront::motion
