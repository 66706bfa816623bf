// Frequency sources of the FR-E500 and their priority, on the bench with motor.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;

TEST(Frequency, Terminal2ByRangeAndCalibration) {
  Bench b = fast();
  b.terminal("STF");
  ASSERT_TRUE(b->set_analog("2", 6).has_value());
  EXPECT_TRUE(runs_at(b, 30));
  b.terminal("STF", false);
  ASSERT_TRUE(stands(b));
  Bench five = fast({{"Pr.73", 0}, {"Pr.38", 60}});
  five.terminal("STF");
  ASSERT_TRUE(five->set_analog("2", 2.5).has_value());
  EXPECT_TRUE(runs_at(five, 30));
  Bench biased = fast({{"Pr.902.1", 10}, {"Pr.902.2", 0}, {"Pr.903.1", 50}});
  biased.terminal("STF");
  ASSERT_TRUE(biased->set_analog("2", 5).has_value());
  EXPECT_TRUE(runs_at(biased, 30));
}

TEST(Frequency, Terminal4NeedsAuAndTakesTheSpeedFromTerminal2) {
  Bench b = fast({{"Pr.183", 4}});
  b.terminal("STF");
  ASSERT_TRUE(b->set_analog("2", 2).has_value());
  ASSERT_TRUE(b->set_analog("4", 12).has_value());
  EXPECT_TRUE(runs_at(b, 10));
  b.terminal("MRS");
  EXPECT_TRUE(runs_at(b, 25));
  b.terminal("RM");
  EXPECT_TRUE(runs_at(b, 30));  // a speed signal goes before both
}

TEST(Frequency, Pr74FiltersTheInput) {
  const auto after_50_ms = [](double pr74) {
    Bench b = fast({{"Pr.74", pr74}});
    EXPECT_TRUE(b->set_analog("2", 10).has_value());
    b.run(0.05);
    return b.signal("set_frequency");
  };
  EXPECT_GT(after_50_ms(0), 49);
  EXPECT_LT(after_50_ms(8), 5);
}

TEST(Frequency, CombinedModesSplitStartAndSpeed) {
  Bench one = fast({{"Pr.79", 3}});
  ASSERT_TRUE(one->set_panel_frequency(22).has_value());
  EXPECT_FALSE(one->press_key(PanelKey::kFwd).has_value());
  one.terminal("STF");
  EXPECT_TRUE(runs_at(one, 22));
  one.terminal("RM");
  EXPECT_TRUE(runs_at(one, 30));
  Bench two = fast({{"Pr.79", 4}});
  EXPECT_FALSE(two->set_panel_frequency(22).has_value());
  ASSERT_TRUE(two->set_analog("2", 4).has_value());
  two.terminal("STR");  // has no meaning here
  EXPECT_TRUE(stands(two));
  two.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(two, 20));
  two.key(PanelKey::kStopReset);
  EXPECT_TRUE(stands(two));
}

TEST(Frequency, PuOperationIgnoresSpeedSignals) {
  Bench b = fast();
  b.terminal("RM");
  b.pu();
  ASSERT_TRUE(b->set_panel_frequency(15).has_value());
  b.key(PanelKey::kRev);
  EXPECT_TRUE(runs_at(b, 15));
  EXPECT_TRUE(b.port().status().reverse);
}

TEST(Frequency, RemoteSettingByRhRmAndRl) {
  Bench b = fast({{"Pr.59", 1}, {"Pr.44", 5}});  // 10 Hz per second
  b.terminal("STF");
  b.terminal("RH");
  b.run(2);
  b.terminal("RH", false);
  b.run(0.5);
  const double raised = b.output_hz();
  EXPECT_NEAR(raised, 20, 0.5);
  b.terminal("RM");
  b.run(1);
  b.terminal("RM", false);
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), raised - 10, 0.5);
  const double kept = b.signal("set_frequency");
  b.terminal("STF", false);
  b.power_cycle();
  b.run(0.1);
  EXPECT_NEAR(b.signal("set_frequency"), kept, 0.01);
  b.terminal("RL");
  b.tick();
  b.tick();
  EXPECT_NEAR(b.signal("set_frequency"), 0, 0.01);
}

TEST(Frequency, PidRaisesTheOutputWhileTheMeasuredValueIsLow) {
  Bench b = fast({{"Pr.128", 20}, {"Pr.129", 100}, {"Pr.130", 2}, {"Pr.132", 30}, {"Pr.191", 14}});
  ASSERT_TRUE(b->set_analog("2", 5).has_value());    // set point 50 %
  ASSERT_TRUE(b->set_analog("4", 7.2).has_value());  // 20 %
  b.terminal("STF");
  b.run(1);
  const double early = b.output_hz();
  EXPECT_GT(early, 10);
  EXPECT_TRUE(b.output("FU"));  // FDN: below 30 %
  b.run(1);
  EXPECT_GT(b.output_hz(), early + 3);
  const double high = b.output_hz();
  ASSERT_TRUE(b->set_analog("4", 12.8).has_value());  // 55 %
  b.run(1);
  EXPECT_FALSE(b.output("FU"));
  EXPECT_LT(b.output_hz(), high - 10);
  const double lower = b.output_hz();
  ASSERT_GT(lower, 2);
  b.run(0.5);
  EXPECT_LT(b.output_hz(), lower - 0.3);
}

TEST(Frequency, LimitsJumpsAndStartFrequency) {
  Bench b = fast({{"Pr.1", 40}, {"Pr.2", 5}, {"Pr.13", 2}, {"Pr.31", 18}, {"Pr.32", 22}});
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(1));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  EXPECT_TRUE(runs_at(b, 5));
  ASSERT_TRUE(b.frequency(20));
  EXPECT_TRUE(runs_at(b, 18));
  ASSERT_TRUE(b.frequency(100));
  EXPECT_TRUE(runs_at(b, 40));
}

}  // namespace
}  // namespace vinv::inverter::test
