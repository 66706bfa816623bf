// Alarms of the FR-A700: every row by injection with code, history, display, reset and retry; those with a cause in
// mains, terminals and settings by their cause. FR-A7NE manual 7.6; the rest typical for the family.
#include "a700_bench.hpp"
#include "motor_model/inverter/a700/tables.hpp"

namespace vinv::inverter::test {
namespace {

TEST(A700Alarm, EveryRowShutsTheOutputOffIsShownAndReset) {
  for (const AlarmRow& row : a700::family_data().alarms.rows()) {
    SCOPED_TRACE(row.name);
    Bench b = a700_with({{"Pr.4", 20}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(0.1);
    ASSERT_TRUE(b.port().status().running);
    ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
    b.tick();
    EXPECT_FALSE(b.port().status().running);
    EXPECT_TRUE(b.port().status().alarm);
    EXPECT_EQ(b.port().active_alarm(), row.code);
    EXPECT_EQ(b.port().alarm_history()[0], row.code);
    EXPECT_EQ(b->display(), row.display);
    EXPECT_TRUE(b.output("ABC1"));
    b.terminal("STF", false);
    b.terminal("RES");
    b.run(0.05);
    b.terminal("RES", false);
    b.run(1.1);
    EXPECT_EQ(b->alarm_name(), row.reset == ResetRule::kAny ? "" : row.name);
  }
}

TEST(A700Alarm, Pr65SaysWhichAlarmsAreRetried) {
  for (const AlarmRow& row : a700::family_data().alarms.rows()) {
    for (int selection = 0; selection <= 5; ++selection) {
      Bench b = a700_with({{"Pr.65", static_cast<double>(selection)}, {"Pr.67", 1}, {"Pr.68", 0.1}});
      ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
      b.run(0.2);
      EXPECT_EQ(b->alarm_name().empty(), row.retried_with(selection)) << row.name << " " << selection;
    }
  }
}

TEST(A700Alarm, Pr67CountsRetriesAndErPlusOneHundredShowsThem) {
  for (int pr67 : {1, 101}) {
    Bench b = a700_with({{"Pr.67", static_cast<double>(pr67)}, {"Pr.68", 0.5}, {"Pr.192", 64}});
    ASSERT_TRUE(b->inject_fault("E.OC1", true).has_value());
    b.run(0.1);
    EXPECT_EQ(b.output("ABC1"), pr67 == 101);
    EXPECT_TRUE(b.output("IPF"));  // Y64
    b.run(0.6);
    EXPECT_EQ(b->alarm_name(), "");
    ASSERT_TRUE(b->inject_fault("E.OC1", true).has_value());
    b.run(0.1);
    EXPECT_EQ(b->alarm_name(), "E.RET");
  }
  Bench counted = a700_with({{"Pr.67", 1}, {"Pr.68", 0.1}});
  ASSERT_TRUE(counted->inject_fault("E.OC1", true).has_value());
  counted.run(1);
  EXPECT_EQ(counted.raw(69), 1u);
  counted.pu();
  ASSERT_TRUE(counted->set_parameter("Pr.69", 0).has_value());
  EXPECT_EQ(counted.raw(69), 0u);
}

TEST(A700Alarm, AMainsFailureWhileRunningIsIpfAndALowSupplyUvtUnlessPr57Restarts) {
  const auto after = [](double volt, const Settings& settings) {
    Bench b = a700_running(40, settings);
    b->set_load(loaded(0, 5).load);
    b->set_mains({.voltage_v_rms = volt});
    b.run_until([&] { return !b->alarm_name().empty() || !b.port().status().running; }, 5);
    b.run(0.03);
    return b->alarm_name();
  };
  EXPECT_EQ(after(0, {}), "E.IPF");
  EXPECT_EQ(after(210, {}), "E.UVT");
  EXPECT_EQ(after(0, {{"Pr.57", 0}, {"Pr.186", 9999}}), "");
  EXPECT_EQ(after(0, {{"Pr.57", 0}}), "E.IPF");  // CS is assigned and off
}

TEST(A700Alarm, AMissingInputPhaseTripsOnlyWithPr872Is1) {
  for (int pr872 : {0, 1}) {
    Bench b = a700_running(20, {{"Pr.872", static_cast<double>(pr872)}});
    b->set_mains({.voltage_v_rms = 400, .phase_present = {true, true, false}});
    b.run(1.5);
    EXPECT_EQ(b.alarm("E.ILF"), pr872 == 1);
  }
}

TEST(A700Alarm, ThirtyMilliampereAtACurrentInputIsAie) {
  Bench b = a700_with();
  ASSERT_TRUE(b->set_analog("4", 30).has_value());
  b.run(0.01);
  EXPECT_TRUE(b.alarm("E.AIE"));
  Bench c = a700_with({{"Pr.73", 6}});
  ASSERT_TRUE(c->set_analog("2", 31).has_value());
  c.run(0.01);
  EXPECT_TRUE(c.alarm("E.AIE"));
  EXPECT_FALSE(c->set_analog("2", 41).has_value());
  EXPECT_FALSE(c->set_analog("1", -11).has_value());
}

TEST(A700Alarm, AHotThermistorTripsAfterTenSecondsAtATerminalWithPtc) {
  Bench b = a700_with({{"Pr.184", 63}});
  ASSERT_TRUE(b->inject_fault("thermistor", true).has_value());
  b.run(9.9);
  EXPECT_EQ(b->alarm_name(), "");
  b.run(0.2);
  EXPECT_TRUE(b.alarm("E.PTC"));
  Bench c = a700_with();
  ASSERT_TRUE(c->inject_fault("thermistor", true).has_value());
  c.run(11);
  EXPECT_EQ(c->alarm_name(), "");
}

TEST(A700Alarm, Pr167Is1MakesTheCurrentDetectionOfPr150AnAlarm) {
  for (int pr167 : {0, 1}) {
    Bench b = a700_with({{"Pr.150", 10}, {"Pr.167", static_cast<double>(pr167)}, {"Pr.192", 12}, {"Pr.4", 30}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(1.5);
    EXPECT_EQ(b.alarm("E.CDO"), pr167 == 1);
    if (pr167 == 0) {
      EXPECT_TRUE(b.output("IPF"));  // Y12
    }
  }
}

TEST(A700Alarm, ShortRampsAndBlockedShaftsTripAsOnEveryFamily) {
  // A heavy load stopped at once: over-voltage, without a brake resistor.
  Bench b = a700_running(50, {{"Pr.7", 5}}, loaded(0.2, 0, config_a700()));
  ASSERT_TRUE(b.command({}).has_value());
  ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 3));
  EXPECT_EQ(b->alarm_name(), "E.OV3");
  // A blocked shaft: stall prevention pulls the frequency down and gives up.
  Bench c = a700_with({{"Pr.340", 1}});
  c.preset("Pr.7", 1);
  c->set_shaft_locked(true);
  ASSERT_TRUE(c.frequency(50).has_value());
  ASSERT_TRUE(c.command({NetTerminal::kStf}).has_value());
  ASSERT_TRUE(c.run_until([&] { return !c->alarm_name().empty(); }, 90));
  EXPECT_THAT(c->alarm_name(), testing::AnyOf("E.OLT", "E.THT"));
}

TEST(A700Alarm, CausesAreInjectedByName) {
  for (const auto& [cause, alarm, pr] :
       {std::tuple{"earth_fault", "E.GF", "Pr.251"}, {"output_phase_open", "E.LF", "Pr.251"}}) {
    Bench b = a700_with({{"Pr.4", 30}, {pr, 1}});
    ASSERT_TRUE(b->inject_fault(cause, true).has_value());
    b.terminal("STF");
    b.terminal("RH");
    b.run(2);
    EXPECT_EQ(b->alarm_name(), alarm);
  }
  Bench oh = a700_with({{"Pr.183", 7}});
  oh.run(0.01);
  EXPECT_TRUE(oh.alarm("E.OHT"));  // the contact must be closed
  Bench pu = a700_with({{"Pr.75", 16}});
  ASSERT_TRUE(pu->inject_fault("pu_disconnected", true).has_value());
  pu.run(0.01);
  EXPECT_TRUE(pu.alarm("E.PUE"));
  Bench pe = a700_with({{"Pr.340", 1}});
  ASSERT_TRUE(pe->inject_fault("eeprom_write", true).has_value());
  ASSERT_TRUE(pe.write_parameter(4, 3000).has_value());
  EXPECT_TRUE(pe.alarm("E.PE"));
}

}  // namespace
}  // namespace vinv::inverter::test
