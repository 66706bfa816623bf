// Life of parts, password, alarm code, alarms after a stop, warnings and small settings of the FR-A700. Typical for the
// family; password: FR-A700 manual 4.22.5.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/alarm_code.hpp"
#include "motor_model/inverter/a700/inverter.hpp"
#include "motor_model/inverter/a700/part_life.hpp"
#include "motor_model/inverter/a700/tables.hpp"

namespace vinv::inverter::test {
namespace {

a700::Du07 panel(Bench& b) { return dynamic_cast<a700::A700Inverter&>(*b).du07(); }

TEST(A700PartLife, CapacitorsLiveHalfAsLongTenDegreesHotter) {
  EXPECT_DOUBLE_EQ(a700::ageing_rate(40), 1);
  EXPECT_DOUBLE_EQ(a700::ageing_rate(50), 2);
  EXPECT_DOUBLE_EQ(a700::ageing_rate(20), 0.25);
  const double life_s = 87600.0 * 3600;
  EXPECT_EQ(a700::control_capacitor_percent(0), 100);
  EXPECT_EQ(a700::control_capacitor_percent(life_s), 10);
  EXPECT_EQ(a700::control_capacitor_percent(2 * life_s), 0);
  EXPECT_EQ(a700::main_capacitor_percent(life_s), 85);
  EXPECT_EQ(a700::inrush_circuit_percent(9999), 100);
  EXPECT_EQ(a700::inrush_circuit_percent(900000), 10);
  EXPECT_EQ(a700::inrush_circuit_percent(2000000), 0);
}

TEST(A700PartLife, Pr255ToPr257TellWornPartsAndY90) {
  Bench b = a700_with({{"Pr.192", 90}});
  EXPECT_EQ(b.raw(255), 0u);
  EXPECT_FALSE(b.output("IPF"));
  ASSERT_TRUE(b->inject_fault("inrush_circuit", true).has_value());
  b.tick();
  EXPECT_EQ(b.raw(255), 8u);
  EXPECT_EQ(b.raw(256), static_cast<unsigned>(a700::kWornPart_percent));
  EXPECT_TRUE(b.output("IPF"));
  ASSERT_TRUE(b->inject_fault("control_capacitor", true).has_value());
  EXPECT_EQ(b.raw(255), 9u);
  EXPECT_EQ(b.raw(257), static_cast<unsigned>(a700::kWornPart_percent));
  ASSERT_TRUE(b->inject_fault("fan", true).has_value());
  EXPECT_EQ(b.raw(255), 13u);
}

TEST(A700PartLife, CountersOfTheEepromAgeTheParts) {
  Bench b = a700_with();
  std::string text = b->eeprom_text();
  EXPECT_THAT(text, testing::HasSubstr("inrush_operations = 1\n"));
  b.power_cycle();
  EXPECT_THAT(b->eeprom_text(), testing::HasSubstr("inrush_operations = 2\n"));
  b.run(5);
  EXPECT_THAT(b->eeprom_text(), testing::Not(testing::HasSubstr("capacitor_ageing_seconds = 0\n")));
}

TEST(A700PartLife, Pr259MeasuresTheMainCapacitorAtPowerOff) {
  Bench b = a700_with();
  ASSERT_TRUE(b->preset_parameter("Pr.259", 1).has_value());
  EXPECT_EQ(b.raw(259), 1u);
  ASSERT_TRUE(b->inject_fault("main_capacitor", true).has_value());
  EXPECT_EQ(b.raw(258), 100u);
  b.power_cycle();
  EXPECT_EQ(b.raw(259), 3u);
  EXPECT_EQ(b.raw(258), 80u);
  EXPECT_EQ(b.raw(255), 2u);
  // With a start signal there is no measurement.
  ASSERT_TRUE(b->preset_parameter("Pr.259", 1).has_value());
  b.terminal("STF");
  b.run(0.5);
  b.power_cycle();
  EXPECT_EQ(b.raw(259), 8u);
}

TEST(A700Password, Pr296AndPr297LockReadingAndWriting) {
  struct Case {
    unsigned level;
    bool panel_read, panel_write, network_read, network_write;
  };
  for (const Case& c : {Case{1, true, false, true, false},
                        {2, true, false, true, true},
                        {3, true, true, true, false},
                        {4, false, false, true, false},
                        {5, false, false, true, true},
                        {6, true, true, true, false}}) {
    SCOPED_TRACE(c.level);
    Bench b = a700_with({{"Pr.340", 1}, {"Pr.77", 2}});
    ASSERT_TRUE(b.write_parameter(296, c.level).has_value());
    ASSERT_TRUE(b.write_parameter(297, 1234).has_value());
    EXPECT_EQ(b.port().read_parameter({4, 0}).has_value(), c.network_read);
    EXPECT_EQ(b.write_parameter(4, 2000).has_value(), c.network_write);
    EXPECT_EQ(b->get_parameter("Pr.4").has_value(), c.panel_read);
    EXPECT_EQ(b->set_parameter("Pr.4", 20).has_value(), c.panel_write);
    EXPECT_FALSE(b.write_parameter(296, 9999 == 0 ? 1 : 65535).has_value());
    // It holds over a power cycle; a wrong word does not open it, the right one does.
    b.power_cycle();
    EXPECT_EQ(b.write_parameter(4, 2500).has_value(), c.network_write);
    ASSERT_TRUE(b.write_parameter(297, 4321).has_value());
    EXPECT_EQ(b.write_parameter(4, 2600).has_value(), c.network_write);
    ASSERT_TRUE(b.write_parameter(297, 1234).has_value());
    EXPECT_TRUE(b.write_parameter(4, 2700).has_value());
    EXPECT_EQ(b.raw(297), 65535u);
  }
}

TEST(A700Password, FiveErrorsLockItUntilAllClear) {
  Bench b = a700_with({{"Pr.340", 1}});
  ASSERT_TRUE(b.write_parameter(296, 101).has_value());
  ASSERT_TRUE(b.write_parameter(297, 1234).has_value());
  for (unsigned i = 1; i <= 6; ++i) {
    ASSERT_TRUE(b.write_parameter(297, 2000 + i).has_value());
    EXPECT_EQ(b.raw(297), std::min(i, 5u));
  }
  ASSERT_TRUE(b.write_parameter(297, 1234).has_value());
  EXPECT_FALSE(b.write_parameter(4, 2000).has_value());
  ASSERT_TRUE(b.write({.kind = port::WriteRequest::Kind::kRestoreDefaults, .value = 3}).has_value());
  EXPECT_TRUE(b.write_parameter(4, 2000).has_value());
  EXPECT_EQ(b.raw(297), 65535u);
}

TEST(A700Password, Level99LeavesTheUserGroupAndLevel0TheOptionNothing) {
  Bench b = a700_with({{"Pr.173", 4}, {"Pr.340", 1}});
  ASSERT_TRUE(b.write_parameter(296, 99).has_value());
  ASSERT_TRUE(b.write_parameter(297, 1234).has_value());
  EXPECT_TRUE(b.write_parameter(4, 2000).has_value());
  EXPECT_FALSE(b.write_parameter(5, 2000).has_value());
  Bench none = a700_with({{"Pr.340", 1}});
  ASSERT_TRUE(none.write_parameter(296, 0).has_value());
  ASSERT_TRUE(none.write_parameter(297, 1234).has_value());
  none.run(0.01);
  EXPECT_EQ(none->alarm_name(), "E.OPT");
}

TEST(A700AlarmCode, Pr76PutsTheCodeOnFourTerminals) {
  const std::array terminals{"SU", "IPF", "OL", "FU"};
  for (const auto& [name, code] : {std::pair{"E.OC1", 1u},
                                   {"E.OC2", 2u},
                                   {"E.OC3", 3u},
                                   {"E.OV2", 4u},
                                   {"E.THM", 5u},
                                   {"E.THT", 6u},
                                   {"E.IPF", 7u},
                                   {"E.UVT", 8u},
                                   {"E.FIN", 9u},
                                   {"E.BE", 10u},
                                   {"E.GF", 11u},
                                   {"E.OHT", 12u},
                                   {"E.OLT", 13u},
                                   {"E.OP3", 14u},
                                   {"E.CPU", 15u}}) {
    for (const double pr76 : {0.0, 1.0, 2.0}) {
      Bench b = a700_with({{"Pr.76", pr76}, {"Pr.191", 11}});
      b.run(0.01);
      EXPECT_EQ(b.output("SU"), pr76 != 1);  // RY, where no code goes out
      ASSERT_TRUE(b->inject_fault(name, true).has_value());
      b.tick();
      unsigned shown = 0;
      for (const char* terminal : terminals) shown = shown << 1 | (b.output(terminal) ? 1u : 0u);
      EXPECT_EQ(shown, pr76 == 0 ? 0 : code) << name;
    }
  }
  EXPECT_EQ(a700::alarm_code(0), 0u);
}

TEST(A700FaultDefinition, Pr875Is1DeceleratesBeforeTheMotorsAlarms) {
  for (const double pr875 : {0.0, 1.0}) {
    const auto seen = [&](Settings more, const char* alarm, const std::function<void(Bench&)>& cause) {
      more.emplace_back("Pr.875", pr875);
      more.emplace_back("Pr.8", 2);
      Bench b = a700_running(40, more, loaded(0.005, 6, config_a700()));
      cause(b);
      ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty() || b.port().status().stopping; }, 60)) << alarm;
      EXPECT_EQ(b->alarm_name().empty(), pr875 == 1) << alarm;
      ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 5));
      EXPECT_EQ(b->alarm_name(), alarm);
      EXPECT_FALSE(b.port().status().running);
      EXPECT_EQ(b.port().alarm_history()[0], b.port().active_alarm());
    };
    seen({{"Pr.9", 0.6}}, "E.THM", [](Bench&) {});
    seen({{"Pr.184", 63}}, "E.PTC", [](Bench& b) { ASSERT_TRUE(b->inject_fault("thermistor", true).has_value()); });
  }
  Bench b = a700_with({{"Pr.183", 7}, {"Pr.875", 1}, {"Pr.8", 2}, {"Pr.340", 1}});
  EXPECT_TRUE(b.alarm("E.OHT"));  // at standstill at once
}

