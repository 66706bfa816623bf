// Parameters that say what the FR-E500 shows and who may do what: display, terminals and their functions, detection
// signals, resets, write rules, user groups, the EEPROM.
#include "motor_model/inverter/eeprom_text.hpp"
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::OperationMode;

// --- display ---

TEST(ParameterEffect, Pr37Pr52ShowSpeedHoursOrSetFrequency) {
  const auto display = [](const Settings& settings, bool running) {
    Bench b = drive_with(settings);
    b.terminal("RM");
    b.terminal("STF", running);
    b.run(1.5);
    return b->display();
  };
  EXPECT_EQ(display({}, true), "30.00");
  EXPECT_EQ(display({}, false), "0.00");
  EXPECT_EQ(display({{"Pr.37", 1800}}, true), "900.0");  // 1800 at 60 Hz
  EXPECT_EQ(display({{"Pr.37", 0.01}}, true), "0.0");
  EXPECT_EQ(display({{"Pr.52", 100}}, false), "30.00");
  EXPECT_EQ(display({{"Pr.52", 100}, {"Pr.7", 3}}, true), "25.48");  // running: the output frequency
  EXPECT_EQ(display({{"Pr.52", 23}}, true), "0");
}

TEST(ParameterEffect, Pr171ClearsTheHoursThatPr52Shows) {
  Bench b = drive_with({{"Pr.52", 23}});
  std::string text = b->eeprom_text();
  const std::string line = "operating_seconds = 0";
  text.replace(text.find(line), line.size(), "operating_seconds = 36000");
  text.resize(text.rfind("checksum"));
  char checksum[32];
  std::snprintf(checksum, sizeof checksum, "checksum = %08x\n", crc32(text));
  Bench used;
  ASSERT_TRUE(used->load_eeprom(text + checksum).has_value());
  used.power_on();
  EXPECT_EQ(used->display(), "10");
  ASSERT_TRUE(used.net());
  ASSERT_TRUE(used.write_parameter(171, 0));
  EXPECT_EQ(used->display(), "0");
}

TEST(ParameterEffect, Pr158AndItsFullScalesDriveTerminalAm) {
  const auto am = [](const Settings& settings) {
    Bench b = drive_with(settings);
    b.terminal("RM");
    b.terminal("STF");
    b.run(2);
    return std::tuple(b.signal("am"), b.output_a(), b.output_v());
  };
  EXPECT_NEAR(std::get<0>(am({})), 6, 0.01);  // 30 of 50 Hz
  EXPECT_NEAR(std::get<0>(am({{"Pr.55", 120}})), 2.5, 0.01);
  EXPECT_NEAR(std::get<0>(am({{"Pr.901", 50}})), 3, 0.01);
  const auto [by_current, current_a, ignored_v] = am({{"Pr.158", 1}});
  EXPECT_NEAR(by_current, current_a / 4.0 * 10, 0.03);
  const auto [by_8_a, same_a, also_ignored_v] = am({{"Pr.158", 1}, {"Pr.56", 8}});
  EXPECT_NEAR(by_8_a, same_a / 8.0 * 10, 0.03);
  const auto [by_voltage, ignored_a, voltage_v] = am({{"Pr.158", 2}});
  EXPECT_NEAR(by_voltage, voltage_v / 800 * 10, 0.01);
}

// --- detection signals on terminal RUN ---

TEST(ParameterEffect, Pr41IsTheWidthOfUpToFrequency) {
  for (const auto& [pr41, width] : {std::pair{10.0, 5.0}, {40.0, 20.0}, {0.0, 0.0}}) {
    Bench b = drive_with({{"Pr.190", 1}, {"Pr.41", pr41}, {"Pr.7", 5}});
    start(b, 50);
    ASSERT_TRUE(b.run_until([&] { return b.output("RUN"); }, 6));
    EXPECT_NEAR(b.output_hz(), 50 - width, 0.03);
  }
}

