// Alarms of the FR-E500 whose cause is motor, load and mains alone: each one of the over-current and over-voltage
// alarms in the ramp that names it, stall prevention and inverter overload apart. Levels:
// families/mitsubishi_e500/models.csv.
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

using testing::HasSubstr;

plant::LoadSettings hoist(double nm) {
  plant::LoadSettings load;
  load.hoist_nm = nm;
  return load;
}

// The alarm within a time; empty if there is none.
std::string alarm_within(Bench& b, double seconds) {
  b.run_until([&] { return !b->alarm_name().empty(); }, seconds);
  return b->alarm_name();
}

TEST(AlarmCause, AShaftBlockedAtConstantSpeedIsOc2WithoutCurrentLimits) {
  Bench b = drive_with({{"Pr.7", 2}, {"Pr.22", 0}});
  start(b, 50);
  b.run(3);
  b->set_shaft_locked(true);
  EXPECT_EQ(alarm_within(b, 0.5), "E.OC2") << b->alarm_cause();
  EXPECT_THAT(b->alarm_cause(), HasSubstr("at constant speed"));
}

TEST(AlarmCause, AShaftBlockedInADecelerationIsOc3WithoutCurrentLimits) {
  Bench b = drive_with({{"Pr.7", 2}, {"Pr.8", 10}, {"Pr.22", 0}});
  start(b, 50);
  b.run(3);
  stop(b);
  b.run(1);
  b->set_shaft_locked(true);
  EXPECT_EQ(alarm_within(b, 0.5), "E.OC3") << b->alarm_cause();
}

TEST(AlarmCause, ALoadThatDrivesTheMotorUpIsOv1) {
  // Lowering a hoist: the acceleration ends with the load pushing.
  Bench b = drive_with({{"Pr.7", 10}}, loaded(0.01));
  start(b, 50);
  b.run(4);
  b->set_load(hoist(-8));
  EXPECT_EQ(alarm_within(b, 3), "E.OV1") << b->alarm_cause();
  EXPECT_THAT(b->alarm_cause(), HasSubstr("accelerating in 10 s"));
}

TEST(AlarmCause, ALoadThatDrivesTheMotorAtConstantSpeedIsOv2) {
  Bench b = drive_with({{"Pr.7", 2}}, loaded(0.01));
  start(b, 50);
  b.run(3);
  b->set_load(hoist(-8));
  EXPECT_EQ(alarm_within(b, 3), "E.OV2") << b->alarm_cause();
  EXPECT_NEAR(b.signal("dc_link"), 800, 5);
}

TEST(AlarmCause, TheSameLoadWithABrakeResistorIsNone) {
  InverterConfig c = loaded(0.01);
  c.brake_resistance_ohm = 150;
  Bench b = drive_with({{"Pr.7", 2}, {"Pr.30", 1}, {"Pr.70", 30}}, c);
  start(b, 50);
  b.run(3);
  b->set_load(hoist(-8));
  EXPECT_EQ(alarm_within(b, 3), "") << b->alarm_cause();
  EXPECT_GT(b.signal("brake_power"), 300);
}

TEST(AlarmCause, AMotorPulledDownToStandstillIsOltAfterThreeSeconds) {
  // The boost alone is more than the stall level, and less than what overloads the inverter in that time.
  Bench b = drive_with({{"Pr.7", 2}, {"Pr.22", 100}, {"Pr.0", 8}});
  b->set_shaft_locked(true);
  start(b, 50);
  b.run(0.3);
  ASSERT_TRUE(b.run_until([&] { return b.output_hz() < 0.6; }, 10));
  const double at = b.now_s();
  EXPECT_EQ(alarm_within(b, 10), "E.OLT") << b->alarm_cause();
  EXPECT_NEAR(b.now_s() - at, 3, 0.2);
  EXPECT_THAT(b->alarm_cause(), HasSubstr("shaft locked"));
}

TEST(AlarmCause, TooMuchCurrentForLongIsTht) {
  // Some 125 % of the rated current, below the stall level, for minutes; the motor's own thermal is off.
  Bench b = drive_with({{"Pr.7", 3}, {"Pr.22", 200}, {"Pr.9", 0}, {"Pr.0", 6}}, loaded(0, 16));
  start(b, 50);
  b.run(10);
  EXPECT_GT(b.signal("inverter_thermal"), 0.5);
  EXPECT_LT(b.signal("inverter_thermal"), 50);
  EXPECT_EQ(alarm_within(b, 900), "E.THT") << b->alarm_cause();
  EXPECT_GT(b.now_s(), 60);
  EXPECT_THAT(b->alarm_cause(), HasSubstr("rated 4.00 A, for too long"));
}

}  // namespace
}  // namespace vinv::inverter::test
