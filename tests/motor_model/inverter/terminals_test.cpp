// Input and output terminals of the FR-E500 on the bench with motor: functions by Pr.180-183 and 190-192, Pr.17, 78,
// 250.
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using port::OperationMode;
using testing::HasSubstr;

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
    InverterConfig config = config_1k5();
    config.load.constant_nm = 3;
    Bench b(config);
    for (const auto& [name, value] : {std::pair{"Pr.183", 18.0}, {"Pr.80", 1.5}, {"Pr.6", 5.0}}) b.preset(name, value);
    b.power_on();
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
  EXPECT_NEAR(b.signal("am"), b.signal("output_voltage") / 800 * 10, 0.01);
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

}  // namespace
}  // namespace vinv::inverter::test
