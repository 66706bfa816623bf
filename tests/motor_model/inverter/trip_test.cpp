// Trips whose causes come out of plant and core, not out of an injection. FR-E500 family; levels in
// motor_model/families/mitsubishi_e500/models.csv.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using testing::HasSubstr;

InverterConfig with_load(double inertia, double constant_nm = 0) {
  InverterConfig c = config_1k5();
  c.load.inertia_kg_m2 = inertia;
  c.load.constant_nm = constant_nm;
  return c;
}

void run_forward(Bench& b, double hz) {
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(hz));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
}

bool reached(Bench& b, double hz) {
  return b.run_until([&] { return b.port().status().up_to_frequency && b.output_hz() > hz - 0.1; }, 20);
}

TEST(Trip, FastStopOfALargeInertiaEndsInOverVoltage) {
  Bench b(with_load(0.2));
  b.preset("Pr.8", 0.5);
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  ASSERT_TRUE(b.command({}));
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 2));
  EXPECT_TRUE(b.alarm("E.OV3"));
  EXPECT_EQ(b.port().active_alarm(), 0x22);
  EXPECT_EQ(b.port().alarm_history()[0], 0x22);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_FALSE(b.port().status().ready);
  EXPECT_TRUE(b.output("ABC"));
  EXPECT_NEAR(b.signal("dc_link"), 800, 5);
  EXPECT_EQ(b->display(), "E.OV3");
  EXPECT_THAT(b->alarm_cause(), HasSubstr("DC link 800 V at "));
  EXPECT_THAT(b->alarm_cause(), HasSubstr("decelerating in 0.5 s with 0.2049 kg m2"));
}

TEST(Trip, ABrakeResistorTakesTheEnergyOfTheSameStop) {
  InverterConfig c = with_load(0.05);
  c.brake_resistance_ohm = 150;
  const auto stop = [](Bench& b) {
    b.preset("Pr.8", 0.8);
    b.preset("Pr.30", 1);
    b.preset("Pr.70", 30);
    run_forward(b, 50);
    ASSERT_TRUE(reached(b, 50));
    ASSERT_TRUE(b.command({}));
    b.run(2);
  };
  Bench with(c);
  stop(with);
  EXPECT_EQ(with->alarm_name(), "") << with->alarm_cause();
  Bench without(with_load(0.05));
  stop(without);
  EXPECT_EQ(without->alarm_name(), "E.OV3");
}

TEST(Trip, ABlockedShaftMeetsStallPreventionThenStopsByOltOrTht) {
  Bench b;
  b.preset("Pr.7", 1);
  b->set_shaft_locked(true);
  run_forward(b, 50);
  bool overload_seen = false;
  ASSERT_TRUE(b.run_until([&] { return overload_seen |= b.port().status().overload, b.port().status().alarm; }, 90));
  EXPECT_TRUE(overload_seen);
  EXPECT_THAT(b->alarm_name(), testing::AnyOf("E.OLT", "E.THT"));
  EXPECT_NEAR(b.signal("speed"), 0, 1e-6);
}

TEST(Trip, ALongOverloadEndsInTheMotorThermal) {
  // About 140 % of Pr.9 from cold: minutes by the curve of Pr.9, before the drive's own overload.
  Bench b(with_load(0, 12.5));
  b.preset("Pr.9", 2.8);
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50)) << b->alarm_cause();
  const double at = b.now_s();
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 900)) << b.signal("output_current");
  EXPECT_TRUE(b.alarm("E.THM")) << b->alarm_cause();
  EXPECT_GT(b.now_s() - at, 60);
  EXPECT_THAT(b->alarm_cause(), HasSubstr("motor thermal set to 2.80 A"));
}

TEST(Trip, AShortAccelerationOfAHeavyLoadWithoutStallPreventionEndsInOverCurrent) {
  Bench b(with_load(0.1, 8));
  b.preset("Pr.7", 0.5);
  b.preset("Pr.22", 0);
  run_forward(b, 50);
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 3));
  EXPECT_TRUE(b.alarm("E.OC1")) << b->alarm_cause();
  EXPECT_EQ(b.port().active_alarm(), 0x10);
  EXPECT_THAT(b->alarm_cause(), HasSubstr("accelerating in 0.5 s"));
  EXPECT_THAT(b->alarm_cause(), HasSubstr("A peak (level 11.3 A)"));
}

TEST(Trip, StallPreventionKeepsTheSameAccelerationAlive) {
  Bench b(with_load(0.1, 8));
  b.preset("Pr.7", 0.5);
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50)) << b->alarm_name() << " " << b->alarm_cause();
}

TEST(Trip, AHotPlaceEndsInHeatSinkOverTemperature) {
  InverterConfig c = with_load(0, 8);
  c.ambient_c = 80;
  Bench b(c);
  run_forward(b, 50);
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 900)) << b.signal("heat_sink");
  EXPECT_TRUE(b.alarm("E.FIN")) << b->alarm_cause();
  EXPECT_THAT(b->alarm_cause(), HasSubstr("heat sink 95 degC (level 95 degC)"));
}

