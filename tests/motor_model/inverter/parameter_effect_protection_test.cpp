// Parameters that say what the FR-E500 does about too much current, heat or brake energy, and about a power failure:
// stall prevention, motor thermal, brake duty, restart, fault detection, retry.
#include "parameter_bench.hpp"

namespace vinv::inverter::test {
namespace {

constexpr double kRated_a = 4.0;

// Factory V/f law of a 1.5K: 4 % boost, 380 V at 50 Hz.
double law_v(double hz) { return 380 * (0.04 + 0.96 * std::min(hz / 50, 1.0)); }

plant::LoadSettings torque(double nm, double inertia = 0) {
  plant::LoadSettings load;
  load.constant_nm = nm;
  load.inertia_kg_m2 = inertia;
  return load;
}

// --- stall prevention ---

TEST(ParameterEffect, Pr22IsTheCurrentThatABlockedMotorIsHeldAt) {
  for (double percent : {80.0, 120.0, 150.0}) {
    Bench b = drive_with({{"Pr.22", percent}, {"Pr.7", 2}});
    b->set_shaft_locked(true);
    start(b, 50);
    b.run(2.5);
    EXPECT_TRUE(b.port().status().overload);
    EXPECT_NEAR(b.signal("output_current") / kRated_a * 100, percent, 6) << percent;
    EXPECT_LT(b.output_hz(), 20);
  }
}

TEST(ParameterEffect, Pr23AndPr66LowerTheStallLevelAtHighFrequency) {
  // 5 Nm at 100 Hz need about 70 % of the rated current; with Pr.66 = 50 the level there is 64 % at a factor of 0 and
  // 86 % at a factor of 200.
  const auto stalls = [](const Settings& more) {
    Settings settings{{"Pr.7", 4}};
    settings.insert(settings.end(), more.begin(), more.end());
    Bench b = drive_with(settings);
    start(b, 100);
    b.run(9);
    b->set_load(torque(5));
    b.run(2);
    EXPECT_EQ(b->alarm_name(), "");
    return b.output_hz() < 99;
  };
  EXPECT_FALSE(stalls({}));
  EXPECT_TRUE(stalls({{"Pr.23", 0}}));
  EXPECT_FALSE(stalls({{"Pr.23", 200}}));
  EXPECT_FALSE(stalls({{"Pr.23", 0}, {"Pr.66", 100}}));
  EXPECT_TRUE(stalls({{"Pr.23", 200}, {"Pr.66", 30}}));
}

TEST(ParameterEffect, Pr156SelectsWhereStallPreventionActs) {
  struct Seen {
    bool overload = false;
    std::string alarm;
    double lowest_hz = 1e9;
  };
  const auto accelerate = [](double pr156) {
    Bench b = drive_with({{"Pr.156", pr156}, {"Pr.7", 0.5}}, loaded(0.1, 8));
    start(b, 50);
    Seen s;
    for (int i = 0; i < 1500; ++i) {
      b.tick();
      s.overload |= b.port().status().overload && i < 450;  // then constant speed may follow
    }
    s.alarm = b->alarm_name();
    return s;
  };
  const auto overload_at_50_hz = [](double pr156) {
    Bench b = drive_with({{"Pr.156", pr156}, {"Pr.7", 2}, {"Pr.9", 0}});
    start(b, 50);
    b.run(3);
    b->set_load(torque(20));
    Seen s;
    for (int i = 0; i < 1500; ++i) {
      b.tick();
      s.overload |= b.port().status().overload;
      if (b->alarm_name().empty()) s.lowest_hz = std::min(s.lowest_hz, b.output_hz());
    }
    s.alarm = b->alarm_name();
    return s;
  };
  const auto decelerate = [](double pr156) {
    InverterConfig c = loaded(0.06);
    c.brake_resistance_ohm = 100;
    Bench b =
        drive_with({{"Pr.156", pr156}, {"Pr.7", 5}, {"Pr.8", 0.5}, {"Pr.30", 1}, {"Pr.70", 30}, {"Pr.22", 110}}, c);
    start(b, 50);
    b.run(7);
    stop(b);
    Seen s;
    for (int i = 0; i < 300; ++i) {
      b.tick();
      s.overload |= b.port().status().overload;
      s.lowest_hz = std::min(s.lowest_hz, b.output_hz());
    }
    s.alarm = b->alarm_name();
    return s;
  };
  for (double pr156 : {0.0, 4.0, 8.0, 100.0}) EXPECT_TRUE(accelerate(pr156).overload) << pr156;
  EXPECT_FALSE(accelerate(2).overload);
  EXPECT_EQ(accelerate(3).alarm, "E.OC1");  // the fast current limit off, too
  EXPECT_EQ(accelerate(16).alarm, "E.OLT");
  for (double pr156 : {0.0, 2.0, 8.0, 100.0}) {
    EXPECT_TRUE(overload_at_50_hz(pr156).overload) << pr156;
    EXPECT_LT(overload_at_50_hz(pr156).lowest_hz, 49.5) << pr156;
  }
  EXPECT_FALSE(overload_at_50_hz(4).overload);
  EXPECT_NEAR(overload_at_50_hz(4).lowest_hz, 50, 0.01);
  EXPECT_EQ(overload_at_50_hz(16).alarm, "E.OLT");
  for (double pr156 : {0.0, 2.0, 4.0}) {
    EXPECT_TRUE(decelerate(pr156).overload) << pr156;
    EXPECT_GT(decelerate(pr156).lowest_hz, 25) << pr156;
  }
  for (double pr156 : {8.0, 100.0}) {
    EXPECT_FALSE(decelerate(pr156).overload) << pr156;
    EXPECT_LT(decelerate(pr156).lowest_hz, 21) << pr156;
  }
}

TEST(ParameterEffect, Pr156SwitchesTheFastCurrentLimitOff) {
  // The shaft is blocked at full speed; stall prevention is too slow for that.
  for (double pr156 : {0.0, 1.0}) {
    Bench b = drive_with({{"Pr.156", pr156}, {"Pr.7", 2}, {"Pr.22", 200}});
    start(b, 50);
    b.run(3);
    b->set_shaft_locked(true);
    b.run(0.3);
    EXPECT_EQ(b->alarm_name(), pr156 == 1 ? "E.OC2" : "") << b->alarm_cause();
  }
}

// --- motor thermal ---

// Thermal state and the current behind it after 20 s from cold with 5 Nm.
double thermal_percent(const Settings& more, double hz, bool rt = false) {
  Settings settings{{"Pr.183", 3}, {"Pr.44", 0.5}, {"Pr.7", 0.5}, {"Pr.6", hz}};
  settings.insert(settings.end(), more.begin(), more.end());
  Bench b = drive_with(settings, loaded(0, 5));
  b.terminal("MRS", rt);
  b.terminal("RL");
  b.terminal("STF");
  b.run(20);
  EXPECT_EQ(b->alarm_name(), "");
  return b.signal("motor_thermal");
}

TEST(ParameterEffect, Pr9Pr48AndPr71SetTheMotorThermal) {
  const double factory = thermal_percent({}, 50);
  EXPECT_GT(factory, 1);
  EXPECT_NEAR(thermal_percent({{"Pr.9", 3}}, 50) / factory, 16.0 / 9, 0.02);  // by the square of the current
  EXPECT_EQ(thermal_percent({{"Pr.9", 0}}, 50), 0);
  EXPECT_NEAR(thermal_percent({{"Pr.48", 3}}, 50, true) / factory, 16.0 / 9, 0.02);
  EXPECT_NEAR(thermal_percent({{"Pr.48", 3}}, 50) / factory, 1, 0.02);
  EXPECT_NEAR(thermal_percent({{"Pr.48", 9999}}, 50, true) / factory, 1, 0.02);
  // At 20 Hz a self-cooled motor stands 70 %; constant-torque motors all of it.
  const double slow = thermal_percent({}, 20);
  for (double constant_torque : {1.0, 13.0, 15.0, 16.0}) {
    EXPECT_NEAR(thermal_percent({{"Pr.71", constant_torque}}, 20) / slow, 0.49, 0.02) << constant_torque;
  }
  for (double standard : {3.0, 5.0, 6.0, 23.0, 100.0, 123.0}) {
    EXPECT_NEAR(thermal_percent({{"Pr.71", standard}}, 20) / slow, 1, 0.02) << standard;
  }
  for (double with_rt : {100.0, 103.0, 123.0}) {
    EXPECT_NEAR(thermal_percent({{"Pr.71", with_rt}}, 20, true) / slow, 0.49, 0.02) << with_rt;
  }
}

// --- brake duty ---

TEST(ParameterEffect, Pr30AndPr70PermitTheBrakeResistor) {
  struct Braked {
    std::string alarm;
    double duty_percent;  // of the permitted duty, used
  };
  const auto brake = [](const Settings& more) {
    InverterConfig c = loaded(0.05);
    c.brake_resistance_ohm = 150;
    Settings settings{{"Pr.7", 4}, {"Pr.8", 0.8}};
    settings.insert(settings.end(), more.begin(), more.end());
    Bench b = drive_with(settings, c);
    start(b, 50);
    b.run(6);
    stop(b);
    b.run(1);
    return Braked{b->alarm_name(), b.signal("brake_duty")};
  };
  const Braked model = brake({});  // 3 % of the model
  EXPECT_EQ(model.alarm, "");
  EXPECT_GT(model.duty_percent, 2);
  EXPECT_NEAR(brake({{"Pr.70", 30}}).duty_percent, model.duty_percent, 1e-6);  // Pr.30 = 0: not asked
  const Braked special = brake({{"Pr.30", 1}, {"Pr.70", 30}});
  EXPECT_EQ(special.alarm, "");
  EXPECT_LT(special.duty_percent, model.duty_percent / 5);
  EXPECT_EQ(brake({{"Pr.30", 1}}).alarm, "E.OV3");  // Pr.70 = 0: no braking at all
}

// --- instantaneous power failure ---

TEST(ParameterEffect, Pr57AndPr58AreTheRestartAfterAPowerFailure) {
  struct Restart {
    bool restarted = false;
    double wait_s = 0;
    double full_voltage_s = 0;
  };
  const auto dip = [](const Settings& more) {
    Settings settings{{"Pr.7", 3}};
    settings.insert(settings.end(), more.begin(), more.end());
    Bench b = drive_with(settings, loaded(0.05, 4));
    start(b, 50);
    b.run(5);
    b->set_mains({.voltage_v_rms = 0});
    b.run(0.1);
    EXPECT_TRUE(b.port().status().power_failure);
    b->set_mains({.voltage_v_rms = 400});
    const double back_s = b.now_s();
    Restart r;
    r.restarted = b.run_until([&] { return b.port().status().running; }, 8);
    r.wait_s = b.now_s() - back_s;
    const double on_s = b.now_s();
    const auto full = [&] { return b.signal("output_voltage") > 0.97 * law_v(b.signal("output_frequency")); };
    if (r.restarted && b.run_until(full, 8)) r.full_voltage_s = b.now_s() - on_s;
    EXPECT_EQ(b->alarm_name(), "") << b->alarm_cause();
    return r;
  };
  EXPECT_FALSE(dip({}).restarted);
  EXPECT_NEAR(dip({{"Pr.57", 0}}).wait_s, 0.5, 0.05);  // the time of the model
  EXPECT_NEAR(dip({{"Pr.57", 0.2}}).wait_s, 0.2, 0.05);
  EXPECT_NEAR(dip({{"Pr.57", 1.5}}).wait_s, 1.5, 0.05);
  EXPECT_NEAR(dip({{"Pr.57", 0.2}}).full_voltage_s, 1, 0.1);
  EXPECT_NEAR(dip({{"Pr.57", 0.2}, {"Pr.58", 3}}).full_voltage_s, 3, 0.2);
  EXPECT_LT(dip({{"Pr.57", 0.2}, {"Pr.58", 0.1}}).full_voltage_s, 0.15);
}

// --- faults of the output ---

TEST(ParameterEffect, Pr249TestsForAnEarthFaultAtTheStart) {
  for (const char* model : {"FR-E520-0.75K", "FR-E540-0.75K"}) {
    const bool low = std::string_view(model) == "FR-E520-0.75K";
    for (double pr249 : {0.0, 1.0}) {
      Bench b = drive_with({{"Pr.249", pr249}}, config_for(model, low ? "iec4p_0k4kW_200V" : "iec4p_0k75kW_400V"));
      ASSERT_TRUE(b->inject_fault("earth_fault", true).has_value());
      start(b, 20);
      b.run(0.5);
      EXPECT_EQ(b->alarm_name(), !low || pr249 == 1 ? "E.GF" : "") << model;
    }
  }
}

TEST(ParameterEffect, Pr251WatchesForAnOpenOutputPhase) {
  for (double pr251 : {0.0, 1.0}) {
    Bench b = drive_with({{"Pr.251", pr251}});
    start(b, 20);
    b.run(1);
    ASSERT_TRUE(b->inject_fault("output_phase_open", true).has_value());
    b.run(1);
    EXPECT_EQ(b->alarm_name(), pr251 == 1 ? "E.LF" : "");
  }
}

// --- retry ---

TEST(ParameterEffect, Pr65SelectsWhatIsRetried) {
  struct Case {
    double pr65;
    const char* alarm;
    bool retried;
  };
  for (const Case& c : {Case{0, "E.OC2", true},
                        {0, "E.OV2", true},
                        {0, "E.THM", true},
                        {0, "E.FIN", false},
                        Case{1, "E.OC2", true},
                        {1, "E.OV2", false},
                        {1, "E.THM", false},
                        Case{2, "E.OC2", false},
                        {2, "E.OV2", true},
                        {2, "E.THM", false},
                        Case{3, "E.OC2", true},
                        {3, "E.OV2", true},
                        {3, "E.THM", false}}) {
    Bench b = drive_with({{"Pr.65", c.pr65}, {"Pr.67", 1}, {"Pr.68", 0.1}});
    start(b, 20);
    b.run(0.5);
    ASSERT_TRUE(b->inject_fault(c.alarm, true).has_value());
    b.run(0.5);
    EXPECT_EQ(b.port().status().running, c.retried) << c.pr65 << " " << c.alarm;
  }
}

TEST(ParameterEffect, Pr67ToPr69CountTimeAndShowTheRetries) {
  struct Seen {
    int restarts = 0;
    bool alarm_meanwhile = false;
    double wait_s = 0;
    std::string end;
    std::uint32_t pr69 = 0;
  };
  // Three alarms, each as soon as the drive runs again.
  const auto retry = [](double pr67, double pr68) {
    Bench b = drive_with({{"Pr.67", pr67}, {"Pr.68", pr68}});
    start(b, 20);
    b.run(0.5);
    Seen s;
    for (int i = 0; i < 3 && b->alarm_name().empty(); ++i) {
      EXPECT_TRUE(b->inject_fault("E.OC2", true).has_value());
      b.tick();
      if (b->alarm_name() != "E.OC2") break;
      s.alarm_meanwhile |= b.port().status().alarm;
      const double at = b.now_s();
      if (!b.run_until([&] { return b.port().status().running; }, pr68 + 1)) break;
      s.wait_s = b.now_s() - at;
      ++s.restarts;
      b.run(0.2);
    }
    s.end = b->alarm_name();
    b.run(5 * pr68 + 0.1);
    s.pr69 = b.raw(69);
    return s;
  };
  const Seen none = retry(0, 0.2);
  EXPECT_EQ(none.restarts, 0);
  EXPECT_TRUE(none.alarm_meanwhile);
  EXPECT_EQ(none.end, "E.OC2");
  for (double pr67 : {1.0, 2.0, 101.0, 102.0}) {
    const Seen s = retry(pr67, 0.2);
    EXPECT_EQ(s.restarts, static_cast<int>(pr67) % 100);
    EXPECT_EQ(s.alarm_meanwhile, pr67 > 100);
    EXPECT_EQ(s.end, "E.RET");
    EXPECT_EQ(s.pr69, 0u);
  }
  for (double pr68 : {0.2, 1.3}) {
    const Seen s = retry(10, pr68);
    EXPECT_EQ(s.restarts, 3);
    EXPECT_NEAR(s.wait_s, pr68, 0.005);
    EXPECT_EQ(s.end, "");
    EXPECT_EQ(s.pr69, 1u);  // one success
  }
}

}  // namespace
}  // namespace vinv::inverter::test
