// What parameters of the FR-A700 do to the motor (protection): set, and something a user can see must follow. Typical
// for the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

// Current at which a blocked motor is held.
double blocked_a(const Settings& settings, std::string_view terminal = "") {
  Settings all = settings;
  all.emplace_back("Pr.4", 30);
  Bench b = a700_with(all);
  b->set_shaft_locked(true);
  if (!terminal.empty()) b.terminal(terminal);
  b.terminal("RH");
  b.terminal("STF");
  b.run(1.5);
  return b.output_a();
}

TEST(A700Parameter, StallLevelsOfTheThreeFunctions) {
  const double at_60 = blocked_a({{"Pr.22", 60}});
  EXPECT_NEAR(at_60, 2.4, 0.4);
  EXPECT_NEAR(blocked_a({{"Pr.22", 90}}), 3.6, 0.4);
  // Pr.48 with RT, unless Pr.49 is 0; Pr.114 with X9, unless Pr.115 is 0.
  EXPECT_NEAR(blocked_a({{"Pr.22", 90}, {"Pr.48", 60}, {"Pr.49", 9999}}, "RT"), at_60, 0.2);
  EXPECT_NEAR(blocked_a({{"Pr.22", 90}, {"Pr.48", 60}, {"Pr.49", 0}}, "RT"), 3.6, 0.4);
  EXPECT_NEAR(blocked_a({{"Pr.183", 9}, {"Pr.22", 90}, {"Pr.114", 60}, {"Pr.115", 60}}, "RT"), at_60, 0.2);
  EXPECT_NEAR(blocked_a({{"Pr.183", 9}, {"Pr.22", 90}, {"Pr.114", 60}, {"Pr.115", 0}}, "RT"), 3.6, 0.4);
}

