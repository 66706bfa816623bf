// Stall prevention around a motor.
#include <gtest/gtest.h>

#include "drive_bench.hpp"

namespace vinv::drive {
namespace {

TEST(DriveCoreStall, AHeavyStartLengthensTheRamp) {
  DriveBench b;
  b.settings.acceleration_s = 1;   // 50 Hz/s
  b.power.acceleration_hz_s = 15;  // rated torque gives 15 Hz/s
  b.forward(50);
  bool overload = false;
  double highest = 0;
  double settled = 0;
  const int ms = b.ms_until(
      [&](const DriveOutputs& o) {
        overload |= o.overload;
        highest = std::max(highest, b.power.sensors(true).current_a_rms);
        if (o.output_frequency_hz < 40) settled = b.power.sensors(true).current_a_rms;
        return o.state == RunState::kConstant;
      },
      20'000);
  // 6 A is 1.65 of rated torque: 25 Hz/s, 2 s.
  EXPECT_NEAR(ms, 2000, 150);
  EXPECT_TRUE(overload);
  EXPECT_LT(highest, 7);
  EXPECT_NEAR(settled, 6, 0.3);
  EXPECT_FALSE(b.tripped);
  b.run_ms(500);
  EXPECT_FALSE(b.out().overload);
}

TEST(DriveCoreStall, AnOverloadAtConstantSpeedLowersItAndRecovers) {
  DriveBench b;
  b.settings.deceleration_s = 2;
  b.settings.acceleration_s = 1;
  b.forward(40);
  b.ms_until_state(RunState::kConstant, 6000);
  b.power.load = 1.9;
  b.run_ms(1000);
  EXPECT_EQ(b.out().state, RunState::kConstant);
  EXPECT_TRUE(b.out().overload);
  // After the torque has built up it goes down along the deceleration ramp, 25 Hz/s.
  const double before = b.hz();
  EXPECT_LT(before, 39);
  b.run_ms(200);
  EXPECT_NEAR(before - b.hz(), 5, 0.1);
  b.power.load = 0.5;
  b.run_ms(4000);
  EXPECT_EQ(b.hz(), 40);
  EXPECT_FALSE(b.out().overload);
}

TEST(DriveCoreStall, AConstantTorqueOverloadEndsInTheStallTrip) {
  DriveBench b;
  b.forward(20);
  b.ms_until_state(RunState::kConstant, 6000);
  b.meddle = [](Sensors& m) {
    m.current_a_rms = 6.5;
    m.active_current_a_rms = 6;
  };
  const int down = b.ms_until([](const DriveOutputs& o) { return o.output_frequency_hz <= 0.55; }, 20'000);
  EXPECT_NEAR(down, 2050, 100);
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 5000), 3000, 10);
  EXPECT_EQ(b.tripped->kind, TripKind::kStallPrevention);
  EXPECT_EQ(b.tripped->state, RunState::kConstant);
  EXPECT_GT(b.tripped->value, b.tripped->level);
  EXPECT_NEAR(b.tripped->level, 6, 1e-9);
  EXPECT_FALSE(b.out().gates_on);
}

TEST(DriveCoreStall, ABlockedShaftIsHeldAtTheLevelUntilTheInverterOverloadTrips) {
  DriveBench b;
  b.settings.electronic_thermal_a_rms = 0;
  b.power.locked = true;
  b.forward(50);
  b.run_ms(5000);
  EXPECT_EQ(b.out().state, RunState::kAccelerating);
  EXPECT_LT(b.hz(), 5);
  EXPECT_TRUE(b.out().overload);
  EXPECT_NEAR(b.power.sensors(true).current_a_rms, 6, 0.1);
  const double held_hz = b.hz();
  const int ms = b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 100'000);
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kInverterOverload);
  const double expected_s = InverterOverload::time_to_trip_s(InverterOverload::effective_ratio(1.5, held_hz));
  EXPECT_NEAR((ms + 5000) / 1000.0, expected_s, 0.1 * expected_s);
}

TEST(DriveCoreStall, ABlockedMotorCanBeStopped) {
  DriveBench b;
  b.power.locked = true;
  b.forward(50);
  b.run_ms(2000);
  EXPECT_TRUE(b.out().overload);
  b.stop();
  EXPECT_GT(b.ms_until_state(RunState::kStopped, 1000), 0);
}

TEST(DriveCoreStall, StallAtOnceTripsWhenOverloadWouldShow) {
  DriveBench b;
  b.settings.stall_trips_at_once = true;
  b.forward(20);
  b.ms_until_state(RunState::kConstant, 6000);
  b.power.load = 2;
  b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 2000);
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kStallPrevention);
  EXPECT_FALSE(b.out().overload);
}

