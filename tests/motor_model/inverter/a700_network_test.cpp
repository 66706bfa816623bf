// The FR-A700 through its option port: command rights, communication errors, resets, storage. FR-A7NE manual 4.3
// to 4.6.
#include "a700_bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::OperationMode;
using port::Refusal;
using port::WriteRequest;
using Kind = WriteRequest::Kind;

constexpr double kStateDecelerating = 3;

port::WriteOutcome mode(Bench& b, std::uint32_t value) {
  return b.write({.kind = Kind::kOperationMode, .value = value});
}
void lose(Bench& b, bool lost = true) { b.port().set_communication_lost(lost); }

TEST(A700Network, WritesOfTheModeFollowTheMatrix) {
  Bench b = a700_with();
  EXPECT_EQ(mode(b, 2).error(), Refusal::kModeChangeRefused);  // PU only with Pr.79 = 6
  EXPECT_EQ(mode(b, 3).error(), Refusal::kOutOfRange);
  ASSERT_TRUE(mode(b, 1).has_value());
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
  ASSERT_TRUE(mode(b, 0).has_value());
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  Bench six = a700_with({{"Pr.79", 6}});
  ASSERT_TRUE(mode(six, 2).has_value());
  EXPECT_EQ(six.port().operation_mode(), OperationMode::kPu);
}

TEST(A700Network, Pr79Is6TakesTheRunningMotorAlong) {
  Bench b = a700_with({{"Pr.79", 6}, {"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(2);
  ASSERT_TRUE(mode(b, 1).has_value());
  b.run(0.5);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_NEAR(b.output_hz(), 30, 0.1);
}

TEST(A700Network, Pr550Is1TakesTheOptionsRightsAway) {
  Bench b = a700_with({{"Pr.550", 1}, {"Pr.340", 1}});
  EXPECT_EQ(b.command({NetTerminal::kStf}).error(), Refusal::kWrongMode);
  EXPECT_EQ(b.frequency(30).error(), Refusal::kWrongMode);
  EXPECT_EQ(mode(b, 0).error(), Refusal::kWrongMode);
  EXPECT_TRUE(b.port().read_monitor(1).has_value());
  EXPECT_TRUE(b.port().read_parameter({7, 0}).has_value());
  for (int owner : {0, 9999}) {
    Bench mine = a700_with({{"Pr.550", static_cast<double>(owner)}, {"Pr.340", 1}});
    EXPECT_TRUE(mine.command({NetTerminal::kStf}).has_value()) << owner;
  }
}

TEST(A700Network, Pr338AndPr339ChooseWhoStartsAndWhoSetsTheSpeed) {
  // 0,0: all by the network.
  Bench net = a700_running(30);
  EXPECT_NEAR(net.output_hz(), 30, 0.1);
  // 1: the terminals start; a start bit is refused.
  Bench starts = a700_with({{"Pr.340", 1}, {"Pr.338", 1}});
  EXPECT_EQ(starts.command({NetTerminal::kStf}).error(), Refusal::kWrongMode);
  ASSERT_TRUE(starts.frequency(25).has_value());
  starts.terminal("STF");
  starts.run(2);
  EXPECT_NEAR(starts.output_hz(), 25, 0.1);
  // 339 = 1: the terminals set the speed, the network's frequency is refused.
  Bench speed = a700_with({{"Pr.340", 1}, {"Pr.339", 1}});
  EXPECT_EQ(speed.frequency(25).error(), Refusal::kWrongMode);
  ASSERT_TRUE(speed.command({NetTerminal::kStf}).has_value());
  ASSERT_TRUE(speed->set_analog("2", 2.5).has_value());
  speed.run(2);
  EXPECT_NEAR(speed.output_hz(), 30, 0.1);
  // 339 = 2: the network's frequency, but the terminals' speeds go before it; terminal 2 does not count.
  Bench both = a700_with({{"Pr.340", 1}, {"Pr.339", 2}, {"Pr.4", 40}});
  ASSERT_TRUE(both.frequency(20).has_value());
  ASSERT_TRUE(both->set_analog("2", 5).has_value());
  ASSERT_TRUE(both.command({NetTerminal::kStf}).has_value());
  both.run(2);
  EXPECT_NEAR(both.output_hz(), 20, 0.1);
  both.terminal("RH");
  both.run(2);
  EXPECT_NEAR(both.output_hz(), 40, 0.1);
}

TEST(A700Network, X67OffGivesEverythingToTheTerminals) {
  Bench b = a700_with({{"Pr.340", 1}, {"Pr.183", 67}, {"Pr.4", 40}});
  ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
  ASSERT_TRUE(b->set_terminal("RH", true).has_value());
  b.run(1);
  EXPECT_FALSE(b.port().status().running);
  b.terminal("STF");
  b.run(2);
  EXPECT_NEAR(b.output_hz(), 40, 0.1);
}

TEST(A700Network, TheBitsFollowTheTerminalAssignmentAndOneOutputStopDoesNot) {
  Bench b = a700_running(30, {{"Pr.187", 9999}});
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kMrs}).has_value());  // MRS has no function
  b.run(0.1);
  EXPECT_TRUE(b.port().status().running);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kOutputStop}).has_value());
  b.run(0.1);
  EXPECT_FALSE(b.port().status().running);
}

