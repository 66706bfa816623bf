// NMT and the operation mode, start-up settings, LED, the loss of the master, CANopen beside Modbus.
// OI-FR-E5NCO manual, 2.3, 2.4, 4.2, 5.1, 6.4, 7.4, 8.7.12.
#include "option_boards/boards/oi_fr_e5nco/startup_settings.hpp"
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::test {
namespace {

using port::OperationMode;

class OiFrE5ncoCanopenMode : public CanopenBench {
 protected:
  void start_signal(Terminal terminal, bool on) { drive.signals_on.set(terminal, on); }
};

TEST_F(OiFrE5ncoCanopenMode, OperationalGivesNetworkModeAndEveryOtherCommandTakesIt) {
  for (const char* command : {"000#0219", "000#8019", "000#8119", "000#8219"}) {
    tell("000#0119");
    wait(3ms);
    EXPECT_EQ(drive.mode, OperationMode::kNetwork) << command;
    tell(command);
    wait(3ms);
    EXPECT_EQ(drive.mode, OperationMode::kExternal) << command;
  }
}

TEST_F(OiFrE5ncoCanopenMode, OperationalWhileRunningIsRefusedWithReason24) {
  drive.status_now.running = true;
  start_signal(Terminal::kStf, true);
  tell("000#0119");
  EXPECT_EQ(wait(5ms), "099#0010001524050000");
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
  EXPECT_EQ(tell("719#R1"), "719#05");  // the NMT state is the master's to choose
  drive.status_now.running = false;
  start_signal(Terminal::kStf, false);
  EXPECT_EQ(wait(1s), "");
  EXPECT_EQ(drive.mode, OperationMode::kExternal);  // it takes another command
  tell("000#0119");
  wait(5ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenMode, StartSignalAtStandstillIsTheReasonByItsName) {
  drive.refuse_decision = port::Refusal::kModeChangeRefused;
  start_signal(Terminal::kStf, true);
  tell("000#0119");
  EXPECT_EQ(wait(5ms), "099#0010001522050000");
  start_signal(Terminal::kStf, false);
  start_signal(Terminal::kStr, true);
  tell("000#0119");
  EXPECT_EQ(wait(5ms), "099#0010001523050000");
}

TEST_F(OiFrE5ncoCanopenMode, OperationalInNetworkModeAlreadyIsNoChange) {
  network();
  drive.status_now.running = true;
  tell("000#0119");
  EXPECT_EQ(wait(5ms), "");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenMode, LeavingWaitsForStandstillWithTheStartSignalsOff) {
  network();
  drive.status_now.running = true;
  start_signal(Terminal::kStf, true);
  tell("000#8019");
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  EXPECT_TRUE(drive.posted.empty());  // 6007H = 0: no action
  drive.status_now.running = false;
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  start_signal(Terminal::kStf, false);
  wait(3ms);
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenMode, LeavingThatIsRefusedIsTriedAgain) {
  network();
  drive.refuse_decision = port::Refusal::kModeChangeRefused;
  tell("000#8019");
  EXPECT_EQ(wait(450ms), "");
  EXPECT_EQ(drive.posted.size(), 5u);
  drive.refuse_decision.reset();
  wait(110ms);
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenMode, StartCallsLeavingOff) {
  network();
  drive.status_now.running = true;
  tell("000#8019");
  wait(10ms);
  tell("000#0119");
  drive.status_now.running = false;
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenMode, LeavingWhileRunningDoesWhat6007Says) {
  const std::pair<std::uint32_t, std::optional<std::uint16_t>> reactions[] = {
      {0, std::nullopt}, {2, bit(Terminal::kMrs)}, {3, bit(Terminal::kRl)}};
  drive.parameters[180] = {3, 0, 18};
  for (const auto& [option, expected] : reactions) {
    drive.status_now.running = false;
    wait(5ms);
    network();
    EXPECT_EQ(write(0x6007, 0, option, 2), "ok");
    drive.status_now.running = true;
    tell("000#0219");
    wait(20ms);
    ASSERT_EQ(drive.executed.size(), expected ? 1u : 0u) << option;
    if (expected) {
      EXPECT_EQ(terminals(0), *expected) << option;
    }
    EXPECT_EQ(drive.mode, OperationMode::kNetwork);
    drive.status_now.running = false;
    wait(5ms);
    EXPECT_EQ(drive.mode, OperationMode::kExternal);
  }
}

TEST_F(OiFrE5ncoCanopenMode, LossOfTheMasterDoesWhat6007Says) {
  const std::pair<std::uint32_t, std::optional<std::uint16_t>> reactions[] = {
      {0, std::nullopt}, {2, bit(Terminal::kMrs)}, {3, bit(Terminal::kRl)}};
  drive.parameters[180] = {3, 0, 18};
  for (const auto& [option, expected] : reactions) {
    tell("000#8219");
    wait(5ms);
    network();
    EXPECT_EQ(write(0x6007, 0, option, 2), "ok");
    EXPECT_EQ(write(0x100c, 0, 50, 2), "ok");
    EXPECT_EQ(write(0x100d, 0, 2, 1), "ok");
    tell("219#02008813");
    tell("719#R1");
    wait(20ms);
    drive.executed.clear();
    EXPECT_EQ(transcript(200ms), "80:099#3081111F00050000") << option;
    ASSERT_EQ(drive.executed.size(), expected ? 1u : 0u) << option;
    if (expected) {
      EXPECT_EQ(terminals(0), *expected) << option;
    }
    EXPECT_EQ(drive.mode, OperationMode::kNetwork);
    EXPECT_EQ(tell("719#R1"), "099#0000000000050000 719#85");
  }
}

TEST_F(OiFrE5ncoCanopenMode, BusOffDoesWhat6007Says) {
  const std::pair<std::uint32_t, std::optional<std::uint16_t>> reactions[] = {
      {0, std::nullopt}, {2, bit(Terminal::kMrs)}, {3, bit(Terminal::kRl)}};
  drive.parameters[180] = {3, 0, 18};
  network();
  for (const auto& [option, expected] : reactions) {
    EXPECT_EQ(write(0x6007, 0, option, 2), "ok");
    tell("219#02008813");
    wait(20ms);
    drive.executed.clear();
    bus().set_bus_off(now, true);
    bus().set_bus_off(now, true);
    wait(20ms);
    ASSERT_EQ(drive.executed.size(), expected ? 1u : 0u) << option;
    if (expected) {
      EXPECT_EQ(terminals(0), *expected) << option;
    }
    bus().set_bus_off(now, false);
  }
}

TEST_F(OiFrE5ncoCanopenMode, StartThatFindsNoRoomIsReported) {
  tell("000#8019");
  drive.is_ready = true;
  drive.ticks_to_decide = 10'000;
  // A client that never waits: each write is abandoned by the next and waits for the inverter.
  for (unsigned i = 0; i < 40; ++i) tell("619#2B07300037000000");
  EXPECT_EQ(tell("000#0119"), "099#0010001519050000");
  drive.ticks_to_decide = 1;
  wait(100ms);
  tell("000#0119");
  wait(5ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenMode, LossOfTheMasterLeavesOtherModesAlone) {
  EXPECT_EQ(write(0x6007, 0, 2, 2), "ok");
  EXPECT_EQ(write(0x100c, 0, 50, 2), "ok");
  EXPECT_EQ(write(0x100d, 0, 2, 1), "ok");
  tell("719#R1");
  EXPECT_EQ(transcript(200ms), "100:099#3081111F007F0000");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenMode, ReactionOvertakesWhatWaits) {
  network();
  EXPECT_EQ(write(0x6007, 0, 2, 2), "ok");
  drive.ticks_to_decide = 5;
  tell("219#02008813");
  tell("219#02008813");
  tell("000#0219");
  wait(50ms);
  EXPECT_EQ(drive.executed.back().kind == Kind::kOperationMode, true);
  std::uint16_t last = 0;
  for (const auto& write : drive.executed) {
    if (write.kind == Kind::kCommand) last = write.terminals.bits;
  }
  EXPECT_EQ(last, bit(Terminal::kMrs));
}

TEST_F(OiFrE5ncoCanopenMode, ReactionIsTheNextThingThatTheInverterDoes) {
  map(0x1601, {0x30070010});
  network();
  EXPECT_EQ(write(0x6007, 0, 2, 2), "ok");
  drive.ticks_to_decide = 5;
  tell("219#02008813");
  tell("319#3200");
  tell("000#0219");
  wait(15ms);
  ASSERT_GE(drive.executed.size(), 2u);
  EXPECT_EQ(terminals(0), bit(Terminal::kStf));  // was with the inverter already
  EXPECT_EQ(terminals(1), bit(Terminal::kMrs));
}

TEST_F(OiFrE5ncoCanopenMode, RefusalIsReportedAgainAfterAnNmtCommand) {
  network();
  drive.mode = OperationMode::kPu;
  drive.refuse_decision = port::Refusal::kWrongMode;
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "099#0010001513050000 099#0010001513050000");
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "");
  tell("000#0119");
  wait(10ms);
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "099#0010001513050000 099#0010001513050000");
}

TEST_F(OiFrE5ncoCanopenMode, BootingDoesNotUndoPr340) {
  drive.mode = OperationMode::kNetwork;
  drive.posted.clear();
  power_cycle();
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_EQ(write(0x4000, 0, 2, 2), "ok");  // SDO commands in PRE-OPERATIONAL
}

TEST_F(OiFrE5ncoCanopenMode, StartDuringStartUpWaitsForTheInverter) {
  drive.is_ready = false;
  tell("000#0119");
  tell("219#02008813");
  EXPECT_EQ(wait(300ms), "");
  EXPECT_TRUE(drive.posted.empty());
  drive.is_ready = true;
  EXPECT_EQ(wait(20ms), "");
  ASSERT_EQ(drive.executed.size(), 3u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kOperationMode);
  EXPECT_EQ(terminals(1), bit(Terminal::kStf));
}

// --- beside Modbus ---

class OiFrE5ncoCanopenBesideModbus : public OiFrE5ncoCanopenMode {
 protected:
  std::string modbus(std::string_view frame_hex, Duration time = 20ms) {
    sent.clear();
    receive(frame(frame_hex));
    advance(time);
    return sent.empty() ? "" : to_hex(ByteView(sent[0].bytes).first(sent[0].bytes.size() - 2));
  }
};

TEST_F(OiFrE5ncoCanopenBesideModbus, LastOneAtStandstillDecidesTheMode) {
  EXPECT_EQ(modbus("19 06 65 90 00 01"), "19 06 65 90 00 01");
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  tell("000#8019");
  wait(5ms);
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
  tell("000#0119");
  wait(5ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  modbus("19 06 65 90 00 00");
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
  EXPECT_EQ(tell("719#R1"), "719#05");  // OPERATIONAL without the mode
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "099#0010001512050000 099#0010001512050000");
  modbus("19 06 65 90 00 01");
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
}

TEST_F(OiFrE5ncoCanopenBesideModbus, LaterRequestOfModbusCallsLeavingOff) {
  network();
  drive.refuse_decision.reset();
  EXPECT_EQ(modbus("19 06 65 90 00 01"), "19 06 65 90 00 01");  // before: does not count
  drive.signals_on.set(Terminal::kStf, true);
  tell("000#8019");
  wait(50ms);
  EXPECT_EQ(modbus("19 06 65 90 00 01"), "19 06 65 90 00 01");
  drive.signals_on = {};
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kNetwork);
  drive.signals_on.set(Terminal::kStf, true);
  EXPECT_EQ(modbus("19 06 65 90 00 01"), "19 06 65 90 00 01");
  tell("000#8019");
  drive.refuse_decision = port::Refusal::kModeChangeRefused;
  EXPECT_EQ(modbus("19 06 65 90 00 01"), "19 86 05");  // refused: does not count
  drive.refuse_decision.reset();
  drive.signals_on = {};
  wait(500ms);
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenBesideModbus, EarlierRequestOfModbusThatIsDecidedLaterDoesNotCount) {
  network();
  drive.signals_on.set(Terminal::kStf, true);
  drive.ticks_to_decide = 30;
  EXPECT_EQ(modbus("19 06 65 90 00 01", 15ms), "");
  tell("000#8019");
  wait(50ms);
  ASSERT_EQ(sent.size(), 1u);
  drive.ticks_to_decide = 1;
  drive.signals_on = {};
  wait(50ms);
  EXPECT_EQ(drive.mode, OperationMode::kExternal);
}

