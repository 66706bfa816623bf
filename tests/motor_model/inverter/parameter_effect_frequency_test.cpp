// Parameters that say at which frequency the FR-E500 runs: speeds, limits, jumps, analog inputs, remote setting, PID,
// operation mode and rights.
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::OperationMode;

TEST(ParameterEffect, EachOfTheFifteenSpeedsHasItsParameter) {
  struct Speed {
    const char* parameter;
    double hz;
    std::vector<std::string_view> on;
  };
  const Speed speeds[] = {{"Pr.4", 41, {"RH"}},
                          {"Pr.5", 32, {"RM"}},
                          {"Pr.6", 13, {"RL"}},
                          {"Pr.24", 24, {"RM", "RL"}},
                          {"Pr.25", 25, {"RH", "RL"}},
                          {"Pr.26", 26, {"RH", "RM"}},
                          {"Pr.27", 27, {"RH", "RM", "RL"}},
                          {"Pr.232", 18, {"MRS"}},
                          {"Pr.233", 19, {"MRS", "RL"}},
                          {"Pr.234", 20, {"MRS", "RM"}},
                          {"Pr.235", 21, {"MRS", "RM", "RL"}},
                          {"Pr.236", 22, {"MRS", "RH"}},
                          {"Pr.237", 23, {"MRS", "RH", "RL"}},
                          {"Pr.238", 14, {"MRS", "RH", "RM"}},
                          {"Pr.239", 15, {"MRS", "RH", "RM", "RL"}}};
  Bench b = drive_with({{"Pr.183", 8}});  // MRS has the function REX
  for (const Speed& s : speeds) b.preset(s.parameter, s.hz);
  b.terminal("STF");
  for (const Speed& s : speeds) {
    for (std::string_view t : {"RL", "RM", "RH", "MRS"}) {
      b.terminal(t, std::find(s.on.begin(), s.on.end(), t) != s.on.end());
    }
    EXPECT_TRUE(runs_at(b, s.hz)) << s.parameter << ": " << b.output_hz();
  }
}

TEST(ParameterEffect, Pr1AndPr18LimitTheFrequency) {
  Bench low = drive_with({{"Pr.1", 30}});
  start(low, 45);
  EXPECT_TRUE(runs_at(low, 30));
  Bench factory = drive_with({{"Pr.7", 0.5}});
  start(factory, 150);
  factory.run(1.5);
  EXPECT_NEAR(factory.output_hz(), 120, 0.01);
  Bench high = drive_with({{"Pr.7", 0.5}, {"Pr.1", 30}, {"Pr.18", 140}});  // takes the place of Pr.1
  start(high, 150);
  high.run(2.5);
  EXPECT_NEAR(high.output_hz(), 140, 0.01);
}

TEST(ParameterEffect, Pr2IsReachedByTheStartSignalAlone) {
  Bench b = drive_with({{"Pr.2", 12}});
  start(b, 0);
  EXPECT_TRUE(runs_at(b, 12));
  Bench factory = drive_with({});
  start(factory, 0);
  EXPECT_TRUE(stands(factory));
  Bench jog = drive_with({{"Pr.2", 12}});  // the jog frequency goes before it
  jog.pu();
  jog.key(PanelKey::kMode);
  jog.key(PanelKey::kMode);
  jog.key(PanelKey::kFwd);
  EXPECT_TRUE(runs_at(jog, 5));
}

TEST(ParameterEffect, Pr13IsWhereTheOutputBegins) {
  Bench b = drive_with({{"Pr.13", 8}, {"Pr.7", 5}});
  start(b, 7.9);
  EXPECT_TRUE(stands(b));
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.run_until([&] { return b.port().status().running; }, 1));
  EXPECT_NEAR(b.output_hz(), 8, 0.02);
}