TEST(A700Network, Pr17Is2TurnsTheNetworksMrsTooAnd4DoesNot) {
  for (int pr17 : {2, 4}) {
    Bench b = a700_with({{"Pr.340", 1}, {"Pr.17", static_cast<double>(pr17)}});
    b.terminal("MRS");  // normally closed contact, closed
    ASSERT_TRUE(b.frequency(30).has_value());
    ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
    b.run(1);
    EXPECT_EQ(b.port().status().running, pr17 == 4) << pr17;
    ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kMrs}).has_value());
    b.run(1);
    EXPECT_EQ(b.port().status().running, pr17 == 2) << pr17;
  }
}

// --- communication errors: manual 4.5.1 ---

TEST(A700LineError, Pr502Is0CoastsWithEop3AndHistory) {
  Bench b = a700_running(30, {{"Pr.500", 0.5}});
  lose(b);
  b.run(0.4);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_EQ(b.raw(501), 1u);
  b.run(0.2);
  EXPECT_TRUE(b.alarm("E.OP3"));
  EXPECT_EQ(b->display(), "E.OP3");
  EXPECT_EQ(b.signal("output_voltage"), 0);
  EXPECT_EQ(b.port().alarm_history()[0], 0xA3);
  EXPECT_TRUE(b.output("ABC1"));
  lose(b, false);
  b.run(1);
  EXPECT_TRUE(b.alarm("E.OP3"));
}

TEST(A700LineError, BackWithinPr500IsCountedOnly) {
  Bench b = a700_running(30, {{"Pr.500", 0.5}});
  lose(b);
  b.run(0.4);
  lose(b, false);
  b.run(2);
  EXPECT_EQ(b->alarm_name(), "");
  EXPECT_NEAR(b.output_hz(), 30, 0.1);
  EXPECT_EQ(b.raw(501), 1u);
}

TEST(A700LineError, Pr502Is1DeceleratesAndTripsAtStandstill) {
  Bench b = a700_running(30, {{"Pr.502", 1}, {"Pr.8", 2}});
  lose(b);
  b.run(0.3);
  EXPECT_EQ(b.signal("run_state"), kStateDecelerating);
  EXPECT_TRUE(b.port().status().fault_stop);
  EXPECT_EQ(b->alarm_name(), "");
  EXPECT_NE(b->display(), "E.OP3");
  EXPECT_FALSE(b.output("ABC1"));
  EXPECT_EQ(b.port().alarm_history()[0], 0);
  ASSERT_TRUE(b.run_until([&] { return b.alarm("E.OP3"); }, 5));
  EXPECT_FALSE(b.port().status().running);
  b.tick();
  EXPECT_TRUE(b.output("ABC1"));
  EXPECT_EQ(b.port().alarm_history()[0], 0xA3);
}

TEST(A700LineError, Pr502Is2StopsShowsEop3WithoutAlarmAndRestarts) {
  Bench b = a700_running(30, {{"Pr.502", 2}});
  lose(b);
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 5));
  b.run(0.5);
  EXPECT_EQ(b->alarm_name(), "");
  EXPECT_EQ(b->display(), "E.OP3");
  EXPECT_FALSE(b.output("ABC1"));
  EXPECT_EQ(b.port().alarm_history()[0], 0xA3);  // overlaid while it lasts
  lose(b, false);
  b.run(3);
  EXPECT_NEAR(b.output_hz(), 30, 0.1);  // the command given before the error
  EXPECT_EQ(b->display(), "30.00");
  EXPECT_EQ(b.port().alarm_history()[0], 0);  // not stored
}

