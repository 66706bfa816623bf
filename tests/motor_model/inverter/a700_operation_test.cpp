// Operation of the FR-A700 by terminals and panel: modes at power-on, terminal functions, analog inputs, jog, panel.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

using port::OperationMode;

a700::Du07 panel(Bench& b) { return dynamic_cast<a700::A700Inverter&>(*b).du07(); }

double set_hz(Bench& b) {
  b.run(0.5);
  return b.signal("set_frequency");
}

TEST(A700Operation, StartsInTheModeOfPr79AndPr340) {
  EXPECT_EQ(a700_with().port().operation_mode(), OperationMode::kExternal);
  EXPECT_EQ(a700_with({{"Pr.340", 1}}).port().operation_mode(), OperationMode::kNetwork);
  EXPECT_EQ(a700_with({{"Pr.340", 12}, {"Pr.79", 1}}).port().operation_mode(), OperationMode::kPu);
  EXPECT_EQ(a700_with({{"Pr.79", 3}}).port().operation_mode(), OperationMode::kCombined1);
}

// FR-A7NE manual 4.3.2, remark 1.
TEST(A700Operation, Pr340ActsAfterTheNextPowerOnOrReset) {
  Bench b = a700_with();
  b.pu();
  ASSERT_TRUE(b->set_parameter("Pr.340", 10).has_value());
  b.key(PanelKey::kPuExt);  // PU jog
  b.key(PanelKey::kPuExt);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  b.terminal("RES");
  b.run(0.1);
  b.terminal("RES", false);
  b.run(1.1);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
}

