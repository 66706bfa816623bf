// What parameters of the FR-A700 do to the motor: set, and something a user can see must follow. Typical for the
// family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/inverter.hpp"

namespace vinv::inverter::test {
namespace {

// Output voltage while running at this frequency, with a light motor.
double volts_at(double hz, Settings settings, std::string_view terminal = "") {
  settings.emplace_back("Pr.4", hz);
  Bench b = a700_with(settings);
  b.terminal("STF");
  b.terminal("RH");
  if (!terminal.empty()) b.terminal(terminal);
  EXPECT_TRUE(b.run_until([&] { return b.output_hz() > hz - 0.01; }, 20)) << b->alarm_name();
  b.run(0.3);
  return b.output_v();
}

// Seconds from a start by RH to its frequency, and back to standstill.
std::pair<double, double> ramps(Settings settings, std::string_view terminal = "", double hz = 50) {
  settings.emplace_back("Pr.11", 0);
  settings.emplace_back("Pr.4", hz);
  Bench b = a700_with(settings);
  b.terminal("RH");
  if (!terminal.empty()) b.terminal(terminal);
  b.terminal("STF");
  const double up = seconds_to_reach(b, hz);
  b.run(0.1);
  b.terminal("STF", false);
  return {up, seconds_to_stop(b)};
}

double running_hz(const Settings& settings, std::initializer_list<std::string_view> terminals) {
  Bench b = a700_with(settings);
  b.terminal("STF");
  for (std::string_view t : terminals) b.terminal(t);
  b.run(3);
  return b.output_hz();
}

// --- frequency ---

TEST(A700Parameter, EachOfTheFifteenSpeedsHasItsParameter) {
  struct Case {
    std::string parameter;
    std::vector<std::string_view> on;
  };
  for (const Case& c : {Case{"Pr.4", {"RH"}},
                        {"Pr.5", {"RM"}},
                        {"Pr.6", {"RL"}},
                        {"Pr.24", {"RM", "RL"}},
                        {"Pr.25", {"RH", "RL"}},
                        {"Pr.26", {"RH", "RM"}},
                        {"Pr.27", {"RH", "RM", "RL"}},
                        {"Pr.232", {"JOG"}},
                        {"Pr.233", {"JOG", "RL"}},
                        {"Pr.234", {"JOG", "RM"}},
                        {"Pr.235", {"JOG", "RM", "RL"}},
                        {"Pr.236", {"JOG", "RH"}},
                        {"Pr.237", {"JOG", "RH", "RL"}},
                        {"Pr.238", {"JOG", "RH", "RM"}},
                        {"Pr.239", {"JOG", "RH", "RM", "RL"}}}) {
    Bench b = a700_with({{"Pr.185", 8}, {c.parameter, 17}});  // REX at terminal JOG
    b.terminal("STF");
    for (std::string_view t : c.on) b.terminal(t);
    b.run(1);
    EXPECT_NEAR(b.output_hz(), 17, 0.01) << c.parameter;
  }
}

TEST(A700Parameter, Pr1Pr2Pr13AndPr18LimitTheFrequency) {
  EXPECT_NEAR(running_hz({{"Pr.1", 33}, {"Pr.4", 40}}, {"RH"}), 33, 0.01);
  EXPECT_NEAR(running_hz({{"Pr.1", 33}, {"Pr.18", 130}, {"Pr.4", 40}}, {"RH"}), 40, 0.01);
  EXPECT_NEAR(running_hz({{"Pr.2", 12}}, {}), 12, 0.01);
  EXPECT_EQ(running_hz({{"Pr.13", 10}, {"Pr.4", 9}}, {"RH"}), 0);
  EXPECT_NEAR(running_hz({{"Pr.13", 10}, {"Pr.4", 11}}, {"RH"}), 11, 0.01);
}

TEST(A700Parameter, FrequenciesBetweenTheJumpsAreLeftOut) {
  const std::pair<std::string, std::string> bands[] = {{"Pr.31", "Pr.32"}, {"Pr.33", "Pr.34"}, {"Pr.35", "Pr.36"}};
  for (const auto& [a, b] : bands) {
    EXPECT_NEAR(running_hz({{a, 18}, {b, 22}, {"Pr.4", 20}}, {"RH"}), 18, 0.01);
    EXPECT_NEAR(running_hz({{a, 22}, {b, 18}, {"Pr.4", 20}}, {"RH"}), 22, 0.01);
  }
}

TEST(A700Parameter, Pr59MakesRhRmAndRlARemoteSetting) {
  for (int pr59 : {0, 1, 2, 3}) {
    Bench b = a700_with({{"Pr.59", static_cast<double>(pr59)}, {"Pr.44", 1}, {"Pr.4", 60}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.4);
    b.terminal("RH", false);
    b.run(1);
    EXPECT_NEAR(b.output_hz(), pr59 == 0 ? 0 : 20, 0.5) << pr59;
    b.terminal("RL");
    b.run(1);
    EXPECT_NEAR(b.output_hz(), pr59 == 0 ? 10 : 0, 0.5) << pr59;
  }
}

TEST(A700Parameter, CalibrationsShiftTheAnalogInputs) {
  const auto set = [](const Settings& settings, double volt_2, double ma_4) {
    Bench b = a700_with(settings);
    EXPECT_TRUE(b->set_analog("2", volt_2).has_value());
    EXPECT_TRUE(b->set_analog("4", ma_4).has_value());
    if (ma_4 > 0) b.terminal("AU");
    b.run(0.5);
    return b.signal("set_frequency");
  };
  EXPECT_NEAR(set({{"Pr.125", 40}}, 5, 0), 40, 0.02);
  EXPECT_NEAR(set({{"Pr.903.1", 40}}, 5, 0), 40, 0.02);
  EXPECT_NEAR(set({{"C4", 50}}, 2.5, 0), 60, 0.02);  // Pr.903
  EXPECT_NEAR(set({{"C2", 10}}, 0, 0), 10, 0.02);    // Pr.902
  EXPECT_NEAR(set({{"C3", 50}}, 2.5, 0), 0, 0.02);   // Pr.902
  EXPECT_NEAR(set({{"Pr.126", 30}}, 0, 20), 30, 0.02);
  EXPECT_NEAR(set({{"Pr.905.1", 30}}, 0, 20), 30, 0.02);
  EXPECT_NEAR(set({{"C7", 60}}, 0, 12), 60, 0.02);  // Pr.905
  EXPECT_NEAR(set({{"C5", 10}}, 0, 4), 10, 0.02);   // Pr.904
  EXPECT_NEAR(set({{"C6", 0}}, 0, 10), 30, 0.02);   // Pr.904
}

TEST(A700Parameter, Pr917AndPr918AreTheLineOfTerminalOne) {
  const auto set = [](const Settings& settings) {
    Bench b = a700_with(settings);
    EXPECT_TRUE(b->set_analog("1", 5).has_value());
    b.run(0.5);
    return b.signal("set_frequency");
  };
  EXPECT_NEAR(set({}), 30, 0.02);
  EXPECT_NEAR(set({{"Pr.917.1", 10}}), 35, 0.02);
  EXPECT_NEAR(set({{"Pr.917.2", 50}}), 0, 0.02);
  EXPECT_NEAR(set({{"Pr.918.1", 40}}), 20, 0.02);
  EXPECT_NEAR(set({{"Pr.918.2", 50}}), 60, 0.02);
  EXPECT_NEAR(set({{"Pr.868", 9999}}), 0, 0.02);
}

TEST(A700Parameter, Pr74FiltersTheInputs) {
  const auto after_20_ms = [](double pr74) {
    Bench b = a700_with({{"Pr.74", pr74}});
    EXPECT_TRUE(b->set_analog("2", 5).has_value());
    b.run(0.02);
    return b.signal("set_frequency");
  };
  EXPECT_GT(after_20_ms(0), 55);
  EXPECT_LT(after_20_ms(8), 5);
}

TEST(A700Parameter, Pr243AddsTerminalOneToTerminalFour) {
  Bench b = a700_with({{"Pr.243", 50}});
  b.terminal("AU");
  ASSERT_TRUE(b->set_analog("4", 12).has_value());
  ASSERT_TRUE(b->set_analog("1", 5).has_value());
  b.run(0.5);
  EXPECT_NEAR(b.signal("set_frequency"), 45, 0.05);
}

// --- ramps ---

TEST(A700Parameter, RampTimesAndThirdFunctions) {
  const auto near = [](std::pair<double, double> got, double up, double down) {
    EXPECT_NEAR(got.first, up, 0.03);
    EXPECT_NEAR(got.second, down, 0.05);
  };
  near(ramps({{"Pr.7", 1}, {"Pr.8", 2}}), 0.99, 1.99);
  near(ramps({{"Pr.7", 1}, {"Pr.8", 2}, {"Pr.20", 100}}), 0.5, 1.0);
  near(ramps({{"Pr.21", 1}, {"Pr.7", 0.75}, {"Pr.8", 0.75}}), 0.75, 0.75);
  near(ramps({{"Pr.44", 2}}, "RT"), 1.98, 1.98);
  near(ramps({{"Pr.44", 2}, {"Pr.45", 1}}, "RT"), 1.98, 0.99);
  // X9 at terminal RT.
  near(ramps({{"Pr.183", 9}, {"Pr.110", 1.5}}, "RT"), 1.48, 1.48);
  near(ramps({{"Pr.183", 9}, {"Pr.110", 1.5}, {"Pr.111", 1}}, "RT"), 1.48, 0.99);
  near(ramps({{"Pr.183", 9}, {"Pr.110", 9999}, {"Pr.111", 1}}, "RT"), 0.5, 0.5);
}

TEST(A700Parameter, Pr16IsTheRampOfTheJogOperation) {
  Bench b = a700_with({{"Pr.15", 20}, {"Pr.16", 2}});
  b.terminal("JOG");
  b.terminal("STF");
  EXPECT_NEAR(seconds_to_reach(b, 20), 0.8, 0.05);
}

TEST(A700Parameter, Pr155Is10LetsRtActAtConstantSpeedOnly) {
  for (int pr155 : {0, 10}) {
    Bench b = a700_with({{"Pr.155", static_cast<double>(pr155)}, {"Pr.44", 5}, {"Pr.4", 50}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.2);
    b.terminal("RT");
    EXPECT_NEAR(seconds_to_reach(b, 50), pr155 == 10 ? 0.3 : 3.1, 0.2);
  }
}

TEST(A700Parameter, Pr29ShapesTheRamp) {
  const auto at_quarter = [](int pr29) {
    Bench b = a700_with({{"Pr.29", static_cast<double>(pr29)}, {"Pr.7", 2}, {"Pr.4", 50}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.5);
    return b.output_hz();
  };
  EXPECT_NEAR(at_quarter(0), 12.9, 0.3);
  EXPECT_LT(at_quarter(1), 12);
  EXPECT_LT(at_quarter(2), 9);
}

TEST(A700Parameter, Pr29Is3StopsTheRampsAsPr140ToPr143Say) {
  const Settings backlash{{"Pr.29", 3}, {"Pr.140", 5}, {"Pr.141", 1}, {"Pr.142", 8}, {"Pr.143", 0.8}};
  const auto [up, down] = ramps(backlash);
  EXPECT_NEAR(up, 1.5, 0.05);
  EXPECT_NEAR(down, 1.3, 0.05);
  Bench b = a700_with({{"Pr.29", 3}, {"Pr.140", 5}, {"Pr.141", 1}, {"Pr.4", 50}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 5, 0.01);
  Bench c = a700_with({{"Pr.29", 3}, {"Pr.142", 8}, {"Pr.143", 1}, {"Pr.4", 50}});
  c.terminal("STF");
  c.terminal("RH");
  c.run(3);
  c.terminal("STF", false);
  c.run(1);
  EXPECT_NEAR(c.output_hz(), 8, 0.01);
}

TEST(A700Parameter, Pr29Is4AddsTheSPartsOfPr380ToPr383) {
  Settings s{{"Pr.29", 4}, {"Pr.7", 2}, {"Pr.8", 1}, {"Pr.380", 50}, {"Pr.381", 20}, {"Pr.382", 10}, {"Pr.383", 50}};
  const auto [up, down] = ramps(s);
  EXPECT_NEAR(up, 3.0, 0.1);
  EXPECT_NEAR(down, 1.2, 0.1);
  s.emplace_back("Pr.183", 20);  // X20 at terminal RT
  const auto [up_2, down_2] = ramps(s, "RT");
  EXPECT_NEAR(up_2, 2.2, 0.1);
  EXPECT_NEAR(down_2, 1.5, 0.1);
}

TEST(A700Parameter, Pr571HoldsTheStartFrequency) {
  Bench b = a700_with({{"Pr.571", 1}, {"Pr.13", 3}, {"Pr.4", 50}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(0.9);
  EXPECT_NEAR(b.output_hz(), 3, 0.01);
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 50, 0.01);
}

TEST(A700Parameter, Pr250CoastsOrMakesStrTheDirection) {
  Bench b = a700_with({{"Pr.250", 0.5}, {"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(1);
  b.terminal("STF", false);
  EXPECT_NEAR(seconds_to_stop(b), 0.5, 0.02);
  Bench c = a700_with({{"Pr.250", 8888}, {"Pr.4", 30}});
  c.terminal("STF");
  c.terminal("STR");
  c.terminal("RH");
  c.run(1);
  EXPECT_TRUE(c.port().status().reverse);
}

TEST(A700Parameter, Pr78ForbidsADirection) {
  for (int pr78 : {0, 1, 2}) {
    for (const char* terminal : {"STF", "STR"}) {
      Bench b = a700_with({{"Pr.78", static_cast<double>(pr78)}, {"Pr.4", 30}});
      b.terminal(terminal);
      b.terminal("RH");
      b.run(0.5);
      const bool forward = std::string_view(terminal) == "STF";
      EXPECT_EQ(b.port().status().running, pr78 == 0 || (pr78 == 1) == forward);
    }
  }
}

// --- voltage ---

TEST(A700Parameter, VoltageFollowsTheVfParameters) {
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}}), 200, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 10}}), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.3", 100}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.19", 200}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.19", 8888}}), 190, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 0}, {"Pr.14", 1}}), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.0", 10}, {"Pr.14", 3}}), 200, 2);  // boost in reverse only
  EXPECT_NEAR(volts_at(25, {{"Pr.46", 10}, {"Pr.0", 0}}, "RT"), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.47", 100}, {"Pr.0", 0}}, "RT"), 100, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.183", 9}, {"Pr.112", 10}, {"Pr.0", 0}}, "RT"), 220, 2);
  EXPECT_NEAR(volts_at(25, {{"Pr.183", 9}, {"Pr.113", 100}, {"Pr.0", 0}}, "RT"), 100, 2);
}

