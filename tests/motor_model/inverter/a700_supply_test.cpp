// Supply of the FR-A700: restart after a power failure, deceleration at a power failure, commercial switch-over.
// Typical for the family.
#include "a700_bench.hpp"

namespace vinv::inverter::test {
namespace {

using plant::MotorSource;

double rotor_hz(Bench& b) { return b.signal("speed") / 60 * b->plant().config().machine.pole_pairs; }

// --- restart ---

// A flywheel at 40 Hz, with the supply gone for half a second; the restart is under way.
Bench restarted(Settings settings, double until_s = 0.05) {
  settings.insert(settings.begin(), {{"Pr.57", 0.1}, {"Pr.58", 0.5}, {"Pr.186", 9999}, {"Pr.4", 40}, {"Pr.7", 3}});
  Bench b = a700_with(settings, loaded(0.1, 3, config_a700()));
  b.terminal("STF");
  b.terminal("RH");
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 39.9; }, 10));
  b->set_mains({.voltage_v_rms = 230});
  b.run(0.4);
  EXPECT_FALSE(b.port().status().running) << "the link has fallen";
  b->set_mains({.voltage_v_rms = 400});
  EXPECT_TRUE(b.run_until([&] { return b.port().status().running; }, 3)) << b->alarm_name();
  b.run(until_s);
  return b;
}

TEST(A700Restart, Pr162SearchesTheMotorOrGoesOnAtTheFrequencyOfBefore) {
  Bench search = restarted({{"Pr.162", 0}});
  EXPECT_LT(search.output_hz(), 37);
  EXPECT_NEAR(search.output_hz(), rotor_hz(search), 1.5);
  Bench reduced = restarted({{"Pr.162", 1}});
  EXPECT_NEAR(reduced.output_hz(), 40, 0.1);
  EXPECT_GT(reduced.output_hz() - rotor_hz(reduced), 3);
  EXPECT_LT(reduced.output_v(), 100) << "with little voltage";
  EXPECT_TRUE(reduced.run_until([&] { return rotor_hz(reduced) > 38; }, 5)) << reduced->alarm_name();
}

TEST(A700Restart, Pr162Is10CatchesATurningMotorAtEveryStart) {
  const auto start_turning = [](double pr162) {
    Bench b = a700_with({{"Pr.57", 0}, {"Pr.186", 9999}, {"Pr.162", pr162}, {"Pr.4", 40}, {"Pr.7", 3}},
                        loaded(0.1, 0, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 39.9; }, 10));
    b.terminal("MRS");
    b.run(1);
    b.terminal("MRS", false);
    b.run(0.02);
    return b.output_hz();
  };
  EXPECT_LT(start_turning(0), 3);
  EXPECT_GT(start_turning(10), 30);
  EXPECT_LT(start_turning(11), 3);
}

TEST(A700Restart, Pr163AndPr164AreAPointOfTheVoltageOnItsWay) {
  // A quarter of a second after the restart.
  const auto volts = [](const Settings& settings) { return restarted(settings, 0.25).output_v(); };
  const double straight = volts({{"Pr.58", 1}});
  EXPECT_GT(volts({{"Pr.58", 1}, {"Pr.163", 0.2}, {"Pr.164", 80}}), straight * 2);
  EXPECT_LT(volts({{"Pr.58", 1}, {"Pr.163", 0.8}, {"Pr.164", 10}}), straight * 0.5);
}

TEST(A700Restart, Pr165AndPr611HoldUntilTheSetFrequencyIsReached) {
  const auto seconds = [](const Settings& settings) {
    Bench b = restarted(settings, 0);
    return seconds_until(
        b, [&] { return b.output_hz() > 39.9; }, 60);
  };
  const double quick = seconds({{"Pr.611", 1}});
  EXPECT_GT(seconds({{"Pr.611", 20}}), quick + 1);
  EXPECT_NEAR(seconds({{"Pr.611", 9999}}), seconds({{"Pr.611", 3}}), 0.1);
  // A low level slows a steep acceleration down.
  EXPECT_GT(seconds({{"Pr.611", 0.2}, {"Pr.165", 60}}), seconds({{"Pr.611", 0.2}, {"Pr.165", 180}}) + 0.1);
}

