// What the option board sees of an FR-E500: mailbox, operation mode, commands, parameters, resets
// (OI-FR-E5NCO manual 4.2, 8.3.4, 8.7).
#include "bench.hpp"

namespace vinv::inverter::test {
namespace {

using port::NetTerminal;
using port::OperationMode;
using port::Refusal;
using Kind = port::WriteRequest::Kind;

Bench fast_in_net() {
  Bench b = fast();
  EXPECT_TRUE(b.net().has_value());
  return b;
}

TEST(Mailbox, HoldsOneWriteUntilItsOutcomeIsTaken) {
  Bench b = fast();
  const port::WriteRequest net{.kind = Kind::kOperationMode, .value = 1};
  EXPECT_FALSE(b.port().write_pending());
  EXPECT_FALSE(b.port().take_outcome().has_value());
  ASSERT_TRUE(b.port().post_write(b.now(), net));
  EXPECT_TRUE(b.port().write_pending());
  EXPECT_FALSE(b.port().take_outcome().has_value());  // not decided yet
  EXPECT_TRUE(refused(b.port().post_write(b.now(), net), Refusal::kBusy));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  b.tick();
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
  EXPECT_TRUE(b.port().write_pending());
  EXPECT_TRUE(refused(b.port().post_write(b.now(), net), Refusal::kBusy));  // not collected yet
  const auto outcome = b.port().take_outcome();
  ASSERT_TRUE(outcome.has_value());
  EXPECT_TRUE(outcome->has_value());
  EXPECT_FALSE(b.port().write_pending());
  EXPECT_FALSE(b.port().take_outcome().has_value());
}

TEST(Mailbox, IsClosedInStartUpAndAfterAReset) {
  Bench b;
  EXPECT_TRUE(refused(b.net(), Refusal::kNotReady));
  b->set_power(true);
  b.run(0.1);
  EXPECT_TRUE(refused(b.net(), Refusal::kNotReady));
  b.power_on();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.reset());  // the outcome is still collected
  EXPECT_FALSE(b.port().ready());
  EXPECT_TRUE(refused(b.net(), Refusal::kNotReady));
  const double at = b.now_s();
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_NEAR(b.now_s() - at, 1.0, 0.01);
}

TEST(Mode, CommandsNeedNetworkOperation) {
  Bench b = fast();
  EXPECT_TRUE(refused(b.command({NetTerminal::kStf}), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.frequency(10), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.write({.kind = Kind::kAnalogReference, .value = 1}), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.write({.kind = Kind::kClearAlarmHistory}), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.reset(), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.write({.kind = Kind::kRestoreDefaults}), Refusal::kWrongMode));
  EXPECT_TRUE(refused(b.write_parameter(7, 10), Refusal::kWrongMode));
  EXPECT_EQ(b.raw(7), 2u);
}

TEST(Mode, ChangesOnlyAtStandstillWithTheStartSignalsOff) {
  Bench b = fast();
  b.terminal("STF");
  b.tick();
  EXPECT_TRUE(refused(b.net(), Refusal::kModeChangeRefused));
  b.terminal("STF", false);
  b.run(0.5);
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.3);
  EXPECT_TRUE(refused(b.net(false), Refusal::kModeChangeRefused));
  ASSERT_TRUE(b.command({}));
  EXPECT_TRUE(refused(b.net(false), Refusal::kModeChangeRefused));  // still turning
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 3));
  ASSERT_TRUE(b.net(false));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(Mode, PuAndNetworkAreNotExchangedDirectly) {
  Bench b = fast();
  b.pu();
  EXPECT_TRUE(refused(b.net(), Refusal::kModeChangeRefused));
  EXPECT_TRUE(b.net(false).has_value());  // already off
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kPu);
  b.key(PanelKey::kPuExt);
  ASSERT_TRUE(b.net());
  EXPECT_FALSE(b->press_key(PanelKey::kPuExt).has_value());
}

