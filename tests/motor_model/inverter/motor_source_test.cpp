// The motor beside the inverter: on the mains, on nothing, and back; what the inverter sees of it.
#include <gtest/gtest.h>

#include "tests/motor_model/inverter/bench.hpp"

namespace vinv::inverter::test {
namespace {

using plant::MainsState;
using plant::MotorSource;

TEST(MotorSource, OnTheMainsTheMotorRunsWithoutTheInvertersSupply) {
  Bench b;
  ASSERT_TRUE(b->set_motor_source(MotorSource::kMains).has_value());
  b.run(2);
  EXPECT_FALSE(b->powered());
  EXPECT_NEAR(b.signal("speed"), 1495, 10);
  EXPECT_NEAR(b.signal("motor_voltage"), 400, 1e-6);
  EXPECT_GT(b.signal("motor_current"), 1);
  EXPECT_EQ(b.signal("output_current"), 0);
  b.power_on();
  EXPECT_NEAR(b.signal("motor_voltage"), 400, 1e-6);
}

TEST(MotorSource, ALostPhaseOpensTheContactorAndADipLowersTheVoltage) {
  Bench b;
  ASSERT_TRUE(b->set_motor_source(MotorSource::kMains).has_value());
  b.run(2);
  b->set_mains({.voltage_v_rms = 240});
  b.run(0.01);
  EXPECT_NEAR(b.signal("motor_voltage"), 240, 1e-6);
  b->set_mains({.voltage_v_rms = 400, .phase_present = {true, false, true}});
  b.run(0.01);
  EXPECT_EQ(b.signal("motor_current"), 0);
  b->set_mains({.voltage_v_rms = 400});
  b.run(1);
  EXPECT_GT(b.signal("motor_current"), 1);
}

// The commercial switch-over by hand: the inverter brings the motor up, contactors put it on the mains and back.
TEST(MotorSource, TheInverterRunsOnWithoutCurrentWhileTheMotorIsAway) {
  Bench b = fast();
  b.pu();
  ASSERT_TRUE(b->set_panel_frequency(50).has_value());
  b.key(PanelKey::kFwd);
  ASSERT_TRUE(runs_at(b, 50));
  const double with_motor = b.signal("output_current");
  EXPECT_EQ(with_motor, b.signal("motor_current"));
  EXPECT_GT(with_motor, 1);
  ASSERT_TRUE(b->set_motor_source(MotorSource::kOpen).has_value());
  b.run(0.005);
  EXPECT_EQ(b.signal("output_current"), 0);
  EXPECT_GT(b.signal("motor_voltage"), 100) << "what the flux still induces";
  ASSERT_TRUE(b->set_motor_source(MotorSource::kMains).has_value());
  b.run(1);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_EQ(b.output_a(), 0);
  EXPECT_NEAR(b.output_hz(), 50, 0.02);
  EXPECT_NEAR(b.signal("speed"), 1495, 10);
  EXPECT_EQ(b->alarm_name(), "");
}

TEST(MotorSource, WithoutATableThereIsNothingToPutTheMotorOn) {
  Bench b;
  const auto refusal = b->set_motor_source(MotorSource::kTable);
  ASSERT_FALSE(refusal.has_value());
  EXPECT_EQ(refusal.error(), "the plant file has no voltage_table for this drive");
  EXPECT_EQ(b->plant().motor_source(), MotorSource::kInverter);
}

TEST(MotorSource, ASnapshotKeepsTheMotorWhereItHangs) {
  Bench one, two;
  one->set_mains({.voltage_v_rms = 380});
  ASSERT_TRUE(one->set_motor_source(MotorSource::kMains).has_value());
  while (!one->on_snapshot_grid() || one.now_s() < 5.3) one.tick();
  two.run(one.now_s() - two.now_s());
  Bytes bytes;
  ASSERT_TRUE(one->save(bytes).has_value());
  ASSERT_TRUE(two->load(bytes).has_value());
  for (Bench* b : {&one, &two}) b->run(0.25);
  EXPECT_EQ(two->plant().motor_source(), MotorSource::kMains);
  EXPECT_GT(two.signal("speed"), 100);
  for (const char* name : {"speed", "torque", "motor_current", "motor_voltage"})
    EXPECT_EQ(one.signal(name), two.signal(name)) << name;
}

}  // namespace
}  // namespace vinv::inverter::test
