// Output signals, meter AM and monitors of the FR-A700. FR-A7NE manual 7.2.1, 7.6, 7.13; the rest typical for the
// family.
#include <map>
#include <set>

#include "a700_bench.hpp"
#include "motor_model/inverter/a700/tables.hpp"
#include "motor_model/inverter/eeprom_text.hpp"

namespace vinv::inverter::test {
namespace {

// The signal at terminal IPF, in both senses at IPF and OL.
struct Signal {
  Bench b;
  Signal(int function, const Settings& settings, const InverterConfig& config = config_a700())
      : b(a700_with(with(function, settings), config)) {}
  static Settings with(int function, Settings settings) {
    settings.emplace_back("Pr.192", function);
    settings.emplace_back("Pr.193", function + 100);
    return settings;
  }
  bool on() {
    EXPECT_NE(b.output("IPF"), b.output("OL"));
    return b.output("IPF");
  }
  void run_at(double hz) {
    b.preset("Pr.4", hz);
    b.terminal("STF");
    b.terminal("RH");
    EXPECT_TRUE(b.run_until([&] { return b.output_hz() > hz - 0.01; }, 20)) << b->alarm_name();
    b.run(0.3);
  }
};

TEST(A700Output, FrequencyDetectionsFollowPr42Pr43Pr50AndPr116) {
  for (const auto& [function, parameter] :
       {std::pair{4, "Pr.42"}, {5, "Pr.50"}, {6, "Pr.116"}, {41, "Pr.42"}, {42, "Pr.50"}, {43, "Pr.116"}}) {
    Signal below(function, {{parameter, 20}});
    below.run_at(15);
    EXPECT_FALSE(below.on()) << function;
    Signal above(function, {{parameter, 20}});
    above.run_at(25);
    EXPECT_TRUE(above.on()) << function;
  }
  Bench reverse = a700_with({{"Pr.43", 10}, {"Pr.42", 50}, {"Pr.4", 20}});
  reverse.terminal("STR");
  reverse.terminal("RH");
  reverse.run(2);
  EXPECT_TRUE(reverse.output("FU"));
}

TEST(A700Output, Pr41IsTheWidthOfUpToFrequency) {
  for (double pr41 : {1.0, 50.0}) {
    Bench b = a700_with({{"Pr.41", pr41}, {"Pr.7", 2}, {"Pr.4", 50}});
    b.terminal("STF");
    b.terminal("RH");
    b.run_until([&] { return b.output_hz() > 30; }, 5);
    EXPECT_EQ(b.output("SU"), pr41 == 50);
  }
}

TEST(A700Output, Pr190ToPr196GiveEachTerminalItsSignal) {
  for (const auto& [parameter, terminal] : {std::pair{"Pr.190", "RUN"},
                                            {"Pr.191", "SU"},
                                            {"Pr.192", "IPF"},
                                            {"Pr.193", "OL"},
                                            {"Pr.194", "FU"},
                                            {"Pr.195", "ABC1"},
                                            {"Pr.196", "ABC2"}}) {
    Bench b = a700_with({{parameter, 10}});  // PU operation
    EXPECT_FALSE(b.output(terminal)) << parameter;
    b.pu();
    b.run(0.01);
    EXPECT_TRUE(b.output(terminal)) << parameter;
    Bench none = a700_with({{parameter, 9999}});
    none.pu();
    none.run(0.01);
    EXPECT_FALSE(none.output(terminal)) << parameter;
  }
}

TEST(A700Output, RunSignalsTellTheOutputAndTheCommand) {
  for (int function : {0, 44, 45, 11, 33}) {
    Signal s(function, {{"Pr.13", 5}});
    s.b.run(0.1);
    EXPECT_EQ(s.on(), function == 11 || function == 33) << function;  // RY and RY2: ready
    s.b.terminal("STF");
    s.b.run(0.1);  // start signal without frequency
    EXPECT_EQ(s.on(), function == 45 || function == 11 || function == 33) << function;
    s.run_at(20);
    EXPECT_EQ(s.on(), function != 33) << function;
  }
}

TEST(A700Output, Pr864AndPr865AreTheTorqueAndLowSpeedDetections) {
  const InverterConfig loaded_motor = loaded(0, 6, config_a700());  // about 60 % of the rated torque
  for (double level : {30.0, 90.0}) {
    Signal s(35, {{"Pr.864", level}, {"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}}, loaded_motor);
    s.run_at(30);
    EXPECT_EQ(s.on(), level == 30) << level;
  }
  Signal slow(34, {{"Pr.865", 10}});
  slow.run_at(8);
  EXPECT_TRUE(slow.on());
  Signal fast(34, {{"Pr.865", 5}});
  fast.run_at(8);
  EXPECT_FALSE(fast.on());
}

TEST(A700Output, Pr150ToPr153AreTheCurrentDetections) {
  Signal y12(12, {{"Pr.150", 20}, {"Pr.151", 0.5}});
  y12.run_at(20);
  y12.b.run(0.3);
  EXPECT_TRUE(y12.on());
  Signal late(12, {{"Pr.150", 20}, {"Pr.151", 10}});
  late.run_at(20);
  EXPECT_FALSE(late.on());
  for (double pr152 : {1.0, 100.0}) {
    Signal y13(13, {{"Pr.152", pr152}, {"Pr.153", 0.1}});
    y13.run_at(20);
    EXPECT_EQ(y13.on(), pr152 == 100);
  }
}

TEST(A700Output, PreAlarmsComeAtEightyFivePercent) {
  Signal thp(8, {{"Pr.9", 1.9}}, loaded(0, 6, config_a700()));
  thp.run_at(30);
  ASSERT_TRUE(thp.b.run_until([&] { return thp.b.signal("motor_thermal") > 84; }, 600));
  EXPECT_FALSE(thp.on());
  ASSERT_TRUE(thp.b.run_until([&] { return thp.b.signal("motor_thermal") > 85.2; }, 60));
  EXPECT_TRUE(thp.on());
  InverterConfig hot = config_a700();
  hot.ambient_c = 90;  // the heat sink trips at 95
  Signal fin(26, {}, hot);
  fin.b.run(0.1);
  EXPECT_TRUE(fin.on());
}

TEST(A700Output, MinorFaultsAreTheFanTheLostLineAndTheMaintenanceTimer) {
  for (int function : {25, 90, 98, 97}) {
    Signal s(function, {});
    s.b.run(0.1);
    EXPECT_FALSE(s.on());
    ASSERT_TRUE(s.b->inject_fault("fan", true).has_value());
    s.b.run(0.01);
    EXPECT_TRUE(s.on()) << function;
    EXPECT_EQ(s.b.raw(255), 4u);
  }
  Signal line(98, {});
  line.b.port().set_communication_lost(true);
  line.b.run(0.01);
  EXPECT_TRUE(line.on());
}

TEST(A700Output, PowerFailureOverloadAndBrakeDutyHaveSignals) {
  Signal ipf(2, {{"Pr.57", 0}, {"Pr.186", 9999}});
  ipf.run_at(30);
  ipf.b->set_mains({.voltage_v_rms = 150});
  bool seen = false;
  for (int i = 0; i < 1000; ++i) {
    ipf.b.tick();
    seen = seen || ipf.on();
  }
  EXPECT_TRUE(seen);
  Signal ol(3, {{"Pr.22", 60}, {"Pr.4", 30}});
  ol.b->set_shaft_locked(true);
  ol.b.terminal("STF");
  ol.b.terminal("RH");
  ol.b.run(1.5);
  EXPECT_TRUE(ol.on());
  InverterConfig braked = loaded(0.1, 0, config_a700());
  braked.brake_resistance_ohm = 200;
  Signal rbp(7, {{"Pr.7", 3}, {"Pr.30", 1}, {"Pr.70", 0.3}}, braked);
  rbp.run_at(50);
  rbp.b.terminal("STF", false);
  ASSERT_TRUE(rbp.b.run_until([&] { return rbp.b.signal("brake_duty") > 86; }, 5));
  EXPECT_TRUE(rbp.on());
  EXPECT_NEAR(monitor(rbp.b, 9) / 10, rbp.b.signal("brake_duty"), 2);
  Signal pid(16, {{"Pr.183", 14}, {"Pr.128", 20}, {"Pr.133", 50}});
  pid.b.terminal("STF");
  pid.b.terminal("RT");
  pid.b.run(1);
  EXPECT_TRUE(pid.on());  // RL: forward under PID control
}

TEST(A700Output, AlarmSignalsTellTheKind) {
  for (int function : {99, 94, 91}) {
    for (const char* alarm : {"E.OC1", "E.CPU"}) {
      Signal s(function, {});
      ASSERT_TRUE(s.b->inject_fault(alarm, true).has_value());
      s.b.run(0.01);
      EXPECT_EQ(s.on(), function != 91 || std::string_view(alarm) == "E.CPU");
    }
  }
}

TEST(A700Output, Pr495ToPr497AreTheRemoteOutputs) {
  Bench b = a700_with({{"Pr.190", 96}, {"Pr.192", 96}, {"Pr.195", 96}, {"Pr.340", 1}});
  ASSERT_TRUE(b.write_parameter(496, 0x24).has_value());
  b.tick();
  EXPECT_FALSE(b.output("RUN"));
  EXPECT_TRUE(b.output("IPF"));
  EXPECT_TRUE(b.output("ABC1"));
  b.power_cycle();
  EXPECT_EQ(b.raw(496), 0u);
  Bench held = a700_with({{"Pr.495", 1}, {"Pr.340", 1}});
  ASSERT_TRUE(held.write_parameter(496, 7).has_value());
  ASSERT_TRUE(held.write_parameter(497, 5).has_value());
  held.power_cycle();
  EXPECT_EQ(held.raw(496), 7u);
  EXPECT_EQ(held.raw(497), 5u);
}

TEST(A700Output, Pr158ChoosesWhatTerminalAmShows) {
  const auto am = [](const Settings& settings) {
    Bench b = a700_running(30, settings);
    b.run(0.1);  // Pr.867
    return b.signal("am");
  };
  EXPECT_NEAR(am({}), 5, 0.02);  // of Pr.55 = 60 Hz
  EXPECT_NEAR(am({{"Pr.55", 40}}), 7.5, 0.02);
  EXPECT_NEAR(am({{"Pr.901", 50}}), 2.5, 0.02);
  EXPECT_NEAR(am({{"Pr.158", 3}, {"Pr.0", 0}}), 3, 0.1);  // 240 of 800 V
  EXPECT_NEAR(am({{"Pr.158", 5}}), 5, 0.02);
  EXPECT_NEAR(am({{"Pr.158", 21}}), 10, 0.001);
  Bench b = a700_running(30, {{"Pr.158", 2}, {"Pr.56", 10}});
  b.run(0.5);
  EXPECT_NEAR(b.signal("am"), b.output_a(), 0.02);
  const Settings vector{{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.158", 7}};
  Settings half = vector;
  half.emplace_back("Pr.866", 300);
  const auto load = loaded(0, 6, config_a700());
  EXPECT_NEAR(2 * a700_running(30, half, load).signal("am"), a700_running(30, vector, load).signal("am"), 0.1);
}

// --- monitors ---

TEST(A700Monitors, EveryCodeIsReadAndOthersAreRefused) {
  Bench b = a700_running(30);
  for (const a700::MonitorRow& row : a700::monitors()) {
    EXPECT_TRUE(b.port().read_monitor(row.code).has_value()) << row.name;
  }
  for (unsigned code : {0u, 4u, 21u, 26u, 61u, 255u}) {
    EXPECT_EQ(b.port().read_monitor(code).error(), port::Refusal::kNoSuchItem) << code;
  }
}

TEST(A700Monitors, ShowWhatTheMotorDoes) {
  Bench b = a700_running(40, {{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}}, loaded(0, 6, config_a700()));
  b.run(3);
  EXPECT_NEAR(monitor(b, 1), b.signal("output_frequency") * 100, 1);
  EXPECT_EQ(monitor(b, 5), 4000);
  EXPECT_NEAR(monitor(b, 2) / 100, b.signal("output_current"), 0.05);
  EXPECT_NEAR(monitor(b, 3) / 10, b.signal("output_voltage"), 3);
  EXPECT_NEAR(monitor(b, 8) / 10, b.signal("dc_link"), 3);
  EXPECT_NEAR(monitor(b, 10) / 10, b.signal("motor_thermal"), 0.2);
  EXPECT_NEAR(monitor(b, 13) * 10, b.signal("input_power"), 30);
  EXPECT_NEAR(monitor(b, 14) * 10, b.signal("output_power"), 30);
  EXPECT_NEAR(monitor(b, 34) * 10, b.signal("shaft_power"), 30);
  EXPECT_NEAR(monitor(b, 24) / 10, b.signal("output_current") / 4.0 * 100, 2);
  const double rated_nm = 1500 / (b->plant().config().machine.rated_speed_rpm * M_PI / 30);
  EXPECT_NEAR(monitor(b, 7) / 10, b.signal("torque") / rated_nm * 100, 1);
  EXPECT_EQ(monitor(b, 32), monitor(b, 7));
  EXPECT_GT(monitor(b, 33), 300);
  // Torque current and excitation current make up the output current.
  const double torque_a = monitor(b, 17) / 1000 * 4.0;  // of Pr.56
  EXPECT_NEAR(std::hypot(torque_a, monitor(b, 18) / 100), b.signal("output_current"), 0.1);
  EXPECT_GE(monitor(b, 11), monitor(b, 2));
  EXPECT_GE(monitor(b, 12), monitor(b, 8));
  for (unsigned code : {19u, 22u, 35u, 58u, 59u, 60u}) EXPECT_EQ(monitor(b, code), 0) << code;
}

// Every row in its own unit and increment, in both sizes of increments; what is left has a test of its own.
TEST(A700Monitors, EachOneHasTheUnitOfItsRow) {
  struct Unit {
    InverterConfig config;
    double kw = 0;
  };
  InverterConfig large = config_for("FR-A740-75K", "iec4p_15kW_400V");
  large.load.constant_nm = 60;
  for (const Unit& unit : {Unit{loaded(0, 6, config_a700()), 1.5}, Unit{large, 15}}) {
    Bench b = a700_running(40, {{"Pr.80", unit.kw}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.7", 2}}, unit.config);
    b.run(3);
    const bool coarse = b.port().facts().coarse;
    const plant::PlantMeasurements& m = b->plant().measurements();
    const double rated_a = coarse ? 144 : 4;
    const double rated_nm = 1000 * unit.kw / (unit.config.motor.rated_speed_rpm * M_PI / 30);
    const double excitation_a = std::sqrt(std::pow(m.output_current_a_rms, 2) - std::pow(m.active_current_a_rms, 2));
    struct Expected {
      double value;
      const char* unit;
      int decimals;
    };
    const int fine = coarse ? 1 : 2;
    const std::map<unsigned, Expected> expected{{1, {b.signal("output_frequency"), "Hz", 2}},
                                                {2, {m.output_current_a_rms, "A", fine}},
                                                {3, {m.output_voltage_v_rms, "V", 1}},
                                                {5, {40, "Hz", 2}},
                                                {6, {b.signal("output_frequency") * 30, "r/min", 0}},
                                                {7, {m.torque_nm / rated_nm * 100, "%", 1}},
                                                {8, {m.dc_link_v, "V", 1}},
                                                {10, {b.signal("motor_thermal"), "%", 1}},
                                                {13, {m.input_power_w / 1000, "kW", fine}},
                                                {14, {m.output_power_w / 1000, "kW", fine}},
                                                {17, {m.active_current_a_rms / rated_a * 100, "%", 1}},
                                                {18, {excitation_a, "A", fine}},
                                                {24, {m.output_current_a_rms / rated_a * 100, "%", 1}},
                                                {32, {m.torque_nm / rated_nm * 100, "%", 1}},
                                                {34, {m.shaft_power_w / 1000, "kW", fine}}};
    const std::set<unsigned> elsewhere{9, 11, 12, 15, 16, 20, 23, 25, 33, 50, 51, 52, 53, 54};
    const std::set<unsigned> not_fitted{19, 22, 35, 58, 59, 60};
    for (const a700::MonitorRow& row : a700::monitors()) {
      SCOPED_TRACE(row.name + (coarse ? ", 75K" : ", 1.5K"));
      if (not_fitted.contains(row.code)) {
        EXPECT_EQ(monitor(b, row.code), 0);
      }
      if (not_fitted.contains(row.code) || elsewhere.contains(row.code)) continue;
      ASSERT_TRUE(expected.contains(row.code));
      const Expected& e = expected.at(row.code);
      EXPECT_EQ(row.unit, e.unit);
      EXPECT_NEAR(monitor(b, row.code) / std::pow(10, e.decimals), e.value,
                  0.02 * e.value + 1.5 / std::pow(10, e.decimals));
    }
  }
}

TEST(A700Monitors, TorqueIsOfVectorControlOnly) {
  Bench b = a700_running(40, {}, loaded(0, 6, config_a700()));
  for (unsigned code : {7u, 32u, 33u, 34u}) EXPECT_EQ(monitor(b, code), 0) << code;
}

TEST(A700Monitors, PeaksAreOfThePresentRun) {
  Bench b = a700_with({{"Pr.4", 30}}, loaded(0.02, 8, config_a700()));
  b.terminal("RH");
  b.terminal("STF");
  b.run(3);
  const double peak = monitor(b, 11);
  EXPECT_GT(peak, monitor(b, 2));
  b.terminal("STF", false);
  b.run(3);
  EXPECT_GE(monitor(b, 11), peak);
  b->set_load({});
  b.preset("Pr.7", 5);
  b.terminal("STF");
  b.run(1);
  EXPECT_LT(monitor(b, 11), peak);
}

// FR-A7NE manual 4.7.
TEST(A700Monitors, RunningSpeedFollowsPr37Pr144AndPr505) {
  const auto speed = [](const Settings& settings) {
    Bench b = a700_running(30, settings);
    EXPECT_EQ(monitor(b, 1), 3000);  // always Hz over the option
    return monitor(b, 6);
  };
  EXPECT_EQ(speed({}), 900);
  EXPECT_EQ(speed({{"Pr.144", 0}}), 900);
  EXPECT_EQ(speed({{"Pr.144", 6}}), 600);
  EXPECT_EQ(speed({{"Pr.144", 108}}), 450);
  EXPECT_EQ(speed({{"Pr.37", 500}}), 250);
  EXPECT_EQ(speed({{"Pr.37", 500}, {"Pr.505", 50}}), 300);
  EXPECT_EQ(speed({{"Pr.37", 500}, {"Pr.144", 104}}), 900);
}

TEST(A700Monitors, TerminalStatesAreBitFields) {
  const char* order[] = {"STF", "STR", "AU", "RT", "RL", "RM", "RH", "JOG", "MRS", "STOP", "RES", "CS"};
  for (unsigned i = 0; i < std::size(order); ++i) {
    if (std::string_view(order[i]) == "RES") continue;
    Bench b = a700_with();
    b.terminal(order[i]);
    b.run(0.01);
    EXPECT_EQ(monitor(b, 15), 1u << i) << order[i];
  }
  const char* outputs[] = {"RUN", "SU", "IPF", "OL", "FU", "ABC1", "ABC2"};
  for (unsigned i = 0; i < std::size(outputs); ++i) {
    Bench b = a700_with({{"Pr.190", 9999},
                         {"Pr.191", 9999},
                         {"Pr.193", 9999},
                         {"Pr.194", 9999},
                         {"Pr.192", 9999},
                         {"Pr.195", 9999},
                         {"Pr." + std::to_string(190 + i), 11}});  // RY
    b.run(0.01);
    EXPECT_EQ(monitor(b, 16), 1u << i) << outputs[i];
  }
}

// A text of the EEPROM with another counter, checksum included.
std::string with_counter(Bench& b, const std::string& name, long long value) {
  std::string text = b->eeprom_text();
  const std::size_t at = text.find(name + " = ");
  EXPECT_NE(at, std::string::npos);
  const std::size_t from = at + name.size() + 3;
  text.replace(from, text.find('\n', from) - from, std::to_string(value));
  text.erase(text.find("checksum = "));
  char sum[32];
  std::snprintf(sum, sizeof sum, "checksum = %08x\n", crc32(text));
  return text + sum;
}

TEST(A700Monitors, HoursAndKilowattHoursAreCountedOverPowerCycles) {
  Bench b(config_a700(), "fr-a700");
  ASSERT_TRUE(b->load_eeprom(with_counter(b, "energized_seconds", 70000LL * 3600)).has_value());
  b.power_on();
  EXPECT_EQ(monitor(b, 20), 70000 - 65536);
  EXPECT_EQ(b.raw(563), 1u);
  Bench c(config_a700(), "fr-a700");
  ASSERT_TRUE(c->load_eeprom(with_counter(c, "operating_seconds", 65540LL * 3600)).has_value());
  c.power_on();
  EXPECT_EQ(monitor(c, 23), 4);
  EXPECT_EQ(c.raw(564), 1u);
  c.pu();
  ASSERT_TRUE(c->set_parameter("Pr.171", 0).has_value());
  EXPECT_EQ(monitor(c, 23), 0);

  for (const auto& [shift, shown] : {std::pair{9999.0, 123456 - 65536}, {0.0, 65535}, {1.0, 12345}, {3.0, 123}}) {
    Bench d(config_a700(), "fr-a700");
    ASSERT_TRUE(d->load_eeprom(with_counter(d, "energy_joule", 123456LL * 3600000)).has_value());
    d.preset("Pr.891", shift);
    d.power_on();
    EXPECT_EQ(monitor(d, 25), shown) << shift;
    d.preset("Pr.170", 10);
    EXPECT_EQ(monitor(d, 25), std::min(9999.0, std::floor(123456 / std::pow(10, shift == 9999 ? 0 : shift))));
    EXPECT_EQ(d.raw(170), 10u);
    d.preset("Pr.170", 9999);
    EXPECT_EQ(d.raw(170), 65535u);
    d.pu();
    ASSERT_TRUE(d->set_parameter("Pr.170", 0).has_value());
    EXPECT_EQ(monitor(d, 25), 0);
  }
  // What a run uses is kept over a power cycle.
  Bench e = a700_running(40, {}, loaded(0, 6, config_a700()));
  e.run(20);
  e.power_cycle();
  const std::string text = e->eeprom_text();
  const double joule = std::stod(text.substr(text.find("energy_joule = ") + 15));
  EXPECT_GT(joule, 10000);
  EXPECT_LT(joule, 40000);
}

TEST(A700Monitors, Pr503CountsHundredsOfHoursUpToPr504) {
  Bench b(config_a700(), "fr-a700");
  ASSERT_TRUE(b->load_eeprom(with_counter(b, "maintenance_seconds", 1234LL * 3600)).has_value());
  b.preset("Pr.504", 12);
  b.preset("Pr.192", 95);
  b.power_on();
  b.run(0.01);
  EXPECT_EQ(b.raw(503), 12u);
  EXPECT_TRUE(b.output("IPF"));  // Y95
  b.pu();
  EXPECT_FALSE(b->set_parameter("Pr.503", 1).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.503", 0).has_value());
  b.run(0.01);
  EXPECT_EQ(b.raw(503), 0u);
  EXPECT_FALSE(b.output("IPF"));
}

TEST(A700Monitors, Pr52ChoosesTheFirstDisplay) {
  Bench b = a700_running(30, {{"Pr.52", 100}});
  EXPECT_EQ(b->display(), "30.00");
  b.preset("Pr.52", 23);
  EXPECT_EQ(b->display(), "0");
  b.preset("Pr.52", 8);
  EXPECT_NEAR(std::stod(b->display()), b.signal("dc_link"), 5);
}

}  // namespace
}  // namespace vinv::inverter::test
