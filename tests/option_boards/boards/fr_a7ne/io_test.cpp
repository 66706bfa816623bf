// Polled data, bit by bit. FR-A7NE manual, 6.2.1 and 7.2.
#include <gtest/gtest.h>

#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using port::NetTerminal;

constexpr std::uint32_t kPr346For20 = 0, kPr346For21 = 132, kPr346For126 = 792, kPr346For129 = 924;

class FrA7neIo : public test::UnitBench {
 protected:
  std::uint16_t terminals() const { return last(Kind::kCommand).terminals.bits; }
  static std::uint16_t bit(NetTerminal t) { return static_cast<std::uint16_t>(t); }
};

TEST_F(FrA7neIo, SelectedPairIsServed) {
  struct Row {
    std::uint32_t pr346, output, input;
    std::size_t bytes;
  };
  for (const Row& row :
       {Row{kPr346For20, 20, 70, 4}, Row{kPr346For21, 21, 71, 4}, Row{kPr346For126, 126, 176, 6},
        Row{kPr346For129, 129, 179, 6}, Row{0x1000 | kPr346For126, 21, 71, 4}, Row{2u << 2 | 31u << 7, 21, 71, 4}}) {
    select(row.pr346);
    for (const std::uint32_t point : {20u, 21u, 126u, 129u, 70u, 71u, 176u, 179u, 0u, 100u}) {
      EXPECT_EQ(unit.consumed_size(point), point == row.output ? std::optional(row.bytes) : std::nullopt) << point;
      EXPECT_EQ(unit.produced_size(point), point == row.input ? std::optional(row.bytes) : std::nullopt) << point;
    }
    EXPECT_TRUE(unit.goes_with(row.output, row.input));
    EXPECT_FALSE(unit.goes_with(row.output, row.input + 1));
  }
  EXPECT_EQ(unit.consumed_size(Unit::kInputOnlyPoint), 0u);
  EXPECT_TRUE(unit.is_heartbeat(Unit::kListenOnlyPoint, cip::IoRole::kListenOnly));
  EXPECT_FALSE(unit.is_heartbeat(Unit::kListenOnlyPoint, cip::IoRole::kInputOnly));
  EXPECT_TRUE(unit.is_heartbeat(Unit::kInputOnlyPoint, cip::IoRole::kInputOnly));
  EXPECT_FALSE(unit.is_heartbeat(Unit::kInputOnlyPoint, cip::IoRole::kListenOnly));
  EXPECT_TRUE(unit.configure(now, 1, {}).ok());
  EXPECT_EQ(unit.configure(now, 1, Bytes{0}), cip::Status(cip::GeneralStatus::kTooMuchData));
  power(false);
  output(21, "61 00 DC 05");
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_FALSE(unit.consumed_size(129).has_value());
  EXPECT_FALSE(unit.produced_size(179).has_value());
}

TEST_F(FrA7neIo, Output20HasForwardAndSpeed) {
  select(kPr346For20);
  output(20, "01 00 DC 05");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
  output(20, "FE 00 00 00");
  EXPECT_EQ(terminals(), 0);
  EXPECT_EQ(last(Kind::kFrequency).value, 0u);
}

TEST_F(FrA7neIo, Output21HasPermissionBits) {
  select(kPr346For21);
  output(21, "61 00 DC 05");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
  output(21, "62 00 EE 02");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStr));
  EXPECT_EQ(last(Kind::kFrequency).value, 2500u);
  output(21, "22 00 DC 05");  // NetRef off
  EXPECT_EQ(last(Kind::kFrequency).value, 2500u);
  output(21, "41 00 DC 05");  // NetCtrl off: what it had on goes off
  EXPECT_EQ(terminals(), 0);
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
  const std::size_t commands = count(Kind::kCommand);
  output(21, "42 00 DC 05");  // no function
  EXPECT_EQ(count(Kind::kCommand), commands);
}

