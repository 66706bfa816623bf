// What parameters of the FR-A700 do to the motor (access, storage, panel): set, and something a user can see must
// follow. Typical for the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

TEST(A700Parameter, Pr77SaysWhichWritesAreAccepted) {
  Bench b = a700_with({{"Pr.79", 1}});
  EXPECT_TRUE(b->set_parameter("Pr.7", 3).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.77", 1).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.7", 4).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.22", 120).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.77", 0).has_value());
  ASSERT_TRUE(b->set_panel_frequency(20).has_value());
  b.key(PanelKey::kFwd);
  b.run(0.5);
  EXPECT_FALSE(b->set_parameter("Pr.7", 4).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.4", 44).has_value());
}

TEST(A700Parameter, Pr160AndPr172ToPr174AreTheUserGroup) {
  Bench b = a700_with({{"Pr.79", 1}});
  ASSERT_TRUE(b->set_parameter("Pr.173", 7).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.173", 8).has_value());
  EXPECT_EQ(b.raw(172), 2u);
  ASSERT_TRUE(b->set_parameter("Pr.174", 8).has_value());
  EXPECT_EQ(b.raw(172), 1u);
  ASSERT_TRUE(b->set_parameter("Pr.160", 1).has_value());
  EXPECT_TRUE(b->get_parameter("Pr.7").has_value());
  EXPECT_FALSE(b->get_parameter("Pr.8").has_value());
  ASSERT_TRUE(b->set_parameter("Pr.160", 9999).has_value());  // simple mode
  EXPECT_TRUE(b->get_parameter("Pr.125").has_value());
  EXPECT_FALSE(b->get_parameter("Pr.44").has_value());
  ASSERT_TRUE(b->set_parameter("Pr.160", 0).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.172", 3).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.172", 9999).has_value());
  EXPECT_EQ(b.raw(172), 0u);
}

TEST(A700Parameter, Pr75SelectsResetPanelSupervisionAndStop) {
  for (int pr75 : {0, 14}) {
    Bench b = a700_with({{"Pr.75", static_cast<double>(pr75)}, {"Pr.4", 30}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(1);
    EXPECT_EQ(b->press_key(PanelKey::kStopReset).has_value(), pr75 == 14);
    b.run(2);
    EXPECT_EQ(b.port().status().running, pr75 == 0);
    if (pr75 == 14) {
      EXPECT_EQ(b->display(), "PS");
    }
  }
}

TEST(A700Parameter, Pr96ArmsAutoTuningThatMeasuresPr90) {
  Bench b = a700_with({{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.96", 1}, {"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(4);
  EXPECT_EQ(b.raw(96), 3u);
  EXPECT_NEAR(b.raw(90) / 1000.0, 3.655, 0.2);
}

TEST(A700Parameter, Pr72IsTheCarrierAndPr244TheFan) {
  EXPECT_EQ(a700_running(20, {{"Pr.72", 5}}).signal("carrier"), 5000);
  EXPECT_EQ(a700_running(20, {{"Pr.72", 0}}).signal("carrier"), 700);
  for (int pr244 : {0, 1}) {
    Bench b = a700_with({{"Pr.244", static_cast<double>(pr244)}});
    b.run(0.1);
    EXPECT_EQ(b.signal("fan"), pr244 == 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
