// Terminals, frequency sources, panel and auto tuning of the FR-E500, on the bench with motor.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using port::OperationMode;
using testing::HasSubstr;

Bench fast(std::initializer_list<std::pair<std::string, double>> presets = {}) {
  Bench b;
  b.preset("Pr.7", 0.2);
  b.preset("Pr.8", 0.2);
  for (const auto& [name, value] : presets) b.preset(name, value);
  b.power_on();
  return b;
}
bool runs_at(Bench& b, double hz) {
  b.run(1.2);
  return b.port().status().running && std::abs(b.output_hz() - hz) < 0.02;
}
bool stands(Bench& b) {
  b.run(1.5);
  return !b.port().status().running;
}

// --- start and stop terminals ---

TEST(Terminals, StfAndStrStartInExternalOperation) {
  Bench b = fast();
  b.terminal("RM");
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
  EXPECT_TRUE(b.port().status().forward);
  EXPECT_TRUE(b.output("RUN"));
  EXPECT_TRUE(b.output("FU"));
  b.terminal("STR");
  EXPECT_TRUE(stands(b));
  EXPECT_FALSE(b.output("RUN"));
  b.terminal("STF", false);
  EXPECT_TRUE(runs_at(b, 30));
  EXPECT_TRUE(b.port().status().reverse);
}

TEST(Terminals, MrsStopsTheOutputAndPr17TurnsItsSense) {
  Bench b = fast();
  b.terminal("RM");
  b.terminal("STF");
  ASSERT_TRUE(runs_at(b, 30));
  b.terminal("MRS");
  b.run(0.002);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_GT(b.signal("speed"), 500);  // coasts
  b.terminal("MRS", false);
  b.terminal("STF", false);
  b.run(2);
  ASSERT_TRUE(b.net(true).has_value());
  ASSERT_TRUE(b.write_parameter(17, 2));
  ASSERT_TRUE(b.net(false));
  b.terminal("STF");
  EXPECT_TRUE(stands(b));  // normally closed now
  b.terminal("MRS");
  EXPECT_TRUE(runs_at(b, 30));
}

TEST(Terminals, Pr17ActsOnlyAfterTheInverterHasStopped) {
  // OI-FR-E5NCO manual 5.1, note.
  Bench b = fast({{"Pr.77", 2}});
  b.terminal("RM");
  b.terminal("STF");
  ASSERT_TRUE(runs_at(b, 30));
  ASSERT_TRUE(b.write_parameter(17, 2));
  EXPECT_TRUE(runs_at(b, 30));
  b.terminal("STF", false);
  ASSERT_TRUE(stands(b));
  b.terminal("STF");
  EXPECT_TRUE(stands(b));
}

TEST(Terminals, SelfHoldingKeepsAPulse) {
  Bench b = fast({{"Pr.180", 5}});  // RL is STOP
  b.terminal("RM");
  b.terminal("RL");
  b.terminal("STF");
  b.run(0.05);
  b.terminal("STF", false);
  EXPECT_TRUE(runs_at(b, 30));
  b.terminal("RL", false);
  EXPECT_TRUE(stands(b));
}

TEST(Terminals, Pr250ReadsStrAsDirectionAndCoasts) {
  Bench b = fast({{"Pr.250", 1000}});
  b.terminal("RM");
  b.terminal("STR");
  EXPECT_TRUE(stands(b));  // a direction alone starts nothing
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
  EXPECT_TRUE(b.port().status().reverse);
  b.terminal("STF", false);
  b.run(0.01);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_LT(b.signal("speed"), -300);  // coasts
}

TEST(Terminals, Pr78ForbidsReverse) {
  Bench b = fast({{"Pr.78", 1}});
  b.terminal("RM");
  b.terminal("STR");
  EXPECT_TRUE(stands(b));
  b.terminal("STR", false);
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
}

TEST(Terminals, RtSelectsTheSecondRamp) {
  Bench b = fast({{"Pr.183", 3}, {"Pr.44", 5}});  // MRS is RT
  b.terminal("RH");
  b.terminal("MRS");
  b.terminal("STF");
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 10, 0.6);  // 50 Hz in 5 s
}

TEST(Terminals, RexReachesSpeed8To15) {
  Bench b = fast({{"Pr.183", 8}, {"Pr.232", 12}, {"Pr.239", 34}});
  b.terminal("STF");
  b.terminal("MRS");
  EXPECT_TRUE(runs_at(b, 12));
  for (const char* t : {"RH", "RM", "RL"}) b.terminal(t);
  EXPECT_TRUE(runs_at(b, 34));
}