TEST(ParameterEffect, JumpBandsAreLeftForTheirAValue) {
  struct Jump {
    const char* a;
    const char* b;
  };
  for (const Jump& j : {Jump{"Pr.31", "Pr.32"}, Jump{"Pr.33", "Pr.34"}, Jump{"Pr.35", "Pr.36"}}) {
    SCOPED_TRACE(j.a);
    Bench up = drive_with({{j.a, 20}, {j.b, 24}});
    start(up, 23);
    EXPECT_TRUE(runs_at(up, 20));
    ASSERT_TRUE(up.frequency(24.5));
    EXPECT_TRUE(runs_at(up, 24.5));
    Bench wider = drive_with({{j.a, 20}, {j.b, 26}});
    start(wider, 24.5);
    EXPECT_TRUE(runs_at(wider, 20));
    Bench down = drive_with({{j.a, 24}, {j.b, 20}});
    start(down, 23);
    EXPECT_TRUE(runs_at(down, 24));
    Bench half = drive_with({{j.a, 20}});  // B at 9999: off
    start(half, 23);
    EXPECT_TRUE(runs_at(half, 23));
  }
}

TEST(ParameterEffect, AnalogInputsFollowTheirCalibration) {
  struct Case {
    Settings settings;
    const char* terminal;
    double value;  // V or mA
    double hz;
    double factory_hz;  // at the same input without the settings
  };
  const Case cases[] = {{{{"Pr.73", 0}}, "2", 2.5, 25, 12.5},  {{{"Pr.38", 80}}, "2", 5, 40, 25},
                        {{{"Pr.39", 80}}, "4", 12, 40, 25},    {{{"Pr.902.1", 10}}, "2", 5, 30, 25},
                        {{{"Pr.902.2", 20}}, "2", 6, 25, 30},  {{{"Pr.903.1", 80}}, "2", 5, 40, 25},
                        {{{"Pr.903.2", 80}}, "2", 4, 25, 20},  {{{"Pr.904.1", 10}}, "4", 12, 30, 25},
                        {{{"Pr.904.2", 0}}, "4", 8, 20, 12.5}, {{{"Pr.905.1", 80}}, "4", 12, 40, 25},
                        {{{"Pr.905.2", 60}}, "4", 12, 50, 25}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.settings.front().first);
    for (bool set : {false, true}) {
      Settings settings = set ? c.settings : Settings{};
      settings.emplace_back("Pr.183", 4);  // MRS is AU
      Bench b = drive_with(settings);
      b.terminal("MRS", std::string_view(c.terminal) == "4");
      ASSERT_TRUE(b->set_analog(c.terminal, c.value).has_value());
      b.terminal("STF");
      EXPECT_TRUE(runs_at(b, set ? c.hz : c.factory_hz)) << b.output_hz();
    }
  }
}

TEST(ParameterEffect, Pr74IsTheTimeConstantOfTheInputs) {
  // 5 ms times 2 to the power of the setting: 63 % of a step after one time constant.
  for (const auto& [pr74, time_constant_s] : {std::pair{0, 0.005}, {4, 0.08}, {6, 0.32}, {8, 1.28}}) {
    Bench b = drive_with({{"Pr.74", pr74}});
    b.run(0.1);
    ASSERT_TRUE(b->set_analog("2", 10).has_value());
    b.run(time_constant_s);
    EXPECT_NEAR(b.signal("set_frequency"), 50 * 0.632, 2.5) << pr74;
  }
}