TEST(ParameterEffect, Pr42AndPr43AreTheFrequencyDetection) {
  const auto on_at = [](const Settings& more, const char* direction) {
    Settings settings{{"Pr.190", 4}, {"Pr.7", 5}};
    settings.insert(settings.end(), more.begin(), more.end());
    Bench b = drive_with(settings);
    b.terminal("RH");
    b.terminal(direction);
    EXPECT_TRUE(b.run_until([&] { return b.output("RUN"); }, 6));
    return b.output_hz();
  };
  EXPECT_NEAR(on_at({}, "STF"), 6, 0.03);
  EXPECT_NEAR(on_at({{"Pr.42", 22}}, "STF"), 22, 0.03);
  EXPECT_NEAR(on_at({{"Pr.42", 22}}, "STR"), 22, 0.03);
  EXPECT_NEAR(on_at({{"Pr.43", 33}}, "STR"), 33, 0.03);
  EXPECT_NEAR(on_at({{"Pr.43", 33}}, "STF"), 6, 0.03);
}

TEST(ParameterEffect, Pr150ToPr153AreTheCurrentDetections) {
  // Without load the motor takes about half of the rated current, with 8 Nm nearly all of it.
  const auto y12 = [](double pr150, double pr151) {
    Bench b = drive_with({{"Pr.190", 12}, {"Pr.150", pr150}, {"Pr.151", pr151}, {"Pr.7", 2}});
    start(b, 30);
    b.run(3);
    EXPECT_FALSE(b.output("RUN"));
    plant::LoadSettings load;
    load.constant_nm = 8;
    b->set_load(load);
    const double at = b.now_s();
    return b.run_until([&] { return b.output("RUN"); }, 4) ? b.now_s() - at : -1.0;
  };
  const double at_once = y12(60, 0);
  EXPECT_NEAR(at_once, 0.05, 0.05);
  EXPECT_NEAR(y12(60, 1.2) - at_once, 1.2, 0.02);
  EXPECT_EQ(y12(130, 0), -1);
  const auto y13 = [](double pr152, double pr153) {
    Bench b = drive_with({{"Pr.190", 13}, {"Pr.152", pr152}, {"Pr.153", pr153}});
    start(b, 30);
    b.run(2);
    if (b.output("RUN")) return -1.0;  // counts as no current while running
    b.terminal("MRS");
    return seconds_until(
        b, [&] { return b.output("RUN"); }, 3);
  };
  EXPECT_NEAR(y13(5, 0.5), 0.5, 0.01);
  EXPECT_NEAR(y13(5, 0.9), 0.9, 0.01);
  EXPECT_EQ(y13(90, 0.5), -1);
}

// --- terminals ---

TEST(ParameterEffect, Pr180ToPr183GiveTheInputTerminalsTheirFunction) {
  const std::pair<const char*, const char*> terminals[] = {
      {"Pr.180", "RL"}, {"Pr.181", "RM"}, {"Pr.182", "RH"}, {"Pr.183", "MRS"}};
  for (const auto& [parameter, terminal] : terminals) {
    SCOPED_TRACE(parameter);
    const auto runs = [&, p = parameter, t = terminal](double function, double hz) {
      Bench b = drive_with({{"Pr.183", 0}, {p, function}, {"Pr.4", 41}, {"Pr.5", 31}, {"Pr.6", 21}, {"Pr.232", 11}});
      b.terminal(t);
      b.terminal("STF");
      return runs_at(b, hz);
    };
    EXPECT_TRUE(runs(0, 21));
    EXPECT_TRUE(runs(1, 31));
    EXPECT_TRUE(runs(2, 41));
    EXPECT_TRUE(runs(8, 11));
    EXPECT_FALSE(runs(6, 21));  // MRS: no output
  }
}

