// Trips whose causes come out of plant and core, not out of an injection. FR-E500 family; numbers in data files.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;

InverterConfig with_load(double inertia, double constant_nm = 0) {
  InverterConfig c = config_1k5();
  c.load.inertia_kg_m2 = inertia;
  c.load.constant_nm = constant_nm;
  return c;
}

TEST(Trip, FastStopOfALargeInertiaEndsInOverVoltage) {
  Bench b(with_load(0.2));
  b.preset("Pr.8", 0.5);
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(50));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  ASSERT_TRUE(b.run_until([&] { return b.port().status().up_to_frequency && b.output_hz() > 49.9; }, 12));
  ASSERT_TRUE(b.command({}));
  ASSERT_TRUE(b.run_until([&] { return b.port().status().alarm; }, 2));
  EXPECT_TRUE(b.alarm("E.OV3"));
  EXPECT_EQ(b.port().active_alarm(), 0x22);
  EXPECT_EQ(b.port().alarm_history()[0], 0x22);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_NEAR(b.signal("dc_link"), 800, 5);
  EXPECT_EQ(b->display(), "E.OV3");
  EXPECT_THAT(b->alarm_cause(), testing::HasSubstr("decelerating in 0.5 s with 0.2049 kg m2"));
  EXPECT_THAT(b->alarm_cause(), testing::HasSubstr("DC link 800 V"));
}

}  // namespace
}  // namespace vinv::inverter::test
