#include "motor_model/drive/vf_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vinv::drive {
namespace {

constexpr auto kFwd = RunDirection::kForward;
constexpr auto kRev = RunDirection::kReverse;

TEST(VfCurve, ConstantTorqueIsALineFromBoostToBaseVoltage) {
  DriveSettings s;
  s.torque_boost_percent = 4;
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kFwd, 0), 16, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 25, kFwd, 0), 208, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 50, kFwd, 0), 400, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 90, kRev, 0), 400, 1e-9);
}

TEST(VfCurve, VariableTorqueIsASquare) {
  DriveSettings s;
  s.load_pattern = LoadPattern::kVariableTorque;
  s.torque_boost_percent = 2;
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kFwd, 0), 8, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 25, kFwd, 0), 8 + 392 * 0.25, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 50, kFwd, 0), 400, 1e-9);
}

TEST(VfCurve, HoistPatternsBoostOneDirectionOnly) {
  DriveSettings s;
  s.torque_boost_percent = 6;
  s.load_pattern = LoadPattern::kHoistBoostForward;
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kFwd, 0), 24, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kRev, 0), 0, 1e-9);
  s.load_pattern = LoadPattern::kHoistBoostReverse;
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kFwd, 0), 0, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kRev, 0), 24, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 25, kFwd, 0), 200, 1e-9);
}

TEST(VfCurve, BaseFrequencyAndVoltageScaleTheLine) {
  DriveSettings s;
  s.torque_boost_percent = 0;
  s.base_frequency_hz = 100;
  s.base_voltage_v_rms = 230;
  EXPECT_NEAR(vf_voltage_v_rms(s, 50, kFwd, 0), 115, 1e-9);
  s.base_frequency_hz = 0;
  EXPECT_NEAR(vf_voltage_v_rms(s, 1, kFwd, 0), 230, 1e-9);
}

TEST(VfCurve, ResistanceCompensationAddsMostOfTheDropUpToTheBaseVoltage) {
  DriveSettings s;
  s.torque_boost_percent = 1;
  s.rated_current_a_rms = 4;
  s.stator_resistance_compensation_ohm = 3;
  EXPECT_NEAR(vf_voltage_v_rms(s, 5, kFwd, 4), 40 + 0.8 * std::sqrt(3.0) * 12, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 5, kFwd, 100), 40 + 0.8 * std::sqrt(3.0) * 18, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 0, kFwd, 0), 4, 1e-9);
  EXPECT_NEAR(vf_voltage_v_rms(s, 49, kFwd, 8), 400, 1e-9);
}

TEST(VfCurve, PhasePeakFollowsFromLineRms) { EXPECT_NEAR(phase_peak_v(400), 326.599, 1e-3); }

TEST(VfCurve, AnAdjustableLawGoesThroughItsPoints) {
  DriveSettings s;
  s.base_frequency_hz = 50;
  s.base_voltage_v_rms = 400;
  s.torque_boost_percent = 5;
  s.vf_points = {VfPoint{10, 60}, VfPoint{30, 200}};
  s.vf_point_count = 2;
  const auto v = [&](double hz) { return vf_voltage_v_rms(s, hz, RunDirection::kForward, 0); };
  EXPECT_DOUBLE_EQ(v(0), 20);
  EXPECT_DOUBLE_EQ(v(5), 40);
  EXPECT_DOUBLE_EQ(v(10), 60);
  EXPECT_DOUBLE_EQ(v(20), 130);
  EXPECT_DOUBLE_EQ(v(30), 200);
  EXPECT_DOUBLE_EQ(v(40), 300);
  EXPECT_DOUBLE_EQ(v(50), 400);
  EXPECT_DOUBLE_EQ(v(80), 400);
}

}  // namespace
}  // namespace vinv::drive