TEST_F(OiFrE5ncoCanopenBesideModbus, EachSeesWhatTheOtherWrote) {
  network();
  EXPECT_EQ(write(0x3007, 0, 77, 2), "ok");
  EXPECT_EQ(modbus("19 03 4E 2E 00 01"), "19 03 02 00 4D");
  EXPECT_EQ(modbus("19 06 4E 2E 00 4E"), "19 06 4E 2E 00 4E");
  EXPECT_EQ(read(0x3007), "=004E");
  EXPECT_EQ(modbus("19 06 5D C0 00 02"), "19 06 5D C0 00 02");
  tell("219#01000000");
  wait(5ms);
  EXPECT_EQ(drive.executed[drive.executed.size() - 2].terminals.bits, bit(Terminal::kStop));
}

TEST_F(OiFrE5ncoCanopenBesideModbus, ModbusWaitsWhileCanopenHasTheMailbox) {
  network();
  drive.ticks_to_decide = 50;
  EXPECT_EQ(tell("619#2B07300037000000"), "");
  EXPECT_EQ(modbus("19 06 4E 2E 00 4E", 45ms), "");
  EXPECT_EQ(wait(10ms), "599#6007300000000000");
  EXPECT_EQ(drive.parameters[7].value, 55u);
  EXPECT_TRUE(sent.empty());
  wait(50ms);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(ByteView(sent[0].bytes).first(6)), "19 06 4E 2E 00 4E");
  EXPECT_EQ(drive.parameters[7].value, 78u);
}

