// Run states as timed transcripts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "drive_bench.hpp"

namespace vinv::drive {
namespace {

TEST(DriveCoreRun, StartsAtTheStartFrequencyAndReachesTheSetFrequencyInTime) {
  DriveBench b;
  EXPECT_FALSE(b.tick().gates_on);
  b.forward(50);
  const DriveOutputs& o = b.tick();
  EXPECT_TRUE(o.gates_on);
  EXPECT_TRUE(o.running);
  EXPECT_EQ(o.state, RunState::kAccelerating);
  EXPECT_EQ(o.output_frequency_hz, 0.5);
  // The ramp of 50 Hz in 5 s begins at 0.5 Hz.
  EXPECT_NEAR(b.ms_until_state(RunState::kConstant, 6000), 4950, 1);
  EXPECT_EQ(b.hz(), 50);
  EXPECT_TRUE(o.up_to_frequency);
}

TEST(DriveCoreRun, StopRampEndsAtTheStartFrequency) {
  DriveBench b;
  b.settings.start_frequency_hz = 3;
  b.settings.deceleration_s = 2;
  b.forward(50);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  EXPECT_EQ(b.tick().state, RunState::kDecelerating);
  double last = 50;
  const int ms = b.ms_until(
      [&](const DriveOutputs& o) {
        if (o.gates_on) last = o.output_frequency_hz;
        return !o.gates_on;
      },
      3000);
  EXPECT_NEAR(ms + 1, 47.0 / 25 * 1000, 1);
  EXPECT_GT(last, 3);
  EXPECT_LT(last, 3.03);
  EXPECT_EQ(b.out().state, RunState::kStopped);
  EXPECT_FALSE(b.out().running);
  EXPECT_EQ(b.out().stage_voltage_peak_v, 0);
}

TEST(DriveCoreRun, ASetFrequencyBelowTheStartFrequencyDoesNotStart) {
  DriveBench b;
  b.settings.start_frequency_hz = 2;
  b.forward(1.99);
  b.run_ms(100);
  EXPECT_FALSE(b.out().gates_on);
  b.command.set_frequency_hz = 2;
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_EQ(b.hz(), 2);
  EXPECT_EQ(b.out().state, RunState::kConstant);
  b.command.set_frequency_hz = 1.99;
  b.tick();
  EXPECT_FALSE(b.out().gates_on);
}

TEST(DriveCoreRun, MinimumFrequencyRunsOnAStartSignalAlone) {
  DriveBench b;
  b.settings.min_frequency_hz = 10;
  b.forward(0);
  b.ms_until_state(RunState::kConstant, 3000);
  EXPECT_EQ(b.hz(), 10);
}

TEST(DriveCoreRun, MaximumAndJumpBandsShapeTheSpeed) {
  DriveBench b;
  b.settings.max_frequency_hz = 40;
  b.settings.acceleration_s = 1;
  b.settings.jump_bands[0] = {20, 25, 20};
  b.forward(60);
  b.ms_until_state(RunState::kConstant, 3000);
  EXPECT_EQ(b.hz(), 40);
  b.command.set_frequency_hz = 22;
  b.run_ms(5000);
  EXPECT_EQ(b.hz(), 20);
  b.command.set_frequency_hz = 25;
  b.run_ms(5000);
  EXPECT_EQ(b.hz(), 25);
}

TEST(DriveCoreRun, NewTimesActOnTheWay) {
  DriveBench b;
  b.settings.acceleration_s = 10;
  b.forward(50);
  b.run_ms(2001);
  EXPECT_NEAR(b.hz(), 10.5, 0.02);
  b.settings.acceleration_s = 2;
  EXPECT_NEAR(b.ms_until_state(RunState::kConstant, 6000), 39.5 / 25 * 1000, 2);
}

TEST(DriveCoreRun, ReversalGoesThroughZeroWithoutDcBrake) {
  DriveBench b;
  b.settings.dc_brake_s = 0.5;
  b.settings.acceleration_s = 2;
  b.settings.deceleration_s = 1;
  b.forward(25);
  b.ms_until_state(RunState::kConstant, 6000);
  b.reverse(25);
  EXPECT_EQ(b.tick().state, RunState::kDecelerating);
  double last = b.hz();
  int below = 0;
  int crossing_ms = -1;
  for (int i = 1; i < 2000; ++i) {
    const DriveOutputs& o = b.tick();
    ASSERT_TRUE(o.gates_on && o.running);
    ASSERT_NE(o.state, RunState::kDcBraking);
    ASSERT_LT(o.output_frequency_hz, last + 1e-9);
    if (std::abs(o.output_frequency_hz) < 0.4999) ++below;
    if (crossing_ms < 0 && o.output_frequency_hz < 0) {
      crossing_ms = i;
      EXPECT_EQ(o.output_frequency_hz, -0.5);
      EXPECT_EQ(o.state, RunState::kAccelerating);
    }
    last = o.output_frequency_hz;
    if (o.state == RunState::kConstant) break;
  }
  EXPECT_NEAR(crossing_ms, 490, 2);
  EXPECT_EQ(below, 0);
  EXPECT_EQ(last, -25);
}

TEST(DriveCoreRun, OutputStopCoastsAndReleaseStartsFromTheStartFrequency) {
  DriveBench b;
  b.forward(50);
  b.ms_until_state(RunState::kConstant, 6000);
  b.command.output_stop = true;
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_EQ(b.out().state, RunState::kStopped);
  b.run_ms(200);
  EXPECT_FALSE(b.out().gates_on);
  EXPECT_GT(b.power.rotor_hz, 40);  // coasts
  b.command.output_stop = false;
  b.power.rotor_hz = 0;
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_EQ(b.hz(), 0.5);
}

TEST(DriveCoreRun, WithoutPermitOrControlPowerThereIsNoOutput) {
  DriveBench b;
  b.forward(50);
  b.run_ms(1000);
  b.command.permit = false;
  EXPECT_FALSE(b.tick().gates_on);
  b.power.rotor_hz = 0;
  b.command.permit = true;
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_EQ(b.hz(), 0.5);
  b.run_ms(1000);
  b.meddle = [](Sensors& m) { m.control_power = false; };
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_FALSE(b.out().chopper_enabled);
}

TEST(DriveCoreRun, DcBrakeActsAtItsFrequencyForItsTime) {
  DriveBench b;
  b.settings.dc_brake_s = 0.5;
  b.settings.dc_brake_frequency_hz = 3;
  b.settings.dc_brake_voltage_percent = 10;
  b.forward(20);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  EXPECT_NEAR(b.ms_until_state(RunState::kDcBraking, 3000), 1700, 1);
  const DriveOutputs& o = b.out();
  EXPECT_TRUE(o.gates_on);
  EXPECT_FALSE(o.running);
  EXPECT_EQ(o.stage_frequency_hz, 0);
  EXPECT_EQ(o.output_frequency_hz, 0);
  EXPECT_NEAR(o.stage_voltage_peak_v, 400 * 0.10 * std::sqrt(2.0 / 3), 1e-9);
  EXPECT_EQ(b.ms_until_state(RunState::kStopped, 3000), 500);
  EXPECT_FALSE(o.gates_on);
}

TEST(DriveCoreRun, AStopBelowTheDcBrakeFrequencyBrakesAtOnce) {
  DriveBench b;
  b.settings.dc_brake_s = 0.5;
  b.forward(2);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  EXPECT_EQ(b.tick().state, RunState::kDcBraking);
}

TEST(DriveCoreRun, ANewStartCancelsTheDcBrake) {
  DriveBench b;
  b.settings.dc_brake_s = 2;
  b.forward(10);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  b.ms_until_state(RunState::kDcBraking, 3000);
  b.run_ms(100);
  b.reverse(10);
  EXPECT_EQ(b.tick().state, RunState::kAccelerating);
  EXPECT_EQ(b.hz(), -0.5);
}

TEST(DriveCoreRun, DcBrakeWithoutTimeOrVoltageIsOff) {
  for (const bool time : {true, false}) {
    DriveBench b;
    b.settings.dc_brake_s = time ? 1 : 0;
    b.settings.dc_brake_voltage_percent = time ? 0 : 6;
    b.forward(10);
    b.ms_until_state(RunState::kConstant, 6000);
    b.stop();
    EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return !o.gates_on; }, 3000), 950, 1);
    EXPECT_EQ(b.out().state, RunState::kStopped);
  }
}

