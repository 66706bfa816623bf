// Parameters that say how the FR-E500 gets from one frequency to another and how it stops: ramps, S-curves, shortest
// ramps, DC injection brake, stop selection.
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

TEST(ParameterEffect, RampTimesUp) {
  struct Case {
    Settings settings;
    bool rt;
    double seconds;  // from the start frequency of 0.5 Hz to 50 Hz
  };
  const Case cases[] = {{{{"Pr.7", 2}}, false, 1.98},
                        {{{"Pr.7", 0.5}}, false, 0.495},
                        {{{"Pr.7", 1}, {"Pr.20", 100}}, false, 0.495},
                        {{{"Pr.7", 1}, {"Pr.20", 25}}, false, 1.98},
                        {{{"Pr.7", 10}, {"Pr.21", 1}}, false, 0.99},  // the digits stay: 10.0 becomes 1.00
                        {{{"Pr.44", 2}, {"Pr.7", 0.5}}, false, 0.495},
                        {{{"Pr.44", 2}}, true, 1.98},
                        {{{"Pr.44", 1}, {"Pr.45", 3}}, true, 0.99}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.settings.front().first + " = " + std::to_string(c.settings.front().second));
    Settings settings = c.settings;
    settings.emplace_back("Pr.183", 3);  // MRS is RT
    Bench b = drive_with(settings);
    b.terminal("MRS", c.rt);
    b.terminal("RH");
    b.terminal("STF");
    EXPECT_NEAR(seconds_to_reach(b, 50), c.seconds, 0.006);
  }
}

TEST(ParameterEffect, RampTimesDown) {
  struct Case {
    Settings settings;
    bool rt;
    double seconds;  // from 50 Hz to 3 Hz, where RUN goes off
  };
  const Case cases[] = {{{{"Pr.8", 2}}, false, 1.88},
                        {{{"Pr.8", 1}, {"Pr.20", 100}}, false, 0.47},
                        {{{"Pr.8", 10}, {"Pr.7", 10}, {"Pr.21", 1}}, false, 0.94},
                        {{{"Pr.44", 2}}, true, 1.88},  // Pr.45 = 9999: both ramps
                        {{{"Pr.45", 3}}, true, 2.82},
                        {{{"Pr.45", 3}, {"Pr.8", 1}}, false, 0.94}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.settings.front().first + " = " + std::to_string(c.settings.front().second));
    Settings settings = c.settings;
    settings.emplace_back("Pr.183", 3);
    Bench b = drive_with(settings);
    b.terminal("RH");
    b.terminal("STF");
    seconds_to_reach(b, 50);
    b.terminal("MRS", c.rt);
    b.terminal("STF", false);
    EXPECT_NEAR(seconds_to_stop(b), c.seconds, 0.006);
  }
}

TEST(ParameterEffect, Pr15AndPr16AreTheJogOperation) {
  Bench b = drive_with({{"Pr.15", 25}, {"Pr.16", 2}, {"Pr.10", 0}});
  b.pu();
  b.key(PanelKey::kMode);
  b.key(PanelKey::kMode);
  b.key(PanelKey::kFwd);
  EXPECT_NEAR(seconds_to_reach(b, 25), 0.98, 0.006);
  EXPECT_TRUE(runs_at(b, 25));
  b.key(PanelKey::kStopReset);
  EXPECT_NEAR(seconds_to_stop(b), 0.98, 0.006);
}

