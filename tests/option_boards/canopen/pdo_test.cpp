// PDOs: every transmission type, times, remote requests, mapping; SYNC. CiA DS-301 v4.0, 9.2.1, 9.2.3, 9.6.3.
#include "tests/option_boards/canopen/slave_bench.hpp"

namespace vinv::test {
namespace {

using canopen::PdoFault;

class CanopenSlaveRpdo : public SlaveBench {
 protected:
  CanopenSlaveRpdo() { drain(); }
};

TEST_F(CanopenSlaveRpdo, AsynchronousTypesActAtOnce) {
  for (const std::uint32_t type : {254u, 255u}) {
    tell("000#8005");
    EXPECT_EQ(write(0x1400, 2, type, 1), "ok");
    tell("000#0105");
    writes.clear();
    tell("205#01000200");
    EXPECT_EQ(writes.size(), 2u) << type;
  }
}

TEST_F(CanopenSlaveRpdo, SynchronousTypesActAtTheNextSync) {
  for (std::uint32_t type = 0; type <= 240; ++type) {
    tell("000#8005");
    EXPECT_EQ(write(0x1400, 2, type, 1), "ok");
    tell("000#0105");
    writes.clear();
    tell("205#01000200");
    tell("205#03000400");
    EXPECT_TRUE(writes.empty());
    tell("080#");
    EXPECT_EQ(writes, (std::vector<std::string>{"pdo 2000 0003", "pdo 2001 0004"})) << type;
    tell("080#");
    EXPECT_EQ(writes.size(), 2u);  // once
  }
}

TEST_F(CanopenSlaveRpdo, ReservedAndRtrTypesAreRefused) {
  for (std::uint32_t type = 241; type <= 253; ++type) EXPECT_EQ(write(0x1400, 2, type, 1), "06090030") << type;
}

TEST_F(CanopenSlaveRpdo, WhatWaitsForASyncIsForgottenOutsideOperational) {
  write(0x1400, 2, 1, 1);
  tell("000#0105");
  tell("205#01000200");
  tell("000#8005");
  tell("000#0105");
  tell("080#");
  EXPECT_TRUE(writes.empty());
}

TEST_F(CanopenSlaveRpdo, ShortFrameIsAFaultOnceUntilAGoodOneComes) {
  tell("000#0105");
  for (const char* text : {"205#", "205#01", "205#0100", "205#010002"}) tell(text);
  EXPECT_TRUE(writes.empty());
  EXPECT_EQ(faults, (std::vector<std::pair<PdoFault, unsigned>>{{PdoFault::kRpdoTooShort, 0}}));
  tell("205#01000200");
  EXPECT_EQ(faults.back().first, PdoFault::kRpdoGoodAgain);
  EXPECT_EQ(writes.size(), 2u);
  for (const char* text : {"205#0100020005", "205#010002000506", "205#01000200050607", "205#0100020005060708"}) {
    tell(text);
  }
  EXPECT_EQ(writes.size(), 10u);  // longer ones are taken, the rest is not used
  EXPECT_EQ(faults.size(), 2u);
}

TEST_F(CanopenSlaveRpdo, RemoteFramesAndInvalidPdosDoNothing) {
  tell("000#0105");
  tell("205#R4");
  tell("305#01000200");
  EXPECT_EQ(write(0x1400, 1, 0x80000205, 4), "ok");
  tell("205#01000200");
  EXPECT_TRUE(writes.empty());
  EXPECT_TRUE(faults.empty());
}

TEST_F(CanopenSlaveRpdo, CobIdMovesWhenThePdoIsTakenAwayFirst) {
  tell("000#0105");
  EXPECT_EQ(write(0x1400, 1, 0x345, 4), "08000022");
  EXPECT_EQ(write(0x1400, 1, 0x80000345, 4), "ok");
  EXPECT_EQ(write(0x1400, 1, 0x345, 4), "ok");
  EXPECT_EQ(write(0x1400, 1, 0x345, 4), "ok");  // the same again changes nothing
  tell("205#01000200");
  EXPECT_TRUE(writes.empty());
  tell("345#01000200");
  EXPECT_EQ(writes.size(), 2u);
}

TEST_F(CanopenSlaveRpdo, CobIdsThatAreTakenOrNoneAreRefused) {
  EXPECT_EQ(write(0x1400, 1, 0x80000205, 4), "ok");
  for (const std::uint32_t id : {0x000u, 0x001u, 0x101u, 0x180u, 0x581u, 0x5ffu, 0x601u, 0x67fu, 0x6e0u, 0x701u, 0x7ffu,
                                 0x800u, 0x20000205u, 0x205u | 1u << 28}) {
    EXPECT_EQ(write(0x1400, 1, id, 4), "06090030") << id;
  }
  for (const std::uint32_t id : {0x002u, 0x100u, 0x181u, 0x580u, 0x600u, 0x680u, 0x6dfu, 0x700u}) {
    EXPECT_EQ(write(0x1400, 1, id, 4), "ok") << id;
    EXPECT_EQ(write(0x1400, 1, id | 0x80000000, 4), "ok") << id;
  }
}

class CanopenSlaveTpdo : public SlaveBench {
 protected:
  CanopenSlaveTpdo() { drain(); }
  // OPERATIONAL with TPDO1 of this type; what that sends.
  std::string start(std::uint32_t type, std::uint32_t inhibit_100us = 0, std::uint32_t event_ms = 0) {
    EXPECT_EQ(write(0x1800, 1, 0x80000185, 4), "ok");
    EXPECT_EQ(write(0x1800, 2, type, 1), "ok");
    EXPECT_EQ(write(0x1800, 3, inhibit_100us, 2), "ok");
    EXPECT_EQ(write(0x1800, 5, event_ms, 2), "ok");
    EXPECT_EQ(write(0x1800, 1, 0x185, 4), "ok");
    return tell("000#0105");
  }
  static constexpr const char* kZero = "185#000000000000";
  static constexpr const char* kSeven = "185#070000000000";
};

TEST_F(CanopenSlaveTpdo, EveryTransmissionTypeIsTakenOrRefused) {
  for (std::uint32_t type = 0; type <= 255; ++type) {
    const bool reserved = type > 240 && type < 252;
    EXPECT_EQ(write(0x1800, 2, type, 1), reserved ? "06090030" : "ok") << type;
  }
}

TEST_F(CanopenSlaveTpdo, TypeZeroGoesWithTheSyncAfterAChange) {
  EXPECT_EQ(start(0), "");
  EXPECT_EQ(tell("080#"), kZero);  // nothing sent yet: the first SYNC
  EXPECT_EQ(tell("080#"), "");
  values[0] = 7;
  EXPECT_EQ(new_data(), "");
  EXPECT_EQ(tell("080#"), kSeven);
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("185#R6"), "");
}

TEST_F(CanopenSlaveTpdo, TypesOneTo240GoWithEveryNthSync) {
  for (std::uint32_t type = 1; type <= 240; ++type) {
    tell("000#8005");
    EXPECT_EQ(start(type), "");
    for (int round = 0; round < 3; ++round) {
      for (std::uint32_t i = 1; i < type; ++i) ASSERT_EQ(tell("080#"), "") << type << " " << i;
      ASSERT_EQ(tell("080#"), kZero) << type;
    }
  }
}

TEST_F(CanopenSlaveTpdo, Type252IsSampledBySyncAndSentOnRequest) {
  EXPECT_EQ(start(252), "");
  EXPECT_EQ(tell("185#R6"), "");
  EXPECT_EQ(tell("185#R6"), "");
  EXPECT_EQ(faults, (std::vector<std::pair<PdoFault, unsigned>>{{PdoFault::kTpdoNotSampled, 0}}));
  values[0] = 7;
  EXPECT_EQ(tell("080#"), "");
  values[0] = 8;
  EXPECT_EQ(tell("185#R6"), kSeven);
  EXPECT_EQ(tell("185#R6"), kSeven);
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("185#R0"), "185#080000000000");
}

