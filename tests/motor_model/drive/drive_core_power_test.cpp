// Instantaneous power failure.
#include <gtest/gtest.h>

#include <cmath>

#include "drive_bench.hpp"

namespace vinv::drive {
namespace {

struct Bench : DriveBench {
  bool mains = true;
  Bench() {
    settings.acceleration_s = 1;
    meddle = [this](Sensors& m) { m.dc_link_v = mains ? 566 : 300; };
    forward(30);
    ms_until_state(RunState::kConstant, 6000);
    run_ms(500);
  }
  Bench(const Bench&) = delete;
};

TEST(DriveCorePower, ALongDipShutsTheOutputWithTheFlagAndNoAlarm) {
  Bench b;
  b.mains = false;
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_EQ(b.out().state, RunState::kPowerFailure);
  EXPECT_FALSE(b.out().power_failure);
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.power_failure; }, 100), 15, 1);
  b.run_ms(500);
  EXPECT_FALSE(b.tripped);
  EXPECT_FALSE(b.out().running);
}

TEST(DriveCorePower, AShortDipIsRiddenThrough) {
  Bench b;
  b.mains = false;
  b.run_ms(10);
  EXPECT_FALSE(b.out().gates_on);
  b.mains = true;
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_FALSE(b.out().power_failure);
  EXPECT_EQ(b.out().state, RunState::kConstant);
  EXPECT_EQ(b.hz(), 30);
}

TEST(DriveCorePower, WithoutRestartItStaysOffUntilANewStartEdge) {
  Bench b;
  b.mains = false;
  b.run_ms(100);
  b.mains = true;
  b.run_ms(5000);
  EXPECT_FALSE(b.out().gates_on);
  EXPECT_TRUE(b.out().power_failure);
  EXPECT_EQ(b.out().state, RunState::kPowerFailure);
  b.stop();
  b.tick();
  EXPECT_FALSE(b.out().power_failure);
  EXPECT_EQ(b.out().state, RunState::kStopped);
  b.power.rotor_hz = 0;
  b.forward(30);
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_EQ(b.hz(), 0.5);
}

TEST(DriveCorePower, RestartWaitsThenCatchesTheCoastingMotorWithRisingVoltage) {
  Bench b;
  b.settings.restart_enabled = true;
  b.settings.restart_coast_s = 0.5;
  b.settings.restart_cushion_s = 0.4;
  b.power.load = 0.05;
  b.mains = false;
  b.run_ms(200);
  b.mains = true;
  EXPECT_EQ(b.tick().state, RunState::kRestartWait);
  EXPECT_TRUE(b.out().power_failure);
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.gates_on; }, 2000), 500, 1);
  EXPECT_FALSE(b.out().power_failure);
  const double caught = b.hz();
  EXPECT_NEAR(caught, b.power.rotor_hz, 0.1);
  EXPECT_LT(caught, 24);
  EXPECT_LT(b.out().stage_voltage_peak_v, 1);
  double last = 0;
  for (int i = 0; i < 398; ++i) {
    b.tick();
    ASSERT_GT(b.out().stage_voltage_peak_v, last) << i;
    ASSERT_EQ(b.hz(), caught);
    last = b.out().stage_voltage_peak_v;
  }
  EXPECT_NEAR(last, (16 + 384 * caught / 50) * std::sqrt(2.0 / 3), 3);
  b.run_ms(1500);
  EXPECT_EQ(b.hz(), 30);
}

TEST(DriveCorePower, AStopDuringTheFailureEndsIt) {
  Bench b;
  b.settings.restart_enabled = true;
  b.mains = false;
  b.run_ms(100);
  b.stop();
  b.mains = true;
  b.tick();
  EXPECT_EQ(b.out().state, RunState::kStopped);
  EXPECT_FALSE(b.out().power_failure);
  b.run_ms(3000);
  EXPECT_FALSE(b.out().gates_on);
}

TEST(DriveCorePower, OutputStopHoldsTheRestartBack) {
  Bench b;
  b.settings.restart_enabled = true;
  b.mains = false;
  b.run_ms(100);
  b.mains = true;
  b.command.output_stop = true;
  b.run_ms(3000);
  EXPECT_FALSE(b.out().gates_on);
  b.command.output_stop = false;
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.gates_on; }, 2000), 501, 1);
}

TEST(DriveCorePower, AnotherDipInTheWaitBeginsItAnew) {
  Bench b;
  b.settings.restart_enabled = true;
  b.mains = false;
  b.run_ms(100);
  b.mains = true;
  b.run_ms(400);
  b.mains = false;
  b.run_ms(5);
  b.mains = true;
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.gates_on; }, 2000), 501, 1);
}

TEST(DriveCorePower, ALowLinkAtStandstillOnlyPreventsTheStart) {
  DriveBench b;
  double v = 300;
  b.meddle = [&](Sensors& m) { m.dc_link_v = v; };
  b.run_ms(100);
  EXPECT_FALSE(b.out().power_failure);
  b.forward(20);
  b.run_ms(100);
  EXPECT_FALSE(b.out().gates_on);
  EXPECT_FALSE(b.out().power_failure);
  v = 370;  // above under-voltage, below its clear level
  b.run_ms(10);
  EXPECT_FALSE(b.out().gates_on);
  v = 500;
  EXPECT_TRUE(b.tick().gates_on);
}

TEST(DriveCorePower, TheComparatorAloneShutsTheOutput) {
  DriveBench b;
  b.forward(30);
  b.run_ms(1000);
  b.meddle = [](Sensors& m) {
    m.under_voltage = true;
    m.dc_link_v = 350;
  };
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_EQ(b.out().state, RunState::kPowerFailure);
}

TEST(DriveCorePower, OutputStopInAShortDipWins) {
  Bench b;
  b.mains = false;
  b.run_ms(5);
  b.command.output_stop = true;
  b.tick();
  b.mains = true;
  EXPECT_FALSE(b.tick().gates_on);
  EXPECT_EQ(b.out().state, RunState::kStopped);
}

}  // namespace
}  // namespace vinv::drive