TEST(Mode, Pr340SelectsNetworkAfterPowerOnAndReset) {
  Bench b;
  b.preset("Pr.340", 1);
  b.power_on();
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
  ASSERT_TRUE(b.net(false));
  b.terminal("RES");
  b.run(0.2);
  b.terminal("RES", false);
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kNetwork);
  ASSERT_TRUE(b.write_parameter(340, 0));
  ASSERT_TRUE(b.reset());
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
}

TEST(Mode, WithPr79Is6TheMotorRunsOnThroughTheChange) {
  Bench b = fast();
  ASSERT_TRUE(b->set_parameter("Pr.79", 6).has_value());
  b.terminal("STF");
  b.terminal("RM");
  b.run(1);
  ASSERT_TRUE(b.net());
  b.run(0.3);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_NEAR(b.output_hz(), 30, 0.5);
  ASSERT_TRUE(b.frequency(20));
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 20, 0.5);
  ASSERT_TRUE(b.net(false));
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 30, 0.5);  // terminals again
}

TEST(Command, StfRunsForwardStrReverseBothStopAndZeroReleases) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.5);
  EXPECT_TRUE(b.port().status().running);
  EXPECT_TRUE(b.port().status().forward);
  EXPECT_GT(b.signal("speed"), 400);
  EXPECT_NEAR(b.output_hz(), 20, 0.01);
  ASSERT_TRUE(b.command({NetTerminal::kStr}));
  b.run(1);
  EXPECT_TRUE(b.port().status().reverse);
  EXPECT_LT(b.signal("speed"), -400);
  EXPECT_NEAR(b.output_hz(), 20, 0.01);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kStr}));
  b.run(1.5);
  EXPECT_FALSE(b.port().status().running);
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.3);
  ASSERT_TRUE(b.command({}));
  b.run(1.5);
  EXPECT_FALSE(b.port().status().running);
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.3);
  ASSERT_TRUE(b.command({NetTerminal::kStop, NetTerminal::kStf}));
  b.run(1.5);
  EXPECT_FALSE(b.port().status().running);
}

TEST(Command, SpeedBitsAndMrsFollowTheTerminalAssignment) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kRm}));
  b.run(0.6);
  EXPECT_NEAR(b.output_hz(), 30, 0.01);
  ASSERT_TRUE(b.command({NetTerminal::kStf, NetTerminal::kMrs}));
  b.run(0.05);
  EXPECT_FALSE(b.port().status().running);
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 20, 0.01);
}

TEST(Command, RlMeansSecondFunctionWithPr180Is3) {
  // Quick stop of the manual, 7.12.2: RL selects the second ramp.
  Bench b = fast();
  ASSERT_TRUE(b.net());
  ASSERT_TRUE(b.write_parameter(180, 3));
  ASSERT_TRUE(b.write_parameter(8, 1000));  // 100 s
  ASSERT_TRUE(b.write_parameter(45, 5));    // 0.5 s
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(1);
  ASSERT_TRUE(b.command({NetTerminal::kRl}));
  ASSERT_TRUE(b.run_until([&] { return !b.port().status().running; }, 2));
}

TEST(Command, RightsOfPr338AndPr339) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.write_parameter(338, 1));
  EXPECT_TRUE(refused(b.command({NetTerminal::kStf}), Refusal::kWrongMode));
  EXPECT_TRUE(b.command({}).has_value());
  ASSERT_TRUE(b.frequency(20));
  b.terminal("STF");
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 20, 0.01);  // started by the terminal, speed of the network
  b.terminal("STF", false);
  b.run(1);
  ASSERT_TRUE(b.write_parameter(338, 0));
  ASSERT_TRUE(b.write_parameter(339, 1));
  EXPECT_TRUE(refused(b.frequency(20), Refusal::kWrongMode));
  b.terminal("RL");
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.5);
  EXPECT_NEAR(b.output_hz(), 10, 0.01);  // started by the network, speed of the terminals
}