TEST_F(CanopenSlaveTpdo, Type253IsSentOnRequestWithPresentData) {
  EXPECT_EQ(start(253), "");
  values[0] = 7;
  EXPECT_EQ(new_data(), "");
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("185#R6"), kSeven);
  EXPECT_EQ(tell("185#"), "");
}

TEST_F(CanopenSlaveTpdo, Types254And255AreSentOnChangeAndOnRequest) {
  for (const std::uint32_t type : {254u, 255u}) {
    tell("000#8005");
    values[0] = 0;
    EXPECT_EQ(start(type), kZero);
    EXPECT_EQ(new_data(), "");
    values[0] = 7;
    EXPECT_EQ(new_data(), kSeven);
    EXPECT_EQ(new_data(), "");
    EXPECT_EQ(tell("080#"), "");
    EXPECT_EQ(tell("185#R6"), kSeven);
    EXPECT_EQ(advance(10s), "");
  }
}

TEST_F(CanopenSlaveTpdo, Bit30ForbidsRemoteRequests) {
  for (const std::uint32_t type : {252u, 253u, 254u, 255u}) {
    tell("000#8005");
    start(type);
    EXPECT_EQ(write(0x1800, 1, 0x40000185, 4), "ok");
    tell("080#");
    EXPECT_EQ(tell("185#R6"), "") << type;
  }
}

