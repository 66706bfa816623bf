// Motor data, control supervisor, AC drive: values, units, commands. FR-A7NE manual, 4.7 and 7.4 to 7.6.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/option_boards/boards/fr_a7ne/unit_bench.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using port::NetTerminal;

class FrA7neDrive : public test::UnitBench {};

TEST_F(FrA7neDrive, MotorDataHasItsUnits) {
  drive.parameters[9] = {400, 0, 50000};
  drive.parameters[19] = {9999, 0, 0xFFFF};
  EXPECT_EQ(get(0x28, 1, 3), "00 07");
  EXPECT_EQ(set(0x28, 1, 3, "07"), "00");
  EXPECT_EQ(set(0x28, 1, 3, "03"), "09");
  EXPECT_EQ(get(0x28, 1, 6), "00 28 00");  // 4.00 A
  drive.parameters[9].value = 405;
  EXPECT_EQ(get(0x28, 1, 6), "00 29 00");  // rounded
  EXPECT_EQ(set(0x28, 1, 6, "2B 00"), "00");
  EXPECT_EQ(drive.parameters[9].value, 430u);
  EXPECT_EQ(set(0x28, 1, 6, "FF FF"), "09");
  drive.facts_now = {200, true};
  drive.parameters[9].value = 3000;
  EXPECT_EQ(get(0x28, 1, 6), "00 B8 0B");  // 300.0 A
  drive.parameters[19].value = 0xFFFF;
  EXPECT_EQ(get(0x28, 1, 7), "00 C8 00");
  drive.facts_now = {};
  drive.parameters[19].value = 0xFFF0;
  EXPECT_EQ(get(0x28, 1, 7), "00 90 01");
  drive.parameters[19].value = 2204;
  EXPECT_EQ(get(0x28, 1, 7), "00 DC 00");
  EXPECT_EQ(set(0x28, 1, 7, "E8 03"), "00");
  EXPECT_EQ(drive.parameters[19].value, 10000u);
  EXPECT_EQ(set(0x28, 1, 7, "E9 03"), "09");
  EXPECT_EQ(set(0x28, 1, 7, "F0 FF"), "00");
  EXPECT_EQ(drive.parameters[19].value, 0xFFF0u);
}

TEST_F(FrA7neDrive, Run1AndRun2AreTheStartSignals) {
  EXPECT_EQ(set(0x29, 1, 3, "01"), "00");
  EXPECT_TRUE(last(Kind::kCommand).terminals.has(NetTerminal::kStf));
  EXPECT_EQ(get(0x29, 1, 3), "00 01");
  EXPECT_EQ(set(0x29, 1, 4, "01"), "00");
  EXPECT_EQ(get(0x29, 1, 4), "00 01");
  EXPECT_EQ(set(0x29, 1, 3, "00"), "00");
  EXPECT_FALSE(last(Kind::kCommand).terminals.has(NetTerminal::kStf));
  EXPECT_EQ(get(0x29, 1, 3), "00 00");
  EXPECT_EQ(get(0x29, 1, 4), "00 01");
  EXPECT_EQ(set(0x29, 1, 3, "02"), "09");
  drive.mode = port::OperationMode::kExternal;
  tick();
  EXPECT_EQ(get(0x29, 1, 4), "00 00");
  EXPECT_EQ(set(0x29, 1, 3, "01"), "0C");
  EXPECT_EQ(get(0x29, 1, 3), "00 00");
}