TEST(Terminals, OhTripsWhenItsContactOpens) {
  Bench b = fast({{"Pr.180", 7}});
  b.run(0.01);
  EXPECT_EQ(b->alarm_name(), "E.OHT");  // open from the start
  b.terminal("RL");
  b.key(PanelKey::kStopReset);
  b.run(1.1);
  ASSERT_EQ(b->alarm_name(), "");
  ASSERT_TRUE(b->inject_fault("external_thermal", true).has_value());
  b.run(0.01);
  EXPECT_EQ(b->alarm_name(), "E.OHT");
  Bench without = fast();
  EXPECT_THAT(without->inject_fault("external_thermal", true).error(), HasSubstr("OH"));
}

TEST(Terminals, X16SwitchesBetweenPuAndExternalWithPr79Is8) {
  Bench b = fast({{"Pr.183", 16}, {"Pr.79", 8}});
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kPu);
  b.terminal("MRS");
  b.tick();
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  EXPECT_TRUE(refused(b.net(), port::Refusal::kModeChangeRefused));
  b.terminal("STF");
  b.terminal("RM");
  b.run(0.5);
  b.terminal("MRS", false);
  EXPECT_TRUE(runs_at(b, 30));  // inhibited while running
  b.terminal("STF", false);
  ASSERT_TRUE(stands(b));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kPu);
}

TEST(Terminals, MrsIsTheInterlockOfPuOperationWithPr79Is7) {
  Bench b = fast({{"Pr.79", 7}});
  EXPECT_FALSE(b->press_key(PanelKey::kPuExt).has_value());
  b.terminal("MRS");
  b.pu();
  ASSERT_TRUE(b->set_panel_frequency(25).has_value());
  b.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(b, 25));  // no output stop in PU operation
  b.terminal("MRS", false);
  EXPECT_TRUE(stands(b));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(Terminals, WithTheInterlockOnTheNetworkMayRunToo) {
  Bench b = fast({{"Pr.79", 7}});
  EXPECT_TRUE(refused(b.net(), port::Refusal::kModeChangeRefused));
  b.terminal("MRS");
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(25));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  EXPECT_TRUE(runs_at(b, 25));
}

TEST(Terminals, X18SwitchesFluxVectorControlOff) {
  const auto voltage_at_5_hz = [](bool x18) {
    Bench b = fast({{"Pr.183", 18}, {"Pr.80", 1.5}, {"Pr.6", 5}});
    b.terminal("MRS", x18);
    b.terminal("RL");
    b.terminal("STF");
    b.run(1.5);
    return b.output_v();
  };
  EXPECT_GT(std::abs(voltage_at_5_hz(true) - voltage_at_5_hz(false)), 1.0);
}

TEST(Terminals, UnknownNamesAndValuesAreRefusedWithWhatThereIs) {
  Bench b;
  EXPECT_EQ(b->set_terminal("XYZ", true).error(),
            "there is no input terminal XYZ; there are STF, STR, RL, RM, RH, MRS, RES");
  EXPECT_THAT(b->set_terminal("AU", true).error(), HasSubstr("Pr.180-183"));
  EXPECT_EQ(b->set_analog("2", 11).error(), "terminal 2 takes 0 to 10 V");
  EXPECT_EQ(b->set_analog("4", -1).error(), "terminal 4 takes 0 to 20 mA");
  EXPECT_FALSE(b->set_analog("1", 1).has_value());
}

TEST(Terminals, ResResetsWhileHeld) {
  Bench b = fast();
  ASSERT_TRUE(b->inject_fault("E.OC2", true).has_value());
  b.terminal("RES");
  b.run(1.5);
  EXPECT_EQ(b->display(), "Err.");
  EXPECT_FALSE(b.port().ready());
  EXPECT_EQ(b->alarm_name(), "");
  b.terminal("RES", false);
  const double at = b.now_s();
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_NEAR(b.now_s() - at, 1.0, 0.01);
}

// --- output terminals and AM ---

TEST(Outputs, EachAssignmentShowsItsSignal) {
  const auto output_with = [](double function, bool running) {
    Bench b = fast({{"Pr.190", function}, {"Pr.152", 5}, {"Pr.150", 1}});
    if (running) {
      b.terminal("RM");
      b.terminal("STF");
    }
    b.run(1.5);
    return b.output("RUN");
  };
  for (double function : {0.0, 1.0, 4.0, 12.0}) {
    EXPECT_FALSE(output_with(function, false)) << function;
    EXPECT_TRUE(output_with(function, true)) << function;
  }
  EXPECT_TRUE(output_with(11, false));  // RY
  EXPECT_FALSE(output_with(13, true));  // Y13: there is current
  EXPECT_FALSE(output_with(99, true));
}

TEST(Outputs, AmShowsWhatPr158Selects) {
  Bench b = fast({{"Pr.55", 60}});
  b.terminal("RM");
  b.terminal("STF");
  ASSERT_TRUE(runs_at(b, 30));
  EXPECT_NEAR(b.signal("am"), 5, 0.01);
  ASSERT_TRUE(b->preset_parameter("Pr.158", 1).has_value());
  b.tick();
  EXPECT_NEAR(b.signal("am"), b.signal("output_current") / 4.0 * 10, 0.1);
  ASSERT_TRUE(b->preset_parameter("Pr.158", 2).has_value());
  b.tick();
  EXPECT_NEAR(b.signal("am"), b.signal("output_voltage") / 400 * 10, 0.01);
  const double full = b.signal("am");
  ASSERT_TRUE(b->preset_parameter("Pr.901", 50).has_value());
  b.tick();
  EXPECT_NEAR(b.signal("am"), full / 2, 0.05);
}