TEST_F(CanopenSlaveTpdo, InhibitTimeHoldsEventsBack) {
  EXPECT_EQ(start(255, 250), kZero);  // 25 ms
  values[0] = 1;
  EXPECT_EQ(new_data(), "");
  EXPECT_EQ(advance(10ms), "");
  values[0] = 7;
  EXPECT_EQ(new_data(), "");
  EXPECT_EQ(advance(14900us), "");
  EXPECT_EQ(advance(10ms), "0.1:185#070000000000");  // the latest, once
  EXPECT_EQ(advance(100ms), "");
  values[0] = 8;
  EXPECT_EQ(new_data(), "185#080000000000");
  EXPECT_EQ(tell("185#R6"), "185#080000000000");  // a request does not wait
}

TEST_F(CanopenSlaveTpdo, EventTimerSendsAfterTheLastTransmission) {
  EXPECT_EQ(start(254, 0, 40), kZero);
  EXPECT_EQ(advance(100ms), "40:185#000000000000 80:185#000000000000");
  values[0] = 7;
  EXPECT_EQ(new_data(), kSeven);
  EXPECT_EQ(advance(60ms), "40:185#070000000000");
}

TEST_F(CanopenSlaveTpdo, EventTimerWaitsForTheInhibitTime) {
  EXPECT_EQ(start(254, 1000, 40), kZero);
  EXPECT_EQ(advance(250ms), "100:185#000000000000 200:185#000000000000");
}

TEST_F(CanopenSlaveTpdo, InhibitTimeIsFixedWhileThePdoExists) {
  EXPECT_EQ(write(0x1800, 3, 5, 2), "08000022");
  EXPECT_EQ(write(0x1800, 1, 0x80000185, 4), "ok");
  EXPECT_EQ(write(0x1800, 3, 5, 2), "ok");
  EXPECT_EQ(read(0x1800, 3), "=0005");
}

TEST_F(CanopenSlaveTpdo, NothingIsSentOutsideOperational) {
  start(254, 0, 10);
  tell("000#8005");
  values[0] = 7;
  EXPECT_EQ(new_data(), "");
  EXPECT_EQ(advance(1s), "");
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("000#0105"), kSeven);
}

TEST_F(CanopenSlaveTpdo, WhatTheBusDidNotTakeIsForgottenOutsideOperational) {
  start(1);
  slave.handle_frame(now, can("080#"));
  EXPECT_EQ(tell("000#8005"), "");
  EXPECT_EQ(tell("000#0105"), "");
}

TEST_F(CanopenSlaveTpdo, BusyBusGetsTheLatestDataOnce) {
  start(1);
  values[0] = 1;
  slave.handle_frame(now, can("080#"));
  values[0] = 7;
  slave.handle_frame(now, can("080#"));
  EXPECT_EQ(drain(), kSeven);
}

class CanopenSlaveSync : public SlaveBench {};