TEST(A700LineError, Pr502Is2GoesOnFromTheFrequencyWhereTheLineCameBack) {
  Bench b = a700_running(40, {{"Pr.502", 2}, {"Pr.7", 2}, {"Pr.8", 2}});
  lose(b);
  ASSERT_TRUE(b.run_until([&] { return b.output_hz() < 20; }, 5));
  lose(b, false);
  double lowest = 40;
  for (int i = 0; i < 2000; ++i) {
    b.tick();
    lowest = std::min(lowest, b.output_hz());
  }
  EXPECT_GT(lowest, 19.5);
  EXPECT_NEAR(b.output_hz(), 40, 0.1);
}

TEST(A700LineError, Pr502Is3GoesOn) {
  Bench b = a700_running(30, {{"Pr.502", 3}});
  lose(b);
  b.run(3);
  EXPECT_NEAR(b.output_hz(), 30, 0.1);
  EXPECT_EQ(b->display(), "30.00");
  EXPECT_EQ(b.raw(501), 1u);
}

TEST(A700LineError, OutsideNetworkOperationTheDriveGoesOn) {
  for (int pr502 : {0, 1, 2, 3}) {
    Bench b = a700_with({{"Pr.4", 30}, {"Pr.502", static_cast<double>(pr502)}});
    b.terminal("STF");
    b.terminal("RH");
    b.run(2);
    lose(b);
    b.run(2);
    EXPECT_NEAR(b.output_hz(), 30, 0.1) << pr502;
    EXPECT_EQ(b->alarm_name(), "");
    EXPECT_EQ(b.raw(501), 1u);
  }
}

TEST(A700OptionError, AFaultOfTheOptionActsInNetworkOperationByPr502) {
  for (int pr502 : {0, 1, 2, 3}) {
    Bench b = a700_running(30, {{"Pr.502", static_cast<double>(pr502)}});
    b.port().set_option_failed(true);
    b.run(0.1);
    const bool coasts = pr502 == 0 || pr502 == 3;
    EXPECT_EQ(b.alarm("E.3"), coasts) << pr502;
    EXPECT_EQ(b.port().status().fault_stop, !coasts) << pr502;
    ASSERT_TRUE(b.run_until([&] { return b.alarm("E.3"); }, 5)) << pr502;
    EXPECT_EQ(b->display(), "E.  3");
    EXPECT_EQ(b.port().alarm_history()[0], 0xF3);
    b.port().set_option_failed(false);
    b.run(1);
    EXPECT_TRUE(b.alarm("E.3")) << pr502;
  }
  Bench ext = a700_with({{"Pr.4", 30}});
  ext.terminal("STF");
  ext.terminal("RH");
  ext.run(2);
  ext.port().set_option_failed(true);
  ext.run(1);
  EXPECT_TRUE(ext.port().status().running);
}

// Manual 4.5.2: a connection error trips in every mode.
TEST(A700OptionError, ABadContactActsInEveryMode) {
  Bench b = a700_with({{"Pr.4", 30}});
  b.terminal("STF");
  b.terminal("RH");
  b.run(2);
  ASSERT_TRUE(b->inject_fault("option", true).has_value());
  b.run(0.1);
  EXPECT_TRUE(b.alarm("E.3"));
}

TEST(A700OptionError, TheWrongConnectorIsE1OrE2) {
  for (int connector : {1, 2}) {
    InverterConfig config = config_a700();
    config.option_connector = connector;
    Bench b = a700_with({}, config);
    b.run(0.01);
    EXPECT_TRUE(b.alarm(connector == 1 ? "E.1" : "E.2"));
    EXPECT_EQ(b.command({NetTerminal::kStf}).error(), Refusal::kWrongMode);
  }
  InverterConfig none = config_a700();
  none.option_connector = 4;
  EXPECT_FALSE(make_inverter("fr-a700", none).has_value());
}