TEST(Command, AnalogReferenceActsLikeTerminal2WithPr339Is1) {
  Bench b = fast_in_net();
  const port::WriteRequest half{.kind = Kind::kAnalogReference, .value = 120};
  EXPECT_TRUE(refused(b.write(half), Refusal::kWrongMode));
  ASSERT_TRUE(b.write_parameter(339, 1));
  ASSERT_TRUE(b.write_parameter(38, 10000));  // 100 Hz at full scale
  ASSERT_TRUE(b->set_analog("2", 9).has_value());
  ASSERT_TRUE(b.write(half));
  EXPECT_TRUE(refused(b.write({.kind = Kind::kAnalogReference, .value = 256}), Refusal::kOutOfRange));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(1.5);
  EXPECT_NEAR(b.output_hz(), 100 * 120 / 255.0, 0.02);
}

TEST(Command, FrequencyAbove400HzIsRefusedAndAbovePr1Limited) {
  Bench b = fast_in_net();
  EXPECT_TRUE(refused(b.frequency(400.01), Refusal::kOutOfRange));
  ASSERT_TRUE(b.write_parameter(1, 3000));
  ASSERT_TRUE(b.frequency(100));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(1);
  EXPECT_NEAR(b.output_hz(), 30, 0.01);
}

TEST(Parameters, WritesByRawWordWithEachRefusal) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.write_parameter(7, 100));
  EXPECT_EQ(b->get_parameter("Pr.7").value(), 10);
  EXPECT_TRUE(refused(b.write_parameter(7, 36001), Refusal::kOutOfRange));
  EXPECT_TRUE(refused(b.write_parameter(28, 1), Refusal::kNoSuchItem));
  EXPECT_TRUE(refused(b.write_parameter(902, 1), Refusal::kNoSuchItem));
  ASSERT_TRUE(b.write_parameter(902, 100, 1));
  EXPECT_TRUE(refused(b.write_parameter(146, 0), Refusal::kReadOnly));
  EXPECT_EQ(b.port().read_parameter({146, 0}).value(), 0u);
  EXPECT_EQ(b.port().read_parameter({28, 0}).error(), Refusal::kNoSuchItem);
  EXPECT_EQ(b.port().read_parameter({902, 3}).error(), Refusal::kNoSuchItem);
  ASSERT_TRUE(b.write_parameter(57, 65535));
  EXPECT_EQ(b->get_parameter("Pr.57").value(), 9999);
  ASSERT_TRUE(b.write_parameter(19, 65520));
  EXPECT_EQ(b->get_parameter("Pr.19").value(), 8888);
  EXPECT_TRUE(refused(b.write_parameter(7, 0xFFFFFFFFu), Refusal::kOutOfRange));
  ASSERT_TRUE(b.write_parameter(7, 2));
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.2);
  EXPECT_TRUE(refused(b.write_parameter(7, 100), Refusal::kRunning));
  EXPECT_TRUE(b.write_parameter(4, 4000).has_value());
  ASSERT_TRUE(b.command({}));
  b.run(2);
  ASSERT_TRUE(b.write_parameter(77, 1));
  EXPECT_TRUE(refused(b.write_parameter(7, 100), Refusal::kWriteDisabled));
  EXPECT_TRUE(b.write_parameter(22, 1400).has_value());
  EXPECT_TRUE(refused(b.write({.kind = Kind::kRestoreDefaults}), Refusal::kWriteDisabled));
  ASSERT_TRUE(b.write_parameter(77, 2));
  ASSERT_TRUE(b.net(false));
  EXPECT_TRUE(b.write_parameter(7, 5).has_value());  // in external operation, with Pr.77 = 2
}

TEST(Parameters, EveryRowReadsWhatTheTableSaysAfterPowerOn) {
  Bench b;
  b.power_on();
  for (const ParameterInfo& p : b->parameters()) {
    const std::string name = "Pr." + std::to_string(p.id.number) + (p.id.sub > 0 ? "." + std::to_string(p.id.sub) : "");
    EXPECT_TRUE(b.port().read_parameter(p.id).has_value()) << name;
    EXPECT_NEAR(b->get_parameter(name).value(), p.factory_default, 1e-9) << name;
  }
}