TEST(A700Restart, Pr299SaysWhetherAMotorThatTurnsBackwardsIsFound) {
  const auto output_hz = [](const Settings& more) {
    Settings settings{{"Pr.57", 0}, {"Pr.186", 9999}, {"Pr.162", 10}, {"Pr.4", 40}, {"Pr.7", 3}};
    settings.insert(settings.end(), more.begin(), more.end());
    Bench b = a700_with(settings, loaded(0.1, 0, config_a700()));
    b.terminal("STR");
    b.terminal("RH");
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 39.9; }, 10));
    b.terminal("MRS");
    b.run(1);
    b.terminal("STR", false);
    b.terminal("STF");
    b.terminal("MRS", false);
    b.run(0.02);
    return b.signal("output_frequency");
  };
  EXPECT_LT(output_hz({{"Pr.299", 1}}), -30);
  EXPECT_GT(output_hz({{"Pr.299", 0}}), 0);
  EXPECT_LT(output_hz({{"Pr.299", 9999}}), -30) << "Pr.78 = 0: both directions";
}

// --- deceleration at a power failure ---

// A flywheel at 50 Hz; Y46 is at IPF.
struct Failing {
  Bench b;
  explicit Failing(Settings settings, double inertia = 0.15, double nm = 2)
      : b(a700_with(with(std::move(settings)), loaded(inertia, nm, config_a700()))) {
    b.terminal("STF");
    b.terminal("RH");
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() > 49.99; }, 10)) << b->alarm_name();
    b.run(0.2);
  }
  static Settings with(const Settings& settings) {
    Settings all{{"Pr.4", 50}, {"Pr.7", 4}, {"Pr.192", 46}, {"Pr.264", 2}, {"Pr.263", 40}};
    all.insert(all.end(), settings.begin(), settings.end());
    return all;
  }
  void fail() { b->set_mains({.voltage_v_rms = 0}); }
  void back() { b->set_mains({.voltage_v_rms = 400}); }
  bool decelerates() { return b.output("IPF"); }
  // Until the deceleration begins.
  void fails_and_begins() {
    fail();
    EXPECT_TRUE(b.run_until([&] { return decelerates(); }, 2));
  }
};

TEST(A700PowerFailure, Pr261Is0LetsTheMotorCoastWithAnAlarm) {
  Failing f({{"Pr.261", 0}});
  f.fail();
  ASSERT_TRUE(f.b.run_until([&] { return f.b.alarm("E.IPF"); }, 1));
  EXPECT_FALSE(f.decelerates());
  f.b.run(0.5);
  EXPECT_GT(rotor_hz(f.b), 35);
}

TEST(A700PowerFailure, Pr261Is1BringsTheMotorToAStopByItsOwnEnergy) {
  Failing f({{"Pr.261", 1}});
  f.fails_and_begins();
  double lowest_hz = 50;
  EXPECT_TRUE(f.b.run_until(
      [&] {
        if (f.b.port().status().running) lowest_hz = f.b.output_hz();
        return !f.b.port().status().running;
      },
      20));
  EXPECT_LT(lowest_hz, 15) << f.b->alarm_name();
  EXPECT_LT(rotor_hz(f.b), 15);
}

TEST(A700PowerFailure, AfterPr261Is1ANewStartIsNeededAfter2ItGoesOn) {
  Failing stays({{"Pr.261", 1}});
  stays.fails_and_begins();
  stays.b.run(0.3);
  EXPECT_TRUE(stays.b.port().status().stopping);
  stays.back();
  ASSERT_TRUE(stays.b.run_until([&] { return !stays.b.port().status().running; }, 20));
  EXPECT_EQ(stays.b->alarm_name(), "");
  EXPECT_TRUE(stays.decelerates()) << "until the start signal goes";
  stays.b.terminal("STF", false);
  stays.b.run(0.1);
  EXPECT_FALSE(stays.decelerates());
  stays.b.terminal("STF");
  stays.b.run(0.2);
  EXPECT_TRUE(stays.b.port().status().running);

  Failing resumes({{"Pr.261", 2}});
  resumes.fails_and_begins();
  resumes.b.run(0.5);
  EXPECT_LT(resumes.b.output_hz(), 48.5);
  resumes.back();
  resumes.b.run(0.1);
  EXPECT_FALSE(resumes.decelerates());
  EXPECT_TRUE(resumes.b.run_until([&] { return resumes.b.output_hz() > 49.9; }, 6)) << resumes.b->alarm_name();
}