TEST(A700LineError, Pr501IsClearedByZeroAndStoredOnceAnHour) {
  Bench b = a700_with();
  lose(b);
  b.run(0.01);
  lose(b, false);
  b.run(0.01);
  lose(b);
  b.run(0.01);
  EXPECT_EQ(b.raw(501), 2u);
  lose(b, false);
  b.power_cycle();
  EXPECT_EQ(b.raw(501), 0u);  // not yet stored
  lose(b);
  b.run(0.01);
  EXPECT_EQ(b.raw(501), 1u);
  lose(b, false);
  b.pu();
  EXPECT_FALSE(b->set_parameter("Pr.501", 1).has_value());
  ASSERT_TRUE(b->set_parameter("Pr.501", 0).has_value());
  EXPECT_EQ(b.raw(501), 0u);
}

// --- resets: manual 4.6 ---

TEST(A700Reset, TheInverterResetActsAtAnyTimeInNetworkOperationOnly) {
  for (int pr75 : {14, 15}) {  // 15 permits a reset with an alarm only
    Bench b = a700_with({{"Pr.340", 1}, {"Pr.75", static_cast<double>(pr75)}});
    ASSERT_TRUE(b.write({.kind = Kind::kResetInverter, .value = 0}).has_value());
    EXPECT_FALSE(b.port().ready());
    EXPECT_NEAR(seconds_until(
                    b, [&] { return b.port().ready(); }, 3),
                1.0, 0.01);
    EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
    // The Identity object's reset obeys Pr.75.
    EXPECT_EQ(b.write({.kind = Kind::kResetInverter, .value = 1}).has_value(), pr75 == 14);
  }
  Bench ext = a700_with();
  EXPECT_EQ(ext.write({.kind = Kind::kResetInverter}).error(), Refusal::kWrongMode);
  ext.pu();
  EXPECT_EQ(ext.write({.kind = Kind::kResetInverter}).error(), Refusal::kWrongMode);
}

