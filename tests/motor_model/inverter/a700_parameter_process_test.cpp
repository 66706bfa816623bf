// What parameters of the FR-A700 do to the motor (process control, traverse): set, and something a user can see must
// follow. Typical for the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

// A plant in which terminal 4 follows the output: 50 Hz is 100 %.
void follow(Bench& b, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds * 100); ++i) {
    ASSERT_TRUE(b->set_analog("4", 4 + 16 * std::min(1.0, b.output_hz() / 50)).has_value());
    b.run(0.01);
  }
}

TEST(A700Parameter, Pr127ToPr134AreThePidControlThatX14SwitchesOn) {
  const Settings pid{{"Pr.183", 14},   {"Pr.128", 20}, {"Pr.129", 200}, {"Pr.130", 0.5}, {"Pr.133", 40},
                     {"Pr.134", 9999}, {"Pr.192", 47}, {"Pr.193", 15},  {"Pr.194", 14}};
  Bench b = a700_with(pid);
  b.terminal("STF");
  follow(b, 1);
  EXPECT_EQ(b.output_hz(), 0);  // without X14 the input sets the frequency
  b.terminal("RT");
  follow(b, 8);
  EXPECT_NEAR(b.output_hz(), 20, 0.5);  // 40 % of 50 Hz
  EXPECT_TRUE(b.output("IPF"));         // PID
  EXPECT_NEAR(monitor(b, 52), 400, 1);
  EXPECT_NEAR(monitor(b, 53), 400, 12);
  EXPECT_NEAR(static_cast<std::int16_t>(monitor(b, 54)), 0, 12);
  EXPECT_FALSE(b.output("OL"));

  Settings limits = pid;
  limits.emplace_back("Pr.131", 30);
  limits.emplace_back("Pr.132", 10);
  Bench c = a700_with(limits);
  c.terminal("STF");
  c.terminal("RT");
  follow(c, 0.05);
  EXPECT_TRUE(c.output("FU"));  // FDN
  follow(c, 6);
  EXPECT_TRUE(c.output("OL"));  // FUP

  // Pr.127: runs up to there first.
  Settings start = pid;
  start.emplace_back("Pr.127", 10);
  Bench d = a700_with(start);
  d.terminal("STF");
  d.terminal("RT");
  ASSERT_TRUE(d->set_analog("4", 20).has_value());  // far above the set point
  bool reached = false;
  for (int i = 0; i < 1000; ++i) {
    d.tick();
    reached = reached || d.output_hz() >= 10;
  }
  EXPECT_TRUE(reached);
  d.run(4);
  EXPECT_LT(d.output_hz(), 1);
}

TEST(A700Parameter, Pr129AndPr134AreTheBandAndTheDerivativeOfThePid) {
  // Pr.129 without an integral: 10 % of deviation at 200 % are 5 % of Pr.903's frequency, at 50 % they are 20 %.
  const auto by_ten = [](double pr129, const Settings& more, double after_s) {
    Settings proportional{{"Pr.183", 14}, {"Pr.128", 20}, {"Pr.129", pr129}, {"Pr.130", 9999}, {"Pr.133", 40}};
    for (const auto& one : more) proportional.push_back(one);
    Bench b = a700_with(proportional);
    b.terminal("STF");
    b.terminal("RT");
    EXPECT_TRUE(b->set_analog("4", 4 + 16 * 0.3).has_value());
    b.run(3);
    const double before = b.output_hz();
    EXPECT_TRUE(b->set_analog("4", 4 + 16 * 0.2).has_value());
    b.run(after_s);
    return std::pair(before, b.output_hz());
  };
  EXPECT_NEAR(by_ten(200, {}, 0).first, 3, 0.1);
  EXPECT_NEAR(by_ten(50, {}, 0).first, 12, 0.2);
  // Pr.134: a falling measured value adds to the output while it falls.
  EXPECT_GT(by_ten(200, {{"Pr.134", 5}}, 0.3).second, by_ten(200, {}, 0.3).second + 1);
  EXPECT_NEAR(by_ten(200, {{"Pr.134", 5}}, 6).second, 6, 0.2);
}

TEST(A700Parameter, Pr128AndX64ChooseTheAction) {
  const auto runs = [](double pr128, bool x64) {
    Bench b = a700_with({{"Pr.183", 14}, {"Pr.182", 64}, {"Pr.128", pr128}, {"Pr.133", 50}});
    b.terminal("STF");
    b.terminal("RT");
    if (x64) b.terminal("RH");
    EXPECT_TRUE(b->set_analog("4", 4).has_value());  // far below the set point
    b.run(2);
    return b.output_hz() > 30;
  };
  EXPECT_TRUE(runs(20, false));
  EXPECT_FALSE(runs(20, true));
  EXPECT_FALSE(runs(21, false));
  EXPECT_TRUE(runs(21, true));
  // 10: the deviation comes at terminal 1.
  Bench b = a700_with({{"Pr.183", 14}, {"Pr.128", 10}, {"Pr.129", 100}, {"Pr.130", 9999}});
  b.terminal("STF");
  b.terminal("RT");
  ASSERT_TRUE(b->set_analog("1", 5).has_value());
  b.run(3);
  EXPECT_NEAR(b.output_hz(), 30, 0.3);
}

