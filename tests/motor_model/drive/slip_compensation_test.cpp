#include "motor_model/drive/slip_compensation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vinv::drive {
namespace {

DriveSettings with_slip() {
  DriveSettings s;
  s.rated_slip_hz = 2;
  s.motor_rated_current_a_rms = 5;
  s.motor_no_load_current_a_rms = 3;  // rated torque current 4 A
  s.slip_response_s = 0.5;
  return s;
}

double settle(SlipCompensation& slip, const DriveSettings& s, double ramp_hz, double torque_a, int ms = 10000) {
  double df = 0;
  for (int i = 0; i < ms; ++i) df = slip.step(0.001, s, ramp_hz, torque_a);
  return df;
}

TEST(SlipCompensation, RatedTorqueCurrentGivesRatedSlip) {
  SlipCompensation slip;
  EXPECT_NEAR(settle(slip, with_slip(), 30, 4), 2, 1e-6);
  EXPECT_NEAR(settle(slip, with_slip(), 30, 2), 1, 1e-6);
  EXPECT_NEAR(settle(slip, with_slip(), 30, -4), -2, 1e-6);
}

TEST(SlipCompensation, ResponseTimeIsALag) {
  SlipCompensation slip;
  EXPECT_NEAR(settle(slip, with_slip(), 30, 4, 500), 2 * (1 - std::exp(-1)), 0.005);
}

TEST(SlipCompensation, IsBoundedAtTwiceTheRatedLoad) {
  SlipCompensation slip;
  EXPECT_NEAR(settle(slip, with_slip(), 30, 40), 4, 1e-6);
}

TEST(SlipCompensation, IsOffWithoutRatedSlipAndAboveBaseFrequencyWhereSoSet) {
  SlipCompensation slip;
  DriveSettings s = with_slip();
  s.slip_in_constant_output = false;
  EXPECT_NEAR(settle(slip, s, 50, 4), 2, 1e-6);
  EXPECT_EQ(slip.step(0.001, s, 51, 4), 0);
  s.slip_in_constant_output = true;
  EXPECT_GT(settle(slip, s, 51, 4), 1.9);
  s.rated_slip_hz = 0;
  EXPECT_EQ(slip.step(0.001, s, 30, 4), 0);
}

TEST(SlipCompensation, InverterRatingStandsInForAnUnknownMotor) {
  SlipCompensation slip;
  DriveSettings s = with_slip();
  s.motor_rated_current_a_rms = 0;
  s.motor_no_load_current_a_rms = 0;
  s.rated_current_a_rms = 8;
  EXPECT_NEAR(settle(slip, s, 30, 4), 1, 1e-6);
}

TEST(Droop, LowersTheFrequencyWithTheTorqueCurrent) {
  DriveSettings s;
  s.motor_rated_current_a_rms = 5;
  s.motor_no_load_current_a_rms = 3;  // rated torque current 4 A
  s.droop_hz = 2;
  s.droop_filter_s = 0.1;
  Droop d;
  for (int i = 0; i < 2000; ++i) d.step(0.001, s, false, 2);
  EXPECT_NEAR(d.step(0.001, s, false, 2), 1, 1e-3);
  for (int i = 0; i < 2000; ++i) d.step(0.001, s, false, -4);
  EXPECT_NEAR(d.step(0.001, s, false, -4), -2, 1e-3);  // regenerating raises it
  // While ramping it fades, unless it is to act there too.
  for (int i = 0; i < 2000; ++i) d.step(0.001, s, true, 4);
  EXPECT_NEAR(d.step(0.001, s, true, 4), 0, 1e-3);
  s.droop_in_ramps = true;
  for (int i = 0; i < 2000; ++i) d.step(0.001, s, true, 4);
  EXPECT_NEAR(d.step(0.001, s, true, 4), 2, 1e-3);
  s.droop_hz = 0;
  EXPECT_EQ(d.step(0.001, s, false, 4), 0);
}

}  // namespace
}  // namespace vinv::drive