TEST(A700Reset, AfterAResetFromNetworkOperationTheModeIsExternalWithPr340Is0) {
  Bench b = a700_with();
  ASSERT_TRUE(mode(b, 1).has_value());
  ASSERT_TRUE(b.write({.kind = Kind::kResetInverter}).has_value());
  b.run(1.1);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(A700Reset, TheErrorResetNeedsAnAlarmAndFollowsPr349) {
  for (int pr349 : {0, 1}) {
    for (auto wanted : {OperationMode::kNetwork, OperationMode::kExternal, OperationMode::kPu}) {
      Bench b = a700_with({{"Pr.349", static_cast<double>(pr349)}});
      if (wanted == OperationMode::kNetwork) {
        ASSERT_TRUE(mode(b, 1).has_value());
      } else if (wanted == OperationMode::kPu) {
        b.pu();
      }
      EXPECT_EQ(b.write({.kind = Kind::kErrorReset}).error(), Refusal::kNotFaulted);
      ASSERT_TRUE(b->inject_fault("E.OC1", true).has_value());
      const auto outcome = b.write({.kind = Kind::kErrorReset});
      const bool allowed = pr349 == 0 || wanted == OperationMode::kNetwork;
      EXPECT_EQ(outcome.has_value(), allowed);
      EXPECT_EQ(b->alarm_name(), allowed ? "" : "E.OC1");
    }
  }
}

TEST(A700Reset, ALineErrorIsNotResetFromTheNetwork) {
  Bench b = a700_with({{"Pr.340", 1}});
  lose(b);
  b.run(0.1);
  ASSERT_TRUE(b.alarm("E.OP3"));
  EXPECT_EQ(b.write({.kind = Kind::kErrorReset}).error(), Refusal::kFaulted);
  lose(b, false);
  EXPECT_EQ(b.write({.kind = Kind::kErrorReset}).error(), Refusal::kFaulted);
  EXPECT_EQ(b.write({.kind = Kind::kResetInverter}).error(), Refusal::kFaulted);
  b.key(PanelKey::kStopReset);
  b.run(1.1);
  EXPECT_EQ(b->alarm_name(), "");
}

// --- storage: manual 4.4.1, 7.6 ---

TEST(A700Storage, Pr342Is1WritesRamOnly) {
  for (int pr342 : {0, 1}) {
    Bench b = a700_with({{"Pr.340", 1}, {"Pr.342", static_cast<double>(pr342)}});
    ASSERT_TRUE(b.write_parameter(4, 4500).has_value());
    EXPECT_EQ(b.raw(4), 4500u);
    b.power_cycle();
    EXPECT_EQ(b.raw(4), pr342 == 0 ? 4500u : 6000u);
  }
}

TEST(A700Storage, AStoredFrequencySurvivesThePowerOffAndAnotherDoesNot) {
  Bench b = a700_with({{"Pr.340", 1}});
  ASSERT_TRUE(b.write({.kind = Kind::kStoredFrequency, .value = 1500}).has_value());
  ASSERT_TRUE(b.frequency(20).has_value());
  EXPECT_EQ(b.port().network_frequency(), 2000);
  b.power_cycle();
  EXPECT_EQ(b.port().network_frequency(), 1500);
  EXPECT_EQ(b.write({.kind = Kind::kStoredFrequency, .value = 40001}).error(), Refusal::kOutOfRange);
}

TEST(A700Storage, TheFourClearsKeepWhatTheyShould) {
  struct Case {
    std::uint32_t kind;
    bool calibration;
    bool communication;
  };
  for (const Case& c : {Case{0, false, true}, {1, true, true}, {2, false, false}, {3, true, false}}) {
    Bench b = a700_with({{"Pr.340", 1}, {"Pr.4", 45}, {"C3", 5}, {"Pr.75", 15}, {"Pr.500", 3}});
    ASSERT_TRUE(b.write({.kind = Kind::kRestoreDefaults, .value = c.kind}).has_value());
    EXPECT_EQ(b.raw(4), 6000u) << c.kind;
    EXPECT_EQ(b.raw(902, 2), c.calibration ? 0u : 50u) << c.kind;
    EXPECT_EQ(b.raw(500), c.communication ? 0u : 30u) << c.kind;
    EXPECT_EQ(b.raw(340), c.communication ? 0u : 1u) << c.kind;
    EXPECT_EQ(b.raw(75), 15u) << c.kind;
  }
}

TEST(A700Storage, Pr77AndPr79AreReadOnlyForTheNetwork) {
  Bench b = a700_with({{"Pr.340", 1}});
  EXPECT_EQ(b.write_parameter(79, 1).error(), Refusal::kReadOnly);
  EXPECT_EQ(b.write_parameter(77, 2).error(), Refusal::kReadOnly);
  EXPECT_EQ(b.write_parameter(255, 0).error(), Refusal::kReadOnly);
  EXPECT_EQ(b.write_parameter(340, 3).error(), Refusal::kOutOfRange);
  EXPECT_TRUE(b.write_parameter(10, 65535).has_value());  // 9999
}

TEST(A700Storage, TheEepromTextCarriesCountersAndComesBack) {
  Bench b = a700_with({{"Pr.340", 1}, {"Pr.11", 8888}});
  ASSERT_TRUE(b.write({.kind = Kind::kStoredFrequency, .value = 1234}).has_value());
  b.run(3);
  const std::string text = b->eeprom_text();
  EXPECT_THAT(text, testing::HasSubstr("network_frequency_0.01Hz = 1234\n"));
  EXPECT_THAT(text, testing::HasSubstr("Pr.11 = 8888"));
  Bench other(config_a700(), "fr-a700");
  ASSERT_TRUE(other->load_eeprom(text).has_value());
  EXPECT_EQ(other->eeprom_text(), text);
  std::string damaged = text;
  damaged.replace(damaged.find("= 1234"), 6, "= -1234");
  EXPECT_THAT(other->load_eeprom(damaged).error(), testing::HasSubstr("network_frequency_0.01Hz takes 0 to"));
}

TEST(A700Storage, Pr340Is12GoesOnAfterAShortPowerFailureWhere1DoesNot) {
  for (int pr340 : {1, 2, 10, 12}) {
    Bench b = a700_with({{"Pr.340", static_cast<double>(pr340)}, {"Pr.57", 0}, {"Pr.186", 9999}});
    ASSERT_TRUE(b.frequency(20).has_value());
    ASSERT_TRUE(b.command({NetTerminal::kStf}).has_value());
    b.run(2);
    plant::MainsState off{.voltage_v_rms = 0};
    b->set_mains(off);
    ASSERT_TRUE(b.run_until([&] { return !b.port().ready(); }, 20));
    b->set_mains({.voltage_v_rms = 400});
    b.run(5);
    EXPECT_EQ(b.port().status().running, pr340 == 2 || pr340 == 12) << pr340;
  }
}

}  // namespace
}  // namespace vinv::inverter::test