TEST(A700Warning, ThePanelTellsWhatDoesNotTrip) {
  Bench b = a700_running(30);
  EXPECT_EQ(panel(b).warning, "");
  ASSERT_TRUE(b->inject_fault("fan", true).has_value());
  b.tick();
  EXPECT_EQ(panel(b).warning, "FN");
  Bench ol = a700_with({{"Pr.22", 60}, {"Pr.340", 1}}, loaded(0.01, 9, config_a700()));
  ASSERT_TRUE(ol.frequency(30).has_value());
  ASSERT_TRUE(ol.command({NetTerminal::kStf}).has_value());
  ol.run(1);
  EXPECT_EQ(panel(ol).warning, "OL");
  Bench sl = a700_with(
      {{"Pr.80", 1.5}, {"Pr.81", 4}, {"Pr.84", 50}, {"Pr.800", 11}, {"Pr.804", 1}, {"Pr.806", 1060}, {"Pr.340", 1}});
  ASSERT_TRUE(sl.frequency(20).has_value());
  ASSERT_TRUE(sl.command({NetTerminal::kStf}).has_value());
  sl.run(3);
  EXPECT_EQ(panel(sl).warning, "SL");
  Bench mt = a700_with({{"Pr.504", 0}});
  mt.tick();
  EXPECT_EQ(panel(mt).warning, "MT");
}