TEST_F(OiFrE5ncoCanopenBesideModbus, FloodOfPdosDoesNotKeepModbusFromWriting) {
  network();
  drive.ticks_to_decide = 2;
  sent.clear();
  receive(frame("19 06 4E 2E 00 4E"));
  for (int i = 0; i < 20; ++i) {
    tell("219#02008813");
    advance(1ms);
  }
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(ByteView(sent[0].bytes).first(6)), "19 06 4E 2E 00 4E");
  EXPECT_EQ(drive.parameters[7].value, 78u);
  EXPECT_GT(drive.executed.size(), 5u);
}

TEST_F(OiFrE5ncoCanopenBesideModbus, WriteThatWaitsForARestartingInverterIsNotReady) {
  network();
  drive.ticks_to_decide = 30;
  EXPECT_EQ(tell("619#2B07210000000000"), "");
  EXPECT_EQ(modbus("19 06 4E 2E 00 4E", 60ms), "19 86 04");
  EXPECT_EQ(taken(), "599#6007210000000000");
}

TEST_F(OiFrE5ncoCanopenBesideModbus, WriteThatWaitedWhenTheSupplyWentIsForgotten) {
  network();
  drive.ticks_to_decide = 30;
  EXPECT_EQ(tell("619#2B07300037000000"), "");
  EXPECT_EQ(modbus("19 06 4E 2E 00 4E", 10ms), "");
  drive.ticks_to_decide = 1;
  drive.executed.clear();
  power_cycle();
  wait(100ms);
  EXPECT_TRUE(drive.executed.empty());
  EXPECT_EQ(modbus("19 06 4E 2E 00 4F"), "19 06 4E 2E 00 4F");
  EXPECT_EQ(write(0x3007, 0, 56, 2), "ok");
}

