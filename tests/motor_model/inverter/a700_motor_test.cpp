// The second motor of the FR-A700 (RT with Pr.450), ramp patterns and levels that depend on the frequency, seen at the
// drive port. Typical for the family.
#include "a700_bench.hpp"

namespace vinv::inverter::test {
namespace {

InverterConfig with_load(double inertia, double nm) { return loaded(inertia, nm, config_a700()); }
// Second motor: values of the motor on the bench.
Settings second(const Settings& more = {}) {
  Settings s{{"Pr.450", 0}, {"Pr.453", 1.5}, {"Pr.454", 4}, {"Pr.457", 50}, {"Pr.340", 1}};
  s.insert(s.end(), more.begin(), more.end());
  return s;
}
Bench on_second(double hz, const Settings& settings, const InverterConfig& config = config_a700()) {
  Bench b = a700_with(settings, config);
  EXPECT_TRUE(b.frequency(hz).has_value());
  EXPECT_TRUE(b.command({NetTerminal::kRt}).has_value());
  b.run(0.01);
  EXPECT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  return b;
}

TEST(A700SecondMotor, Pr451MakesRtChooseItsControlMethod) {
  const auto running_at = [](const Settings& more) {
    Bench b = on_second(25, second(more), with_load(0.01, 9));
    b.run(4);
    return std::pair{b.signal("speed") / 30, monitor(b, 32)};
  };
  // 10: the speed is held; without Pr.453 and 454, or with Pr.450 = 9999, it is V/f control.
  EXPECT_NEAR(running_at({{"Pr.451", 10}}).first, 25, 0.1);
  EXPECT_LT(running_at({{"Pr.451", 10}, {"Pr.453", 9999}}).first, 24.4);
  EXPECT_LT(running_at({{"Pr.451", 10}, {"Pr.454", 9999}}).first, 24.4);
  EXPECT_EQ(running_at({{"Pr.451", 10}, {"Pr.450", 9999}}).second, 0);
  // 11: torque control.
  Bench torque = on_second(40, second({{"Pr.451", 11}, {"Pr.804", 1}, {"Pr.806", 1050}}), with_load(0.15, 0));
  torque.run(1);
  EXPECT_NEAR(monitor(torque, 32) / 10, 50, 1);
  // Without RT it is the first motor, in V/f control.
  Bench first = a700_running(25, second({{"Pr.451", 10}}));
  EXPECT_EQ(monitor(first, 32), 0);
}

TEST(A700SecondMotor, IsChosenWhileTheOutputIsOff) {
  Bench b = a700_running(20, second({{"Pr.451", 10}}));
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  b.run(0.5);
  EXPECT_EQ(monitor(b, 32), 0);
  ASSERT_TRUE(b.command({NetTerminal::kRt}).has_value());
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 3));
  b.run(0.6);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  b.run(0.2);
  EXPECT_GT(monitor(b, 32), 0);
}

TEST(A700SecondMotor, Pr455ToPr462AreItsConstants) {
  const auto volts = [](const Settings& more, double nm = 9, double hz = 20) {
    Settings s = second({{"Pr.451", 10}, {"Pr.51", 3.25}});
    s.insert(s.end(), more.begin(), more.end());
    Bench b = on_second(hz, s, with_load(0.01, nm));
    b.run(4);
    return std::pair{b.output_v(), b.output_a()};
  };
  const auto factory = volts({});
  EXPECT_GT(volts({{"Pr.458", 6}}).first, factory.first + 5);
  EXPECT_GT(volts({{"Pr.460", 50}}).first, factory.first + 1);
  EXPECT_GT(volts({{"Pr.461", 50}}).first, factory.first + 1);
  EXPECT_LT(volts({{"Pr.860", 1.2}}).first, factory.first - 2);
  EXPECT_LT(volts({{"Pr.456", 300}}, 2).first, volts({}, 2).first - 20);
  EXPECT_LT(volts({{"Pr.457", 100}}, 2).first, volts({}, 2).first - 20);
  // R2 (Pr.459) and the speed gain (Pr.569): slip compensation of flux vector control.
  const auto slip = [](const Settings& more) {
    Settings s = second({{"Pr.451", 20}, {"Pr.51", 3.25}});
    s.insert(s.end(), more.begin(), more.end());
    Bench b = on_second(20, s, with_load(0.01, 8));
    b.run(4);
    return b.output_hz() - 20;
  };
  const double compensated = slip({});
  EXPECT_GT(compensated, 0.5);
  EXPECT_NEAR(slip({{"Pr.569", 50}}), compensated / 2, 0.25);
  EXPECT_GT(slip({{"Pr.459", 6}}), compensated + 0.3);
  EXPECT_GT(slip({{"Pr.455", 2.6}}), compensated + 0.1);
  EXPECT_GT(slip({{"Pr.462", 90}}), compensated + 0.1);
}