TEST_F(CanopenSlaveSync, CobIdOfSyncCanBeChanged) {
  operational();
  EXPECT_EQ(write(0x1800, 2, 1, 1), "ok");
  EXPECT_EQ(tell("080#"), "185#000000000000");
  EXPECT_EQ(write(0x1005, 0, 0x90, 4), "ok");
  EXPECT_EQ(read(0x1005, 0), "=00000090");
  EXPECT_EQ(tell("080#"), "");
  EXPECT_EQ(tell("090#"), "185#000000000000");
  EXPECT_EQ(tell("090#R0"), "");
  EXPECT_EQ(write(0x1005, 0, 0x40000080, 4), "06090030");  // no producer
  EXPECT_EQ(write(0x1005, 0, 0x20000080, 4), "06090030");  // 11 bits
  EXPECT_EQ(write(0x1005, 0, 0, 4), "06090030");
  EXPECT_EQ(write(0x1005, 0, 0x605, 4), "06090030");
  EXPECT_EQ(write(0x1005, 0, 0x80000081, 4), "ok");  // bit 31 has no meaning
  EXPECT_EQ(read(0x1005, 0), "=80000081");
  EXPECT_EQ(tell("081#"), "185#000000000000");
}

class CanopenSlaveMapping : public SlaveBench {
 protected:
  CanopenSlaveMapping() { drain(); }
};

TEST_F(CanopenSlaveMapping, FollowsTheProcedure) {
  // Valid, or entries in force: 08000022.
  EXPECT_EQ(write(0x1600, 0, 0, 1), "08000022");
  EXPECT_EQ(write(0x1600, 1, 0x20020020, 4), "08000022");
  EXPECT_EQ(write(0x1400, 1, 0x80000205, 4), "ok");
  EXPECT_EQ(write(0x1600, 1, 0x20020020, 4), "08000022");
  EXPECT_EQ(write(0x1600, 0, 0, 1), "ok");
  EXPECT_EQ(write(0x1600, 1, 0x20020020, 4), "ok");
  EXPECT_EQ(write(0x1600, 2, 0x20030008, 4), "ok");
  EXPECT_EQ(write(0x1600, 3, 0x20050010, 4), "ok");
  EXPECT_EQ(write(0x1600, 0, 3, 1), "ok");
  EXPECT_EQ(write(0x1400, 1, 0x205, 4), "ok");
  operational();
  tell("205#0102030405060708");
  EXPECT_EQ(writes, (std::vector<std::string>{"pdo 2002 4030201", "pdo 2003 0005", "pdo 2005 0706"}));
}

TEST_F(CanopenSlaveMapping, EntriesThatCannotBeMapped) {
  EXPECT_EQ(write(0x1400, 1, 0x80000205, 4), "ok");
  EXPECT_EQ(write(0x1600, 0, 0, 1), "ok");
  EXPECT_EQ(write(0x1600, 1, 0x30000010, 4), "06020000");
  EXPECT_EQ(write(0x1600, 1, 0x21050010, 4), "06020000");
  EXPECT_EQ(write(0x1600, 1, 0x20000110, 4), "06090011");
  EXPECT_EQ(write(0x1600, 1, 0x20070010, 4), "06040041");  // not for PDOs
  EXPECT_EQ(write(0x1600, 1, 0x20060010, 4), "06040041");  // read only
  EXPECT_EQ(write(0x1600, 1, 0x20000008, 4), "06040041");  // not its length
  EXPECT_EQ(write(0x1600, 1, 0x10000020, 4), "06040041");
  EXPECT_EQ(write(0x1800, 1, 0x80000185, 4), "ok");
  EXPECT_EQ(write(0x1a00, 0, 0, 1), "ok");
  EXPECT_EQ(write(0x1a00, 1, 0x20050010, 4), "06040041");  // write only
  EXPECT_EQ(write(0x1a00, 1, 0x00060010, 4), "06040041");  // gaps are for reception
  EXPECT_EQ(write(0x1a00, 1, 0x20060010, 4), "ok");
  EXPECT_EQ(write(0x1a00, 2, 0x10010008, 4), "ok");
}

TEST_F(CanopenSlaveMapping, NumberAndLengthAreChecked) {
  EXPECT_EQ(write(0x1400, 1, 0x80000205, 4), "ok");
  EXPECT_EQ(write(0x1600, 0, 5, 1), "06090030");
  EXPECT_EQ(write(0x1600, 0, 0, 1), "ok");
  EXPECT_EQ(write(0x1600, 1, 0x20020020, 4), "ok");
  EXPECT_EQ(write(0x1600, 2, 0x20020020, 4), "ok");
  EXPECT_EQ(write(0x1600, 3, 0x20030008, 4), "ok");
  EXPECT_EQ(write(0x1600, 0, 3, 1), "06040042");
  EXPECT_EQ(read(0x1600, 0), "=00");
  EXPECT_EQ(write(0x1600, 0, 2, 1), "ok");
  EXPECT_EQ(write(0x1600, 0, 0, 1), "ok");
  EXPECT_EQ(write(0x1600, 2, 0, 4), "ok");
  EXPECT_EQ(write(0x1600, 0, 3, 1), "06040041");  // an empty entry in between
}