// Run Fwd and Run Rev are attributes 3 and 4 of class 0x29: the events of the profile.
TEST_F(FrA7neIo, PolledRunBitsFollowTheRunStopEvents) {
  select(kPr346For21);
  output(21, "23 00 00 00");  // both at once: nothing starts
  EXPECT_EQ(terminals(), 0);
  output(21, "21 00 00 00");  // what stays starts
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
  output(21, "23 00 00 00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
  output(21, "22 00 00 00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStr));
  output(21, "20 00 00 00");
  EXPECT_EQ(terminals(), 0);
}

// Neither is lost when both are on their way to the inverter at once.
TEST_F(FrA7neIo, PolledCommandKeepsTheExplicitOneThatIsUnderWay) {
  select(kPr346For129);
  drive.ticks_to_decide = 3;
  EXPECT_EQ(request("10 03 20 29 24 01 30 03 01"), "later");
  output(129, "00 10 00 00 00 00");
  tick(10);
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf) | bit(NetTerminal::kRh));
}

TEST_F(FrA7neIo, RunBitsWithoutPermissionLeaveExplicitCommandsAlone) {
  select(kPr346For21);
  EXPECT_EQ(set(0x29, 1, 3, "01"), "00");
  output(21, "02 00 00 00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
  EXPECT_EQ(get(0x29, 1, 3), "00 01");
}

TEST_F(FrA7neIo, PolledAndExplicitCommandsTheLastOneCounts) {
  select(kPr346For21);
  output(21, "21 00 00 00");
  EXPECT_EQ(get(0x29, 1, 3), "00 01");
  EXPECT_EQ(set(0x29, 1, 3, "00"), "00");
  EXPECT_EQ(terminals(), 0);
  output(21, "21 00 00 00");  // has not changed: not accepted (6.2.1)
  EXPECT_EQ(terminals(), 0);
  output(21, "22 00 00 00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStr));
}

// 6.2.1: accepted only when it changes.
TEST_F(FrA7neIo, DataThatWasRefusedActsAfterItChanges) {
  select(kPr346For21);
  drive.mode = port::OperationMode::kExternal;
  output(21, "61 00 DC 05");
  EXPECT_EQ(count(Kind::kCommand), 0u);
  drive.mode = port::OperationMode::kNetwork;
  output(21, "61 00 DC 05");
  EXPECT_EQ(count(Kind::kCommand), 0u);
  output(21, "61 00 DD 05");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
}

TEST_F(FrA7neIo, NewOwnersFirstDataActs) {
  select(kPr346For21);
  output(21, "21 00 00 00");
  EXPECT_EQ(count(Kind::kCommand), 1u);
  unit.on_connection(now, owner(), cip::IoEvent::kClosed);
  open_owner();
  output(21, "21 00 00 00");
  EXPECT_EQ(count(Kind::kCommand), 2u);
}

TEST_F(FrA7neIo, FaultResetActsOnItsEdgeWithPermission) {
  select(kPr346For21);
  drive.status_now.alarm = true;
  output(21, "04 00 00 00");
  EXPECT_TRUE(drive.status_now.alarm);
  output(21, "24 00 00 00");
  EXPECT_FALSE(drive.status_now.alarm);
  drive.status_now.alarm = true;
  output(21, "24 00 01 00");
  EXPECT_TRUE(drive.status_now.alarm);
  output(21, "20 00 01 00");
  drive.mode = port::OperationMode::kPu;
  drive.parameters[349].value = 1;
  output(21, "24 00 01 00");
  EXPECT_TRUE(drive.status_now.alarm);
  drive.parameters[349].value = 0;
  output(21, "20 00 01 00");
  output(21, "24 00 01 00");
  EXPECT_FALSE(drive.status_now.alarm);
}

TEST_F(FrA7neIo, IdleTakesTheRunBitsAway) {
  select(kPr346For21);
  output(21, "61 00 DC 05");
  output(21, "61 00 DC 05", cip::RunMode::kIdle);
  EXPECT_EQ(terminals(), 0);
  output(21, "61 00 F4 01", cip::RunMode::kIdle);
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
  output(21, "61 00 DC 05");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
}

TEST_F(FrA7neIo, DataOfTheWrongPointOrSizeIsIgnored) {
  select(kPr346For21);
  output(20, "01 00 DC 05");
  output(21, "61 00 DC");
  output(21, "61 00 DC 05 00");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(FrA7neIo, Output126WritesAndReadsParameters) {
  select(kPr346For126);
  drive.parameters[7].value = 50;
  output(126, "00 00 00 00 66 11");
  EXPECT_EQ(input(176).substr(12), "32 00");
  EXPECT_EQ(input(176).substr(3, 2), "00");
  drive.ticks_to_decide = 20;
  output(126, "80 01 64 00 66 11");
  EXPECT_EQ(input(176).substr(3, 2), "80");  // PrEnd
  tick(20);
  EXPECT_EQ(drive.parameters[7].value, 100u);
  EXPECT_EQ(input(176).substr(12), "64 00");
  tick(100);
  EXPECT_EQ(input(176).substr(3, 2), "00");
  // WriteParam takes the place of the speed, whatever NetRef says.
  const std::size_t speeds = count(Kind::kFrequency);
  output(126, "C0 01 65 00 66 11");
  EXPECT_EQ(count(Kind::kFrequency), speeds);
  tick(200);
  output(126, "40 01 DC 05 66 11");
  tick(20);
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
}

TEST_F(FrA7neIo, Output126ReachesOtherClassesAndInstances) {
  select(kPr346For126);
  drive.calibration[{902, 2}] = {77, 0, 1000};
  output(126, "00 02 00 00 79 0C");
  EXPECT_EQ(input(176).substr(12), "4D 00");
  output(126, "80 01 00 00 29 05");
  tick(100);
  EXPECT_EQ(drive.parameters[338].value, 1u);
  output(126, "00 00 00 00 01 07");  // a text has no room
  EXPECT_EQ(input(176).substr(12), "00 00");
  output(126, "00 00 00 00 99 07");
  EXPECT_EQ(input(176).substr(12), "00 00");
  const std::size_t posted = drive.posted.size();
  output(126, "80 01 05 00 66 59");  // Pr.79 is Get
  tick(100);
  EXPECT_EQ(drive.posted.size(), posted);
}

TEST_F(FrA7neIo, PolledParameterWriteWaitsForAnExplicitOne) {
  select(kPr346For126);
  EXPECT_EQ(request("10 03 20 66 24 01 30 0A 32 00"), "later");
  output(126, "80 01 64 00 66 11");
  EXPECT_EQ(poll(), "00");
  EXPECT_NE(drive.parameters[7].value, 100u);
  tick(100);
  EXPECT_EQ(drive.parameters[7].value, 100u);
}

TEST_F(FrA7neIo, Output129SetsSignalsAndPr496) {
  select(kPr346For129);
  struct Row {
    const char* data;
    NetTerminal terminal;
  };
  for (const Row& row : {Row{"00 01 00 00 00 00", NetTerminal::kAu}, Row{"00 02 00 00 00 00", NetTerminal::kRt},
                         Row{"00 04 00 00 00 00", NetTerminal::kRl}, Row{"00 08 00 00 00 00", NetTerminal::kRm},
                         Row{"00 10 00 00 00 00", NetTerminal::kRh}, Row{"00 20 00 00 00 00", NetTerminal::kJog},
                         Row{"00 40 00 00 00 00", NetTerminal::kMrs}, Row{"00 80 00 00 00 00", NetTerminal::kStop},
                         Row{"80 00 00 00 00 00", NetTerminal::kOutputStop},
                         Row{"21 00 00 00 00 00", NetTerminal::kStf}, Row{"22 00 00 00 00 00", NetTerminal::kStr}}) {
    output(129, row.data);
    EXPECT_EQ(terminals(), bit(row.terminal)) << row.data;
  }
  output(129, "00 00 00 00 00 05");
  EXPECT_EQ(drive.parameters[496].value, 5u);
  const std::size_t writes = count(Kind::kParameter);
  output(129, "00 01 00 00 00 05");
  EXPECT_EQ(count(Kind::kParameter), writes);
  output(129, "00 00 00 00 00 00");
  EXPECT_EQ(drive.parameters[496].value, 0u);
}

TEST_F(FrA7neIo, Input179GivesTerminalsAndTheSelectedMonitor) {
  select(kPr346For129);
  drive.monitors = {{1, 3000}, {2, 250}, {3, 2000}, {4, 9}, {15, 0x03FF}, {60, 0x1234}};
  output(129, "00 00 00 00 02 00");
  EXPECT_EQ(input(179).substr(3), "FF 84 03 FA 00");
  output(129, "00 00 00 00 3C 00");
  EXPECT_EQ(input(179).substr(12), "34 12");
  for (const char* none : {"00", "04", "15", "1A", "30", "37", "3D", "FF"}) {
    output(129, std::string("00 00 00 00 ") + none + " 00");
    EXPECT_EQ(input(179).substr(12), "00 00") << none;
  }
  drive.monitors[15] = 0x0003;  // STF and STR are not in byte 1
  EXPECT_EQ(input(179).substr(3, 2), "00");
  drive.monitors[15] = 1u << 8;
  EXPECT_EQ(input(179).substr(3, 2), "40");  // MRS
}

TEST_F(FrA7neIo, StatusBitsOfEachInput) {
  struct Row {
    const char* what;
    void (*make)(test::FakeDrive&);
    const char *in70, *in71, *in176;
  };
  using Drive = test::FakeDrive;
  const Row rows[] = {
      {"standing, from the network", [](Drive&) {}, "00", "70", "72"},
      {"fault", [](Drive& d) { d.status_now.alarm = true; }, "01", "71", "73"},
      {"forward", [](Drive& d) { d.status_now.running = d.status_now.forward = true; }, "04", "74", "76"},
      {"reverse", [](Drive& d) { d.status_now.running = d.status_now.reverse = true; }, "00", "78", "7A"},
      {"at speed", [](Drive& d) { d.status_now.up_to_frequency = true; }, "00", "F0", "F2"},
      {"Pr.338", [](Drive& d) { d.parameters[338].value = 1; }, "00", "50", "50"},
      {"Pr.339", [](Drive& d) { d.parameters[339].value = 1; }, "00", "30", "30"},
      {"both", [](Drive& d) { d.parameters[338].value = d.parameters[339].value = 1; }, "00", "10", "10"},
      {"Pr.339 = 2", [](Drive& d) { d.parameters[339].value = 2; }, "00", "70", "70"},
      {"external", [](Drive& d) { d.mode = port::OperationMode::kExternal; }, "00", "10", "10"},
      {"Pr.550", [](Drive& d) { d.parameters[550].value = 1; }, "00", "10", "10"},
  };
  for (const Row& row : rows) {
    const test::FakeDrive before = drive;
    row.make(drive);
    EXPECT_EQ(get(4, 70, 3).substr(3, 2), row.in70) << row.what;
    EXPECT_EQ(get(4, 71, 3).substr(3, 2), row.in71) << row.what;
    EXPECT_EQ(get(4, 176, 3).substr(3, 2), row.in176) << row.what;
    EXPECT_EQ(get(4, 179, 3).substr(3, 2), row.in176) << row.what;
    drive = before;
  }
  drive.monitors[1] = 5000;
  EXPECT_EQ(get(4, 71, 3), "00 70 00 DC 05");
  EXPECT_EQ(get(4, 70, 3), "00 00 00 DC 05");
}

TEST_F(FrA7neIo, OutputInstancesReadBackWhatWasPolled) {
  select(kPr346For21);
  output(21, "61 00 DC 05");
  EXPECT_EQ(get(4, 21, 3), "00 61 00 DC 05");
  EXPECT_EQ(get(4, 126, 3), "00 00 00 00 00 00 00");
  EXPECT_EQ(set(4, 21, 3, "61 00 DC 05"), "08");
}

TEST_F(FrA7neIo, VersionChangesWithTheInputData) {
  select(kPr346For21);
  tick();
  const std::uint32_t before = unit.produced_version(71);
  tick(5);
  EXPECT_EQ(unit.produced_version(71), before);
  drive.monitors[1] = 100;
  tick();
  EXPECT_NE(unit.produced_version(71), before);
}

TEST_F(FrA7neIo, PolledWritesDoNotStarveExplicitOnes) {
  select(kPr346For21);
  // Always something new to write, before the inverter has taken the last one.
  std::uint8_t speed = 0;
  const auto poll_more = [&] { unit.consume(now, 21, Bytes{0x61, 0, ++speed, 1}, cip::RunMode::kRun); };
  poll_more();
  EXPECT_EQ(request("10 03 20 66 24 01 30 11 14 00"), "later");
  std::string answer;
  for (unsigned i = 0; i < 10 && answer.empty(); ++i) {
    poll_more();
    tick();
    answer = poll();
  }
  EXPECT_EQ(answer, "00");
  EXPECT_GT(count(Kind::kCommand), 0u);
}

// 7.2.1, the list of monitors.
TEST_F(FrA7neIo, MonitorSelectionHasWhatTheListHas) {
  select(kPr346For129);
  for (unsigned number = 0; number <= 255; ++number) drive.monitors[number] = 0x0101;
  std::string listed;
  for (unsigned number = 0; number <= 255; ++number) {
    output(129, "00 00 00 00 " + test::to_hex(Bytes{static_cast<std::uint8_t>(number)}) + " 00");
    if (input(179).substr(12) == "01 01") listed += test::to_hex(Bytes{static_cast<std::uint8_t>(number)}) + " ";
  }
  EXPECT_EQ(
      listed,
      "01 02 03 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10 11 12 13 14 16 17 18 19 20 21 22 23 32 33 34 35 36 3A 3B 3C ");
}

TEST_F(FrA7neIo, SignalsOf129StayWithIdleAndWithExplicitRunCommands) {
  select(kPr346For129);
  output(129, "21 10 00 00 00 00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf) | bit(NetTerminal::kRh));
  output(129, "21 08 00 00 00 00", cip::RunMode::kIdle);
  EXPECT_EQ(terminals(), bit(NetTerminal::kRh)) << "what comes with idle is no command";
  EXPECT_EQ(set(0x29, 1, 4, "01"), "00");
  EXPECT_EQ(terminals(), bit(NetTerminal::kStr) | bit(NetTerminal::kRh));
}

TEST_F(FrA7neIo, StartBitsWithoutPr338AreNone) {
  select(kPr346For21);
  drive.parameters[338].value = 1;
  output(21, "21 00 00 00");
  EXPECT_EQ(terminals(), 0);
}

TEST_F(FrA7neIo, PolledSpeedEndsAt400Hz) {
  select(kPr346For21);
  output(21, "40 00 FF FF");
  EXPECT_EQ(last(Kind::kFrequency).value, 40000u);
}

TEST_F(FrA7neIo, ParameterDataOf126IsNoSpeed) {
  select(kPr346For126);
  output(126, "C0 00 14 00 66 11");
  EXPECT_EQ(count(Kind::kFrequency), 0u);
  EXPECT_EQ(last(Kind::kParameter).value, 20u);
}

// 7.2.2: "forward rotation" is of the output, not of the command.
TEST_F(FrA7neIo, RunningBitsNeedTheOutput) {
  drive.status_now.forward = true;
  EXPECT_EQ(get(4, 71, 3).substr(3, 2), "70");
  drive.status_now.forward = false;
  drive.status_now.reverse = true;
  EXPECT_EQ(get(4, 71, 3).substr(3, 2), "70");
}

TEST_F(FrA7neIo, PolledWriteWaitsForATakenMailbox) {
  select(kPr346For21);
  drive.refuse_post = port::Refusal::kBusy;
  output(21, "21 00 00 00");
  EXPECT_EQ(count(Kind::kCommand), 0u);
  drive.refuse_post.reset();
  tick(3);
  EXPECT_EQ(terminals(), bit(NetTerminal::kStf));
}

// 7.2.1: valid only at an inverter trip; a bit that is on already when it comes is no edge.
TEST_F(FrA7neIo, FaultResetWithoutAnAlarmIsNone) {
  select(kPr346For21);
  output(21, "24 00 00 00");
  EXPECT_EQ(drive.posted.size(), 1u) << "the run command";
  drive.status_now.alarm = true;
  output(21, "24 00 01 00");
  EXPECT_TRUE(drive.status_now.alarm);
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