TEST(A700Parameter, X17TakesTheHoistBoostOfPr14Away) {
  // X17 at terminal RT; 5 boosts the reverse direction only, with X17 both.
  const Settings hoist{{"Pr.0", 10}, {"Pr.14", 5}, {"Pr.183", 17}};
  EXPECT_NEAR(volts_at(25, hoist), 200, 2);
  EXPECT_NEAR(volts_at(25, hoist, "RT"), 220, 2);
}

TEST(A700Parameter, Pr71Is2MakesPr100ToPr109TheVfLaw) {
  const Settings law{{"Pr.71", 2},    {"Pr.19", 400},  {"Pr.0", 0},    {"Pr.100", 10},  {"Pr.101", 40},
                     {"Pr.102", 20},  {"Pr.103", 120}, {"Pr.104", 30}, {"Pr.105", 180}, {"Pr.106", 35},
                     {"Pr.107", 250}, {"Pr.108", 40},  {"Pr.109", 330}};
  EXPECT_NEAR(volts_at(10, law), 40, 2);
  EXPECT_NEAR(volts_at(15, law), 80, 2);
  EXPECT_NEAR(volts_at(30, law), 180, 2);
  EXPECT_NEAR(volts_at(35, law), 250, 3);
  EXPECT_NEAR(volts_at(40, law), 330, 3);
  Settings other = law;
  other[0].second = 0;
  EXPECT_NEAR(volts_at(10, other), 80, 2);
  // Pr.19 left to the supply: no adjustable law.
  other = law;
  other[1].second = 9999;
  EXPECT_NEAR(volts_at(10, other), 80, 2);
}