TEST_F(CanopenSlaveMapping, DummyEntriesSkipBytes) {
  map(0x1600, {0x00060010, 0x20000010, 0x00050008, 0x20030008});
  operational();
  tell("205#AAAA0100BB05");
  EXPECT_EQ(writes, (std::vector<std::string>{"pdo 2000 0001", "pdo 2003 0005"}));
  tell("205#AAAA0100BB");
  EXPECT_EQ(writes.size(), 2u);
}

TEST_F(CanopenSlaveMapping, RemappingWhileOperationalActsWhenThePdoIsValidAgain) {
  operational();
  values[1] = 0x1122;
  map(0x1a00, {0x20010010});
  EXPECT_EQ(tell("185#R2"), "185#2211");
}

class CanopenSlaveEmergency : public SlaveBench {
 protected:
  CanopenSlaveEmergency() { drain(); }
};

TEST_F(CanopenSlaveEmergency, HasCodeRegisterAndManufacturerBytes) {
  error_bits = 0x05;
  slave.send_emergency({0x3210, {1, 2, 3, 4, 5}});
  EXPECT_EQ(drain(), "085#1032050102030405");
  EXPECT_EQ(drain(), "");
}

TEST_F(CanopenSlaveEmergency, StoppedNodeKeepsTheMostRecentForLater) {
  tell("000#0205");
  slave.send_emergency({0x1000, {}});
  slave.send_emergency({0x2000, {}});
  EXPECT_EQ(drain(), "");
  EXPECT_EQ(tell("000#8005"), "085#0020000000000000");
}

TEST_F(CanopenSlaveEmergency, WhatTheBusDidNotTakeBeforeAStopIsForgottenButForTheMostRecent) {
  slave.send_emergency({0x1000, {}});
  slave.send_emergency({0x2000, {}});
  EXPECT_EQ(tell("000#0205"), "");
  EXPECT_EQ(tell("000#8005"), "085#0020000000000000");
}

TEST_F(CanopenSlaveEmergency, QueueHasALimitAndLosesTheOldest) {
  for (std::uint16_t i = 0; i < 20; ++i) slave.send_emergency({i, {}});
  std::vector<CanFrame> sent;
  while (const auto frame = slave.poll_transmit(now)) sent.push_back(*frame);
  ASSERT_EQ(sent.size(), canopen::Slave::kMaxEmergencies);
  EXPECT_EQ(sent.front().data[0], 20 - canopen::Slave::kMaxEmergencies);
  EXPECT_EQ(sent.back().data[0], 19);
}

TEST_F(CanopenSlaveEmergency, CobIdOfEmergencyCanBeChangedAndTakenAway) {
  EXPECT_EQ(write(0x1014, 0, 0x95, 4), "08000022");  // 85H exists
  EXPECT_EQ(read(0x1014, 0), "=00000085");
  EXPECT_EQ(write(0x1014, 0, 0x85, 4), "ok");  // the same again changes nothing
  EXPECT_EQ(write(0x1014, 0, 0x80000095, 4), "ok");
  slave.send_emergency({0x1000, {}});
  EXPECT_EQ(drain(), "");
  EXPECT_EQ(write(0x1014, 0, 0x95, 4), "ok");
  slave.send_emergency({0x1000, {}});
  EXPECT_EQ(drain(), "095#0010000000000000");
  slave.send_emergency({0x1000, {}});  // not sent yet
  slave.handle_frame(now, sdo(0x23, 0x1014, 0, 0x80000095));
  EXPECT_EQ(drain(), "585#6014100000000000");
  EXPECT_EQ(write(0x1014, 0, 0x605, 4), "06090030");
  EXPECT_EQ(write(0x1014, 0, 0x20000095, 4), "06090030");
  EXPECT_EQ(write(0x1014, 0, 0x40000095, 4), "06090030");
  EXPECT_EQ(read(0x1014, 0), "=80000095");
}

}  // namespace
}  // namespace vinv::test