TEST(Parameters, Pr38AndPr903AreOneFullScale) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.write_parameter(38, 6000));
  EXPECT_EQ(b.raw(903, 1), 6000u);
  ASSERT_TRUE(b.write_parameter(903, 4000, 1));
  EXPECT_EQ(b.raw(38), 4000u);
  ASSERT_TRUE(b.write_parameter(39, 7000));
  EXPECT_EQ(b.raw(905, 1), 7000u);
}

TEST(Parameters, ClearsOverTheNetwork) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.write_parameter(345, 17));
  EXPECT_TRUE(refused(b.write({.kind = Kind::kRestoreDefaults, .value = 2}), Refusal::kOutOfRange));
  ASSERT_TRUE(b.write({.kind = Kind::kRestoreDefaults, .value = 0}));
  EXPECT_EQ(b.raw(7), 50u);
  EXPECT_EQ(b.raw(345), 17u);
  ASSERT_TRUE(b.write({.kind = Kind::kRestoreDefaults, .value = 1}));
  EXPECT_EQ(b.raw(345), 63u);
  b.power_cycle();
  EXPECT_EQ(b.raw(7), 50u);
}

TEST(Reset, ReloadsRamFromEepromAndReleasesTheCommand) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.write_parameter(342, 1));
  ASSERT_TRUE(b.write_parameter(8, 900));
  ASSERT_TRUE(b.frequency(20));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(0.5);
  ASSERT_TRUE(b.reset());  // Pr.75 = 14 permits it at any time: the motor coasts
  b.tick();
  EXPECT_FALSE(b.port().status().running);
  EXPECT_GT(b.signal("speed"), 300);
  ASSERT_TRUE(b.run_until([&] { return b.port().ready(); }, 2));
  EXPECT_EQ(b.raw(8), 2u);
  EXPECT_EQ(b.port().operation_mode(), OperationMode::kExternal);
  ASSERT_TRUE(b.net());
  b.run(0.5);
  EXPECT_FALSE(b.port().status().running);
  EXPECT_EQ(b.signal("set_frequency"), 0);
}

TEST(Reset, WithAnOddPr75OnlyAnAlarmMayBeReset) {
  Bench b;
  b.preset("Pr.75", 15);
  b.power_on();
  ASSERT_TRUE(b.net());
  EXPECT_TRUE(refused(b.reset(), Refusal::kNotFaulted));
  b.terminal("RES");
  b.run(0.2);
  EXPECT_TRUE(b.port().ready());
  b.terminal("RES", false);
  ASSERT_TRUE(b->inject_fault("E.THT", true).has_value());
  ASSERT_TRUE(b.reset());
  EXPECT_EQ(b->alarm_name(), "");
}

TEST(Monitors, ThreeOfThem) {
  Bench b = fast_in_net();
  ASSERT_TRUE(b.frequency(50));
  ASSERT_TRUE(b.command({NetTerminal::kStf}));
  b.run(2);
  EXPECT_EQ(b.port().read_monitor(1).value(), 5000);
  EXPECT_NEAR(b.output_a(), b.signal("output_current"), 0.05);
  EXPECT_GT(b.output_a(), 1.0);
  EXPECT_NEAR(b.output_v(), 380, 5);
  EXPECT_EQ(b.port().read_monitor(0).error(), Refusal::kNoSuchItem);
  EXPECT_EQ(b.port().read_monitor(4).error(), Refusal::kNoSuchItem);
  EXPECT_TRUE(b.port().status().up_to_frequency);
  EXPECT_TRUE(b.port().status().frequency_detected);
  EXPECT_TRUE(b.port().status().ready);
}

}  // namespace
}  // namespace vinv::inverter::test
