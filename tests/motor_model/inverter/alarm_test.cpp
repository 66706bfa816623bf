// Alarms of the FR-E500: every row of alarms.csv by injection with code, history, status, output, reset and retry; the
// causes that a user can inject; Pr.65, 67-69, Pr.75.
#include "bench.hpp"
#include "motor_model/inverter/e500/inverter.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using port::OperationMode;
using testing::HasSubstr;

Bench running(std::initializer_list<std::pair<std::string, double>> presets = {}) {
  Bench b;
  b.preset("Pr.7", 0.2);
  for (const auto& [name, value] : presets) b.preset(name, value);
  b.power_on();
  EXPECT_TRUE(b.net().has_value());
  EXPECT_TRUE(b.frequency(20).has_value());
  EXPECT_TRUE(b.command({NetTerminal::kStf}).has_value());
  b.run(0.5);
  EXPECT_TRUE(b.port().status().running);
  return b;
}

TEST(Alarm, EveryRowShutsTheOutputOffAndIsReported) {
  for (const AlarmRow& row : e500::family_data().alarms.rows()) {
    SCOPED_TRACE(row.name);
    Bench b = running();
    ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
    b.tick();
    EXPECT_EQ(b->alarm_name(), row.name);
    EXPECT_EQ(b->display(), row.name);
    EXPECT_THAT(b->alarm_cause(), HasSubstr("(injected)"));
    EXPECT_EQ(b.port().active_alarm(), row.code);
    EXPECT_EQ(b.port().alarm_history()[0], row.code);
    EXPECT_TRUE(b.port().status().alarm);
    EXPECT_FALSE(b.port().status().running);
    EXPECT_FALSE(b.port().status().ready);
    EXPECT_TRUE(b.output("ABC"));
    EXPECT_FALSE(b->plant().measurements().gates_on);
    EXPECT_GT(b.signal("speed"), 300);  // coasts
    // Data communication goes on, and the start command still stands.
    EXPECT_TRUE(b.port().ready());
    b.run(0.5);
    EXPECT_FALSE(b.port().status().running);
    EXPECT_TRUE(b.output("ABC"));
  }
}

TEST(Alarm, EveryRowIsClearedByWhatItsTableSays) {
  struct Way {
    const char* name;
    std::function<bool(Bench&)> reset;  // true if accepted
  };
  const Way ways[] = {{"network", [](Bench& b) { return b.reset().has_value(); }},
                      {"panel", [](Bench& b) { return b->press_key(PanelKey::kStopReset).has_value(); }},
                      {"RES", [](Bench& b) {
                         b.terminal("RES");
                         b.run(0.2);
                         const bool accepted = b->display() == "Err.";
                         b.terminal("RES", false);
                         return accepted;
                       }}};
  for (const AlarmRow& row : e500::family_data().alarms.rows()) {
    const bool any = row.reset == ResetRule::kAny;
    for (const Way& way : ways) {
      SCOPED_TRACE(row.name + " by " + way.name);
      Bench b = running();
      ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
      b.run(0.1);
      EXPECT_EQ(way.reset(b), any);
      EXPECT_EQ(b->alarm_name(), any ? "" : row.name);
      b.run(1.1);
      EXPECT_EQ(b->alarm_name(), any ? "" : row.name);
      EXPECT_EQ(b.port().active_alarm(), any ? 0 : row.code);
      EXPECT_EQ(b.port().status().alarm, !any);
      EXPECT_EQ(b.output("ABC"), !any);
      EXPECT_EQ(b.port().alarm_history()[0], row.code);  // the history stays
    }
    Bench b = running();
    ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
    b.power_cycle();
    EXPECT_EQ(b->alarm_name(), "") << row.name;
    EXPECT_FALSE(b.port().status().alarm);
    EXPECT_EQ(b.port().alarm_history()[0], row.code);
  }
}

TEST(Alarm, EveryRowIsRetriedAsItsTableSays) {
  for (const AlarmRow& row : e500::family_data().alarms.rows()) {
    for (int pr65 = 0; pr65 <= 3; ++pr65) {
      SCOPED_TRACE(row.name + " Pr.65 = " + std::to_string(pr65));
      Bench b = running({{"Pr.65", static_cast<double>(pr65)}, {"Pr.67", 1}, {"Pr.68", 0.1}});
      ASSERT_TRUE(b->inject_fault(row.name, true).has_value());
      b.run(0.05);
      EXPECT_FALSE(b.port().status().running);
      EXPECT_EQ(b.port().status().alarm, !row.retried_with(pr65));
      b.run(0.3);
      EXPECT_EQ(b.port().status().running, row.retried_with(pr65));
    }
  }
}