TEST(ParameterEffect, Pr29ShapesTheRamp) {
  const auto run = [](double pattern, double hz, double ramp_s) {
    Bench b = drive_with({{"Pr.29", pattern}, {"Pr.7", ramp_s}});
    start(b, hz);
    return b;
  };
  // Linear and S-curve B at a quarter of the time: 25 % and (1 - cos 45 deg) / 2 of the way.
  Bench linear = run(0, 50, 2);
  linear.run(0.495);
  EXPECT_NEAR(linear.output_hz(), 12.9, 0.1);
  Bench b = run(2, 50, 2);
  b.run(0.495);
  EXPECT_NEAR(b.output_hz(), 0.5 + 49.5 * 0.1464, 0.1);
  EXPECT_NEAR(seconds_to_reach(b, 50), 1.98 - 0.495, 0.015);
  // S-curve A: square, straight, and above the base frequency a square root: to 100 Hz 7/3 of the time to 50 Hz.
  Bench a = run(1, 50, 2);
  a.run(0.4);
  EXPECT_NEAR(a.output_hz(), 8.54, 0.1);
  Bench fast_a = run(1, 100, 1);
  EXPECT_NEAR(seconds_to_reach(fast_a, 100), 7.0 / 3 - 0.063, 0.01);
  Bench fast_linear = run(0, 100, 1);
  EXPECT_NEAR(seconds_to_reach(fast_linear, 100), 1.99, 0.01);
}

// --- shortest ramps: Pr.60-63, with an inertia that makes the current decide ---

double shortest(const Settings& settings, bool down) {
  InverterConfig c = loaded(0.03);
  c.brake_resistance_ohm = 100;
  Settings s{{"Pr.7", 20}, {"Pr.8", 20}, {"Pr.22", 200}, {"Pr.30", 1}, {"Pr.70", 30}};
  s.insert(s.end(), settings.begin(), settings.end());
  Bench b = drive_with(s, c);
  start(b, 50);
  const double up_s = seconds_to_reach(b, 50);
  if (!down) return up_s;
  b.run(1);
  stop(b);
  return seconds_to_stop(b);
}

TEST(ParameterEffect, Pr60ShortensTheRamps) {
  EXPECT_NEAR(shortest({{"Pr.60", 0}}, false), 19.8, 0.1);
  const double at_150 = shortest({{"Pr.60", 1}}, false);
  EXPECT_LT(at_150, 5);
  EXPECT_LT(shortest({{"Pr.60", 2}}, false), at_150 * 0.95);  // 180 %
  EXPECT_NEAR(shortest({{"Pr.60", 11}}, false), at_150, 0.1);
  EXPECT_LT(shortest({{"Pr.60", 12}}, false), at_150 * 0.95);
  EXPECT_NEAR(shortest({{"Pr.60", 0}}, true), 18.8, 0.1);
  EXPECT_LT(shortest({{"Pr.60", 11}}, true), 5);
}

TEST(ParameterEffect, Pr60MindsTheDcLinkWithoutABrakeResistor) {
  for (const auto& [pr60, alarm] : {std::pair{1.0, ""}, {2.0, ""}, {11.0, "E.OV3"}, {12.0, "E.OV3"}}) {
    Bench b = drive_with({{"Pr.60", pr60}, {"Pr.22", 200}}, loaded(0.05));
    start(b, 50);
    seconds_to_reach(b, 50);
    b.run(1);
    stop(b);
    b.run_until([&] { return !b.port().status().running; }, 30);
    EXPECT_EQ(b->alarm_name(), alarm) << pr60;
  }
}

TEST(ParameterEffect, Pr60MindsTheDcLinkOfAStopInTheAccelerationToo) {
  Bench b = drive_with({{"Pr.60", 1}}, loaded(0.04));
  start(b, 50);
  ASSERT_TRUE(b.run_until([&] { return b.output_hz() > 45; }, 20));
  stop(b);
  b.run_until([&] { return !b.port().status().running; }, 30);
  EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
}

TEST(ParameterEffect, Pr61ToPr63AreTheCurrentsOfTheShortestRamps) {
  const double up = shortest({{"Pr.60", 11}}, false);
  EXPECT_GT(shortest({{"Pr.60", 11}, {"Pr.61", 2.8}}, false), up * 1.2);  // 70 % of the rated current
  EXPECT_GT(shortest({{"Pr.60", 11}, {"Pr.62", 105}}, false), up * 1.2);
  EXPECT_NEAR(shortest({{"Pr.60", 11}, {"Pr.63", 105}}, false), up, 0.1);
  const double down = shortest({{"Pr.60", 11}}, true);
  EXPECT_GT(shortest({{"Pr.60", 11}, {"Pr.63", 60}}, true), down * 1.1);
  EXPECT_NEAR(shortest({{"Pr.60", 11}, {"Pr.62", 105}}, true), down, 0.1);
}