TEST(A700Parameter, Pr575ToPr577StopAnIdlePump) {
  Bench b = a700_with({{"Pr.183", 14},
                       {"Pr.128", 20},
                       {"Pr.129", 100},
                       {"Pr.130", 9999},
                       {"Pr.133", 40},
                       {"Pr.575", 3},
                       {"Pr.576", 10},
                       {"Pr.577", 1020},
                       {"Pr.192", 70}});
  b.terminal("STF");
  b.terminal("RT");
  ASSERT_TRUE(b->set_analog("4", 4 + 16 * 0.3).has_value());  // 10 % below the set point
  b.run(2.5);
  EXPECT_TRUE(b.port().status().running);
  b.run(1.5);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_TRUE(b.output("IPF"));                               // SLEEP
  ASSERT_TRUE(b->set_analog("4", 4 + 16 * 0.1).has_value());  // 30 % below: wakes up
  b.run(0.7);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_FALSE(b.output("IPF"));
}

TEST(A700Parameter, Pr278ToPr283AreTheBrakeSequenceThatPr292SwitchesOn) {
  InverterConfig config = config_a700();
  config.load.hoist_nm = 5;
  const auto hoist = [&](double pr292, bool reports) {
    Bench b = a700_with({{"Pr.80", 1.5},
                         {"Pr.81", 4},
                         {"Pr.84", 50},
                         {"Pr.292", pr292},
                         {"Pr.183", 15},
                         {"Pr.192", 20},
                         {"Pr.278", 3},
                         {"Pr.279", 50},
                         {"Pr.280", 0.3},
                         {"Pr.281", 0.5},
                         {"Pr.282", 6},
                         {"Pr.283", 0.4},
                         {"Pr.4", 30}},
                        config);
    // The brake holds the shaft until it is asked to open, and reports at terminal RT (BRI).
    const auto run = [&b, reports](double seconds) {
      for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
        const bool open = b.output("IPF");  // BOF
        b->set_shaft_locked(!open);
        if (reports) b.terminal("RT", open);
        b.tick();
      }
    };
    b->set_shaft_locked(true);
    b.terminal("RH");
    b.terminal("STF");
    run(0.3);
    EXPECT_FALSE(b.output("IPF"));
    run(0.5);
    EXPECT_EQ(b.output("IPF"), true);
    EXPECT_LT(b.output_hz(), 6);  // waits for Pr.281
    run(3);
    return std::pair(std::move(b), run);
  };
  auto [seven, run_seven] = hoist(7, true);
  EXPECT_EQ(seven->alarm_name(), "");
  EXPECT_GT(seven.output_hz(), 29);
  auto [eight, run_eight] = hoist(8, false);
  EXPECT_GT(eight.output_hz(), 29);
  // With 7 a brake that does not report is E.MB5.
  auto [silent, run_silent] = hoist(7, false);
  EXPECT_EQ(silent->alarm_name(), "E.MB5");
}

TEST(A700Parameter, Pr278Pr279AndPr280SayWhenTheBrakeMayOpen) {
  struct Opening {
    double after_s = 0;
    double ramp_hz = 0;
    std::string alarm;
  };
  const auto opening = [](Settings more) {
    more.insert(more.begin(), {{"Pr.80", 1.5},
                               {"Pr.81", 4},
                               {"Pr.84", 50},
                               {"Pr.245", 0},
                               {"Pr.292", 8},
                               {"Pr.192", 20},
                               {"Pr.279", 50},
                               {"Pr.4", 30}});
    Bench b = a700_with(more);
    b->set_shaft_locked(true);
    b.terminal("RH");
    b.terminal("STF");
    const double from = b.now_s();
    b.run_until([&] { return b.output("IPF") || !b->alarm_name().empty(); }, 5);
    return Opening{b.now_s() - from, b.output_hz(), b->alarm_name()};
  };
  const Opening base = opening({{"Pr.280", 0.5}});
  EXPECT_NEAR(base.ramp_hz, 3, 0.05);
  const Opening late = opening({{"Pr.280", 1.5}});
  EXPECT_NEAR(late.after_s - base.after_s, 1, 0.05);
  EXPECT_NEAR(opening({{"Pr.280", 0.5}, {"Pr.278", 4}}).ramp_hz, 4, 0.05);
  EXPECT_EQ(opening({{"Pr.279", 200}, {"Pr.22", 120}}).alarm, "E.MB4");  // such a current never flows
}