TEST(A700PowerFailure, Pr262AndPr263TakeTheFrequencyDownAtOnce) {
  const auto first_step = [](const Settings& more) {
    Settings settings{{"Pr.261", 2}, {"Pr.264", 20}};
    settings.insert(settings.end(), more.begin(), more.end());
    Failing f(settings);
    f.fails_and_begins();
    f.b.run(0.012);
    return 50 - f.b.output_hz();
  };
  EXPECT_NEAR(first_step({{"Pr.262", 3}, {"Pr.263", 40}}), 3, 0.3);
  EXPECT_NEAR(first_step({{"Pr.262", 5}, {"Pr.263", 40}}), 5, 0.3);
  EXPECT_NEAR(first_step({{"Pr.262", 5}, {"Pr.263", 60}}), 0, 0.3) << "not below Pr.263";
  EXPECT_NEAR(first_step({{"Pr.262", 5}, {"Pr.263", 9999}}), 5, 0.3);
}

TEST(A700PowerFailure, Pr264ToPr266AreTheDeceleration) {
  // Hz per second from 45 to 25 Hz, where load and losses take about what the deceleration gives.
  const auto rate = [](const Settings& more, double nm) {
    Settings settings{{"Pr.261", 1}, {"Pr.262", 3}};
    settings.insert(settings.end(), more.begin(), more.end());
    Failing f(settings, 0.1, nm);
    f.fail();
    EXPECT_TRUE(f.b.run_until([&] { return f.b.output_hz() < 45; }, 2));
    const double from = f.b.now_s();
    EXPECT_TRUE(f.b.run_until([&] { return f.b.output_hz() < 25; }, 10));
    EXPECT_EQ(f.b->alarm_name(), "");
    return 20 / (f.b.now_s() - from);
  };
  // Held at the slower one the link would not last.
  EXPECT_NEAR(rate({{"Pr.264", 2}, {"Pr.265", 20}, {"Pr.266", 0}}, 6.8), 25, 2.5);
  EXPECT_NEAR(rate({{"Pr.264", 20}, {"Pr.265", 2}, {"Pr.266", 60}}, 6.8), 25, 2.5);
  EXPECT_NEAR(rate({{"Pr.264", 4}, {"Pr.266", 0}}, 2.9), 12.5, 1.2);
  EXPECT_NEAR(rate({{"Pr.264", 2}, {"Pr.265", 4}, {"Pr.266", 60}}, 2.9), 12.5, 1.2);
  EXPECT_NEAR(rate({{"Pr.264", 2}, {"Pr.265", 9999}, {"Pr.266", 60}}, 6.8), 25, 2.5);
}

TEST(A700PowerFailure, Pr261Is11AndPr294KeepTheLinkAlive) {
  // Alone a slow deceleration does not feed the losses of a loaded motor.
  const auto alarm = [](const Settings& more) {
    Settings settings{{"Pr.264", 20}, {"Pr.263", 60}};
    settings.insert(settings.end(), more.begin(), more.end());
    Failing f(settings, 0.15, 4);
    f.fail();
    f.b.run(0.2);
    return f.b->alarm_name();
  };
  EXPECT_EQ(alarm({{"Pr.261", 1}}), "E.IPF");
  EXPECT_EQ(alarm({{"Pr.261", 11}}), "");
  EXPECT_EQ(alarm({{"Pr.261", 12}}), "");
  EXPECT_EQ(alarm({{"Pr.261", 11}, {"Pr.294", 0}}), "E.IPF");
}

TEST(A700PowerFailure, AMissingPhaseDeceleratesInsteadOfTripping) {
  Failing f({{"Pr.261", 1}, {"Pr.872", 1}});
  f.b->set_mains({.voltage_v_rms = 400, .phase_present = {true, true, false}});
  f.b.run(1.2);
  EXPECT_TRUE(f.decelerates());
  EXPECT_TRUE(f.b.run_until([&] { return !f.b.port().status().running; }, 20));
  EXPECT_EQ(f.b->alarm_name(), "");
}

