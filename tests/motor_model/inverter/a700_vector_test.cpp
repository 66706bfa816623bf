// Control of speed and torque without an encoder on the FR-A700 (Pr.800 = 10 to 12), seen at the drive port. Typical
// for the family.
#include "a700_bench.hpp"

namespace vinv::inverter::test {
namespace {

Settings vector_settings(double method, const Settings& more = {}) {
  Settings s{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.9", 3.25}, {"Pr.340", 1}, {"Pr.800", method}};
  s.insert(s.end(), more.begin(), more.end());
  return s;
}
Bench ordered(double hz, double method, const Settings& more = {}, const InverterConfig& config = config_a700(),
              NetTerminal start = NetTerminal::kStf) {
  Bench b = a700_with(vector_settings(method, more), config);
  EXPECT_TRUE(b.frequency(hz).has_value());
  EXPECT_TRUE(b.command({start}).has_value());
  return b;
}
InverterConfig with_load(double inertia, double nm) { return loaded(inertia, nm, config_a700()); }
double speed_hz(Bench& b) { return b.signal("speed") / 30; }
double command_percent(Bench& b) { return monitor(b, 32) / 10; }
// The largest torque command while it runs on.
double highest_command(Bench& b, double seconds) {
  double most = 0;
  for (int i = 0; i < seconds * 100; ++i) {
    b.run(0.01);
    most = std::max(most, command_percent(b));
  }
  return most;
}
void stop_command(Bench& b) { ASSERT_TRUE(b.command({}).has_value()); }

TEST(A700Vector, SpeedControlHoldsTheSpeedAtEveryLoad) {
  for (const double hz : {1.0, 5.0, 25.0, 45.0}) {
    for (const double nm : {0.0, 9.0}) {
      Bench b = ordered(hz, 10, {}, with_load(0.01, nm));
      b.run(4);
      EXPECT_NEAR(speed_hz(b), hz, hz < 2 ? (nm > 0 ? 1.2 : 0.2) : 0.12) << hz << " Hz " << nm << " Nm";
      EXPECT_EQ(b->alarm_name(), "");
    }
  }
  // V/f control lets the motor slip.
  Bench vf = ordered(25, 20, {{"Pr.80", 9999}}, with_load(0.01, 9));
  vf.run(4);
  EXPECT_LT(speed_hz(vf), 24);
}

TEST(A700Vector, ReverseRunsTheOtherWay) {
  Bench b = ordered(30, 10, {}, with_load(0.01, 5), NetTerminal::kStr);
  b.run(3);
  EXPECT_NEAR(speed_hz(b), -30, 0.1);
  EXPECT_TRUE(b.port().status().reverse);
  stop_command(b);
  b.run(3);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_EQ(b->alarm_name(), "");
}

TEST(A700Vector, Pr22LimitsTheTorqueAndPr874MakesALongStallAnAlarm) {
  Bench b = ordered(20, 10, {{"Pr.22", 60}, {"Pr.874", 50}, {"Pr.865", 1.5}}, with_load(0.01, 9.9));
  b.run(2);
  EXPECT_NEAR(command_percent(b), 60, 0.2);
  EXPECT_NEAR(monitor(b, 7) / 10, 60, 4);
  EXPECT_TRUE(b.port().status().overload);
  EXPECT_LT(speed_hz(b), 0.5);
  ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 3));
  EXPECT_EQ(b->alarm_name(), "E.OLT");
  EXPECT_FALSE(b.port().status().running);
  // Above its torque, or while it turns faster than Pr.865, there is none.
  Bench above = ordered(20, 10, {{"Pr.22", 60}, {"Pr.874", 80}}, with_load(0.01, 9.9));
  above.run(6);
  EXPECT_EQ(above->alarm_name(), "");
}

// Pr.812 forward braking, 813 reverse driving, 814 reverse braking; 9999 is Pr.22.
TEST(A700Vector, Pr812ToPr814LimitTheOtherQuadrants) {
  for (const double limit : {30.0, 70.0}) {
    Bench braking = ordered(30, 10, {{"Pr.812", limit}}, with_load(0.05, 0));
    EXPECT_GT(highest_command(braking, 2), 100);
    stop_command(braking);
    EXPECT_NEAR(highest_command(braking, 0.3), limit, 2);
    Bench driving = ordered(30, 10, {{"Pr.813", limit}}, with_load(0.05, 0), NetTerminal::kStr);
    EXPECT_NEAR(highest_command(driving, 0.5), limit, 2);
    Bench reverse = ordered(30, 10, {{"Pr.814", limit}}, with_load(0.05, 0), NetTerminal::kStr);
    EXPECT_GT(highest_command(reverse, 2), 100);
    stop_command(reverse);
    EXPECT_NEAR(highest_command(reverse, 0.3), limit, 2);
  }
}

TEST(A700Vector, Pr815HoldsWhileTlIsOnAndPr816AndPr817InTheRamps) {
  for (const bool tl : {false, true}) {
    Bench b = ordered(30, 10, {{"Pr.815", 40}, {"Pr.183", 27}}, with_load(0.05, 0));
    if (tl) {
      ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
    }
    const double most = highest_command(b, 0.5);
    EXPECT_NEAR(most, tl ? 40 : 137, 3) << tl;
  }
  InverterConfig braked = with_load(0.15, 0);
  braked.brake_resistance_ohm = 100;
  Bench ramps =
      ordered(50, 10, {{"Pr.816", 55}, {"Pr.817", 35}, {"Pr.7", 2}, {"Pr.8", 2}, {"Pr.30", 1}, {"Pr.70", 30}}, braked);
  EXPECT_NEAR(highest_command(ramps, 1), 55, 1);
  ramps.run(8);
  stop_command(ramps);
  EXPECT_NEAR(highest_command(ramps, 1), 35, 1);
}

TEST(A700Vector, Pr810Is1TakesTheTorqueLimitFromAnAnalogInput) {
  // Terminal 1 (Pr.868 = 4): 150 % at 10 V as Pr.920 comes from the factory.
  for (const double volt : {2.0, 5.0}) {
    Bench b = ordered(30, 10, {{"Pr.810", 1}, {"Pr.868", 4}}, with_load(0.05, 0));
    ASSERT_TRUE(b->set_analog("1", volt).has_value());
    EXPECT_NEAR(highest_command(b, 0.5), 15 * volt, 3);
  }
  // Its own line.
  Bench line = ordered(30, 10, {{"Pr.810", 1}, {"Pr.868", 4}, {"Pr.919.1", 20}, {"Pr.920.1", 120}}, with_load(0.05, 0));
  ASSERT_TRUE(line->set_analog("1", 5).has_value());
  EXPECT_NEAR(highest_command(line, 0.5), 70, 3);
  // Terminal 4 (Pr.858 = 4): 4 to 20 mA.
  Bench four = ordered(30, 10, {{"Pr.810", 1}, {"Pr.858", 4}, {"Pr.933.1", 100}}, with_load(0.05, 0));
  ASSERT_TRUE(four->set_analog("4", 12).has_value());
  EXPECT_NEAR(highest_command(four, 0.5), 50, 1);
  Bench bias = ordered(30, 10, {{"Pr.810", 1}, {"Pr.858", 4}, {"Pr.932.1", 40}, {"Pr.933.1", 100}}, with_load(0.05, 0));
  ASSERT_TRUE(bias->set_analog("4", 12).has_value());
  EXPECT_NEAR(highest_command(bias, 0.5), 70, 3);
  // The ends of the lines in percent of the input.
  const auto by_line = [](Settings more, const char* input, double value) {
    more.emplace_back("Pr.810", 1);
    Bench b = ordered(30, 10, more, with_load(0.05, 0));
    EXPECT_TRUE(b->set_analog(input, value).has_value());
    return highest_command(b, 0.5);
  };
  EXPECT_NEAR(by_line({{"Pr.868", 4}, {"Pr.919.2", 25}}, "1", 5), 50, 3);
  EXPECT_NEAR(by_line({{"Pr.868", 4}, {"Pr.920.2", 50}}, "1", 2.5), 75, 3);
  EXPECT_NEAR(by_line({{"Pr.858", 4}, {"Pr.932.2", 0}}, "4", 8), 60, 3);
  EXPECT_NEAR(by_line({{"Pr.858", 4}, {"Pr.933.2", 60}}, "4", 8), 75, 3);
  // Pr.868 = 2 limits braking only.
  Bench braking = ordered(30, 10, {{"Pr.810", 1}, {"Pr.868", 2}}, with_load(0.05, 0));
  ASSERT_TRUE(braking->set_analog("1", 2).has_value());
  EXPECT_GT(highest_command(braking, 2), 100);
  stop_command(braking);
  EXPECT_NEAR(highest_command(braking, 0.3), 30, 1);
  // Without Pr.810 it is Pr.22.
  Bench none = ordered(30, 10, {{"Pr.868", 4}}, with_load(0.05, 0));
  EXPECT_NEAR(highest_command(none, 0.5), 137, 3);
}

TEST(A700Vector, Pr803KeepsTheTorqueLimitAboveRatedFrequency) {
  const auto torque = [](double pr803) {
    Bench b = ordered(90, 10, {{"Pr.803", pr803}, {"Pr.22", 60}}, with_load(0.02, 0));
    EXPECT_TRUE(b.run_until([&] { return speed_hz(b) > 75; }, 20));
    return command_percent(b);
  };
  EXPECT_NEAR(torque(0), 60 * 50 / 75.0, 1);
  EXPECT_NEAR(torque(1), 60, 1);
}

TEST(A700Vector, TorqueControlGivesPr806UpToTheSetFrequency) {
  for (const double percent : {30.0, 60.0, -40.0}) {
    Bench b = ordered(30, 11, {{"Pr.804", 1}, {"Pr.806", 1000 + percent}}, with_load(0.15, 1));
    b.run(1);
    EXPECT_NEAR(b.signal("torque") / 9.91 * 100, percent, 4);
    EXPECT_NEAR(command_percent(b), std::abs(percent), 0.2);
    EXPECT_EQ(speed_hz(b) > 0, percent > 0);
    b.run(20);
    EXPECT_NEAR(std::abs(speed_hz(b)), 30, 0.3) << percent;  // with the torque that the load takes
    EXPECT_LT(command_percent(b), 20);
    stop_command(b);
    b.run(6);
    EXPECT_FALSE(b.port().status().running);
  }
  // STR turns the command round.
  Bench reverse = ordered(30, 11, {{"Pr.804", 1}, {"Pr.806", 1050}}, with_load(0.15, 0), NetTerminal::kStr);
  reverse.run(1);
  EXPECT_NEAR(reverse.signal("torque") / 9.91 * 100, -50, 4);
}

TEST(A700Vector, Pr805IsTheSameCommandInRamAndPr806IsKept) {
  Bench b = a700_with(vector_settings(11, {{"Pr.804", 1}}), with_load(0.15, 0));
  ASSERT_TRUE(b.write_parameter(806, 1020).has_value());
  EXPECT_EQ(b.raw(805), 1020u);
  ASSERT_TRUE(b.write_parameter(805, 1080).has_value());
  EXPECT_EQ(b.raw(806), 1080u);
  ASSERT_TRUE(b.frequency(40).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
  EXPECT_NEAR(highest_command(b, 0.5), 80, 2);
  b.power_cycle();
  EXPECT_EQ(b.raw(805), 1020u);
  EXPECT_EQ(b.raw(806), 1020u);
}

TEST(A700Vector, Pr804Is0TakesTheTorqueFromTerminalOne) {
  Bench b = ordered(40, 11, {{"Pr.868", 4}}, with_load(0.1, 0));
  ASSERT_TRUE(b->set_analog("1", 4).has_value());
  b.run(1);
  EXPECT_NEAR(b.signal("torque") / 9.91 * 100, 60, 4);
  ASSERT_TRUE(b->set_analog("1", -2).has_value());
  b.run(0.5);
  EXPECT_NEAR(b.signal("torque") / 9.91 * 100, -30, 4);
  // With another function of the terminal there is no command.
  Bench none = ordered(40, 11, {{"Pr.868", 0}}, with_load(0.1, 0));
  ASSERT_TRUE(none->set_analog("1", 4).has_value());
  none.run(1);
  EXPECT_NEAR(speed_hz(none), 0, 0.3);
}

TEST(A700Vector, Pr804OfAnOptionThatIsNotFittedIsOpt) {
  Bench b = ordered(40, 11, {{"Pr.804", 4}});
  b.run(0.1);
  EXPECT_EQ(b->alarm_name(), "E.OPT");
  Bench speed = ordered(40, 10, {{"Pr.804", 4}});
  speed.run(0.1);
  EXPECT_EQ(speed->alarm_name(), "");
}

TEST(A700Vector, Pr807ChoosesTheSpeedLimitOfTorqueControl) {
  const Settings torque{{"Pr.804", 1}, {"Pr.806", 1060}, {"Pr.808", 20}};
  const auto limited = [&](Settings more, double volt, double percent = 60) {
    Settings s = torque;
    s.insert(s.end(), more.begin(), more.end());
    s.emplace_back("Pr.806", 1000 + percent);
    Bench b = ordered(30, 11, s, with_load(0.01, 0));
    EXPECT_TRUE(b->set_analog("1", volt).has_value());
    b.run(8);
    return speed_hz(b);
  };
  EXPECT_NEAR(limited({{"Pr.807", 0}}, 0), 30, 0.3);
  EXPECT_NEAR(limited({{"Pr.807", 1}}, 0), 20, 0.3);
  // Pr.809 in the other direction; 9999 is Pr.808.
  EXPECT_NEAR(limited({{"Pr.807", 1}, {"Pr.809", 12}}, 0, -60), -12, 0.3);
  EXPECT_NEAR(limited({{"Pr.807", 1}}, 0, -60), -20, 0.3);
  // Terminal 1 with Pr.868 = 5: 60 Hz at 10 V.
  EXPECT_NEAR(limited({{"Pr.807", 2}, {"Pr.868", 5}}, 2.5), 15, 0.3);
}

TEST(A700Vector, Pr800Is12ChangesToTorqueControlWithMc) {
  Bench b = ordered(20, 12, {{"Pr.183", 26}, {"Pr.804", 1}, {"Pr.806", 1050}}, with_load(0.05, 0));
  b.run(3);
  EXPECT_NEAR(speed_hz(b), 20, 0.1);
  EXPECT_LT(command_percent(b), 10);
  // The torque of the command takes it on to the next limit.
  ASSERT_TRUE(b.frequency(60).has_value());
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
  b.run(0.5);
  EXPECT_NEAR(command_percent(b), 50, 1);
}

TEST(A700Vector, MethodsThatNeedAnEncoderAreRefused) {
  Bench b = a700_with({{"Pr.340", 1}});
  for (const unsigned method : {0u, 1u, 5u, 9u})
    EXPECT_TRUE(refused(b.write_parameter(800, method), port::Refusal::kOutOfRange));
  EXPECT_TRUE(b.write_parameter(800, 10).has_value());
  const auto preset = b->preset_parameter("Pr.800", 3);
  ASSERT_FALSE(preset.has_value());
  EXPECT_THAT(preset.error(), testing::HasSubstr("FR-A7AP"));
}

TEST(A700Vector, Pr820Pr821AndX44AreTheSpeedController) {
  // Deepest speed when a load comes on at 30 Hz, and the deviation 2 s later.
  const auto after_load = [](const Settings& more, bool x44 = false) {
    Settings s = more;
    s.emplace_back("Pr.183", 44);
    Bench b = ordered(30, 10, s, with_load(0.02, 0));
    if (x44) {
      EXPECT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRt}).has_value());
    }
    b.run(4);
    plant::LoadSettings load;
    load.inertia_kg_m2 = 0.02;
    load.constant_nm = 8;
    b->set_load(load);
    double least = 100;
    for (int i = 0; i < 200; ++i) {
      b.run(0.01);
      least = std::min(least, speed_hz(b));
    }
    return std::pair{30 - least, 30 - speed_hz(b)};
  };
  const auto factory = after_load({});
  const auto stiff = after_load({{"Pr.820", 100}});
  const auto slow = after_load({{"Pr.821", 5}});
  const auto proportional = after_load({}, true);
  EXPECT_LT(stiff.first, 0.8 * factory.first);
  EXPECT_LT(std::abs(factory.second), 0.2);
  EXPECT_GT(slow.second, 2 * std::abs(factory.second) + 0.5);
  EXPECT_GT(proportional.second, slow.second);
}