TEST(DriveCoreStall, WithoutStallPreventionAShortRampIsOverCurrent) {
  DriveBench b;
  b.settings.stall_level_percent = 0;
  b.settings.fast_current_limit = false;
  b.settings.acceleration_s = 0.1;
  b.power.acceleration_hz_s = 10;
  b.forward(50);
  b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 2000);
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kOverCurrentAcceleration);
}

TEST(DriveCoreStall, AFastStopOfALargeInertiaIsOverVoltageWithoutAndAHoldWithTheLinkFunction) {
  for (const double hold_v : {0.0, 700.0}) {
    DriveBench b;
    b.settings.deceleration_s = 3;
    b.settings.dc_link_hold_v = hold_v;
    b.power.stiff_link = false;
    b.power.acceleration_hz_s = 60;
    b.power.standby_w = 150;
    b.forward(50);
    b.ms_until_state(RunState::kConstant, 6000);
    b.run_ms(500);
    b.stop();
    const int ms = b.ms_until([](const DriveOutputs& o) { return !o.gates_on; }, 60'000);
    if (hold_v > 0) {
      EXPECT_FALSE(b.tripped);
      EXPECT_GT(ms, 3500);
    } else {
      ASSERT_TRUE(b.tripped);
      EXPECT_EQ(b.tripped->kind, TripKind::kOverVoltageDeceleration);
      EXPECT_LT(ms, 500);
    }
  }
}

TEST(DriveCoreStall, TheChopperSavesTheStopUntilItsDutyIsUsedUp) {
  DriveBench b;
  b.settings.deceleration_s = 0.5;
  b.settings.acceleration_s = 1;
  b.settings.chopper_duty_percent = 1;
  b.settings.electronic_thermal_a_rms = 0;
  b.power.acceleration_hz_s = 60;
  b.power.stiff_link = false;
  b.power.brake_ohm = 250;
  int stops = 0;
  for (; stops < 100 && !b.tripped; ++stops) {
    b.forward(50);
    b.ms_until_state(RunState::kConstant, 6000);
    b.stop();
    b.ms_until([](const DriveOutputs& o) { return !o.gates_on; }, 6000);
  }
  EXPECT_GT(stops, 2);
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kOverVoltageDeceleration);
  EXPECT_FALSE(b.out().chopper_enabled);
  EXPECT_GT(b.out().brake_duty_fraction, 0.9);
}

TEST(DriveCoreStall, RecoveryIsARampAlsoWithoutAccelerationTime) {
  DriveBench b;
  b.settings.acceleration_s = 0;
  b.settings.over_current_percent = 1000;
  b.settings.inverter_overload_start_percent = 1000;
  b.power.acceleration_hz_s = 1000;
  b.forward(10);
  b.ms_until_state(RunState::kConstant, 6000);
  b.run_ms(500);
  b.meddle = [](Sensors& m) {
    m.current_a_rms = 7.5;
    m.active_current_a_rms = 7;
  };
  b.run_ms(500);
  EXPECT_LT(b.hz(), 7);
  EXPECT_GT(b.hz(), 3);
  b.meddle = nullptr;
  double last = b.hz();
  for (int i = 0; i < 200; ++i) {
    b.tick();
    ASSERT_LE(b.hz() - last, 0.5 + 1e-9);
    last = b.hz();
  }
  EXPECT_EQ(b.hz(), 10);
}

TEST(DriveCoreStall, TheFastLimitTakesVoltageNotFrequency) {
  DriveBench b;
  b.settings.stall_at_constant = false;  // it would lower the frequency next
  b.forward(30);
  b.ms_until_state(RunState::kConstant, 6000);
  const double before = b.out().stage_voltage_peak_v;
  b.meddle = [](Sensors& m) { m.current_peak_a = 11; };  // trips at 11.3
  b.run_ms(3);
  EXPECT_LT(b.out().stage_voltage_peak_v, 0.9 * before);
  EXPECT_EQ(b.hz(), 30);
  b.meddle = nullptr;
  b.run_ms(60);
  EXPECT_NEAR(b.out().stage_voltage_peak_v, before, 1e-9);
}

}  // namespace
}  // namespace vinv::drive