TEST(A700PowerFailure, ARestartTakesThePlaceOfAStop) {
  Failing f({{"Pr.261", 1}, {"Pr.57", 0.1}, {"Pr.58", 0.1}, {"Pr.186", 9999}});
  f.fail();
  f.b.run(0.15);
  EXPECT_FALSE(f.decelerates());
  f.back();
  EXPECT_TRUE(f.b.run_until([&] { return f.b.output_hz() > 49.9; }, 20)) << f.b->alarm_name();
}

// --- commercial supply ---

// MC1 to MC3 at SU, IPF and OL; MRS permits operation, CS on is the inverter.
struct Commercial {
  Bench b;
  explicit Commercial(const Settings& more = {}) : b(a700_with(with(more), config())) {}
  static InverterConfig config() {
    InverterConfig c = loaded(0.02, 2, config_a700());
    c.mains_frequency_hz = 50;
    return c;
  }
  static Settings with(const Settings& more) {
    Settings settings{{"Pr.135", 1},  {"Pr.136", 0.3}, {"Pr.137", 0.2}, {"Pr.57", 0.1}, {"Pr.58", 0.2}, {"Pr.4", 50},
                      {"Pr.191", 17}, {"Pr.192", 18},  {"Pr.193", 19},  {"Pr.7", 1},    {"Pr.8", 1}};
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
  }
  bool mc1() { return b.output("SU"); }
  bool mc2() { return b.output("IPF"); }
  bool mc3() { return b.output("OL"); }
  MotorSource source() { return b->plant().motor_source(); }
  void run_by_inverter() {
    b.terminal("MRS");
    b.terminal("CS");
    b.terminal("RH");
    b.terminal("STF");
    ASSERT_TRUE(b.run_until([&] { return b.output_hz() > 49.99; }, 10)) << b->alarm_name();
  }
};

TEST(A700Commercial, Pr135MakesTheContactorsFollowMrsAndCs) {
  Commercial c;
  c.b.run(1);
  EXPECT_TRUE(c.mc1());
  EXPECT_TRUE(c.mc3());
  c.b.terminal("STF");
  c.b.terminal("RH");
  c.b.terminal("CS");
  c.b.run(1);
  EXPECT_FALSE(c.b.port().status().running) << "MRS off: no operation";
  c.run_by_inverter();
  EXPECT_EQ(c.source(), MotorSource::kInverter);

  c.b.terminal("CS", false);
  c.b.run(0.01);
  EXPECT_FALSE(c.mc3());
  EXPECT_FALSE(c.mc2());
  EXPECT_EQ(c.source(), MotorSource::kOpen);
  EXPECT_FALSE(c.b.port().status().running);
  c.b.run(2);
  EXPECT_TRUE(c.mc2());
  EXPECT_EQ(c.source(), MotorSource::kMains);
  EXPECT_NEAR(c.b.signal("speed"), 1490, 15);
  EXPECT_EQ(monitor(c.b, 2), 0);
  EXPECT_EQ(monitor(c.b, 13), 0);

  c.b.terminal("CS");
  c.b.run(0.6);
  EXPECT_EQ(c.source(), MotorSource::kInverter);
  ASSERT_TRUE(c.b.run_until([&] { return c.b.port().status().running; }, 1));
  EXPECT_GT(c.b.output_hz(), 30) << "the turning motor is caught";
  EXPECT_TRUE(c.b.run_until([&] { return c.b.output_hz() > 49.9 && rotor_hz(c.b) > 48; }, 8)) << c.b->alarm_name();

  Commercial off({{"Pr.135", 0}});
  off.b.terminal("STF");
  off.b.terminal("RH");
  off.b.run(2);
  EXPECT_TRUE(off.b.port().status().running);
  EXPECT_FALSE(off.mc1() || off.mc2() || off.mc3());
}

TEST(A700Commercial, Pr136IsTheTimeWithBothContactorsOpenAndPr137TheWaitForTheStart) {
  const auto times = [](const Settings& more) {
    Commercial c(more);
    c.run_by_inverter();
    c.b.terminal("CS", false);
    const double open = seconds_until(
        c.b, [&] { return c.mc2(); }, 10);
    c.b.run(1);
    c.b.terminal("CS");
    EXPECT_TRUE(c.b.run_until([&] { return c.mc3(); }, 10));
    const double start = seconds_until(
        c.b, [&] { return c.b.port().status().running; }, 10);
    return std::pair(open, start);
  };
  const auto [open, start] = times({});
  EXPECT_NEAR(open, 0.3, 0.01);
  EXPECT_NEAR(start, 0.2 + 0.1, 0.01);  // and Pr.57
  EXPECT_NEAR(times({{"Pr.136", 0.8}}).first, 0.8, 0.01);
  EXPECT_NEAR(times({{"Pr.137", 0.7}}).second, 0.8, 0.01);
}