TEST(Trip, MainsThatAreTooHighTripOverVoltage) {
  Bench b;
  b.power_on();
  b->set_mains({.voltage_v_rms = 590});
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 1));
  EXPECT_THAT(b->alarm_name(), testing::StartsWith("E.OV"));
  b.key(PanelKey::kStopReset);
  b.run(1.2);
  EXPECT_THAT(b->alarm_name(), testing::StartsWith("E.OV"));  // the cause is still there
}

// --- mains dips: Pr.57 and 58 ---

plant::MainsState mains(double v) { return {.voltage_v_rms = v}; }

void dip(Bench& b, double seconds) {
  b->set_mains(mains(0));
  b.run(seconds);
  b->set_mains(mains(400));
}

TEST(PowerFailure, ShutsTheOutputOffWithIpfAndWithoutAlarm) {
  Bench b(with_load(0.05, 4));
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  b->set_mains(mains(0));
  ASSERT_TRUE(b.run_until([&] { return b.port().status().power_failure; }, 0.3));
  EXPECT_FALSE(b.port().status().running);
  EXPECT_FALSE(b.port().status().alarm);
  EXPECT_EQ(b.port().active_alarm(), 0);
  EXPECT_EQ(b.port().alarm_history()[0], 0);
  EXPECT_EQ(b->alarm_name(), "");
}

// The link of 300 V mains is above the under-voltage level, and the pre-charge resistor must stay out of its way.
TEST(PowerFailure, AQuarterLessVoltageIsRiddenThrough) {
  Bench b(with_load(0.05, 4));
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  b->set_mains(mains(300));
  for (int i = 0; i < 1000; ++i) {
    b.tick();
    ASSERT_TRUE(b.port().status().running) << b.signal("dc_link");
  }
  EXPECT_NEAR(b.signal("dc_link"), 415, 10);  // 424 V less what the supply drops
}

TEST(PowerFailure, WithoutRestartANewStartEdgeIsNeeded) {
  Bench b(with_load(0.05, 4));
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  dip(b, 0.1);
  b.run(3);
  ASSERT_TRUE(b.port().ready());
  EXPECT_FALSE(b.port().status().running);
  ASSERT_TRUE(b.command({}));
  b.run(0.1);
  EXPECT_FALSE(b.port().status().power_failure);
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.2);
  EXPECT_TRUE(b.port().status().running);
}

TEST(PowerFailure, WithRestartTheDriveCatchesTheMotor) {
  Bench b(with_load(0.05, 4));
  b.preset("Pr.57", 0.5);
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  dip(b, 0.1);
  b.run(0.3);
  EXPECT_FALSE(b.port().status().running);  // waits Pr.57
  ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 2));
  ASSERT_TRUE(reached(b, 50)) << b->alarm_name() << " " << b->alarm_cause();
  EXPECT_FALSE(b.port().status().power_failure);
}

TEST(PowerFailure, ZeroInPr57WaitsTheTimeOfTheModel) {
  Bench b(with_load(0.05, 4));
  b.preset("Pr.57", 0);
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  dip(b, 0.1);
  const double back_s = b.now_s();
  ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 3));
  EXPECT_NEAR(b.now_s() - back_s, 0.5, 0.1);
}

TEST(PowerFailure, ALongOneTakesTheControlDown) {
  Bench b(with_load(0.05, 4));
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  b->set_mains(mains(0));
  ASSERT_TRUE(b.run_until([&] { return !b->powered(); }, 60));
  EXPECT_FALSE(b.port().ready());
  EXPECT_EQ(b->display(), "");
  EXPECT_FALSE(b.port().read_parameter({7, 0}).has_value());
  b->set_mains(mains(400));
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b.port().operation_mode(), port::OperationMode::kExternal);
  EXPECT_FALSE(b.port().status().running);
}

// --- supply ---

TEST(Supply, StartsUpAfterThePreCharge) {
  Bench b;
  EXPECT_FALSE(b->powered());
  EXPECT_FALSE(b.port().ready());
  b->set_power(true);
  EXPECT_TRUE(b->powered());
  const double at = b.now_s();
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_GE(b.now_s() - at, 0.3);
  EXPECT_LT(b.now_s() - at, 0.5);
  EXPECT_NEAR(b.signal("dc_link"), 560, 10);
}

TEST(Supply, SwitchedOffWhileRunningTheMotorCoastsAndTheLinkFalls) {
  Bench b(with_load(0.05));
  run_forward(b, 50);
  ASSERT_TRUE(reached(b, 50));
  b->set_power(false);
  ASSERT_TRUE(b.run_until([&] { return !b->powered(); }, 60));
  EXPECT_GT(b.signal("speed"), 500);
  EXPECT_LT(b.signal("dc_link"), 200);
  EXPECT_EQ(b.output_hz(), 0);
}

TEST(Supply, PowerOffClearsTheThermalAccumulator) {
  Bench b(with_load(0, 12.5));
  b.preset("Pr.9", 2.8);
  run_forward(b, 50);
  b.run(60);
  ASSERT_GT(b.signal("motor_thermal"), 10);
  b.power_cycle();
  b.run(0.1);
  EXPECT_LT(b.signal("motor_thermal"), 1);
}

}  // namespace
}  // namespace vinv::inverter::test