TEST(Outputs, FanStopsWithTheOutputOnlyIfPr244SaysSo) {
  Bench always = fast();
  EXPECT_EQ(always.signal("fan"), 1);
  Bench controlled = fast({{"Pr.244", 1}});
  controlled.run(0.01);
  EXPECT_EQ(controlled.signal("fan"), 0);
  controlled.terminal("RM");
  controlled.terminal("STF");
  controlled.run(0.5);
  EXPECT_EQ(controlled.signal("fan"), 1);
}

// --- frequency sources ---

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

// --- panel ---

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

// --- auto tuning ---

TEST(AutoTuning, MeasuresTheStatorResistanceAtStandstill) {
  for (const char* machine : {"iec4p_0k75kW_400V", "iec4p_1k5kW_400V", "iec4p_2k2kW_400V"}) {
    Bench b(config_for("FR-E540-1.5K", machine));
    b.preset("Pr.80", 1.5);
    b.preset("Pr.96", 1);
    b.power_on();
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.frequency(20));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(0.5);
    EXPECT_EQ(b.raw(96), 2u);
    EXPECT_TRUE(refused(b.write_parameter(3, 6000), port::Refusal::kRunning));
    ASSERT_TRUE(b.run_until([&] { return b.raw(96) != 2; }, 10));
    EXPECT_EQ(b.raw(96), 3u);
    EXPECT_NEAR(b.signal("speed"), 0, 1);
    const double r1 = plant::find_machine(machine)->R_s_ohm;
    EXPECT_NEAR(b->get_parameter("Pr.90").value(), r1, 0.02 * r1) << machine;
    b.run(1);
    EXPECT_FALSE(b.port().status().running);  // waits for a new start
    ASSERT_TRUE(b.command({}));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(3);
    EXPECT_NEAR(b.output_hz(), 20, 3);
  }
}

TEST(AutoTuning, StoppedEarlyReads8AndKeepsPr90) {
  Bench b = fast({{"Pr.80", 1.5}, {"Pr.96", 1}});
  b.terminal("STF");
  b.run(0.5);
  b.terminal("STF", false);
  b.run(0.1);
  EXPECT_EQ(b.raw(96), 8u);
  EXPECT_EQ(b->get_parameter("Pr.90").value(), 9999);
}

TEST(AutoTuning, NeedsTheMotorCapacity) {
  Bench b = fast({{"Pr.96", 1}});
  b.terminal("RM");
  b.terminal("STF");
  EXPECT_TRUE(runs_at(b, 30));
}

// --- construction ---

TEST(MakeInverter, RefusesWithASentence) {
  EXPECT_EQ(make_inverter("fr-x", config_1k5()).error(), "there is no inverter family fr-x; there is fr-e500");
  EXPECT_THAT(make_inverter("fr-e500", config_for("FR-X", "iec4p_1k5kW_400V")).error(),
              HasSubstr("has no model FR-X; there are FR-E520-0.1K, "));
  InverterConfig c = config_1k5();
  c.motor.R_s_ohm = -1;
  EXPECT_THAT(make_inverter("fr-e500", c).error(), testing::StartsWith("motor: "));
  c = config_1k5();
  c.brake_resistance_ohm = -1;
  EXPECT_FALSE(make_inverter("fr-e500", c).has_value());
  c = config_1k5();
  c.mains = plant::MainsState{.voltage_v_rms = 1000};
  EXPECT_THAT(make_inverter("fr-e500", c).error(), HasSubstr("takes 0 to 600 V"));
}

TEST(MakeInverter, EveryModelStartsAndRunsItsMotor) {
  for (std::string_view model : models("fr-e500")) {
    const bool low = model.substr(0, 7) == "FR-E520";
    Bench b(config_for(std::string(model), low ? "iec4p_0k4kW_200V" : "iec4p_0k4kW_400V"));
    b.preset("Pr.7", 1);
    b.power_on();
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.frequency(30));
    ASSERT_TRUE(b.command({NetTerminal::kStf}));
    b.run(3);
    // The two smallest are far too small for this motor: they may stall, they must not fall over.
    if (model != "FR-E520-0.1K" && model != "FR-E520-0.2K") {
      EXPECT_NEAR(b.output_hz(), 30, 0.1) << model << " " << b->alarm_cause();
      EXPECT_NEAR(b.signal("speed"), 880, 25) << model;
    }
  }
}

}  // namespace
}  // namespace vinv::inverter::test