TEST(A700SecondMotor, Pr830ToPr836AreItsGainsAndFilters) {
  const auto speed_after = [](const Settings& more) {
    Settings s = second({{"Pr.451", 10}, {"Pr.44", 0.5}});
    s.insert(s.end(), more.begin(), more.end());
    Bench b = on_second(30, s, with_load(0.02, 0));
    b.run(0.4);
    return b.signal("speed") / 30;
  };
  const double factory = speed_after({});
  EXPECT_LT(speed_after({{"Pr.832", 1}}), factory - 3);
  EXPECT_LT(speed_after({{"Pr.836", 1}}), factory - 3);
  EXPECT_LT(speed_after({{"Pr.830", 5}}), factory - 1);
  EXPECT_NE(speed_after({{"Pr.831", 5}}), factory);
  EXPECT_EQ(speed_after({{"Pr.820", 60}}), factory);  // 9999 is the first motor's
  EXPECT_LT(speed_after({{"Pr.820", 5}}), factory - 1);
}

TEST(A700SecondMotor, Pr463TunesItIntoPr458) {
  Bench b = a700_with(second({{"Pr.463", 1}}));
  ASSERT_TRUE(b.frequency(20).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kRt}).has_value());
  b.run(0.01);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  b.run(0.5);
  EXPECT_EQ(b.raw(463), 2u);
  b.run(4);
  EXPECT_EQ(b.raw(463), 3u);
  EXPECT_NEAR(b.raw(458), 3655, 200);
  EXPECT_EQ(b.raw(90), 65535u);
  EXPECT_EQ(b.raw(96), 0u);
}

TEST(A700SecondMotor, BothMotorsHaveAThermalOfTheirOwn) {
  // Heats the first, then runs the second: its own thermal is cold, and the first one cools meanwhile.
  Bench b = a700_with(second({{"Pr.9", 1.5}, {"Pr.51", 1.5}, {"Pr.71", 1}}), with_load(0.01, 7));
  ASSERT_TRUE(b.frequency(40).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
  ASSERT_TRUE(b.run_until([&] { return monitor(b, 10) >= 500; }, 200));
  ASSERT_TRUE(b.command({NetTerminal::kRt}).has_value());
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 5));
  b.run(0.6);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  b.run(0.3);
  EXPECT_LT(monitor(b, 10), 100);  // of 0.1 %
  ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 400));
  EXPECT_EQ(b->alarm_name(), "E.THM");
}

TEST(A700SecondMotor, Pr450SaysItsKind) {
  // A self-cooled motor gets hotter at 5 Hz than one with constant torque.
  const auto heat = [](double kind) {
    Bench b = on_second(5, second({{"Pr.450", kind}, {"Pr.51", 3}}), with_load(0.01, 4));
    b.run(20);
    return monitor(b, 10);
  };
  EXPECT_GT(heat(0), 1.5 * heat(1));
}

// --- ramps ---