// --- DC injection brake ---

struct Stop {
  double last_running_hz = 0;
  double braking_s = 0;
  double braking_a = 0;  // at its end
};

Stop stop_of(const Settings& settings) {
  Bench b = drive_with(settings);
  start(b, 30);
  EXPECT_TRUE(runs_at(b, 30));
  stop(b);
  Stop out;
  while (b.port().status().running) {
    out.last_running_hz = b.output_hz();
    b.tick();
  }
  while (b.signal("run_state") == kStateDcBraking) {
    out.braking_a = b.signal("output_current");
    out.braking_s += 0.001;
    b.tick();
  }
  return out;
}

TEST(ParameterEffect, Pr10ToPr12AreTheDcInjectionBrake) {
  const Stop factory = stop_of({});
  EXPECT_NEAR(factory.last_running_hz, 3, 0.3);
  EXPECT_NEAR(factory.braking_s, 0.5, 0.002);
  EXPECT_NEAR(stop_of({{"Pr.10", 12}}).last_running_hz, 12, 0.3);
  EXPECT_NEAR(stop_of({{"Pr.11", 1.7}}).braking_s, 1.7, 0.002);
  EXPECT_EQ(stop_of({{"Pr.11", 0}}).braking_s, 0);
  EXPECT_NEAR(stop_of({{"Pr.11", 0}}).last_running_hz, 0.5, 0.3);
  // 6 % of 380 V on the stator resistance alone.
  const double ohm = config_1k5().motor.R_s_ohm;
  EXPECT_NEAR(stop_of({{"Pr.11", 2}}).braking_a, 0.06 * 380 / std::sqrt(3) / ohm, 0.05);
  EXPECT_NEAR(stop_of({{"Pr.11", 2}, {"Pr.12", 3}}).braking_a, 0.03 * 380 / std::sqrt(3) / ohm, 0.05);
  EXPECT_EQ(stop_of({{"Pr.12", 0}}).braking_s, 0);
}

// --- stop selection ---

TEST(ParameterEffect, Pr250SelectsRampOrCoastingAndWhatStrMeans) {
  struct Case {
    double pr250;
    bool str_alone_runs;
    bool coasts;
    double off_after_s;  // from the stop command to the end of RUN
  };
  const Case cases[] = {{9999, true, false, 0.27}, {8888, false, false, 0.27}, {0, true, true, 0.001},
                        {0.7, true, true, 0.7},    {1000, false, true, 0.001}, {1000.7, false, true, 0.7}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.pr250);
    Bench b = drive_with({{"Pr.250", c.pr250}, {"Pr.8", 0.5}});
    b.terminal("RM");
    b.terminal("STR");
    b.run(1.2);
    EXPECT_EQ(b.port().status().reverse, c.str_alone_runs);
    b.terminal("STR", false);
    ASSERT_TRUE(stands(b));
    b.terminal("STF");
    ASSERT_TRUE(runs_at(b, 30));
    EXPECT_TRUE(b.port().status().forward);
    b.terminal("STF", false);
    EXPECT_NEAR(seconds_to_stop(b), c.off_after_s, 0.01);
    EXPECT_EQ(b.signal("speed") > 600, c.coasts) << b.signal("speed");
    if (c.str_alone_runs) continue;
    ASSERT_TRUE(b.run_until([&] { return std::abs(b.signal("speed")) < 5; }, 60));
    b.run(1);  // past the DC injection brake
    b.terminal("STR");
    b.terminal("STF");
    b.run(2);
    EXPECT_TRUE(b.port().status().reverse) << b->alarm_name() << " " << b->alarm_cause();
  }
}

}  // namespace
}  // namespace vinv::inverter::test