// The run/stop events of the drive profile (CIP Vol 1, 6-29): Run1 and Run2 before and after, and what starts or stops.
TEST_F(FrA7neDrive, RunStopEventsAreThoseOfTheProfile) {
  struct Row {
    const char* name;
    std::vector<std::pair<unsigned, const char*>> writes;  // attribute, value
    bool forward, reverse;
  };
  for (const Row& row :
       {Row{"0 0", {{3, "01"}, {3, "00"}}, false, false}, Row{"0>1 0", {{3, "01"}}, true, false},
        Row{"0 0>1", {{4, "01"}}, false, true}, Row{"1 0>1", {{3, "01"}, {4, "01"}}, true, false},
        Row{"0>1 1", {{4, "01"}, {3, "01"}}, false, true}, Row{"1>0 1", {{3, "01"}, {4, "01"}, {3, "00"}}, false, true},
        Row{"1 1>0", {{4, "01"}, {3, "01"}, {4, "00"}}, true, false},
        Row{"all off", {{3, "01"}, {4, "01"}, {3, "00"}, {4, "00"}}, false, false}}) {
    EXPECT_EQ(set(0x2A, 1, 114, "00 00"), "00");
    for (const auto& [attribute, value] : row.writes) EXPECT_EQ(set(0x29, 1, attribute, value), "00") << row.name;
    EXPECT_EQ(last(Kind::kCommand).terminals.has(NetTerminal::kStf), row.forward) << row.name;
    EXPECT_EQ(last(Kind::kCommand).terminals.has(NetTerminal::kStr), row.reverse) << row.name;
  }
}

// Attribute 114 has the terminals themselves.
TEST_F(FrA7neDrive, RunCommandGivesBothStartSignalsToTheInverter) {
  EXPECT_EQ(set(0x2A, 1, 114, "06 00"), "00");
  EXPECT_TRUE(last(Kind::kCommand).terminals.has(NetTerminal::kStf));
  EXPECT_TRUE(last(Kind::kCommand).terminals.has(NetTerminal::kStr));
  EXPECT_EQ(get(0x29, 1, 3), "00 01");
  EXPECT_EQ(get(0x29, 1, 4), "00 01");
}

TEST_F(FrA7neDrive, RunCommandSetsEverySignal) {
  struct Row {
    const char* data;
    NetTerminal terminal;
  };
  for (const Row& row :
       {Row{"02 00", NetTerminal::kStf}, Row{"04 00", NetTerminal::kStr}, Row{"08 00", NetTerminal::kRh},
        Row{"10 00", NetTerminal::kRm}, Row{"20 00", NetTerminal::kRl}, Row{"40 00", NetTerminal::kJog},
        Row{"80 00", NetTerminal::kRt}, Row{"00 01", NetTerminal::kAu}, Row{"00 02", NetTerminal::kCs},
        Row{"00 04", NetTerminal::kMrs}, Row{"00 08", NetTerminal::kStop}, Row{"00 10", NetTerminal::kRes}}) {
    EXPECT_EQ(set(0x2A, 1, 114, row.data), "00") << row.data;
    EXPECT_EQ(last(Kind::kCommand).terminals.bits, static_cast<std::uint16_t>(row.terminal)) << row.data;
  }
  EXPECT_EQ(set(0x2A, 1, 114, "01 E0"), "00");
  EXPECT_EQ(last(Kind::kCommand).terminals.bits, 0);
}

TEST_F(FrA7neDrive, StatusWordHasItsBits) {
  EXPECT_EQ(get(0x2A, 1, 114), "00 00 00");
  const auto one = [&](bool port::Status::*flag) {
    drive.status_now = {};
    drive.status_now.*flag = true;
    return get(0x2A, 1, 114);
  };
  EXPECT_EQ(one(&port::Status::running), "00 01 00");
  EXPECT_EQ(one(&port::Status::forward), "00 02 00");
  EXPECT_EQ(one(&port::Status::reverse), "00 04 00");
  EXPECT_EQ(one(&port::Status::up_to_frequency), "00 08 00");
  EXPECT_EQ(one(&port::Status::overload), "00 10 00");
  EXPECT_EQ(one(&port::Status::power_failure), "00 20 00");
  EXPECT_EQ(one(&port::Status::frequency_detected), "00 40 00");
  EXPECT_EQ(one(&port::Status::alarm), "00 80 00");
  EXPECT_EQ(one(&port::Status::ready), "00 00 80");
}