TEST(A700Vector, Pr822AndPr826FilterSetSpeedAndTorque) {
  const auto seconds_to = [](double hz, const Settings& more) {
    Bench b = ordered(30, 10, more, with_load(0.02, 0));
    return seconds_until(
        b, [&] { return speed_hz(b) > hz; }, 10);
  };
  const double plain = seconds_to(15, {});
  EXPECT_GT(seconds_to(15, {{"Pr.822", 1}}), plain + 0.3);
  const auto torque_after = [](const Settings& more) {
    Settings s{{"Pr.804", 1}, {"Pr.806", 1060}};
    s.insert(s.end(), more.begin(), more.end());
    Bench b = ordered(30, 11, s, with_load(0.1, 0));
    b.run(0.6);
    return command_percent(b);
  };
  EXPECT_NEAR(torque_after({}), 60, 0.5);
  EXPECT_LT(torque_after({{"Pr.826", 1}}), 40);
}

TEST(A700Vector, Pr877ToPr881GiveTheTorqueOfTheRampAhead) {
  // Behind the ramp in the middle of it, Hz.
  const auto behind = [](const Settings& more) {
    Settings s = more;
    s.emplace_back("Pr.7", 2);
    s.emplace_back("Pr.821", 20);
    Bench b = ordered(50, 10, s, with_load(0.0049 * 3, 0));
    b.run(1.5);
    return 37.5 - speed_hz(b);
  };
  const Settings on{{"Pr.877", 1}, {"Pr.880", 3}, {"Pr.881", 100}};
  const double without = behind({{"Pr.880", 3}, {"Pr.881", 100}});
  const double with = behind(on);
  EXPECT_GT(without, 0.8);
  EXPECT_LT(std::abs(with), 0.5 * without);
  Settings limited = on;
  limited.emplace_back("Pr.879", 5);
  EXPECT_GT(std::abs(behind(limited)), std::abs(with));
  Settings slow = on;
  slow.emplace_back("Pr.878", 1);
  EXPECT_GT(std::abs(behind(slow)), std::abs(with));
  EXPECT_GT(behind({{"Pr.877", 1}, {"Pr.880", 0}, {"Pr.881", 100}}), with);
}