TEST(ParameterEffect, Pr190ToPr192GiveTheOutputTerminalsTheirSignal) {
  const std::pair<const char*, const char*> terminals[] = {{"Pr.190", "RUN"}, {"Pr.191", "FU"}, {"Pr.192", "ABC"}};
  for (const auto& [parameter, terminal] : terminals) {
    SCOPED_TRACE(parameter);
    // At standstill, at 4 Hz, at 30 Hz, with an alarm.
    const auto seen = [&, p = parameter, t = terminal](double function) {
      Bench b = drive_with({{p, function}, {"Pr.150", 10}, {"Pr.152", 1}, {"Pr.6", 4}});
      b.run(1);
      std::string s(1, b.output(t) ? '1' : '0');
      b.terminal("RL");
      b.terminal("STF");
      b.run(1);
      s += b.output(t) ? '1' : '0';
      b.terminal("RL", false);
      b.terminal("RM");
      b.run(1);
      s += b.output(t) ? '1' : '0';
      EXPECT_TRUE(b->inject_fault("E.OC2", true).has_value());
      b.run(0.2);
      s += b.output(t) ? '1' : '0';
      return s;
    };
    EXPECT_EQ(seen(0), "0110");   // RUN
    EXPECT_EQ(seen(1), "0110");   // SU
    EXPECT_EQ(seen(3), "0000");   // OL
    EXPECT_EQ(seen(4), "0010");   // FU
    EXPECT_EQ(seen(11), "1110");  // RY
    EXPECT_EQ(seen(12), "0110");  // Y12
    EXPECT_EQ(seen(13), "1000");  // Y13, 0.5 s after the current
    EXPECT_EQ(seen(98), "0000");  // LF
    EXPECT_EQ(seen(99), "0001");  // ABC
  }
}

TEST(ParameterEffect, OverloadAndMinorFaultHaveOutputSignals) {
  Bench stalled = drive_with({{"Pr.190", 3}, {"Pr.7", 2}});  // OL
  stalled->set_shaft_locked(true);
  start(stalled, 50);
  EXPECT_TRUE(stalled.run_until([&] { return stalled.output("RUN"); }, 3));
  EXPECT_TRUE(stalled.port().status().overload);
  Bench minor = drive_with({{"Pr.190", 98}});  // LF
  minor.run(0.1);
  EXPECT_FALSE(minor.output("RUN"));
  minor.port().set_communication_lost(true);
  minor.run(0.01);
  EXPECT_TRUE(minor.output("RUN"));
  EXPECT_EQ(minor->alarm_name(), "");  // external operation: no alarm
}

TEST(ParameterEffect, Pr17TurnsTheSenseOfMrs) {
  for (double pr17 : {0.0, 2.0}) {
    Bench b = drive_with({{"Pr.17", pr17}});
    b.terminal("RM");
    b.terminal("STF");
    EXPECT_EQ(runs_at(b, 30), pr17 == 0);
    b.terminal("MRS");
    EXPECT_EQ(runs_at(b, 30), pr17 == 2);
  }
}

TEST(ParameterEffect, Pr78ForbidsADirectionWhateverCommandsIt) {
  for (double pr78 : {0.0, 1.0, 2.0}) {
    const auto runs = [&](auto command) {
      Bench b = drive_with({{"Pr.78", pr78}});
      command(b);
      b.run(1);
      return b.port().status().running;
    };
    const auto by_terminal = [](const char* t) {
      return [t](Bench& b) {
        b.terminal("RM");
        b.terminal(t);
      };
    };
    const auto by_panel = [](PanelKey k) {
      return [k](Bench& b) {
        b.pu();
        ASSERT_TRUE(b->set_panel_frequency(20).has_value());
        b.key(k);
      };
    };
    const auto by_network = [](NetTerminal t) {
      return [t](Bench& b) {
        ASSERT_TRUE(b.net());
        ASSERT_TRUE(b.frequency(20));
        ASSERT_TRUE(b.command({t}));
      };
    };
    EXPECT_EQ(runs(by_terminal("STF")), pr78 != 2);
    EXPECT_EQ(runs(by_terminal("STR")), pr78 != 1);
    EXPECT_EQ(runs(by_panel(PanelKey::kFwd)), pr78 != 2);
    EXPECT_EQ(runs(by_panel(PanelKey::kRev)), pr78 != 1);
    EXPECT_EQ(runs(by_network(NetTerminal::kStf)), pr78 != 2);
    EXPECT_EQ(runs(by_network(NetTerminal::kStr)), pr78 != 1);
  }
}

