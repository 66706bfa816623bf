// Trips: what they are called, that they shut the output, how they are reset.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <functional>

#include "drive_bench.hpp"

namespace vinv::drive {
namespace {

void prepare(DriveBench& b, RunState state) {
  b.forward(30);
  if (state == RunState::kStopped) {
    b.stop();
    b.tick();
  } else if (state == RunState::kAccelerating) {
    b.run_ms(1000);
  } else {
    b.ms_until_state(RunState::kConstant, 6000);
    b.run_ms(500);
    if (state == RunState::kDecelerating) {
      b.stop();
      b.run_ms(200);
    }
  }
  ASSERT_EQ(b.out().state, state);
}

TEST(DriveCoreTrip, ComparatorsAreNamedByTheRampAtThatInstant) {
  struct Case {
    RunState state;
    TripKind over_current, over_voltage;
  };
  for (const Case& c :
       {Case{RunState::kAccelerating, TripKind::kOverCurrentAcceleration, TripKind::kOverVoltageAcceleration},
        Case{RunState::kConstant, TripKind::kOverCurrentConstant, TripKind::kOverVoltageConstant},
        Case{RunState::kDecelerating, TripKind::kOverCurrentDeceleration, TripKind::kOverVoltageDeceleration},
        Case{RunState::kStopped, TripKind::kOverCurrentDeceleration, TripKind::kOverVoltageDeceleration}}) {
    for (const bool current : {true, false}) {
      DriveBench b;
      prepare(b, c.state);
      const double hz = b.hz();
      b.meddle = [current](Sensors& m) {
        (current ? m.over_current : m.over_voltage) = true;
        m.comparator_value = current ? 11.4 : 801;
        m.comparator_after = std::chrono::microseconds(321);
      };
      const DriveOutputs& o = b.tick();
      ASSERT_TRUE(o.trip);
      EXPECT_EQ(o.trip->kind, current ? c.over_current : c.over_voltage);
      EXPECT_EQ(o.trip->after, std::chrono::microseconds(321));
      EXPECT_EQ(o.trip->value, current ? 11.4 : 801);
      EXPECT_NEAR(o.trip->level, current ? 11.3137 : 800, 1e-3);
      EXPECT_EQ(o.trip->state, c.state);
      EXPECT_EQ(o.trip->output_frequency_hz, hz);
      EXPECT_EQ(o.state, RunState::kTripped);
      EXPECT_FALSE(o.gates_on);
      EXPECT_FALSE(o.running);
      EXPECT_EQ(o.output_frequency_hz, 0);
      b.meddle = nullptr;
      b.forward(30);
      EXPECT_FALSE(b.tick().trip);  // reported once
      b.run_ms(1000);
      EXPECT_FALSE(b.out().gates_on);
      b.core.reset(DriveCore::Accumulators::kKeep);
      EXPECT_EQ(b.out().state, RunState::kStopped);
      EXPECT_TRUE(b.tick().gates_on);
    }
  }
}

TEST(DriveCoreTrip, DcBrakingCountsAsStopping) {
  DriveBench b;
  b.settings.dc_brake_s = 2;
  b.forward(5);
  b.run_ms(1000);
  b.stop();
  b.ms_until_state(RunState::kDcBraking, 2000);
  b.meddle = [](Sensors& m) { m.over_current = true; };
  b.tick();
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kOverCurrentDeceleration);
}

TEST(DriveCoreTrip, SensorCausesTripWithTheirKind) {
  struct Case {
    const char* name;
    std::function<void(Sensors&)> cause;
    TripKind kind;
    int within_ms;
  };
  for (const Case& c :
       {Case{"heat sink", [](Sensors& m) { m.heat_sink_c = 95; }, TripKind::kHeatSink, 1},
        Case{"chopper", [](Sensors& m) { m.chopper_failed = true; }, TripKind::kBrakeTransistor, 1},
        Case{"phase", [](Sensors& m) { m.output_phase_open = true; }, TripKind::kOutputPhaseLoss, 501}}) {
    DriveBench b;
    prepare(b, RunState::kConstant);
    b.meddle = c.cause;
    EXPECT_EQ(b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 2000), c.within_ms) << c.name;
    EXPECT_EQ(b.tripped->kind, c.kind) << c.name;
    EXPECT_FALSE(b.out().gates_on);
    // While the cause lasts a reset does not help.
    b.core.reset(DriveCore::Accumulators::kKeep);
    b.run_ms(600);
    EXPECT_EQ(b.out().state, RunState::kTripped) << c.name;
  }
}