TEST(A700Vector, Pr850HoldsTheSpeedAtZeroInPlaceOfTheDcBrake) {
  const auto slid_rpm = [](double pr850) {
    Bench b = ordered(10, 10, {{"Pr.850", pr850}, {"Pr.11", 5}, {"Pr.10", 1}}, with_load(0.01, 0));
    b.run(3);
    plant::LoadSettings hoist;
    hoist.inertia_kg_m2 = 0.01;
    hoist.hoist_nm = 6;
    b->set_load(hoist);
    b.run(1);
    stop_command(b);
    EXPECT_TRUE(b.run_until([&] { return b.signal("run_state") == kStateDcBraking; }, 3))
        << b->alarm_name() << b->alarm_cause() << b.signal("speed");
    b.run(2);
    return std::abs(b.signal("speed"));
  };
  EXPECT_LT(slid_rpm(1), 10);
  EXPECT_GT(slid_rpm(0), 10);
}

TEST(A700Vector, LxHoldsTheShaftAndBuildsTheFluxUpBeforeTheStart) {
  const auto ready = [](double method, const Settings& more = {}) {
    Settings s = vector_settings(method, {{"Pr.183", 23}});  // LX at terminal RT
    s.insert(s.end(), more.begin(), more.end());
    Bench b = a700_with(s, with_load(0.02, 0));
    EXPECT_TRUE(b.command({NetTerminal::kRt}).has_value());
    b.run(0.5);
    return b;
  };
  EXPECT_EQ(ready(20).output_a(), 0);  // flux vector control has none
  Bench b = ready(10);
  EXPECT_NEAR(b.output_a(), 1.9, 0.3);  // what excites the motor
  EXPECT_FALSE(b.port().status().running);
  plant::LoadSettings hoist;
  hoist.inertia_kg_m2 = 0.02;
  hoist.hoist_nm = 6;
  b->set_load(hoist);
  b.run(2);
  EXPECT_NEAR(speed_hz(b), 0, 0.05);
  EXPECT_GT(b.output_a(), 2.2);
  stop_command(b);
  b.run(0.6);  // Pr.11
  EXPECT_LT(b.output_a(), 0.05);
  EXPECT_LT(speed_hz(b), -1);

  // Torque of a start at once, and while the flux builds up.
  const auto first_percent = [&](bool lx) {
    Bench t = ready(11, {{"Pr.804", 1}, {"Pr.806", 1060}, {"Pr.7", 0}});
    EXPECT_TRUE(t.frequency(30).has_value());
    if (!lx) {
      stop_command(t);
      t.run(1);
    }
    const NetTerminal other = lx ? NetTerminal::kRt : NetTerminal::kStf;
    EXPECT_TRUE(t.command({NetTerminal::kStf, other}).has_value());
    t.run(0.01);
    return command_percent(t);
  };
  EXPECT_NEAR(first_percent(true), 60, 1);
  EXPECT_LT(first_percent(false), 30);
}