TEST(ParameterEffect, Pr244LetsTheFanStop) {
  for (double pr244 : {0.0, 1.0}) {
    Bench b = drive_with({{"Pr.244", pr244}});
    b.run(0.01);
    EXPECT_EQ(b.signal("fan"), pr244 == 1 ? 0 : 1);
    start(b, 20);
    b.run(0.1);
    EXPECT_EQ(b.signal("fan"), 1);
  }
}

// --- who may do what ---

TEST(ParameterEffect, Pr75SelectsResetPanelSupervisionAndStop) {
  struct Case {
    double pr75;
    bool reset_any_time, supervised, stop_everywhere;
  };
  for (const Case& c : {Case{0, true, false, false},
                        {1, false, false, false},
                        {2, true, true, false},
                        Case{3, false, true, false},
                        {14, true, false, true},
                        {15, false, false, true},
                        Case{16, true, true, true},
                        {17, false, true, true}}) {
    SCOPED_TRACE(c.pr75);
    Bench b = drive_with({{"Pr.75", c.pr75}});
    b.terminal("RES");
    b.run(0.05);
    EXPECT_EQ(b->display() == "Err.", c.reset_any_time);
    b.terminal("RES", false);
    b.run(1.1);
    b.terminal("RM");
    b.terminal("STF");
    b.run(1);
    EXPECT_EQ(b->press_key(PanelKey::kStopReset).has_value(), c.stop_everywhere);
    b.run(1.2);
    EXPECT_EQ(b.port().status().running, !c.stop_everywhere);
    ASSERT_TRUE(b->inject_fault("pu_disconnected", true).has_value());
    b.run(0.01);
    EXPECT_EQ(b->alarm_name(), c.supervised ? "E.PUE" : "");
    ASSERT_TRUE(b->inject_fault("pu_disconnected", false).has_value());
    if (b->alarm_name().empty()) {
      ASSERT_TRUE(b->inject_fault("E.OC1", true).has_value());
    }
    b.terminal("RES");  // always with an alarm
    b.run(0.05);
    EXPECT_EQ(b->alarm_name(), "");
  }
}

TEST(ParameterEffect, Pr77SaysWhichWritesAreAccepted) {
  struct Case {
    double pr77;
    bool stopped, running, in_external, pr22_stopped, pr79_running;
  };
  for (const Case& c : {Case{0, true, false, false, true, false}, Case{1, false, false, false, true, false},
                        Case{2, true, true, true, true, false}}) {
    SCOPED_TRACE(c.pr77);
    Bench b = drive_with({{"Pr.77", c.pr77}});
    EXPECT_EQ(b->set_parameter("Pr.7", 1).has_value(), c.in_external);
    EXPECT_EQ(b.write_parameter(7, 10).has_value(), c.in_external);
    b.pu();
    EXPECT_EQ(b->set_parameter("Pr.7", 2).has_value(), c.stopped);
    EXPECT_EQ(b->set_parameter("Pr.22", 140).has_value(), c.pr22_stopped);
    EXPECT_EQ(b->get_parameter("Pr.7").value(), c.stopped ? 2 : 0.2);
    ASSERT_TRUE(b->set_panel_frequency(20).has_value());
    b.key(PanelKey::kFwd);
    b.run(0.5);
    EXPECT_EQ(b->set_parameter("Pr.7", 3).has_value(), c.running);
    EXPECT_EQ(b->set_parameter("Pr.79", 1).has_value(), c.pr79_running);
    EXPECT_EQ(b->set_parameter("Pr.180", 3).has_value(), false);
  }
}