TEST_F(FrA7neDrive, SupervisorStateFollowsTheDrive) {
  EXPECT_EQ(get(0x29, 1, 6), "00 03");
  EXPECT_EQ(get(0x29, 1, 9), "00 01");
  drive.status_now.running = drive.status_now.forward = true;
  EXPECT_EQ(get(0x29, 1, 6), "00 04");
  EXPECT_EQ(get(0x29, 1, 7), "00 01");
  EXPECT_EQ(get(0x29, 1, 8), "00 00");
  drive.status_now.stopping = true;
  EXPECT_EQ(get(0x29, 1, 6), "00 05");
  drive.status_now.fault_stop = true;
  EXPECT_EQ(get(0x29, 1, 6), "00 06");
  drive.status_now = {};
  drive.status_now.alarm = true;
  EXPECT_EQ(get(0x29, 1, 6), "00 07");
  EXPECT_EQ(get(0x29, 1, 9), "00 00");
  EXPECT_EQ(get(0x29, 1, 10), "00 01");
  drive.status_now.reverse = drive.status_now.running = true;
  EXPECT_EQ(get(0x29, 1, 8), "00 01");
}

// Pr.540 bit 11: the option goes on while the inverter is reset.
TEST_F(FrA7neDrive, StateIsNotReadyDuringAReset) {
  drive.parameters[540].value = 0x0800;
  power(false);
  power(true);
  drive.is_ready = false;
  EXPECT_EQ(get(0x29, 1, 6), "00 02");
  EXPECT_EQ(get(0x29, 1, 9), "00 00");
  EXPECT_EQ(set(0x29, 1, 3, "01"), "10");
}

TEST_F(FrA7neDrive, SourcesAreInverted) {
  EXPECT_EQ(get(0x29, 1, 5), "00 01");
  EXPECT_EQ(set(0x29, 1, 5, "00"), "00");
  EXPECT_EQ(drive.parameters[338].value, 1u);
  EXPECT_EQ(get(0x29, 1, 5), "00 00");
  EXPECT_EQ(set(0x2A, 1, 4, "00"), "00");
  EXPECT_EQ(drive.parameters[339].value, 1u);
  EXPECT_EQ(get(0x2A, 1, 4), "00 00");
  EXPECT_EQ(set(0x2A, 1, 4, "01"), "00");
  EXPECT_EQ(drive.parameters[339].value, 0u);
}

TEST_F(FrA7neDrive, SourceMonitorsNeedModeAndRights) {
  EXPECT_EQ(get(0x2A, 1, 29), "00 01");
  drive.parameters[339].value = 1;
  EXPECT_EQ(get(0x2A, 1, 29), "00 00");
  drive.parameters[339].value = 2;
  EXPECT_EQ(get(0x2A, 1, 29), "00 01");
  drive.parameters[550].value = 1;
  EXPECT_EQ(get(0x2A, 1, 29), "00 00");
  drive.parameters[550].value = 0;
  drive.mode = port::OperationMode::kPu;
  EXPECT_EQ(get(0x2A, 1, 29), "00 00");
  // CtrlFromNet is as at the last start (7.5.1 *2).
  EXPECT_EQ(get(0x29, 1, 15), "00 01");
  power(false);
  power(true);
  EXPECT_EQ(get(0x29, 1, 15), "00 00");
}

TEST_F(FrA7neDrive, AssemblySelectionGoesIntoPr346AndActsAfterTheNextStart) {
  EXPECT_EQ(get(0x29, 1, 140), "00 47");
  EXPECT_EQ(get(0x29, 1, 141), "00 15");
  EXPECT_EQ(set(0x29, 1, 140, "B0"), "00");
  EXPECT_EQ(set(0x29, 1, 141, "7E"), "00");
  EXPECT_EQ(drive.parameters[346].value, 792u);
  EXPECT_EQ(set(0x29, 1, 141, "15"), "00");
  EXPECT_EQ(set(0x29, 1, 141, "7E"), "00");
  EXPECT_EQ(get(0x29, 1, 140), "00 47");
  EXPECT_EQ(set(0x29, 1, 140, "15"), "09");
  EXPECT_EQ(set(0x29, 1, 141, "46"), "09");
  power(false);
  power(true);
  EXPECT_EQ(get(0x29, 1, 140), "00 B0");
  EXPECT_EQ(get(0x29, 1, 141), "00 7E");
  EXPECT_EQ(unit.consumed_size(126), 6u);
  EXPECT_FALSE(unit.consumed_size(21).has_value());
}