TEST(A700Parameter, Pr80AndPr81SwitchVectorControlOnWithPr83AndPr84) {
  const Settings vector{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.83", 400}, {"Pr.84", 50}};
  // The motor keeps its speed under load: slip is compensated.
  const auto speed = [](const Settings& settings, std::string_view terminal = "") {
    Bench b = a700_with(settings, loaded(0, 8, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    if (!terminal.empty()) b.terminal(terminal);
    b.run(5);
    return b.signal("speed");
  };
  Settings s = vector;
  s.emplace_back("Pr.4", 40);
  const double with = speed(s);
  EXPECT_NEAR(with, 1200, 15);
  EXPECT_LT(speed({{"Pr.4", 40}}), with - 15);
  s.emplace_back("Pr.183", 18);  // X18 at terminal RT: V/f control
  EXPECT_LT(speed(s, "RT"), with - 15);
  s[0].second = 9999;
  EXPECT_LT(speed(s), with - 15);
  // Pr.83 at Pr.84 is the V/f law's end.
  Settings low = vector;
  low[2].second = 300;
  EXPECT_NEAR(volts_at(25, low) / volts_at(25, vector), 0.75, 0.03);
}

TEST(A700Parameter, Pr245ToPr247CompensateTheSlipOfVfControl) {
  const auto speed = [](Settings settings, double hz) {
    settings.emplace_back("Pr.4", hz);
    Bench b = a700_with(settings, loaded(0, 6, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    b.run(5);
    return b.signal("speed");
  };
  const double without = speed({}, 40);
  EXPECT_GT(speed({{"Pr.245", 4}}, 40), without + 10);
  EXPECT_LT(speed({{"Pr.245", 4}, {"Pr.246", 10}}, 40), speed({{"Pr.245", 4}}, 40) - 5);
  EXPECT_GT(speed({{"Pr.245", 4}, {"Pr.247", 9999}}, 60), speed({{"Pr.245", 4}, {"Pr.247", 0}}, 60) + 10);
}

TEST(A700Parameter, Pr286ToPr288AreTheDroop) {
  const auto hz = [](Settings settings, double after_s = 5) {
    settings.emplace_back("Pr.80", 1.5);
    settings.emplace_back("Pr.81", 4);
    settings.emplace_back("Pr.84", 50);
    settings.emplace_back("Pr.9", 3.25);
    settings.emplace_back("Pr.245", 0);
    settings.emplace_back("Pr.4", 40);
    Bench b = a700_with(settings, loaded(0, 8, config_a700()));
    b.terminal("STF");
    b.terminal("RH");
    b.run(after_s);
    return b.output_hz();
  };
  EXPECT_NEAR(hz({}), 40, 0.05);
  // 8 Nm take 73 % of the rated torque current, and Pr.286 of 50 Hz is the droop at 100 %.
  EXPECT_NEAR(40 - hz({{"Pr.286", 10}, {"Pr.287", 0.1}}), 3.6, 0.2);
  EXPECT_NEAR(40 - hz({{"Pr.286", 5}, {"Pr.287", 0.1}, {"Pr.288", 1}}), 1.8, 0.1);
  // Pr.287 is its delay, Pr.288 = 1 lets it act in the ramps too.
  EXPECT_NEAR(hz({{"Pr.286", 10}, {"Pr.287", 1}}, 0.7), hz({{"Pr.286", 10}, {"Pr.287", 0.01}}, 0.7) + 2.2, 0.8);
  EXPECT_NEAR(hz({{"Pr.286", 10}, {"Pr.288", 0}, {"Pr.7", 5}}, 2), 20.4, 0.3);
  EXPECT_LT(hz({{"Pr.286", 10}, {"Pr.288", 1}, {"Pr.7", 5}}, 2), 18.5);
}

TEST(A700Parameter, Pr10ToPr12AreTheDcInjectionBrake) {
  const auto braking = [](const Settings& settings, bool x13 = false) {
    Settings all = settings;
    all.emplace_back("Pr.183", 13);
    all.emplace_back("Pr.4", 30);
    Bench b = a700_with(all);
    b.terminal("STF");
    b.terminal("RH");
    b.run(1.5);
    b.terminal("STF", false);
    if (x13) b.terminal("RT");
    struct {
      double seconds = 0, volts = 0, from_hz = 0;
    } seen;
    for (int i = 0; i < 3000; ++i) {
      if (seen.seconds == 0) seen.from_hz = b.output_hz();
      b.tick();
      if (b.signal("run_state") != kStateDcBraking) continue;
      seen.seconds += 0.001;
      seen.volts = b.output_v();
    }
    return seen;
  };
  EXPECT_NEAR(braking({}).seconds, 0.5, 0.01);
  EXPECT_NEAR(braking({{"Pr.11", 1}}).seconds, 1.0, 0.01);
  EXPECT_EQ(braking({{"Pr.12", 0}}).seconds, 0);
  EXPECT_GT(braking({{"Pr.12", 8}}).volts, 1.5 * braking({}).volts);
  EXPECT_EQ(braking({{"Pr.11", 8888}}).seconds, 0);
  EXPECT_GT(braking({{"Pr.11", 8888}}, true).seconds, 2);  // while X13 is on
  EXPECT_NEAR(braking({}).from_hz, 3, 0.2);
  EXPECT_NEAR(braking({{"Pr.10", 8}}).from_hz, 8, 0.2);
  EXPECT_NEAR(braking({{"Pr.10", 9999}, {"Pr.13", 2}}).from_hz, 2, 0.2);
}

// --- protection ---

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

// --- access, storage, panel ---

TEST(A700Parameter, Pr77SaysWhichWritesAreAccepted) {
  Bench b = a700_with({{"Pr.79", 1}});
  EXPECT_TRUE(b->set_parameter("Pr.7", 3).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.77", 1).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.7", 4).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.22", 120).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.77", 0).has_value());
  ASSERT_TRUE(b->set_panel_frequency(20).has_value());
  b.key(PanelKey::kFwd);
  b.run(0.5);
  EXPECT_FALSE(b->set_parameter("Pr.7", 4).has_value());
  EXPECT_TRUE(b->set_parameter("Pr.4", 44).has_value());
}

TEST(A700Parameter, Pr160AndPr172ToPr174AreTheUserGroup) {
  Bench b = a700_with({{"Pr.79", 1}});
  ASSERT_TRUE(b->set_parameter("Pr.173", 7).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.173", 8).has_value());
  EXPECT_EQ(b.raw(172), 2u);
  ASSERT_TRUE(b->set_parameter("Pr.174", 8).has_value());
  EXPECT_EQ(b.raw(172), 1u);
  ASSERT_TRUE(b->set_parameter("Pr.160", 1).has_value());
  EXPECT_TRUE(b->get_parameter("Pr.7").has_value());
  EXPECT_FALSE(b->get_parameter("Pr.8").has_value());
  ASSERT_TRUE(b->set_parameter("Pr.160", 9999).has_value());  // simple mode
  EXPECT_TRUE(b->get_parameter("Pr.125").has_value());
  EXPECT_FALSE(b->get_parameter("Pr.44").has_value());
  ASSERT_TRUE(b->set_parameter("Pr.160", 0).has_value());
  EXPECT_FALSE(b->set_parameter("Pr.172", 3).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.172", 9999).has_value());
  EXPECT_EQ(b.raw(172), 0u);
}

TEST(A700Parameter, Pr75SelectsResetPanelSupervisionAndStop) {
  for (int pr75 : {0, 14}) {
    Bench b = a700_with({{"Pr.75", static_cast<double>(pr75)}, {"Pr.4", 30}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(1);
    EXPECT_EQ(b->press_key(PanelKey::kStopReset).has_value(), pr75 == 14);
    b.run(2);
    EXPECT_EQ(b.port().status().running, pr75 == 0);
    if (pr75 == 14) {
      EXPECT_EQ(b->display(), "PS");
    }
  }
}

TEST(A700Parameter, Pr96ArmsAutoTuningThatMeasuresPr90) {
  Bench b = a700_with({{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.96", 1}, {"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(4);
  EXPECT_EQ(b.raw(96), 3u);
  EXPECT_NEAR(b.raw(90) / 1000.0, 3.655, 0.2);
}

TEST(A700Parameter, Pr72IsTheCarrierAndPr244TheFan) {
  EXPECT_EQ(a700_running(20, {{"Pr.72", 5}}).signal("carrier"), 5000);
  EXPECT_EQ(a700_running(20, {{"Pr.72", 0}}).signal("carrier"), 700);
  for (int pr244 : {0, 1}) {
    Bench b = a700_with({{"Pr.244", static_cast<double>(pr244)}});
    b.run(0.1);
    EXPECT_EQ(b.signal("fan"), pr244 == 0 ? 1 : 0);
  }
}

// --- process control, traverse ---

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