TEST(ParameterEffect, Pr160AndTheGroupsOfPr173ToPr176LimitThePanel) {
  // Group 1: Pr.7 and Pr.8; group 2: Pr.8 and Pr.9.
  for (const auto& [pr160, seen] : {std::pair{0.0, "1111"}, {1.0, "1100"}, {10.0, "0110"}, {11.0, "1110"}}) {
    Bench b = drive_with({{"Pr.173", 7}, {"Pr.173", 8}, {"Pr.175", 8}, {"Pr.175", 9}, {"Pr.160", pr160}});
    b.pu();
    std::string shown;
    std::string written;
    for (const char* name : {"Pr.7", "Pr.8", "Pr.9", "Pr.10"}) {
      shown += b->get_parameter(name).has_value() ? '1' : '0';
      written += b->set_parameter(name, 3).has_value() ? '1' : '0';
    }
    EXPECT_EQ(shown, seen) << pr160;
    EXPECT_EQ(written, seen) << pr160;
    EXPECT_TRUE(b->get_parameter("Pr.77").has_value());
    EXPECT_TRUE(b->get_parameter("Pr.160").has_value());
    EXPECT_EQ(b.raw(10), 300u);  // the network sees all
  }
  // Pr.174 and Pr.176 take out one or, with 9999, all.
  const auto left = [](const Settings& more) {
    Settings settings{{"Pr.173", 7}, {"Pr.173", 8}, {"Pr.175", 8}, {"Pr.175", 9}};
    settings.insert(settings.end(), more.begin(), more.end());
    settings.emplace_back("Pr.160", 11);
    Bench b = drive_with(settings);
    std::string shown;
    for (const char* name : {"Pr.7", "Pr.8", "Pr.9"}) shown += b->get_parameter(name).has_value() ? '1' : '0';
    return shown;
  };
  EXPECT_EQ(left({}), "111");
  EXPECT_EQ(left({{"Pr.174", 7}}), "011");
  EXPECT_EQ(left({{"Pr.176", 9}}), "110");
  EXPECT_EQ(left({{"Pr.174", 9999}}), "011");
  EXPECT_EQ(left({{"Pr.176", 9999}}), "110");
  EXPECT_EQ(left({{"Pr.174", 8}, {"Pr.176", 8}}), "101");
}

TEST(ParameterEffect, Pr338AndPr339GiveStartAndSpeedToTheTerminals) {
  const auto runs = [](double pr338, double pr339, const char* source) {
    Bench b = drive_with({{"Pr.338", pr338}, {"Pr.339", pr339}});
    EXPECT_TRUE(b.net().has_value());
    EXPECT_EQ(b.frequency(20).has_value(), pr339 == 0);
    EXPECT_EQ(b.command({NetTerminal::kStf}).has_value(), pr338 == 0);
    b.terminal("RM");
    b.terminal("STF", std::string_view(source) == "terminal");
    b.run(1);
    return b.output_hz();
  };
  EXPECT_NEAR(runs(0, 0, "network"), 20, 0.01);
  EXPECT_NEAR(runs(0, 1, "network"), 30, 0.01);
  EXPECT_EQ(runs(1, 0, "network"), 0);
  EXPECT_NEAR(runs(1, 0, "terminal"), 20, 0.01);
  EXPECT_NEAR(runs(1, 1, "terminal"), 30, 0.01);
}

TEST(ParameterEffect, Pr340SelectsTheModeAfterPowerOnAndReset) {
  for (const auto& [pr340, mode] :
       {std::pair{0.0, OperationMode::kExternal}, {1.0, OperationMode::kNetwork}, {2.0, OperationMode::kNetwork}}) {
    Bench b = drive_with({{"Pr.340", pr340}});
    EXPECT_EQ(b.port().operation_mode(), mode);
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.reset());
    b.run(1.1);
    EXPECT_EQ(b.port().operation_mode(), mode);
  }
}

TEST(ParameterEffect, Pr342KeepsNetworkWritesOutOfTheEeprom) {
  for (double pr342 : {0.0, 1.0}) {
    Bench b = drive_with({{"Pr.342", pr342}});
    ASSERT_TRUE(b.net());
    ASSERT_TRUE(b.write_parameter(7, 77));
    EXPECT_EQ(b.raw(7), 77u);
    b.power_cycle();
    EXPECT_EQ(b.raw(7), pr342 == 1 ? 2u : 77u);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
