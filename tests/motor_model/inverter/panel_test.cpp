// Operation panel of the FR-E500: keys, display, jog, PS, parameters with the panel's rules.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::OperationMode;
using testing::HasSubstr;

TEST(Panel, KeysRunStopAndChangeTheMode) {
  Bench b = fast();
  EXPECT_EQ(b->display(), "0.00");
  EXPECT_EQ(b->press_key(PanelKey::kFwd).error(), "FWD and REV start in PU operation; it is in external operation");
  b.pu();
  ASSERT_TRUE(b->set_panel_frequency(20).has_value());
  EXPECT_EQ(b->set_panel_frequency(121).error(), "the frequency takes 0 to 120.00 Hz");
  b.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(b, 20));
  EXPECT_EQ(b->display(), "20.00");
  EXPECT_FALSE(b->press_key(PanelKey::kPuExt).has_value());
  b.key(PanelKey::kUp);
  EXPECT_TRUE(runs_at(b, 20.1));
  b.key(PanelKey::kDown);
  b.key(PanelKey::kDown);
  EXPECT_TRUE(runs_at(b, 19.9));
  b.key(PanelKey::kSet);
  EXPECT_EQ(b->display(), [&] {
    char t[16];
    std::snprintf(t, sizeof t, "%.2f", b.output_a());
    return std::string(t);
  }());
  b.key(PanelKey::kStopReset);
  EXPECT_TRUE(stands(b));
  b.key(PanelKey::kPuExt);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(Panel, FrequencyScreenStoresWithSet) {
  Bench b = fast();
  b.pu();
  b.key(PanelKey::kMode);
  for (int i = 0; i < 25; ++i) b.key(PanelKey::kUp);
  EXPECT_EQ(b->display(), "2.50");
  EXPECT_EQ(b.signal("set_frequency"), 0);
  b.key(PanelKey::kSet);
  b.tick();
  EXPECT_EQ(b.signal("set_frequency"), 2.5);
  EXPECT_THAT(b->eeprom_text(), HasSubstr("panel_frequency_0.01Hz = 250\n"));
}

TEST(Panel, JogRunsAtPr15) {
  Bench b = fast({{"Pr.15", 7}, {"Pr.16", 0.3}});
  b.pu();
  ASSERT_TRUE(b->set_panel_frequency(40).has_value());
  b.key(PanelKey::kMode);
  b.key(PanelKey::kMode);
  EXPECT_EQ(b->display(), "JOG");
  b.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(b, 7));
  EXPECT_FALSE(b->press_key(PanelKey::kMode).has_value());
  b.key(PanelKey::kStopReset);
  ASSERT_TRUE(stands(b));
  b.key(PanelKey::kMode);
  b.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(b, 40));
}

TEST(Panel, StopOutsidePuOperationIsPsUntilReleased) {
  Bench b = fast();
  b.terminal("RM");
  b.terminal("STF");
  ASSERT_TRUE(runs_at(b, 30));
  b.key(PanelKey::kStopReset);  // Pr.75 = 14
  EXPECT_TRUE(stands(b));
  EXPECT_EQ(b->display(), "PS");
  EXPECT_EQ(b->press_key(PanelKey::kPuExt).error(), "PS: the start signals must be off first");
  b.terminal("STF", false);
  b.tick();
  b.key(PanelKey::kPuExt);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
  Bench plain = fast({{"Pr.75", 0}});
  plain.terminal("RM");
  plain.terminal("STF");
  ASSERT_TRUE(runs_at(plain, 30));
  EXPECT_FALSE(plain->press_key(PanelKey::kStopReset).has_value());
  EXPECT_TRUE(runs_at(plain, 30));
}

TEST(Panel, DisplayFollowsPr52AndPr37) {
  Bench b = fast({{"Pr.52", 100}, {"Pr.37", 1800}});
  b.terminal("RM");
  b.run(0.1);
  EXPECT_EQ(b->display(), "900.0");  // set frequency 30 Hz as machine speed
  Bench hours = fast({{"Pr.52", 23}});
  EXPECT_EQ(hours->display(), "0");
}

TEST(Panel, ParametersAreWrittenWithThePanelsRules) {
  Bench b = fast();
  EXPECT_THAT(b->set_parameter("Pr.7", 3).error(), HasSubstr("Pr.7 is written from the panel in PU operation"));
  b.pu();
  EXPECT_TRUE(b->set_parameter("Pr.7", 3).has_value());
  EXPECT_THAT(b->set_parameter("Pr.7", 3.05).error(), HasSubstr("takes 0.0 to 3600.0 s in steps of 0.1"));
  EXPECT_THAT(b->set_parameter("Pr.28", 0).error(), HasSubstr("there is no parameter Pr.28"));
  EXPECT_EQ(b->set_parameter("Pr.146", 0).error(), "Pr.146 cannot be written");
  b.key(PanelKey::kFwd);
  ASSERT_TRUE(b->set_panel_frequency(10).has_value());
  b.run(0.2);
  EXPECT_EQ(b->set_parameter("Pr.7", 4).error(), "Pr.7 cannot be written while the inverter runs");
  EXPECT_EQ(b->set_parameter("ALLC", 1).error(), "ALLC needs a stopped inverter");
  b.key(PanelKey::kStopReset);
  ASSERT_TRUE(stands(b));
  EXPECT_TRUE(b->set_parameter("ALLC", 1).has_value());
  EXPECT_EQ(b->get_parameter("Pr.7").value(), 5);
  EXPECT_TRUE(b->set_parameter("Pr.77", 1).has_value());
  EXPECT_EQ(b->set_parameter("Pr.7", 4).error(), "Pr.7 is locked by Pr.77 = 1");
  EXPECT_EQ(b->set_parameter("Pr.CL", 1).error(), "Pr.CL is locked by Pr.77 = 1");
  EXPECT_TRUE(b->set_parameter("Er.CL", 1).has_value());
}

TEST(Panel, IsDarkWithoutSupply) {
  Bench b;
  EXPECT_EQ(b->display(), "");
  EXPECT_FALSE(b->press_key(PanelKey::kFwd).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.7", 3).has_value());
}

}  // namespace
}  // namespace vinv::inverter::test