TEST_F(OiFrE5ncoCanopenBesideModbus, CanopenWaitsWhileModbusHasTheMailbox) {
  network();
  drive.ticks_to_decide = 30;
  sent.clear();
  receive(frame("19 06 4E 2E 00 4E"));
  advance(10ms);
  EXPECT_EQ(tell("619#2B07300037000000"), "");
  EXPECT_EQ(wait(100ms), "599#6007300000000000");
  ASSERT_EQ(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[0].value, 78u);
  EXPECT_EQ(drive.executed[1].value, 55u);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(ByteView(sent[0].bytes).first(6)), "19 06 4E 2E 00 4E");
}

TEST_F(OiFrE5ncoCanopenBesideModbus, BothKeepWorkingWhenTheInverterLosesAWrite) {
  network();
  drive.ticks_to_decide = 1000;
  EXPECT_EQ(tell("619#2B07300037000000"), "");
  drive.lose_mailbox();
  EXPECT_EQ(wait(5ms), "599#8007300000000008");
  sent.clear();
  receive(frame("19 06 4E 2E 00 4E"));
  advance(10ms);
  drive.lose_mailbox();
  drive.ticks_to_decide = 1;
  EXPECT_EQ(write(0x3007, 0, 56, 2), "ok");
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].bytes[2], 0x04);
}