TEST(A700Ramp, Pr29Is5RoundsEachEndAsPr516ToPr519Say) {
  const auto seconds = [](const Settings& more) {
    Settings s{{"Pr.29", 5}, {"Pr.7", 2}, {"Pr.8", 2}, {"Pr.11", 0}, {"Pr.13", 0}};
    s.insert(s.end(), more.begin(), more.end());
    s.emplace_back("Pr.340", 1);
    Bench b = a700_with(s);
    EXPECT_TRUE(b.frequency(50).has_value());
    EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
    const double half = seconds_to_reach(b, 25);
    const double up = half + seconds_to_reach(b, 50);
    EXPECT_TRUE(b.command({}).has_value());
    const double down_half = seconds_until(
        b, [&] { return b.output_hz() <= 25; }, 10);
    return std::array{half, up, down_half, down_half + seconds_to_stop(b)};
  };
  const auto base = seconds({});
  EXPECT_NEAR(base[1], 2.1, 0.03);  // half of each rounding is added
  EXPECT_NEAR(base[3], 2.1, 0.08);
  const auto begin = seconds({{"Pr.516", 1.1}});
  EXPECT_NEAR(begin[1], 2.6, 0.03);
  EXPECT_NEAR(begin[0] - base[0], 0.5, 0.03);  // all of it before the middle
  const auto end = seconds({{"Pr.517", 1.1}});
  EXPECT_NEAR(end[1], 2.6, 0.03);
  EXPECT_NEAR(end[0], base[0], 0.03);
  EXPECT_NEAR(seconds({{"Pr.518", 1.1}})[2] - base[2], 0.5, 0.03);
  const auto down_end = seconds({{"Pr.519", 1.1}});
  EXPECT_NEAR(down_end[2], base[2], 0.03);
  EXPECT_GT(down_end[3], base[3] + 0.3);
}

TEST(A700Ramp, Pr292ShortensTheRampsAndPr293KeepsOneOfThem) {
  const auto seconds = [](const Settings& more) {
    Settings s{{"Pr.7", 20}, {"Pr.8", 20}, {"Pr.340", 1}};
    s.insert(s.end(), more.begin(), more.end());
    Bench b = a700_with(s, with_load(0.02, 2));
    EXPECT_TRUE(b.frequency(50).has_value());
    EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
    const double up = seconds_to_reach(b, 50);
    b.run(1);
    EXPECT_TRUE(b.command({}).has_value());
    return std::pair{up, seconds_to_stop(b, 40)};
  };
  const auto off = seconds({});
  EXPECT_NEAR(off.first, 20, 0.3);
  const auto shortest = seconds({{"Pr.292", 1}});
  EXPECT_LT(shortest.first, 5);
  EXPECT_LT(shortest.second, 15);
  EXPECT_NEAR(seconds({{"Pr.292", 1}, {"Pr.293", 1}}).second, off.second, 0.3);
  EXPECT_NEAR(seconds({{"Pr.292", 1}, {"Pr.293", 2}}).first, off.first, 0.3);
  // 3 stays within the rated current; the references of Pr.61 and 62 change that.
  const auto optimum = seconds({{"Pr.292", 3}});
  EXPECT_GT(optimum.first, shortest.first);
  EXPECT_LT(optimum.first, 15);
  EXPECT_GT(seconds({{"Pr.292", 3}, {"Pr.61", 3.2}}).first, optimum.first);
  EXPECT_LT(seconds({{"Pr.292", 3}, {"Pr.62", 150}}).first, optimum.first);
}

TEST(A700Ramp, Pr63IsTheReferenceOfTheDecelerationWithABrakeResistor) {
  const auto seconds = [](double pr63) {
    InverterConfig c = with_load(0.05, 0);
    c.brake_resistance_ohm = 100;
    Bench b = a700_running(40, {{"Pr.292", 11}, {"Pr.8", 20}, {"Pr.63", pr63}, {"Pr.30", 1}, {"Pr.70", 30}}, c);
    b.run(2);
    EXPECT_TRUE(b.command({}).has_value());
    return seconds_to_stop(b, 40);
  };
  EXPECT_GT(seconds(60), 1.2 * seconds(130));
}

TEST(A700Ramp, Pr292Is5StartsAtPr64) {
  for (const auto& [pr64, hz] : {std::pair{9999.0, 2.0}, {4.0, 4.0}}) {
    Bench b = a700_with({{"Pr.292", 5}, {"Pr.64", pr64}, {"Pr.340", 1}, {"Pr.7", 10}});
    ASSERT_TRUE(b.frequency(30).has_value());
    ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
    b.run(0.01);
    EXPECT_NEAR(b.output_hz(), hz, 0.1);
  }
}