TEST(DriveCoreRun, CoastingStopGoesOnForItsDelayThenShutsTheOutput) {
  DriveBench b;
  b.settings.stop_by_coasting = true;
  b.settings.coast_delay_s = 0.3;
  b.forward(20);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(b.tick().gates_on) << i;
    ASSERT_EQ(b.out().state, RunState::kCoastDelay);
    ASSERT_EQ(b.hz(), 20);
  }
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_EQ(b.out().state, RunState::kStopped);
}

TEST(DriveCoreRun, CoastingStopWithoutDelayIsImmediate) {
  DriveBench b;
  b.settings.stop_by_coasting = true;
  b.forward(20);
  b.run_ms(500);
  b.stop();
  EXPECT_FALSE(b.tick().gates_on);
}

TEST(DriveCoreRun, AStartInTheCoastDelayGoesOn) {
  DriveBench b;
  b.settings.stop_by_coasting = true;
  b.settings.coast_delay_s = 0.3;
  b.forward(20);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  b.run_ms(200);
  b.forward(20);
  EXPECT_EQ(b.tick().state, RunState::kConstant);
  EXPECT_EQ(b.hz(), 20);
  b.stop();
  b.run_ms(300);
  EXPECT_TRUE(b.out().gates_on);  // the delay began anew
  EXPECT_FALSE(b.tick().gates_on);
}

TEST(DriveCoreRun, SlipCompensationRaisesTheOutputUnderLoad) {
  DriveBench b;
  b.settings.rated_slip_hz = 2;
  b.settings.motor_rated_current_a_rms = 4;
  b.settings.motor_no_load_current_a_rms = 2.1;
  b.forward(30);
  b.run_ms(6000);
  EXPECT_NEAR(b.hz(), 30, 0.01);
  b.power.load = 1;
  b.run_ms(6000);
  EXPECT_EQ(b.out().ramp_frequency_hz, 30);
  EXPECT_NEAR(b.hz(), 32, 0.05);
  EXPECT_NEAR(b.power.rotor_hz, 30, 0.06);
  EXPECT_TRUE(b.out().up_to_frequency);
  b.settings.max_frequency_hz = 31;
  b.tick();
  EXPECT_EQ(b.hz(), 31);
}