TEST(DriveCoreTrip, ExternalThermalTripsAlsoAtStandstill) {
  DriveBench b;
  b.tick();
  b.command.external_thermal = true;
  b.tick();
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kExternalThermal);
}

TEST(DriveCoreTrip, PhaseLossNeedsProtectionOutputAndPersistence) {
  DriveBench b;
  b.settings.output_phase_loss_protection = false;
  prepare(b, RunState::kConstant);
  b.meddle = [](Sensors& m) { m.output_phase_open = true; };
  b.run_ms(2000);
  EXPECT_FALSE(b.tripped);
  b.settings.output_phase_loss_protection = true;
  b.run_ms(400);
  EXPECT_FALSE(b.tripped);
  b.command.output_stop = true;
  b.run_ms(2000);
  EXPECT_FALSE(b.tripped);
}

TEST(DriveCoreTrip, EarthFaultIsTestedAtTheStartOnly) {
  DriveBench b;
  prepare(b, RunState::kConstant);
  b.meddle = [](Sensors& m) { m.earth_fault = true; };
  b.run_ms(1000);
  EXPECT_FALSE(b.tripped);
  b.command.output_stop = true;
  b.run_ms(100);
  EXPECT_FALSE(b.tripped);
  b.command.output_stop = false;
  EXPECT_FALSE(b.tick().gates_on);
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kEarthFault);
  b.core.reset(DriveCore::Accumulators::kKeep);
  b.settings.earth_fault_detection = false;
  b.tripped.reset();
  EXPECT_TRUE(b.tick().gates_on);
  EXPECT_FALSE(b.tripped);
}

TEST(DriveCoreTrip, OverVoltageTripsAgainWhileTheLinkIsHigh) {
  DriveBench b;
  b.tick();
  b.meddle = [](Sensors& m) { m.dc_link_v = 805; };
  b.tick();
  ASSERT_TRUE(b.tripped);
  b.tripped.reset();
  b.core.reset(DriveCore::Accumulators::kKeep);
  b.tick();
  EXPECT_TRUE(b.tripped);
  b.meddle = nullptr;
  b.core.reset(DriveCore::Accumulators::kKeep);
  EXPECT_EQ(b.tick().state, RunState::kStopped);
}