TEST(A700Commercial, Pr138PutsTheMotorOnTheMainsAtAnAlarm) {
  for (double pr138 : {0.0, 1.0}) {
    for (const char* alarm : {"E.OC2", "E.OHT", "E.CPU"}) {
      Commercial c({{"Pr.138", pr138}});
      c.run_by_inverter();
      ASSERT_TRUE(c.b->inject_fault(alarm, true).has_value());
      c.b.run(2);
      const bool mains = pr138 == 1 && std::string_view(alarm) == "E.OC2";
      EXPECT_EQ(c.source(), mains ? MotorSource::kMains : MotorSource::kOpen) << pr138 << alarm;
      EXPECT_EQ(c.mc2(), mains);
      EXPECT_FALSE(c.mc1());
      EXPECT_FALSE(c.mc3());
      EXPECT_EQ(rotor_hz(c.b) > 45, mains);
    }
  }
}

TEST(A700Commercial, Pr139SwitchesOverByItselfAndPr159Back) {
  Commercial c({{"Pr.139", 45}, {"Pr.159", 5}, {"Pr.5", 30}});
  c.b.terminal("MRS");
  c.b.terminal("CS");
  c.b.terminal("RH");
  c.b.terminal("STF");
  ASSERT_TRUE(c.b.run_until([&] { return c.source() == MotorSource::kMains; }, 10));
  c.b.run(2);
  EXPECT_NEAR(rotor_hz(c.b), 49.5, 0.5);
  // Less than Pr.139 - Pr.159 goes back to the inverter.
  c.b.terminal("RH", false);
  c.b.terminal("RM");
  ASSERT_TRUE(c.b.run_until([&] { return c.b.port().status().running && c.b.output_hz() < 30.1; }, 10))
      << c.b->alarm_name();
  EXPECT_EQ(c.source(), MotorSource::kInverter);

  Commercial stays({{"Pr.139", 45}, {"Pr.159", 9999}, {"Pr.5", 30}});
  stays.b.terminal("MRS");
  stays.b.terminal("CS");
  stays.b.terminal("RH");
  stays.b.terminal("STF");
  ASSERT_TRUE(stays.b.run_until([&] { return stays.source() == MotorSource::kMains; }, 10));
  stays.b.terminal("RH", false);
  stays.b.terminal("RM");
  stays.b.run(3);
  EXPECT_EQ(stays.source(), MotorSource::kMains);
  // The start signal off: the inverter takes the motor over and brings it to a stop.
  stays.b.terminal("STF", false);
  ASSERT_TRUE(stays.b.run_until([&] { return stays.b.port().status().running; }, 5));
  EXPECT_GT(stays.b.output_hz(), 30);
  ASSERT_TRUE(stays.b.run_until([&] { return !stays.b.port().status().running; }, 5)) << stays.b->alarm_name();
  EXPECT_LT(rotor_hz(stays.b), 5);
}

TEST(A700Commercial, WithoutControlSupplyTheContactorsFallOff) {
  Commercial c;
  c.run_by_inverter();
  c.b.terminal("CS", false);
  c.b.run(2);
  ASSERT_EQ(c.source(), MotorSource::kMains);
  c.b->set_power(false);
  ASSERT_TRUE(c.b.run_until([&] { return !c.b->powered(); }, 60));
  EXPECT_EQ(c.source(), MotorSource::kOpen);
}

TEST(A700Commercial, WithoutMc3AtATerminalTheMotorIsWiredToTheInverter) {
  Commercial c({{"Pr.193", 9999}});
  c.run_by_inverter();
  c.b.terminal("MRS", false);
  c.b.run(0.01);
  EXPECT_EQ(c.source(), MotorSource::kInverter);
  EXPECT_FALSE(c.b.port().status().running);
}

}  // namespace
}  // namespace vinv::inverter::test