TEST_F(FrA7neDrive, FaultResetActsOncePerEdge) {
  drive.status_now.alarm = true;
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");
  EXPECT_FALSE(drive.status_now.alarm);
  EXPECT_EQ(get(0x29, 1, 12), "00 01");
  drive.status_now.alarm = true;
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");
  EXPECT_TRUE(drive.status_now.alarm);
  EXPECT_EQ(set(0x29, 1, 12, "00"), "00");
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");
  EXPECT_FALSE(drive.status_now.alarm);
  EXPECT_EQ(set(0x29, 1, 12, "00"), "00");
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");  // no alarm, no function
  EXPECT_EQ(count(Kind::kErrorReset), 2u);
}

// 4.6: Pr.349 and line errors.
TEST_F(FrA7neDrive, FaultResetNeedsNetworkOperationWithPr349) {
  drive.parameters[349].value = 1;
  drive.mode = port::OperationMode::kExternal;
  drive.status_now.alarm = true;
  EXPECT_EQ(set(0x29, 1, 12, "01"), "0C");
  drive.parameters[349].value = 0;
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");
  EXPECT_FALSE(drive.status_now.alarm);
  EXPECT_EQ(set(0x29, 1, 12, "00"), "00");
  drive.status_now.alarm = true;
  open_owner();
  unit.on_connection(now, owner(), cip::IoEvent::kTimedOut);
  EXPECT_EQ(set(0x29, 1, 12, "01"), "0C");
}

// 4.7, column "Running speed monitor".
TEST_F(FrA7neDrive, SpeedsFollowPr37AndPr144) {
  drive.monitors[1] = 3000;  // 30.00 Hz
  const auto speed = [&](std::uint32_t pr37, std::uint32_t pr144) {
    drive.parameters[37].value = pr37;
    drive.parameters[144].value = pr144;
    return get(0x2A, 1, 7);
  };
  EXPECT_EQ(speed(0, 0), "00 84 03");  // 900
  EXPECT_EQ(speed(0, 2), "00 08 07");  // 1800
  EXPECT_EQ(speed(0, 4), "00 84 03");
  EXPECT_EQ(speed(0, 6), "00 58 02");   // 600
  EXPECT_EQ(speed(0, 10), "00 68 01");  // 360
  EXPECT_EQ(speed(0, 102), "00 08 07");
  EXPECT_EQ(speed(0, 110), "00 68 01");
  EXPECT_EQ(speed(1000, 0), "00 F4 01");  // 500: 1000 at Pr.505 = 60 Hz
  EXPECT_EQ(speed(1000, 4), "00 F4 01");
  EXPECT_EQ(speed(1000, 104), "00 84 03");
  drive.parameters[505] = {5000, 100, 12000};
  EXPECT_EQ(speed(1000, 4), "00 58 02");
  drive.monitors[1] = 0xFFFF;
  EXPECT_EQ(speed(9998, 4), "00 FF 7F");
}

TEST_F(FrA7neDrive, SpeedReferenceIsAFrequency) {
  EXPECT_EQ(set(0x2A, 1, 8, "DC 05"), "00");  // 1500 r/min
  EXPECT_EQ(last(Kind::kFrequency).value, 5000u);
  EXPECT_EQ(get(0x2A, 1, 8), "00 DC 05");
  EXPECT_EQ(get(0x2A, 1, 112), "00 88 13");
  EXPECT_EQ(set(0x2A, 1, 8, "FF FF"), "09");
  EXPECT_EQ(set(0x2A, 1, 8, "FF 7F"), "09");
  EXPECT_EQ(set(0x2A, 1, 112, "40 9C"), "00");
  EXPECT_EQ(last(Kind::kFrequency).value, 40000u);
  EXPECT_EQ(set(0x2A, 1, 112, "41 9C"), "09");
  EXPECT_EQ(set(0x2A, 1, 113, "88 13"), "00");
  EXPECT_EQ(last(Kind::kStoredFrequency).value, 5000u);
  EXPECT_EQ(get(0x2A, 1, 113), "14");
  EXPECT_EQ(get(0x2A, 1, 112), "00 88 13");
}