// --- start-up ---

class OiFrE5ncoCanopenStartup : public CanopenBench {};

TEST_F(OiFrE5ncoCanopenStartup, BitRateIsTheLowNibbleOfPr346) {
  using boards::oi_fr_e5nco::can_bit_rate;
  const std::uint32_t rates[] = {125'000, 1'000'000, 500'000, 250'000, 125'000, 100'000, 62'500,  50'000,
                                 20'000,  125'000,   125'000, 125'000, 125'000, 125'000, 125'000, 125'000};
  for (std::uint32_t raw = 0; raw < 256; ++raw) EXPECT_EQ(can_bit_rate(raw), rates[raw % 16]) << raw;
  EXPECT_EQ(can_bit_rate(132), 125'000u);  // the factory value, 84H
}

TEST_F(OiFrE5ncoCanopenStartup, NodeAndBitRateAreTakenAtPowerOnOnly) {
  EXPECT_EQ(bus().bit_rate(), 125'000u);  // this inverter has no Pr.346
  drive.parameters[346] = {0x81, 0, 255};
  drive.parameters[345].value = 7;
  tell("000#8100");
  EXPECT_EQ(bus().node(), 25);
  EXPECT_EQ(bus().bit_rate(), 125'000u);
  board->handle_power(now, false);
  EXPECT_EQ(bus().node(), 0);
  EXPECT_EQ(bus().bit_rate(), 0u);
  EXPECT_EQ(tell("000#8100"), "");
  power_on();
  EXPECT_EQ(taken(), "707#00");
  EXPECT_EQ(bus().node(), 7);
  EXPECT_EQ(bus().bit_rate(), 1'000'000u);
}

TEST_F(OiFrE5ncoCanopenStartup, SwitchesGiveTheNodeWithPr345At100) {
  drive.parameters[345].value = 100;
  ASSERT_TRUE(board->set_switch("SW1", 9));
  ASSERT_TRUE(board->set_switch("SW2", 9));
  power_cycle();
  EXPECT_EQ(taken(), "763#00");
  ASSERT_TRUE(board->set_switch("SW1", 0));
  ASSERT_TRUE(board->set_switch("SW2", 0));
  EXPECT_EQ(tell("763#R1"), "763#7F");
  power_cycle();
  EXPECT_EQ(taken(), "");
  EXPECT_EQ(bus().bit_rate(), 0u);
  EXPECT_EQ(board->status_led(), "red");
}

TEST_F(OiFrE5ncoCanopenStartup, LedShowsTheNmtState) {
  EXPECT_EQ(board->status_led(), "green flashing");
  tell("000#0119");
  EXPECT_EQ(board->status_led(), "green");
  tell("000#0219");
  EXPECT_EQ(board->status_led(), "red flashing");
  tell("000#8119");
  EXPECT_EQ(board->status_led(), "green flashing");
  bus().set_bus_off(now, true);
  EXPECT_EQ(board->status_led(), "red");
  bus().set_bus_off(now, false);
  EXPECT_EQ(board->status_led(), "green flashing");
  board->handle_power(now, false);
  EXPECT_EQ(board->status_led(), "off");
}

TEST_F(OiFrE5ncoCanopenStartup, PowerCycleForgetsEverything) {
  tell("000#0119");
  wait(5ms);
  drive.ticks_to_decide = 100;
  EXPECT_EQ(write(0x1005, 0, 0x90, 4), "ok");
  tell("219#02008813");
  power_cycle();
  drive.ticks_to_decide = 1;
  EXPECT_EQ(taken(), "719#00");
  drive.executed.clear();
  EXPECT_EQ(wait(200ms), "");
  EXPECT_TRUE(drive.executed.empty());
  EXPECT_EQ(read(0x1005), "=00000080");
  EXPECT_EQ(tell("719#R1"), "719#7F");
}

}  // namespace
}  // namespace vinv::test