TEST(A700Parameter, Pr156LeavesStallPreventionOutOfTheAcceleration) {
  const auto up = [](double pr156) {
    Bench b = a700_with({{"Pr.156", pr156}, {"Pr.22", 60}, {"Pr.7", 1}, {"Pr.4", 50}}, loaded(0.02, 0, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    return seconds_to_reach(b, 50, 60);
  };
  EXPECT_GT(up(0), up(2) + 0.3);
}

// A deceleration that is somewhat too steep waits for the DC link (oL on the panel); a much too steep one trips.
TEST(A700Parameter, Pr156SaysWhetherADecelerationWaitsForTheLink) {
  struct Stop {
    std::string alarm, warning;
    double seconds = 0, most_v = 0;
    bool overload = false;
  };
  const auto stop = [](double pr156, double inertia, const Settings& more = {}) {
    Settings s{{"Pr.156", pr156}, {"Pr.7", 5}, {"Pr.8", 2}};
    s.insert(s.end(), more.begin(), more.end());
    Bench b = a700_running(50, s, loaded(inertia, 0, config_a700()));
    EXPECT_TRUE(b.command({}).has_value());
    Stop seen;
    const double from = b.now_s();
    while (b.port().status().running && b.now_s() < from + 10) {
      b.tick();
      seen.most_v = std::max(seen.most_v, b.signal("dc_link"));
      seen.overload = seen.overload || b.port().status().overload;
      const std::string warning = dynamic_cast<a700::A700Inverter&>(*b).du07().warning;
      if (!warning.empty()) seen.warning = warning;
    }
    seen.alarm = b->alarm_name();
    seen.seconds = b.now_s() - from;
    return seen;
  };
  const Settings speed_control{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.800", 10}};
  for (const Settings& control : {Settings{}, speed_control}) {
    const Stop held = stop(0, 0.017, control);
    EXPECT_EQ(held.alarm, "");
    EXPECT_TRUE(held.overload);
    EXPECT_EQ(held.warning, "oL");
    EXPECT_GT(held.seconds, 1.8);
    EXPECT_LT(held.seconds, 4.0);
    EXPECT_GT(held.most_v, 760);
    EXPECT_EQ(stop(8, 0.017, control).alarm, "E.OV3");
    EXPECT_EQ(stop(0, 0.2, control).alarm, "E.OV3");
    EXPECT_FALSE(stop(0, 0.005, control).overload);
  }
}

TEST(A700Parameter, Pr23AndPr66LowerTheStallLevelAtHighFrequency) {
  const auto load_carried = [](const Settings& settings) {
    Settings all = settings;
    all.emplace_back("Pr.22", 100);
    all.emplace_back("Pr.4", 90);
    Bench b = a700_with(all, loaded(0, 4.5, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    b.run(8);
    return b.output_hz();
  };
  EXPECT_NEAR(load_carried({}), 90, 0.5);
  EXPECT_LT(load_carried({{"Pr.23", 50}, {"Pr.66", 30}}), 85);
}

TEST(A700Parameter, Pr9Pr51AndPr71SetTheMotorThermal) {
  const auto thermal = [](const Settings& settings, std::string_view terminal = "") {
    Settings all = settings;
    all.emplace_back("Pr.4", 20);
    Bench b = a700_with(all, loaded(0, 8, config_a700()));
    if (!terminal.empty()) b.terminal(terminal);
    b.terminal("STF");
    b.terminal("RH");
    b.run(20);
    return b.signal("motor_thermal");
  };
  const double base = thermal({});
  EXPECT_GT(thermal({{"Pr.9", 2.5}}), 1.5 * base);
  EXPECT_GT(thermal({{"Pr.51", 2.5}}, "RT"), 1.5 * base);
  EXPECT_LT(thermal({{"Pr.71", 1}}), 0.8 * base);
}

TEST(A700Parameter, Pr30AndPr70GiveTheBrakeDuty) {
  InverterConfig config = loaded(0.1, 0, config_a700());
  config.brake_resistance_ohm = 200;
  const auto used = [&](const Settings& settings) {
    Settings all = settings;
    all.emplace_back("Pr.7", 3);
    all.emplace_back("Pr.4", 50);
    Bench b = a700_with(all, config);
    b.terminal("STF");
    b.terminal("RH");
    b.run(5);
    b.terminal("STF", false);
    b.run(0.5);
    return b.signal("brake_duty");
  };
  const double base = used({});
  EXPECT_GT(base, 0);
  EXPECT_LT(used({{"Pr.30", 1}, {"Pr.70", 30}}), base / 2);
  EXPECT_GT(used({{"Pr.30", 1}, {"Pr.70", 10}}), 2 * used({{"Pr.30", 1}, {"Pr.70", 30}}));
  EXPECT_NEAR(used({{"Pr.30", 0}, {"Pr.70", 30}}), base, 1e-9);
}

TEST(A700Parameter, Pr57AndPr58RestartAfterAShortPowerFailure) {
  const auto after_dip = [](Settings settings, bool cs) {
    settings.emplace_back("Pr.4", 30);
    Bench b = a700_with(settings, loaded(0.02, 2, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    if (cs) b.terminal("CS");
    b.run(3);
    b->set_mains({.voltage_v_rms = 200});
    b.run(0.5);
    b->set_mains({.voltage_v_rms = 400});
    return seconds_until(
        b, [&] { return b.output_v() > 200 || b.now_s() > 40; }, 60);
  };
  const double quick = after_dip({{"Pr.57", 0.1}, {"Pr.58", 0.1}}, true);
  EXPECT_LT(quick, 2);
  EXPECT_GT(after_dip({{"Pr.57", 2}, {"Pr.58", 0.1}}, true), quick + 1);
  EXPECT_GT(after_dip({{"Pr.57", 0.1}, {"Pr.58", 3}}, true), quick + 0.5);
}

TEST(A700Parameter, Pr251SaysWhetherAnOpenOutputPhaseTrips) {
  for (int pr251 : {0, 1}) {
    Bench b = a700_with({{"Pr.251", static_cast<double>(pr251)}, {"Pr.4", 30}});
    ASSERT_TRUE(b->inject_fault("output_phase_open", true).has_value());
    b.terminal("STF");
    b.terminal("RH");
    b.run(2);
    EXPECT_EQ(b.alarm("E.LF"), pr251 == 1);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