TEST_F(FrA7neDrive, MonitorsOfTheProfileHaveItsUnits) {
  drive.monitors[2] = 255;   // 2.55 A
  drive.monitors[3] = 2003;  // 200.3 V
  drive.monitors[14] = 150;  // 1.50 kW
  EXPECT_EQ(get(0x2A, 1, 9), "00 1A 00");
  EXPECT_EQ(get(0x2A, 1, 17), "00 C8 00");
  EXPECT_EQ(get(0x2A, 1, 15), "00 DC 05");
  drive.facts_now.coarse = true;
  EXPECT_EQ(get(0x2A, 1, 9), "00 FF 00");
  EXPECT_EQ(get(0x2A, 1, 15), "00 98 3A");
  drive.monitors[14] = 1000;
  EXPECT_EQ(get(0x2A, 1, 15), "00 FF FF");
  EXPECT_EQ(get(0x2A, 1, 6), "00 00");
  drive.status_now.up_to_frequency = true;
  EXPECT_EQ(get(0x2A, 1, 3), "00 01");
}

TEST_F(FrA7neDrive, RampTimesAreScaledByTheFrequencies) {
  drive.parameters[1] = {12000, 0, 12000};
  drive.parameters[20] = {6000, 100, 40000};
  drive.parameters[21] = {0, 0, 1};
  drive.parameters[7] = {50, 0, 36000};     // 5.0 s
  drive.parameters[8] = {3600, 0, 36000};   // 360.0 s
  EXPECT_EQ(get(0x2A, 1, 18), "00 10 27");  // 10000 ms
  EXPECT_EQ(get(0x2A, 1, 19), "00 FF FF");
  EXPECT_EQ(set(0x2A, 1, 18, "A0 0F"), "00");  // 4000 ms
  EXPECT_EQ(drive.parameters[7].value, 20u);
  drive.parameters[21].value = 1;
  EXPECT_EQ(set(0x2A, 1, 19, "A0 0F"), "00");
  EXPECT_EQ(drive.parameters[8].value, 200u);
  EXPECT_EQ(get(0x2A, 1, 19), "00 A0 0F");
  drive.parameters[1].value = 0;
  EXPECT_EQ(set(0x2A, 1, 18, "A0 0F"), "0C");
}

TEST_F(FrA7neDrive, SpeedLimitsAreParameters1And2) {
  drive.parameters[2] = {600, 0, 12000};
  EXPECT_EQ(get(0x2A, 1, 20), "00 B4 00");  // 180 r/min
  EXPECT_EQ(get(0x2A, 1, 21), "00 10 0E");  // 3600 r/min
  EXPECT_EQ(set(0x2A, 1, 21, "B8 0B"), "00");
  EXPECT_EQ(drive.parameters[1].value, 10000u);
  EXPECT_EQ(set(0x2A, 1, 21, "FF FF"), "09");
}

TEST_F(FrA7neDrive, OperationModeIsReadAndWritten) {
  EXPECT_EQ(get(0x2A, 1, 120), "00 04 00");
  EXPECT_EQ(set(0x2A, 1, 120, "10 00"), "00");
  EXPECT_EQ(get(0x2A, 1, 120), "00 00 00");
  drive.jogs = true;
  EXPECT_EQ(get(0x2A, 1, 120), "00 02 00");
  EXPECT_EQ(set(0x2A, 1, 120, "11 00"), "0C");
  drive.parameters[79].value = 6;
  EXPECT_EQ(set(0x2A, 1, 120, "11 00"), "00");
  EXPECT_EQ(get(0x2A, 1, 120), "00 03 00");
  drive.jogs = false;
  EXPECT_EQ(get(0x2A, 1, 120), "00 01 00");
  drive.mode = port::OperationMode::kCombined1;
  EXPECT_EQ(get(0x2A, 1, 120), "00 05 00");
  EXPECT_EQ(set(0x2A, 1, 120, "14 00"), "00");
  EXPECT_EQ(drive.mode, port::OperationMode::kNetwork);
  EXPECT_EQ(set(0x2A, 1, 120, "12 00"), "09");
  EXPECT_EQ(set(0x2A, 1, 120, "04 00"), "09");
  EXPECT_EQ(set(0x2A, 1, 120, "10"), "13");
  drive.status_now.running = true;
  EXPECT_EQ(set(0x2A, 1, 120, "10 00"), "0C");
}