TEST(DriveCoreRun, VoltageFollowsTheCurveInBothDirections) {
  DriveBench b;
  b.settings.acceleration_s = 0;
  b.settings.load_pattern = LoadPattern::kHoistBoostForward;
  b.settings.torque_boost_percent = 10;
  b.settings.stall_level_percent = 0;
  b.settings.fast_current_limit = false;
  b.settings.over_current_percent = 10000;
  b.settings.inverter_overload_start_percent = 10000;
  b.power.acceleration_hz_s = 1000;
  b.forward(25);
  b.run_ms(3000);
  EXPECT_NEAR(b.out().stage_voltage_peak_v, (40 + 180) * std::sqrt(2.0 / 3), 1e-6);
  b.reverse(25);
  b.run_ms(8000);
  EXPECT_NEAR(b.out().stage_voltage_peak_v, 200 * std::sqrt(2.0 / 3), 1e-6);
}

TEST(DriveCoreRun, ShortestAccelerationIsLimitedByTheCurrentOnly) {
  DriveBench b;
  b.settings.acceleration_s = 100;
  b.settings.shortest_acceleration = true;
  b.forward(50);
  double highest = 0;
  const int ms = b.ms_until(
      [&](const DriveOutputs& o) {
        highest = std::max(highest, b.power.sensors(true).current_a_rms);
        return o.state == RunState::kConstant;
      },
      10'000);
  // 150 % of 4 A is 6 A: 1.65 of the rated torque, 330 Hz/s; the rate has to find that.
  EXPECT_GT(ms, 150);
  EXPECT_LT(ms, 600);
  EXPECT_LT(highest, 8);
  EXPECT_FALSE(b.tripped);
}

TEST(DriveCoreRun, ShortestAccelerationKeepsItsReferenceCurrent) {
  DriveBench b;
  b.settings.shortest_acceleration = true;
  b.settings.shortest_current_acceleration_a_rms = 4;
  b.power.acceleration_hz_s = 25;
  b.forward(50);
  b.run_ms(800);
  double sum = 0;
  for (int i = 0; i < 500; ++i) {
    b.tick();
    sum += b.power.sensors(true).current_a_rms;
  }
  EXPECT_EQ(b.out().state, RunState::kAccelerating);
  EXPECT_NEAR(sum / 500, 4, 0.2);
}

TEST(DriveCoreRun, ShortestDecelerationKeepsTheLinkBelowItsTrip) {
  DriveBench b;
  b.settings.shortest_deceleration = true;
  b.settings.deceleration_s = 0.1;
  b.power.stiff_link = false;
  b.power.standby_w = 100;
  b.forward(50);
  b.ms_until_state(RunState::kConstant, 6000);
  b.stop();
  EXPECT_GT(b.ms_until_state(RunState::kStopped, 30'000), 100);
  EXPECT_FALSE(b.tripped) << b.tripped->value;
}

TEST(DriveCoreRun, ANewStartForgetsSlipAndShortestRate) {
  DriveBench b;
  b.settings.rated_slip_hz = 2;
  b.settings.shortest_acceleration = true;
  b.power.load = 1;
  b.forward(50);
  b.run_ms(150);
  b.command.output_stop = true;
  b.tick();
  b.power.rotor_hz = 0;
  b.power.torque = 0;
  b.command.output_stop = false;
  b.tick();
  EXPECT_EQ(b.hz(), 0.5);
  b.run_ms(5);
  EXPECT_NEAR(b.out().ramp_frequency_hz, 0.55, 0.01);  // 10 Hz/s again
}

// A copy is a snapshot: both go on identically.
TEST(DriveCoreRun, ACopyOnTheRampGoesOnIdentically) {
  DriveBench b;
  b.settings.ramp_pattern = RampPattern::kSCurveB;
  b.settings.rated_slip_hz = 2;
  b.settings.dc_brake_s = 0.5;
  b.power.load = 0.5;
  b.forward(50);
  b.run_ms(2345);
  DriveBench c = b;
  for (int i = 0; i < 12'000; ++i) {
    if (i == 5000) b.stop(), c.stop();
    if (i == 11'500) b.reverse(20), c.reverse(20);
    const DriveOutputs& x = b.tick();
    const DriveOutputs& y = c.tick();
    ASSERT_EQ(x.state, y.state);
    ASSERT_EQ(x.stage_frequency_hz, y.stage_frequency_hz);
    ASSERT_EQ(x.stage_voltage_peak_v, y.stage_voltage_peak_v);
    ASSERT_EQ(x.motor_thermal_fraction, y.motor_thermal_fraction);
  }
}

static_assert(std::is_trivially_copyable_v<DriveCore>);

}  // namespace
}  // namespace vinv::drive