TEST(A700Setting, Pr268TakesDecimalsFromThePanel) {
  const auto shown = [](double pr268) { return a700_running(30, {{"Pr.268", pr268}})->display(); };
  EXPECT_EQ(shown(9999), "30.00");
  EXPECT_EQ(shown(1), "30.0");
  EXPECT_EQ(shown(0), "30");
}

TEST(A700Setting, Pr849MovesTerminalTwo) {
  const auto hz = [](double pr849, double volt) {
    Bench b = a700_with({{"Pr.849", pr849}});
    b.terminal("STF");
    EXPECT_TRUE(b->set_analog("2", volt).has_value());
    b.run(2);
    return b.output_hz();
  };
  EXPECT_NEAR(hz(100, 2.5), 30, 0.05);
  EXPECT_NEAR(hz(110, 2.5), 36, 0.05);
  EXPECT_NEAR(hz(90, 2.5), 24, 0.05);
  EXPECT_EQ(hz(90, 0.3), 0);
}

TEST(A700Setting, Pr867FiltersTerminalAm) {
  const auto after = [](double pr867) {
    Bench b = a700_with({{"Pr.867", pr867}, {"Pr.158", 21}});
    b.run(0.2);
    return b.signal("am");
  };
  EXPECT_NEAR(after(0), 10, 0.01);
  EXPECT_LT(after(5), 2);
}

TEST(A700Setting, Pr888AndPr889KeepAUsersNumbers) {
  Bench b = a700_with({{"Pr.340", 1}});
  ASSERT_TRUE(b.write_parameter(888, 1234).has_value());
  ASSERT_TRUE(b.write_parameter(889, 4321).has_value());
  b.power_cycle();
  EXPECT_EQ(b.raw(888), 1234u);
  EXPECT_EQ(b.raw(889), 4321u);
}

}  // namespace
}  // namespace vinv::inverter::test