// The brake is open before the drive starts: the load falls, and is caught while the flux builds up.
TEST(A700Vector, AFallingLoadIsCaughtWithoutAnOverCurrent) {
  InverterConfig config = with_load(0.01, 0);
  config.load.hoist_nm = 12;
  config.brake_resistance_ohm = 100;  // what the fall gives comes back
  Bench b = a700_with(vector_settings(10, {{"Pr.7", 2}, {"Pr.30", 1}, {"Pr.70", 30}}), config);
  ASSERT_TRUE(b.frequency(30).has_value());
  b->set_shaft_locked(true);
  b.run(0.1);
  b->set_shaft_locked(false);
  b.run(0.1);
  EXPECT_LT(speed_hz(b), -1);
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
  b.run(4);
  EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
  EXPECT_NEAR(speed_hz(b), 30, 0.2);
}

TEST(A700Vector, Pr854TakesTheFluxAwayWithoutLoad) {
  const auto amperes = [](double percent) {
    Bench b = ordered(25, 10, {{"Pr.854", percent}}, with_load(0.01, 0));
    b.run(4);
    return b.output_a();
  };
  EXPECT_LT(amperes(50), 0.7 * amperes(100));
}

TEST(A700Vector, TheMotorConstantsSetVoltageAndCurrent) {
  const auto volts = [](const Settings& more, double nm = 9) {
    Bench b = ordered(20, 10, more, with_load(0.01, nm));
    b.run(4);
    return b.output_v();
  };
  const double factory = volts({});
  EXPECT_GT(volts({{"Pr.90", 6}}), factory + 5);     // R1 drops more
  EXPECT_GT(volts({{"Pr.92", 50}}), factory + 1);    // leakage of the stator ...
  EXPECT_GT(volts({{"Pr.93", 50}}), factory + 1);    // ... and of the rotor
  EXPECT_LT(volts({{"Pr.859", 1.2}}), factory - 2);  // torque current
  // R2 says the slip that flux vector control compensates, and Pr.89 how much of it.
  const auto slip = [](const Settings& more) {
    Bench b = ordered(20, 20, more, with_load(0.01, 8));
    b.run(4);
    return b.output_hz() - 20;
  };
  const double compensated = slip({});
  EXPECT_GT(compensated, 0.5);
  EXPECT_NEAR(slip({{"Pr.89", 50}}), compensated / 2, 0.25);
  EXPECT_GT(slip({{"Pr.91", 6}}), compensated + 0.3);
  // More excitation (Pr.82, or Pr.94 where that is not set) leaves less torque current of the rated one.
  EXPECT_GT(slip({{"Pr.82", 2.6}}), compensated + 0.1);
  EXPECT_GT(slip({{"Pr.94", 90}}), compensated + 0.1);
  EXPECT_NEAR(slip({{"Pr.94", 90}, {"Pr.82", 1.91}}), compensated, 0.05);
}

TEST(A700Vector, VectorControlKnowsFourCarriers) {
  for (const auto& [pr72, hz] : {std::pair{2.0, 2000.0}, {7.0, 6000.0}, {12.0, 10000.0}, {15.0, 14000.0}}) {
    Bench b = ordered(20, 10, {{"Pr.72", pr72}});
    b.run(0.1);
    EXPECT_EQ(b.signal("carrier"), hz);
  }
}

}  // namespace
}  // namespace vinv::inverter::test