TEST_F(FrA7neDrive, AlarmHistoryIsReadAndCleared) {
  drive.history = {0xA3, 0x10, 0x20, 0x30, 0x40, 0x50, 0x60, 0x70};
  EXPECT_EQ(get(0x2A, 1, 141), "00 A3 00");
  EXPECT_EQ(get(0x2A, 1, 142), "00 10 00");
  EXPECT_EQ(get(0x2A, 1, 148), "00 70 00");
  EXPECT_EQ(set(0x2A, 1, 142, "00 00"), "0E");
  EXPECT_EQ(set(0x2A, 1, 141, "05 00"), "00");
  EXPECT_EQ(get(0x2A, 1, 141), "00 00 00");
}

TEST_F(FrA7neDrive, ClearsTakeTheirCodes) {
  struct Row {
    unsigned attribute;
    const char* code;
    std::uint32_t value;
  };
  for (const Row& row : {Row{102, "5A 96", 0}, Row{103, "AA 99", 1}, Row{105, "96 5A", 2}, Row{106, "99 AA", 3}}) {
    EXPECT_EQ(set(0x2A, 1, row.attribute, row.code), "00") << row.attribute;
    EXPECT_EQ(last(Kind::kRestoreDefaults).value, row.value);
    EXPECT_EQ(set(0x2A, 1, row.attribute, "00 00"), "09");
    EXPECT_EQ(get(0x2A, 1, row.attribute), "14");
  }
}

// 7.5.1, attribute 6: 1 until the inverter has been ready once, 2 while it is reset.
TEST_F(FrA7neDrive, StateIsStartupOnlyAfterPowerOn) {
  drive.is_ready = false;
  tick(3);
  EXPECT_FALSE(unit.online());
  EXPECT_EQ(request(get_request(0x29, 1, 6)), "00 02");
  power(false);
  power(true);
  EXPECT_EQ(request(get_request(0x29, 1, 6)), "00 01");
  EXPECT_EQ(request(set_request(0x29, 1, 3, "01")), "10") << "not started";
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(FrA7neDrive, RefusedRunCommandsLeaveWhatWasOn) {
  EXPECT_EQ(set(0x29, 1, 3, "01"), "00");
  drive.refuse_decision = port::Refusal::kWrongMode;
  EXPECT_EQ(set(0x29, 1, 3, "00"), "0C");
  EXPECT_EQ(get(0x29, 1, 3), "00 01");
  EXPECT_EQ(set(0x29, 1, 4, "01"), "0C");
  EXPECT_EQ(get(0x29, 1, 4), "00 00");
}

TEST_F(FrA7neDrive, LargestCurrentIsThatOfTheType) {
  drive.facts_now.coarse = true;
  drive.monitors[2] = 65535;
  EXPECT_EQ(get(0x2A, 1, 9), "00 FF 7F");
}

TEST_F(FrA7neDrive, SourceIsTheNetworkWith0Only) {
  drive.parameters[339].value = 2;
  EXPECT_EQ(get(0x2A, 1, 4), "00 00");
}

TEST_F(FrA7neDrive, FaultResetWithoutAnAlarmIsTakenEverywhere) {
  drive.parameters[349].value = 1;
  drive.mode = port::OperationMode::kPu;
  EXPECT_EQ(set(0x29, 1, 12, "01"), "00");
  EXPECT_TRUE(drive.posted.empty());
}

// 4.2.1: with key bits Pr.346 acts as 132, so that is what changes.
TEST_F(FrA7neDrive, AssemblySelectionTakesTheKeyBitsAway) {
  drive.parameters[346] = {0x1318, 0, 0xFFFF};
  EXPECT_EQ(set(0x29, 1, 141, "14"), "00");
  EXPECT_EQ(drive.parameters[346].value, 0x80u);
}

}  // namespace
}  // namespace vinv::boards::fr_a7ne