TEST(A700Parameter, TheBrakeClosesAtPr282OnTheWayDown) {
  Bench b = a700_with({{"Pr.80", 1.5},
                       {"Pr.81", 4},
                       {"Pr.84", 50},
                       {"Pr.292", 8},
                       {"Pr.192", 20},
                       {"Pr.279", 10},
                       {"Pr.282", 10},
                       {"Pr.283", 1},
                       {"Pr.4", 30}});
  b.terminal("RH");
  b.terminal("STF");
  b.run(4);
  ASSERT_TRUE(b.output("IPF"));
  b.terminal("STF", false);
  ASSERT_TRUE(b.run_until([&] { return !b.output("IPF"); }, 3));
  EXPECT_NEAR(b.output_hz(), 10, 1);
  b.run(0.9);
  EXPECT_NEAR(b.output_hz(), 10, 1);  // waits for Pr.283
  EXPECT_TRUE(b.run_until([&] { return !b.port().status().running; }, 3));
}

TEST(A700Parameter, Pr157DelaysTheSignalOl) {
  const auto seen = [](double pr157) {
    Bench b = a700_with({{"Pr.157", pr157}, {"Pr.22", 60}, {"Pr.4", 30}});
    b->set_shaft_locked(true);
    b.terminal("STF");
    b.terminal("RH");
    bool on = false;
    for (int i = 0; i < 1500; ++i) {
      b.tick();
      on = on || b.output("OL");
    }
    return on;
  };
  EXPECT_TRUE(seen(0));
  EXPECT_TRUE(seen(0.5));
  EXPECT_FALSE(seen(5));
  EXPECT_FALSE(seen(9999));
}

TEST(A700Parameter, Pr161LocksTheKeysButStop) {
  for (double pr161 : {0.0, 1.0, 10.0, 11.0}) {
    Bench b = a700_with({{"Pr.161", pr161}, {"Pr.79", 1}});
    EXPECT_EQ(b->press_key(PanelKey::kFwd).has_value(), pr161 < 10);
    EXPECT_TRUE(b->press_key(PanelKey::kStopReset).has_value());
  }
}

TEST(A700Parameter, Pr592ToPr597AreTheTraverse) {
  const auto swing = [](const Settings& settings, bool network = false, bool x37 = false) {
    Settings all{{"Pr.593", 20},
                 {"Pr.594", 0},
                 {"Pr.595", 0},
                 {"Pr.596", 2},
                 {"Pr.597", 1},
                 {"Pr.4", 40},
                 {"Pr.340", network ? 1.0 : 0.0}};
    for (const auto& [name, value] : settings) all.emplace_back(name, value);
    Bench b = a700_with(all);
    if (network) {
      EXPECT_TRUE(b.frequency(40).has_value());
      EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
    }
    b.terminal("STF");
    b.terminal("RH");
    if (x37) b.terminal("RT");
    b.run(2);
    struct {
      double low = 100, high = 0, mean = 0, rising_s = 0;
    } seen;
    double last = b.output_hz();
    for (int i = 0; i < 6000; ++i) {  // two whole swings
      b.tick();
      if (i % 50 == 0) {
        if (b.output_hz() > last) seen.rising_s += 0.05;
        last = b.output_hz();
      }
      seen.low = std::min(seen.low, b.output_hz());
      seen.high = std::max(seen.high, b.output_hz());
      seen.mean += b.output_hz() / 6000;
    }
    return seen;
  };
  const auto plain = swing({{"Pr.592", 1}});
  EXPECT_NEAR(plain.low, 32, 0.2);
  EXPECT_NEAR(plain.high, 48, 0.2);
  EXPECT_NEAR(plain.mean, 40, 0.1);
  EXPECT_NEAR(plain.rising_s, 6 * 2.0 / 3, 0.15);                                                 // Pr.596
  EXPECT_NEAR(swing({{"Pr.592", 1}, {"Pr.596", 1}, {"Pr.597", 2}}).rising_s, 6 * 1.0 / 3, 0.15);  // Pr.597
  EXPECT_NEAR(swing({{"Pr.592", 0}}).high, 40, 0.01);
  EXPECT_NEAR(swing({{"Pr.592", 1}}, true).high, 40, 0.01);
  EXPECT_NEAR(swing({{"Pr.592", 2}}, true).high, 48, 0.2);
  EXPECT_NEAR(swing({{"Pr.592", 1}, {"Pr.183", 37}}).high, 40, 0.01);
  EXPECT_NEAR(swing({{"Pr.592", 1}, {"Pr.183", 37}}, false, true).high, 48, 0.2);
  EXPECT_LT(swing({{"Pr.592", 1}, {"Pr.594", 50}}).mean, plain.mean - 0.3);
  EXPECT_GT(swing({{"Pr.592", 1}, {"Pr.595", 50}}).mean, plain.mean + 0.3);
}

}  // namespace
}  // namespace vinv::inverter::test