TEST(Alarm, TheHistoryKeepsEightNewestFirstAndIsCleared) {
  Bench b;
  b.power_on();
  for (const char* name : {"E.OC1", "E.OC2", "E.OC3", "E.OV1", "E.OV2", "E.OV3", "E.THT", "E.THM", "E.FIN"}) {
    ASSERT_TRUE(b->inject_fault(name, true).has_value());
    b.key(PanelKey::kStopReset);
    ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  }
  EXPECT_EQ(b.port().alarm_history(), (port::AlarmHistory{0x40, 0x31, 0x30, 0x22, 0x21, 0x20, 0x12, 0x11}));
  b.power_cycle();
  EXPECT_EQ(b.port().alarm_history()[0], 0x40);
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.write({.kind = port::WriteRequest::Kind::kClearAlarmHistory}));
  EXPECT_EQ(b.port().alarm_history(), port::AlarmHistory{});
}

TEST(Alarm, AfterAResetFromNetworkTheModeIsExternal) {
  Bench b = running();
  ASSERT_TRUE(b->inject_fault("E.OV2", true).has_value());
  ASSERT_TRUE(b.reset());
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  EXPECT_FALSE(b.port().status().running);
}

TEST(Alarm, AStartTerminalThatIsStillOnStartsAgainAfterTheReset) {
  // The family warns of it.
  Bench b;
  b.preset("Pr.7", 0.2);
  b.power_on();
  b.terminal("RM");
  b.terminal("STF");
  b.run(0.5);
  ASSERT_TRUE(b->inject_fault("E.OC2", true).has_value());
  b.run(0.1);
  b.key(PanelKey::kStopReset);
  b.run(0.9);
  EXPECT_FALSE(b.port().status().running);
  b.run(0.2);
  EXPECT_TRUE(b.port().status().running);
}

TEST(Alarm, TheFirstOneStays) {
  Bench b = running();
  ASSERT_TRUE(b->inject_fault("E.THT", true).has_value());
  EXPECT_FALSE(b->inject_fault("E.GF", true).has_value());
  b.port().set_communication_lost(true);
  b.run(0.1);
  EXPECT_EQ(b->alarm_name(), "E.THT");
  EXPECT_EQ(b.port().alarm_history()[1], 0);
}

// --- retry: Pr.65, 67-69 ---

TEST(Retry, RestartsSilentlyAndCountsSuccess) {
  Bench b = running({{"Pr.67", 2}, {"Pr.68", 0.5}});
  ASSERT_TRUE(b->inject_fault("E.OC2", true).has_value());
  b.run(0.45);
  EXPECT_EQ(b->alarm_name(), "E.OC2");
  EXPECT_FALSE(b.port().status().alarm);
  EXPECT_EQ(b.port().active_alarm(), 0);
  EXPECT_FALSE(b.output("ABC"));
  b.run(0.3);
  EXPECT_EQ(b->alarm_name(), "");
  EXPECT_TRUE(b.port().status().running);
  EXPECT_EQ(b.raw(69), 0u);
  b.run(2.5);  // five waiting times without trouble
  EXPECT_EQ(b.raw(69), 1u);
  EXPECT_EQ(b.port().alarm_history()[0], 0x11);
  ASSERT_TRUE(b.command({}));
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 8));
  EXPECT_TRUE(refused(b.write_parameter(69, 1), port::Refusal::kOutOfRange));
  ASSERT_TRUE(b.write_parameter(69, 0));
  EXPECT_EQ(b.raw(69), 0u);
}

TEST(Retry, UsedUpEndsInERet) {
  Bench b = running({{"Pr.67", 2}, {"Pr.68", 0.2}});
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(b->inject_fault("E.OV2", true).has_value());
    b.run(0.4);
    EXPECT_TRUE(b.port().status().running) << i;
  }
  ASSERT_TRUE(b->inject_fault("E.OV2", true).has_value());
  b.tick();
  EXPECT_EQ(b->alarm_name(), "E.RET");
  EXPECT_THAT(b->alarm_cause(), HasSubstr("2 retries used up; the last alarm was E.OV2"));
  EXPECT_EQ(b.port().active_alarm(), 0xB2);
  EXPECT_TRUE(b.port().status().alarm);
  // Only the first alarm of the sequence and its end are stored.
  EXPECT_EQ(b.port().alarm_history(), (port::AlarmHistory{0xB2, 0x21}));
  b.run(1);
  EXPECT_FALSE(b.port().status().running);
}

TEST(Retry, Above100GivesTheAlarmOutputMeanwhile) {
  Bench b = running({{"Pr.67", 101}, {"Pr.68", 0.5}});
  ASSERT_TRUE(b->inject_fault("E.OC2", true).has_value());
  b.run(0.3);
  EXPECT_TRUE(b.port().status().alarm);
  EXPECT_EQ(b.port().active_alarm(), 0x11);
  b.run(0.3);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_FALSE(b.port().status().alarm);
}

// --- causes ---

struct CauseCase {
  const char* cause;
  const char* alarm;
};

TEST(Cause, TripsTheRunningDriveAndAgainAfterAResetWhileItLasts) {
  for (const CauseCase& c : {CauseCase{"output_phase_open", "E.LF"}, CauseCase{"option", "E.OPT"}}) {
    SCOPED_TRACE(c.cause);
    Bench b = running();
    ASSERT_TRUE(b->inject_fault(c.cause, true).has_value());
    ASSERT_TRUE(b.run_until([&] { return b->alarm_name() == c.alarm; }, 2)) << b->alarm_name();
    b.key(PanelKey::kStopReset);
    b.run(1.2);
    if (std::string_view(c.cause) == "option") {
      EXPECT_EQ(b->alarm_name(), c.alarm);
    }
    ASSERT_TRUE(b->inject_fault(c.cause, false).has_value());
    if (!b->alarm_name().empty()) b.key(PanelKey::kStopReset);
    b.run(1.2);
    EXPECT_EQ(b->alarm_name(), "");
  }
}