TEST(A700Ramp, AbovePr147TheSecondRampTimesHold) {
  Bench b = a700_with({{"Pr.147", 20}, {"Pr.7", 1}, {"Pr.44", 4}, {"Pr.45", 2}, {"Pr.8", 1}, {"Pr.340", 1}});
  ASSERT_TRUE(b.frequency(50).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
  EXPECT_NEAR(seconds_to_reach(b, 20), 0.4, 0.03);
  EXPECT_NEAR(seconds_to_reach(b, 50), 4 * 0.6, 0.03);
  ASSERT_TRUE(b.command({}).has_value());
  EXPECT_NEAR(seconds_until(
                  b, [&] { return b.output_hz() <= 20; }, 10),
              2 * 0.6, 0.05);
}

// --- levels ---

TEST(A700Level, Pr49AndPr115EndTheirStallLevels) {
  // Against a blocked-like load at 10 Hz the second level (60 %) holds below Pr.49 only.
  const auto overload = [](const Settings& more, NetTerminal by) {
    Settings s{{"Pr.340", 1}, {"Pr.48", 60}, {"Pr.114", 60}, {"Pr.184", 9}, {"Pr.49", 0}, {"Pr.7", 2}};
    s.insert(s.end(), more.begin(), more.end());
    Bench b = a700_with(s, with_load(0.01, 8));
    EXPECT_TRUE(b.frequency(30).has_value());
    EXPECT_TRUE(b.command({NetTerminal::kStf, by}).has_value());
    b.run(4);
    return b.output_hz();
  };
  for (const auto& [number, by] : {std::pair{"Pr.49", NetTerminal::kRt}, {"Pr.115", NetTerminal::kAu}}) {
    EXPECT_NEAR(overload({{number, 0.3}}, by), 30, 0.2);
    EXPECT_LT(overload({{number, 40}}, by), 10) << number;
  }
}

TEST(A700Level, Pr148AndPr149AreTheStallLevelAtAnAnalogInput) {
  const auto reaches = [](const Settings& more, double volt) {
    Settings s{{"Pr.340", 1}, {"Pr.7", 1}, {"Pr.868", 4}};
    s.insert(s.end(), more.begin(), more.end());
    Bench b = a700_with(s, with_load(0.01, 8));
    EXPECT_TRUE(b->set_analog("1", volt).has_value());
    b.run(0.1);
    EXPECT_TRUE(b.frequency(30).has_value());
    EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
    b.run(3);
    return b.output_hz();
  };
  EXPECT_LT(reaches({{"Pr.148", 60}}, 0), 10);
  EXPECT_NEAR(reaches({{"Pr.148", 60}}, 10), 30, 0.2);
  EXPECT_LT(reaches({{"Pr.149", 60}}, 10), 10);
  EXPECT_NEAR(reaches({{"Pr.148", 60}, {"Pr.868", 0}}, 0), 30, 0.2);
  // Terminal 4 with Pr.858 = 4; another function than 0 takes the frequency from it.
  EXPECT_LT(reaches({{"Pr.148", 60}, {"Pr.868", 0}, {"Pr.858", 4}}, 0), 10);
  for (const double pr858 : {0.0, 9999.0}) {
    Bench b = a700_with({{"Pr.858", pr858}});
    b.terminal("STF");
    b.terminal("AU");
    ASSERT_TRUE(b->set_analog("4", 20).has_value());
    b.run(2);
    EXPECT_NEAR(b.output_hz(), pr858 == 0 ? 60 : 0, 0.1);
  }
}

TEST(A700Level, Pr598RaisesTheUnderVoltageLevel) {
  for (const double pr598 : {9999.0, 430.0}) {
    Bench b = a700_running(20, {{"Pr.598", pr598}});
    plant::MainsState low;
    low.voltage_v_rms = 290;  // 410 V of link
    b->set_mains(low);
    b.run(2);
    EXPECT_EQ(b->alarm_name(), pr598 == 9999 ? "" : "E.UVT");
  }
}

TEST(A700Level, Pr166HoldsTheCurrentDetection) {
  const auto held = [](double pr166, double after_s) {
    Bench b = a700_running(30, {{"Pr.150", 5}, {"Pr.166", pr166}, {"Pr.192", 12}, {"Pr.250", 0}});
    b.run(0.5);
    EXPECT_TRUE(b.output("IPF"));
    EXPECT_TRUE(b.command({}).has_value());  // coasts
    b.run(after_s);
    return b.output("IPF");
  };
  EXPECT_FALSE(held(0.1, 0.3));
  EXPECT_TRUE(held(1, 0.8));
  EXPECT_FALSE(held(1, 1.2));
  EXPECT_TRUE(held(9999, 5));  // until the next start
}

}  // namespace
}  // namespace vinv::inverter::test