TEST(ParameterEffect, Pr59MakesRhRmAndRlARemoteSetting) {
  const auto raise = [](double pr59) {
    Bench b = drive_with({{"Pr.59", pr59}, {"Pr.44", 5}, {"Pr.45", 2.5}});  // 10 Hz/s up, 20 Hz/s down
    b.terminal("STF");
    b.terminal("RH");
    b.run(2);
    b.terminal("RH", false);
    b.run(0.2);
    return b;
  };
  Bench plain = raise(0);
  EXPECT_EQ(plain.signal("set_frequency"), 0);  // RH was a speed, and is off
  for (double pr59 : {1.0, 2.0}) {
    Bench b = raise(pr59);
    EXPECT_NEAR(b.output_hz(), 20, 0.1);
    b.terminal("RM");
    b.run(0.5);
    b.terminal("RM", false);
    b.run(0.2);
    EXPECT_NEAR(b.output_hz(), 10, 0.1);
    b.terminal("STF", false);
    b.run(0.5);
    EXPECT_NEAR(b.signal("set_frequency"), 10, 0.1);
    b.power_cycle();
    b.run(0.1);
    EXPECT_NEAR(b.signal("set_frequency"), pr59 == 1 ? 10 : 0, 0.1);
    if (pr59 != 1) continue;
    // What 1 has stored is not taken over by 2.
    ASSERT_TRUE(b->preset_parameter("Pr.59", 2).has_value());
    b.power_cycle();
    b.run(0.1);
    EXPECT_EQ(b.signal("set_frequency"), 0);
  }
}

// --- PID: Pr.128-134. Set point on terminal 2, measured value on terminal 4 (4-20 mA), both held. ---

struct PidBench {
  Bench bench;
  PidBench(const Settings& settings, double set_point_percent, double measured_percent)
      : bench(drive_with([&] {
          Settings s{{"Pr.128", 20}, {"Pr.130", 9999}, {"Pr.74", 0}};
          s.insert(s.end(), settings.begin(), settings.end());
          return s;
        }())) {
    EXPECT_TRUE(bench->set_analog("2", set_point_percent / 10).has_value());
    measure(measured_percent);
    bench.run(0.1);
  }
  void measure(double percent) { EXPECT_TRUE(bench->set_analog("4", 4 + 0.16 * percent).has_value()); }
  double hz_after(double seconds) {
    bench.terminal("STF");
    bench.run(seconds);
    return bench.signal("set_frequency");
  }
};

TEST(ParameterEffect, Pr128SelectsTheActionOfPidControl) {
  EXPECT_NEAR(PidBench({}, 60, 50).hz_after(0.2), 5, 0.05);                // 10 % of 50 Hz
  EXPECT_NEAR(PidBench({}, 40, 50).hz_after(0.2), 0, 0.05);                // reverse action: below is wanted
  EXPECT_NEAR(PidBench({{"Pr.128", 21}}, 40, 50).hz_after(0.2), 5, 0.05);  // forward action
  EXPECT_NEAR(PidBench({{"Pr.128", 21}}, 60, 50).hz_after(0.2), 0, 0.05);
  EXPECT_NEAR(PidBench({{"Pr.128", 0}}, 60, 50).hz_after(0.2), 30, 0.05);  // terminal 2 as it is
}

TEST(ParameterEffect, Pr129Pr130AndPr134AreThePartsOfPidControl) {
  EXPECT_NEAR(PidBench({{"Pr.129", 50}}, 60, 50).hz_after(0.2), 10, 0.05);
  EXPECT_NEAR(PidBench({{"Pr.129", 9999}, {"Pr.130", 2}}, 60, 50).hz_after(2), 5, 0.1);  // integral alone
  EXPECT_NEAR(PidBench({{"Pr.130", 2}}, 60, 50).hz_after(2), 10, 0.1);
  EXPECT_NEAR(PidBench({{"Pr.130", 4}}, 60, 50).hz_after(2), 7.5, 0.1);
  // The derivative of a step of 1 % is filtered with a tenth of Pr.134.
  const auto kick = [](double pr134, double after_s) {
    PidBench p({{"Pr.134", pr134}}, 60, 50);
    p.hz_after(0.5);
    p.measure(49);
    p.bench.run(after_s);
    return p.bench.signal("set_frequency") - 5.5;  // 11 % by the proportional part
  };
  EXPECT_NEAR(kick(9999, 0.2), 0, 0.05);
  EXPECT_GT(kick(1, 0.02), 3.5);
  EXPECT_NEAR(kick(1, 0.2), 5 * std::exp(-2), 0.15);
  EXPECT_NEAR(kick(2, 0.2), 5 * std::exp(-1), 0.15);
}