TEST(DriveCoreTrip, MotorOverloadTripsByItsCurveAfterThePreAlarm) {
  DriveBench b;
  b.settings.stall_level_percent = 0;
  b.settings.inverter_overload_start_percent = 1000;
  b.settings.acceleration_s = 1;
  b.forward(50);
  b.ms_until_state(RunState::kConstant, 6000);
  b.run_ms(500);
  b.meddle = [](Sensors& m) { m.current_a_rms = 6; };
  int pre_alarm_ms = -1, ms = 0;
  while (!b.tripped && ms < 300'000) {
    b.tick();
    ++ms;
    if (pre_alarm_ms < 0 && b.out().thermal_pre_alarm) pre_alarm_ms = ms;
  }
  ASSERT_TRUE(b.tripped);
  EXPECT_EQ(b.tripped->kind, TripKind::kMotorOverload);
  EXPECT_NEAR(ms, 252'000, 5000);
  EXPECT_GT(pre_alarm_ms, 150'000);
  EXPECT_LT(pre_alarm_ms, ms);
  // The state survives a reset, so the next start trips at once; power-off clears it.
  b.core.reset(DriveCore::Accumulators::kKeep);
  b.tripped.reset();
  b.run_ms(2);
  EXPECT_TRUE(b.tripped);
  b.tripped.reset();
  b.core.reset(DriveCore::Accumulators::kClear);
  b.power.rotor_hz = 0;
  b.run_ms(100);
  EXPECT_FALSE(b.tripped);
  EXPECT_LT(b.out().motor_thermal_fraction, 0.01);
}

TEST(DriveCoreTrip, AThermalStateAtStandstillDoesNotTrip) {
  DriveBench b;
  b.settings.electronic_thermal_a_rms = 1;
  prepare(b, RunState::kConstant);
  b.meddle = [](Sensors& m) { m.current_a_rms = 5; };
  b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 100'000);
  ASSERT_TRUE(b.tripped);
  b.meddle = nullptr;
  b.stop();
  b.tripped.reset();
  b.core.reset(DriveCore::Accumulators::kKeep);
  b.run_ms(10);
  EXPECT_FALSE(b.tripped);
  EXPECT_EQ(b.out().state, RunState::kStopped);
}

TEST(DriveCoreTrip, InverterOverloadTripsByItsCurve) {
  DriveBench b;
  b.settings.stall_level_percent = 0;
  b.settings.fast_current_limit = false;
  b.settings.electronic_thermal_a_rms = 0;
  prepare(b, RunState::kConstant);
  b.meddle = [](Sensors& m) { m.current_a_rms = 7.2; };  // 180 %
  EXPECT_NEAR(b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 20'000), 9940, 200);
  EXPECT_EQ(b.tripped->kind, TripKind::kInverterOverload);
}

TEST(DriveCoreTrip, AForcedTripShutsTheOutputBeforeTheNextTick) {
  DriveBench b;
  prepare(b, RunState::kConstant);
  b.core.force_trip();
  EXPECT_FALSE(b.out().gates_on);
  EXPECT_EQ(b.out().state, RunState::kTripped);
  EXPECT_EQ(b.out().stage_voltage_peak_v, 0);
  b.run_ms(1000);
  EXPECT_FALSE(b.out().gates_on);
  EXPECT_FALSE(b.tripped);
  b.core.reset(DriveCore::Accumulators::kKeep);
  EXPECT_TRUE(b.tick().gates_on);
}

TEST(DriveCoreTrip, NothingTripsWithoutPermitButTheCauseWaits) {
  DriveBench b;
  b.command.permit = false;
  b.meddle = [](Sensors& m) { m.heat_sink_c = 120; };
  b.run_ms(100);
  EXPECT_FALSE(b.tripped);
  b.command.permit = true;
  b.tick();
  EXPECT_TRUE(b.tripped);
}

TEST(DriveCoreTrip, EarthFaultTestLastsATenthOfASecond) {
  for (const int ms : {50, 150}) {
    DriveBench b;
    b.forward(30);
    b.run_ms(ms);
    b.meddle = [](Sensors& m) { m.earth_fault = true; };
    b.run_ms(200);
    EXPECT_EQ(b.tripped.has_value(), ms < 100) << ms;
  }
}

TEST(DriveCoreTrip, AnOverloadedInverterAtStandstillDoesNotTripAgain) {
  DriveBench b;
  b.settings.stall_level_percent = 0;
  b.settings.electronic_thermal_a_rms = 0;
  prepare(b, RunState::kConstant);
  b.meddle = [](Sensors& m) { m.current_a_rms = 7.2; };
  b.ms_until([](const DriveOutputs& o) { return o.trip.has_value(); }, 20'000);
  ASSERT_TRUE(b.tripped);
  // The sensors still show the current for a moment.
  b.stop();
  b.tripped.reset();
  b.core.reset(DriveCore::Accumulators::kKeep);
  b.tick();
  EXPECT_FALSE(b.tripped);
  EXPECT_EQ(b.out().state, RunState::kStopped);
}

TEST(DriveCoreTrip, MotorOverloadCountsFasterAtLowSpeedWithoutForcedCooling) {
  std::array<double, 3> fraction{};
  for (std::size_t i = 0; i < fraction.size(); ++i) {
    DriveBench b;
    b.settings.acceleration_s = 0.5;
    b.settings.motor_forced_cooling = i == 2;
    b.forward(i == 0 ? 50 : 5);
    b.meddle = [](Sensors& m) { m.current_a_rms = 4; };
    b.run_ms(20'000);
    fraction[i] = b.out().motor_thermal_fraction;
  }
  EXPECT_NEAR(fraction[1] / fraction[0], 4, 0.15);  // (1 / 0.5)^2
  EXPECT_NEAR(fraction[2] / fraction[0], 1, 0.05);
}

}  // namespace
}  // namespace vinv::drive
