#include "motor_model/drive/torque_current.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vinv::drive {
namespace {

TEST(TorqueCurrent, MagnetisingMotorHasNoneHoweverMuchItsResistanceTakes) {
  // 2 A through 4 ohm behind which 20 V are in quadrature: all active current heats the stator.
  const double u = std::hypot(4 * 2.0, 20);
  const OutputSample idle{.current_a_rms = 2, .active_current_a_rms = 2 * 8 / u, .phase_voltage_v_rms = u};
  EXPECT_GT(idle.active_current_a_rms, 0.7);
  EXPECT_NEAR(torque_current_a_rms(idle, 4), 0, 1e-12);
  EXPECT_NEAR(resistive_current_a_rms(idle, 4), idle.active_current_a_rms, 1e-12);
}

TEST(TorqueCurrent, IsThePartInPhaseWithTheVoltageBehindTheResistance) {
  // 3 A in phase with 30 V and 2 A across, behind 5 ohm.
  const double in_phase_v = 30 + 5 * 3;
  const double across_v = 5 * 2;
  const double u = std::hypot(in_phase_v, across_v);
  OutputSample loaded{.current_a_rms = std::hypot(3, 2), .active_current_a_rms = 0, .phase_voltage_v_rms = u};
  loaded.active_current_a_rms = (in_phase_v * 3 + across_v * 2) / u;
  EXPECT_NEAR(torque_current_a_rms(loaded, 5), 3, 1e-9);
  EXPECT_NEAR(torque_current_a_rms(loaded, 0), loaded.active_current_a_rms, 1e-9);
}

TEST(TorqueCurrent, IsNegativeWhereTheMotorBrakesAlsoIfTheResistanceTakesAll) {
  // -1 A in phase with 10 V behind 15 ohm: the output still gives power.
  OutputSample braking{.current_a_rms = std::hypot(1, 2), .active_current_a_rms = 0, .phase_voltage_v_rms = 0};
  const double in_phase_v = 10 - 15;
  const double across_v = 15 * 2;
  braking.phase_voltage_v_rms = std::hypot(in_phase_v, across_v);
  braking.active_current_a_rms = (in_phase_v * -1 + across_v * 2) / braking.phase_voltage_v_rms;
  EXPECT_GT(braking.active_current_a_rms, 0);
  EXPECT_NEAR(torque_current_a_rms(braking, 15), -1, 1e-9);
}

TEST(TorqueCurrent, IsNoneWithoutOutputAndNeverMoreThanTheCurrent) {
  EXPECT_EQ(torque_current_a_rms({}, 4), 0);
  EXPECT_EQ(torque_current_a_rms({.current_a_rms = 3, .active_current_a_rms = 2, .phase_voltage_v_rms = 0}, 4), 0);
  EXPECT_EQ(torque_current_a_rms({.current_a_rms = 2, .active_current_a_rms = 5, .phase_voltage_v_rms = 100}, 0), 2);
  EXPECT_EQ(torque_current_a_rms({.current_a_rms = 2, .active_current_a_rms = 2, .phase_voltage_v_rms = 8}, 4), 0);
}

}  // namespace
}  // namespace vinv::drive