TEST(ParameterEffect, Pr131AndPr132WatchTheMeasuredValue) {
  // RUN shows FUP (15), FU shows FDN (14).
  PidBench p({{"Pr.190", 15}, {"Pr.191", 14}, {"Pr.131", 70}, {"Pr.132", 30}}, 50, 50);
  p.hz_after(0.1);
  const auto outputs = [&](double percent) {
    p.measure(percent);
    p.bench.run(0.1);
    return std::pair(p.bench.output("RUN"), p.bench.output("FU"));
  };
  EXPECT_EQ(outputs(50), std::pair(false, false));
  EXPECT_EQ(outputs(72), std::pair(true, false));
  EXPECT_EQ(outputs(68), std::pair(false, false));
  EXPECT_EQ(outputs(28), std::pair(false, true));
  EXPECT_EQ(outputs(32), std::pair(false, false));
}

TEST(ParameterEffect, Pr133IsTheSetPointInPuOperation) {
  for (const auto& [pr133, hz] : {std::pair{0.0, 0.0}, {60.0, 5.0}, {70.0, 10.0}}) {
    PidBench p({{"Pr.133", pr133}}, 90, 50);
    p.bench.pu();
    p.bench.key(PanelKey::kFwd);
    p.bench.run(0.2);
    EXPECT_NEAR(p.bench.signal("set_frequency"), hz, 0.05);
  }
}

TEST(ParameterEffect, PidForwardOutputTellsTheDirection) {
  // Signal RL of Pr.190-192 = 16.
  for (const char* terminal : {"STF", "STR"}) {
    PidBench p({{"Pr.190", 16}}, 80, 50);
    p.bench.terminal(terminal);
    p.bench.run(0.5);
    EXPECT_TRUE(p.bench.port().status().running);
    EXPECT_EQ(p.bench.output("RUN"), std::string_view(terminal) == "STF");
  }
}

TEST(ParameterEffect, PidControlIsOffWhileASpeedIsSelected) {
  PidBench p({}, 60, 50);
  p.hz_after(0.5);
  p.bench.terminal("RM");
  EXPECT_TRUE(runs_at(p.bench, 30));
  p.bench.terminal("RM", false);
  EXPECT_TRUE(runs_at(p.bench, 5));
}

// --- modes and rights ---

TEST(ParameterEffect, Pr79FixesOrFreesTheOperationMode) {
  struct Case {
    double pr79;
    OperationMode at_start;
    bool panel_key;
    bool network;
  };
  const Case cases[] = {{0, OperationMode::kExternal, true, true},    {1, OperationMode::kPu, false, false},
                        {2, OperationMode::kExternal, false, true},   {3, OperationMode::kCombined1, false, false},
                        {4, OperationMode::kCombined2, false, false}, {6, OperationMode::kExternal, true, true},
                        {7, OperationMode::kExternal, false, false},  // MRS is open: the interlock holds
                        {8, OperationMode::kPu, false, false}};       // X16 is not assigned
  for (const Case& c : cases) {
    SCOPED_TRACE(c.pr79);
    Bench b = drive_with({{"Pr.79", c.pr79}});
    EXPECT_EQ(b.port().operation_mode(), c.at_start);
    EXPECT_EQ(b.net().has_value(), c.network);
    if (c.network) {
      ASSERT_TRUE(b.net(false));
    }
    EXPECT_EQ(b->press_key(PanelKey::kPuExt).has_value(), c.panel_key);
  }
  // 6 changes while running, 0 does not.
  for (double pr79 : {0.0, 6.0}) {
    Bench b = drive_with({{"Pr.79", pr79}});
    b.terminal("RM");
    b.terminal("STF");
    ASSERT_TRUE(runs_at(b, 30));
    EXPECT_EQ(b->press_key(PanelKey::kPuExt).has_value(), pr79 == 6);
    EXPECT_TRUE(runs_at(b, 30));
  }
}

}  // namespace
}  // namespace vinv::inverter::test