TEST(A700Operation, TheKeyGoesRoundExternalPuAndPuJog) {
  Bench b = a700_with();
  b.pu();
  EXPECT_FALSE(b.port().jog_operation());
  b.key(PanelKey::kPuExt);
  EXPECT_EQ(panel(b).digits, "JOG");
  b.key(PanelKey::kFwd);
  b.run(1);
  EXPECT_TRUE(b.port().jog_operation());
  EXPECT_NEAR(b.output_hz(), 5, 0.1);  // Pr.15
  EXPECT_FALSE(b->press_key(PanelKey::kPuExt).has_value());
  b.key(PanelKey::kStopReset);
  b.run(2);
  b.key(PanelKey::kPuExt);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(A700Operation, TerminalsHaveTheFunctionsOfPr178ToPr189) {
  // Each of them as RH, which makes the set frequency that of Pr.4.
  const std::pair<std::string, std::string> terminals[] = {
      {"Pr.178", "STF"}, {"Pr.179", "STR"}, {"Pr.180", "RL"}, {"Pr.181", "RM"},  {"Pr.182", "RH"},   {"Pr.183", "RT"},
      {"Pr.184", "AU"},  {"Pr.185", "JOG"}, {"Pr.186", "CS"}, {"Pr.187", "MRS"}, {"Pr.188", "STOP"}, {"Pr.189", "RES"}};
  for (const auto& [parameter, terminal] : terminals) {
    Bench b = a700_with({{parameter, 2}, {"Pr.4", 40}});
    EXPECT_EQ(set_hz(b), 0) << parameter;
    b.terminal(terminal);
    EXPECT_EQ(set_hz(b), 40) << parameter;
  }
  Bench rm = a700_with({{"Pr.182", 1}, {"Pr.5", 33}});  // the factory has RH at this one
  rm.terminal("RH");
  EXPECT_EQ(set_hz(rm), 33);
  Bench b = a700_with({{"Pr.4", 20}});
  b.terminal("RH");
  for (const char* start : {"STF", "STR"}) {
    b.terminal(start);
    b.run(1.5);
    EXPECT_EQ(b.port().status().forward, std::string_view(start) == "STF");
    EXPECT_TRUE(b.port().status().running);
    b.terminal(start, false);
    EXPECT_TRUE(b.run_until([&] { return !b.port().status().running; }, 5));
  }
  EXPECT_THAT(b->set_terminal("X14", true).error(), testing::HasSubstr("Pr.178-189"));
  EXPECT_THAT(b->set_terminal("XX", true).error(), testing::HasSubstr("STF, STR, RL, RM, RH, RT, AU, JOG, CS, MRS"));
}

TEST(A700Operation, WithoutAFunctionStfDoesNothing) {
  Bench b = a700_with({{"Pr.178", 9999}, {"Pr.4", 40}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(1);
  EXPECT_FALSE(b.port().status().running);
}

TEST(A700Operation, StopHoldsAPulseByItsTerminal) {
  Bench b = a700_with({{"Pr.4", 30}});
  b.terminal("RH");
  b.terminal("STOP");
  b.terminal("STF");
  b.run(0.1);
  b.terminal("STF", false);
  b.run(1);
  EXPECT_TRUE(b.port().status().running);
  b.terminal("STOP", false);
  EXPECT_TRUE(b.run_until([&] { return !b.port().status().running; }, 3));
}

TEST(A700Operation, JogByTerminalRunsAtPr15UntilItIsReleased) {
  Bench b = a700_with({{"Pr.15", 7}, {"Pr.16", 0.2}});
  b.terminal("JOG");
  b.terminal("STF");
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 7, 0.1);
  EXPECT_TRUE(b.port().jog_operation());
  b.terminal("JOG", false);
  EXPECT_TRUE(b.run_until([&] { return !b.port().status().running; }, 3));
}

TEST(A700Operation, AnalogInputsFollowPr73AndPr267) {
  struct Case {
    int pr73;
    double input;
    double hz;
  };
  // Pr.125 = 60 Hz at full scale.
  for (const Case& c : {Case{1, 5, 60}, {1, 2.5, 30}, {0, 5, 30}, {0, 10, 60}, {6, 20, 60}, {6, 10, 30}}) {
    Bench b = a700_with({{"Pr.73", static_cast<double>(c.pr73)}});
    ASSERT_TRUE(b->set_analog("2", c.input).has_value());
    EXPECT_NEAR(set_hz(b), c.hz, 0.05) << c.pr73 << " " << c.input;
  }
  for (const auto& [pr267, input, hz] : {std::tuple{0, 12.0, 30.0}, {1, 3.0, 30.0}, {2, 6.0, 30.0}}) {
    Bench b = a700_with({{"Pr.267", static_cast<double>(pr267)}});
    b.terminal("AU");
    ASSERT_TRUE(b->set_analog("4", input).has_value());
    EXPECT_NEAR(set_hz(b), hz, 0.1) << pr267;  // bias 20 %
  }
}

TEST(A700Operation, TerminalOneAddsToTerminalTwoByPr242AndToSpeedsWithPr28) {
  const auto with = [](const Settings& settings, double volt_1) {
    Bench b = a700_with(settings);
    EXPECT_TRUE(b->set_analog("2", 2.5).has_value());
    EXPECT_TRUE(b->set_analog("1", volt_1).has_value());
    return set_hz(b);
  };
  EXPECT_NEAR(with({}, 5), 60, 0.1);                // 30 + 30
  EXPECT_NEAR(with({{"Pr.242", 50}}, 5), 45, 0.1);  // half of it
  EXPECT_NEAR(with({{"Pr.73", 3}}, 2.5), 60, 0.1);  // terminal 1 has 5 V
  EXPECT_NEAR(with({}, -2.5), 15, 0.1);
  for (int pr28 : {0, 1}) {
    Bench b = a700_with({{"Pr.28", static_cast<double>(pr28)}, {"Pr.4", 30}});
    b.terminal("RH");
    ASSERT_TRUE(b->set_analog("1", 5).has_value());
    EXPECT_NEAR(set_hz(b), pr28 == 1 ? 60 : 30, 0.1);
  }
}

TEST(A700Operation, ANegativeSumTurnsTheMotorRoundOnlyWithPr73FromTen) {
  for (int pr73 : {1, 11}) {
    Bench b = a700_with({{"Pr.73", static_cast<double>(pr73)}});
    ASSERT_TRUE(b->set_analog("1", -5).has_value());
    b.terminal("STF");
    b.run(2);
    EXPECT_EQ(b.port().status().reverse, pr73 == 11);
    EXPECT_EQ(b.port().status().running, pr73 == 11);
  }
}

TEST(A700Operation, WithPr73Is4TerminalTwoIsAnOverrideByPr252AndPr253) {
  Bench b = a700_with({{"Pr.73", 4}, {"Pr.252", 20}, {"Pr.253", 120}});
  ASSERT_TRUE(b->set_analog("1", 5).has_value());  // main speed 30 Hz
  EXPECT_NEAR(set_hz(b), 6, 0.1);
  ASSERT_TRUE(b->set_analog("2", 5).has_value());
  EXPECT_NEAR(set_hz(b), 21, 0.1);
  ASSERT_TRUE(b->set_analog("2", 10).has_value());
  EXPECT_NEAR(set_hz(b), 36, 0.1);
  EXPECT_FALSE(b->set_reference(20).has_value());
}

TEST(A700Operation, AReferenceTurnsTheInputThatCounts) {
  Bench b = a700_with();
  ASSERT_TRUE(b->set_reference(42).has_value());
  EXPECT_NEAR(set_hz(b), 42, 0.05);
  b.terminal("AU");
  ASSERT_TRUE(b->set_reference(12).has_value());
  EXPECT_NEAR(set_hz(b), 12, 0.05);
  EXPECT_FALSE(b->set_reference(70).has_value());
}

TEST(A700Operation, Pr79Is7MakesMrsTheInterlockAndX12TakesItsPlace) {
  Bench b = a700_with({{"Pr.79", 7}});
  EXPECT_FALSE(b->press_key(PanelKey::kPuExt).has_value());
  b.terminal("MRS");
  b.run(0.01);
  b.pu();
  b.terminal("MRS", false);
  b.run(0.01);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  // With X12 at another terminal MRS is an output stop again.
  Bench x = a700_with({{"Pr.79", 7}, {"Pr.185", 12}, {"Pr.4", 30}});
  x.terminal("STF");
  x.terminal("RH");
  x.run(0.5);
  EXPECT_TRUE(x.port().status().running);
  x.terminal("MRS");
  x.run(0.1);
  EXPECT_FALSE(x.port().status().running);
}

TEST(A700Operation, X65AndX66ChooseTheMode) {
  Bench b = a700_with({{"Pr.183", 66}});
  b.terminal("RT");
  b.run(0.01);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
  b.terminal("RT", false);
  b.run(0.01);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  Bench c = a700_with({{"Pr.183", 65}, {"Pr.340", 10}});
  EXPECT_EQ(c.port().operation_mode(), OperationMode::kNetwork);
  c.terminal("RT");
  c.run(0.01);
  EXPECT_EQ(c.port().operation_mode(), OperationMode::kPu);
}

TEST(A700Operation, X16ChoosesBetweenPuAndExternal) {
  Bench b = a700_with({{"Pr.183", 16}});
  b.run(0.01);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kPu);
  b.terminal("RT");
  b.run(0.01);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(A700Operation, Pr551TakesThePanelsRunKeysAway) {
  for (int owner : {1, 2, 3}) {
    Bench b = a700_with({{"Pr.551", static_cast<double>(owner)}});
    b.pu();
    EXPECT_EQ(b->press_key(PanelKey::kFwd).has_value(), owner == 2) << owner;
  }
}

// --- FR-DU07 ---

TEST(Du07, NumbersHaveFourDigits) {
  EXPECT_EQ(a700::four_digits(0), "0.00");
  EXPECT_EQ(a700::four_digits(60), "60.00");
  EXPECT_EQ(a700::four_digits(99.996), "100.0");
  EXPECT_EQ(a700::four_digits(400), "400.0");
  EXPECT_EQ(a700::four_digits(1234.5), "1234");
}

TEST(Du07, LampsShowModeDirectionAndUnit) {
  Bench b = a700_with();
  b.run(0.01);
  a700::Du07 d = panel(b);
  EXPECT_EQ(d.digits, "0.00");
  EXPECT_TRUE(d.external && d.hertz && d.monitor);
  EXPECT_FALSE(d.pu || d.network);
  b.terminal("STR");
  b.run(0.1);
  EXPECT_EQ(panel(b).reverse, a700::Lamp::kFlicker);  // no frequency yet
  ASSERT_TRUE(b->set_analog("2", 5).has_value());
  b.run(2);
  EXPECT_EQ(panel(b).reverse, a700::Lamp::kOn);
  EXPECT_EQ(panel(b).forward, a700::Lamp::kOff);
  EXPECT_EQ(panel(b).digits, "60.00");
  b.key(PanelKey::kSet);
  EXPECT_TRUE(panel(b).ampere);
  EXPECT_FALSE(panel(b).hertz);
  b.key(PanelKey::kSet);
  EXPECT_TRUE(panel(b).volt);
  EXPECT_EQ(panel(b).digits.size(), 5u);
  Bench net = a700_with({{"Pr.340", 1}});
  EXPECT_TRUE(panel(net).network);
  Bench both = a700_with({{"Pr.79", 3}});
  EXPECT_TRUE(panel(both).pu && panel(both).external);
}

TEST(Du07, AlarmsStandInFourDigits) {
  Bench b = a700_with();
  ASSERT_TRUE(b->inject_fault("E.OC1", true).has_value());
  EXPECT_EQ(b->display(), "E.OC1");
  Bench c = a700_with();
  ASSERT_TRUE(c->inject_fault("E.3", true).has_value());
  EXPECT_EQ(c->display(), "E.  3");
  Bench dark(config_a700(), "fr-a700");
  EXPECT_EQ(dark->display(), "");
}

// FR-A7NE manual 4.7: without the option the panel shows speeds, with it Hz.
TEST(Du07, FrequencyIsShownAsSpeedOnlyWithoutTheOption) {
  InverterConfig bare = config_a700();
  bare.option_fitted = false;
  const auto shown = [](const Settings& settings, const InverterConfig& config) {
    Bench b = a700_with(settings, config);
    b.preset("Pr.52", 100);
    EXPECT_TRUE(b->set_analog("2", 5).has_value());
    b.run(0.5);
    return b->display();
  };
  EXPECT_EQ(shown({{"Pr.144", 104}}, bare), "1800");
  EXPECT_EQ(shown({{"Pr.144", 104}}, config_a700()), "60.00");
  EXPECT_EQ(shown({{"Pr.37", 500}}, bare), "500.0");
  EXPECT_EQ(shown({{"Pr.37", 500}, {"Pr.505", 120}}, bare), "250.0");
}

}  // namespace
}  // namespace vinv::inverter::test