TEST(Cause, AnEarthFaultTripsAtTheStart) {
  Bench b;
  b.power_on();
  ASSERT_TRUE(b->inject_fault("earth_fault", true).has_value());
  b.terminal("RM");
  b.terminal("STF");
  b.run(0.05);
  EXPECT_EQ(b->alarm_name(), "E.GF");
}

TEST(Cause, AFailedBrakeTransistorTripsTheFirstTimeItIsUsed) {
  InverterConfig c = config_1k5();
  c.brake_resistance_ohm = 150;
  c.load.inertia_kg_m2 = 0.05;
  Bench b(c);
  b.preset("Pr.8", 0.8);
  b.power_on();
  ASSERT_TRUE(b->inject_fault("brake_transistor", true).has_value());
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(50));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(7);
  EXPECT_EQ(b->alarm_name(), "");  // driving needs no brake
  ASSERT_TRUE(b.command({}));
  ASSERT_TRUE(b.run_until([&] { return !b->alarm_name().empty(); }, 2));
  EXPECT_EQ(b->alarm_name(), "E.BE") << b->alarm_cause();
}

TEST(Cause, LostCommunicationTripsInNetworkOperationOnly) {
  Bench b = running();
  b.port().set_communication_lost(true);
  b.tick();
  EXPECT_EQ(b->alarm_name(), "E.OP3");
  EXPECT_EQ(b.port().active_alarm(), 0xA3);
  Bench external;
  external.power_on();
  external.port().set_communication_lost(true);
  external.port().set_option_failed(true);
  external.run(0.1);
  EXPECT_EQ(external->alarm_name(), "");
}

TEST(Cause, AFailedOptionIsE3) {
  Bench b = running();
  b.port().set_option_failed(true);
  b.tick();
  EXPECT_EQ(b->alarm_name(), "E.3");
}

TEST(Cause, ADisconnectedPanelTripsAsPr75Says) {
  for (const auto& [pr75, trips] :
       {std::pair{0, false}, {1, false}, {2, true}, {3, true}, {14, false}, {15, false}, {16, true}, {17, true}}) {
    Bench b = running({{"Pr.75", static_cast<double>(pr75)}});
    ASSERT_TRUE(b->inject_fault("pu_disconnected", true).has_value());
    b.run(0.01);
    EXPECT_EQ(b->alarm_name(), trips ? "E.PUE" : "") << pr75;
    EXPECT_EQ(b->press_key(PanelKey::kStopReset).error(), "the operation panel is disconnected");
  }
}

TEST(Cause, AnOpenHeatSinkThermistorIsEFinUntilItIsMended) {
  Bench b = running();
  ASSERT_TRUE(b->inject_fault("heat_sink_sensor", true).has_value());
  b.tick();
  EXPECT_EQ(b->alarm_name(), "E.FIN");
  EXPECT_THAT(b->alarm_cause(), HasSubstr("heat sink 150 degC"));
  ASSERT_TRUE(b->inject_fault("heat_sink_sensor", false).has_value());
  EXPECT_LT(b->plant().measurements().heat_sink_c, 60);
}

TEST(Cause, ADeadDcLinkSensorIsAPowerFailureToTheDrive) {
  Bench b = running();
  ASSERT_TRUE(b->inject_fault("dc_link_sensor", true).has_value());
  b.run(0.05);
  EXPECT_FALSE(b->plant().measurements().gates_on);
  EXPECT_GT(b->plant().measurements().dc_link_v, 500);
  EXPECT_FALSE(b.port().status().ready);
}

TEST(Cause, ADeadCurrentSensorBlindsMonitorAndStallPreventionButNotTheComparator) {
  Bench b = running();
  ASSERT_TRUE(b->inject_fault("current_sensor", true).has_value());
  b.run(2);
  EXPECT_GT(b->plant().measurements().output_current_a_rms, 0.5);
  EXPECT_EQ(b.output_a(), 0);
  b->set_shaft_locked(true);
  b.run(1);
  EXPECT_EQ(b->alarm_name(), "E.OC2");
}

TEST(Cause, UnknownOnesAreRefusedWithTheList) {
  Bench b;
  b.power_on();
  EXPECT_THAT(b->inject_fault("E.XYZ", true).error(), HasSubstr("earth_fault, output_phase_open"));
  EXPECT_EQ(b->injectable_faults().size(), 10 + e500::family_data().alarms.rows().size());
  InverterConfig c = config_1k5();
  c.option_fitted = false;
  Bench bare(c);
  bare.power_on();
  EXPECT_EQ(bare->inject_fault("option", true).error(), "no option board is fitted");
}

}  // namespace
}  // namespace vinv::inverter::test
