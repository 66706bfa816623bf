// PDOs of the board. OI-FR-E5NCO manual, 6.5.
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

class OiFrE5ncoCanopenPdo : public CanopenBench {};

TEST_F(OiFrE5ncoCanopenPdo, DefaultsAreTheManuals) {
  EXPECT_EQ(read(0x1400, 0), "=02");
  EXPECT_EQ(read(0x1400, 1), "=00000219");
  EXPECT_EQ(read(0x1400, 2), "=FF");
  EXPECT_EQ(read(0x1600, 0), "=02");
  EXPECT_EQ(read(0x1600, 1), "=40000010");
  EXPECT_EQ(read(0x1600, 2), "=40010010");
  EXPECT_EQ(read(0x1600, 3), "=00000000");
  EXPECT_EQ(read(0x1600, 4), "=00000000");
  EXPECT_EQ(read(0x1800, 1), "=00000199");
  EXPECT_EQ(read(0x1800, 2), "=FD");  // asynchronous, RTR only
  EXPECT_EQ(read(0x1800, 3), "=0000");
  EXPECT_EQ(read(0x1800, 5), "=0000");
  EXPECT_EQ(read(0x1a00, 0), "=04");
  EXPECT_EQ(read(0x1a00, 1), "=40000010");
  EXPECT_EQ(read(0x1a00, 2), "=40010010");
  EXPECT_EQ(read(0x1a00, 3), "=20010010");
  EXPECT_EQ(read(0x1a00, 4), "=34000010");
  for (unsigned n = 1; n < 4; ++n) {  // 6.5.3: not mapped
    EXPECT_EQ(read(0x1400 + n, 1), "=" + hex(0x80000219 + 0x100 * n, 8));
    EXPECT_EQ(read(0x1800 + n, 1), "=" + hex(0x80000199 + 0x100 * n, 8));
    EXPECT_EQ(read(0x1600 + n, 0), "=00");
    EXPECT_EQ(read(0x1a00 + n, 0), "=00");
  }
}

TEST_F(OiFrE5ncoCanopenPdo, ManualsExamplesOfReceivePdo1) {
  network();
  EXPECT_EQ(tell("219#0200881300000000"), "");  // run with 50 Hz
  wait(10ms);
  ASSERT_EQ(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kCommand);
  EXPECT_EQ(terminals(0), bit(Terminal::kStf));
  EXPECT_EQ(drive.executed[1].kind, Kind::kFrequency);
  EXPECT_EQ(drive.executed[1].value, 5000u);
  EXPECT_EQ(tell("219#0100000000000000"), "");  // stop
  wait(10ms);
  ASSERT_EQ(drive.executed.size(), 4u);
  EXPECT_EQ(terminals(2), bit(Terminal::kStop));
  EXPECT_EQ(drive.executed[3].value, 0u);
}

TEST_F(OiFrE5ncoCanopenPdo, ReceivePdo1TakesFourToEightBytes) {
  network();
  for (const char* text :
       {"219#02008813", "219#0200881300", "219#020088130000", "219#02008813000000", "219#0200881300000000"}) {
    drive.executed.clear();
    EXPECT_EQ(tell(text), "");
    wait(10ms);
    EXPECT_EQ(drive.executed.size(), 2u) << text;
  }
}

TEST_F(OiFrE5ncoCanopenPdo, TransmitPdo1HasStatusFrequencyCurrentAndAlarms) {
  network();
  drive.status_now.running = true;
  drive.status_now.forward = true;
  drive.monitors = {{1, 5000}, {2, 0x0123}, {3, 0}};
  drive.history = {0xb1, 0xa3};
  wait(1ms);
  EXPECT_EQ(tell("199#R8"), "199#030088132301B1A3");
  EXPECT_EQ(wait(100ms), "");  // on request only
  EXPECT_EQ(tell("080#"), "");
}

TEST_F(OiFrE5ncoCanopenPdo, DummyEntriesFillGapsInAnRpdo) {
  map(0x1601, {0x00060010, 0x40000010});
  network();
  EXPECT_EQ(tell("319#88130200"), "");
  wait(10ms);
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(terminals(0), bit(Terminal::kStf));
  EXPECT_EQ(write(0x1402, 1, 0x80000419, 4), "ok");
  EXPECT_EQ(write(0x1a01, 1, 0x00060010, 4), "06040041");
}

TEST_F(OiFrE5ncoCanopenPdo, WhatCanBeMappedAndWhatNot) {
  const std::uint32_t both[] = {0x40000010, 0x40010010, 0x40010110, 0x60400010, 0x60420010, 0x30070010, 0x33860110};
  const std::uint32_t transmit[] = {0x10010008, 0x10020020, 0x20000010, 0x20010010, 0x20020010,
                                    0x34000010, 0x34030010, 0x60410010, 0x60430010, 0x60440010};
  const std::uint32_t none[] = {0x10000020, 0x10050020, 0x10080020, 0x100c0010, 0x10110020, 0x14000120,
                                0x16000120, 0x21060010, 0x21070010, 0x60070010, 0x60460120, 0x60480120,
                                0x60480210, 0x60600008, 0x60610008, 0x67ff0020};
  drive.calibration[{902, 1}] = {0};
  for (const std::uint32_t entry : both) {
    EXPECT_EQ(write(0x1601, 1, entry, 4), "ok") << std::hex << entry;
    EXPECT_EQ(write(0x1a01, 1, entry, 4), "ok") << std::hex << entry;
  }
  for (const std::uint32_t entry : transmit) {
    EXPECT_EQ(write(0x1601, 1, entry, 4), "06040041") << std::hex << entry;
    EXPECT_EQ(write(0x1a01, 1, entry, 4), "ok") << std::hex << entry;
  }
  for (const std::uint32_t entry : none) {
    EXPECT_EQ(write(0x1601, 1, entry, 4), "06040041") << std::hex << entry;
    EXPECT_EQ(write(0x1a01, 1, entry, 4), "06040041") << std::hex << entry;
  }
  EXPECT_EQ(write(0x1601, 1, 0x40010210, 4), "ok");  // analog speed: received only
  EXPECT_EQ(write(0x1a01, 1, 0x40010210, 4), "06040041");
  EXPECT_EQ(write(0x1601, 1, 0x39990010, 4), "06020000");
  EXPECT_EQ(write(0x1601, 1, 0x33E70010, 4), "06020000");  // Pr.999: this inverter does not have it
}

TEST_F(OiFrE5ncoCanopenPdo, AllEightPdosWork) {
  map(0x1601, {0x40010010});
  map(0x1602, {0x30070010});
  map(0x1603, {0x40010210});
  for (unsigned n = 1; n < 4; ++n) {
    map(0x1a00 + n, {0x20000010 + (n - 1) * 0x10000});
    EXPECT_EQ(write(0x1800 + n, 2, n, 1), "ok");
  }
  network();
  tell("319#1027");
  tell("419#6400");
  tell("519#7800");
  wait(10ms);
  ASSERT_EQ(drive.executed.size(), 3u);
  EXPECT_EQ(drive.executed[0].value, 10000u);
  EXPECT_EQ(drive.executed[1].parameter.number, 7);
  EXPECT_EQ(drive.parameters[7].value, 100u);
  EXPECT_EQ(drive.executed[2].kind, Kind::kAnalogReference);
  drive.monitors = {{1, 1}, {2, 2}, {3, 3}};
  EXPECT_EQ(tell("080#"), "299#0100");
  EXPECT_EQ(tell("080#"), "299#0100 399#0200");
  EXPECT_EQ(tell("080#"), "299#0100 499#0300");
}

TEST_F(OiFrE5ncoCanopenPdo, EventDrivenTpdoFollowsTheInverterTickByTick) {
  map(0x1a01, {0x20000010});
  EXPECT_EQ(write(0x1801, 2, 255, 1), "ok");
  EXPECT_EQ(tell("000#0119"), "299#0000");
  EXPECT_EQ(wait(10ms), "");
  drive.monitors[1] = 7;
  EXPECT_EQ(transcript(5ms), "1:299#0700");
  EXPECT_EQ(write(0x1801, 1, 0x80000299, 4), "ok");
  EXPECT_EQ(write(0x1801, 3, 200, 2), "ok");
  EXPECT_EQ(write(0x1801, 1, 0x299, 4), "ok");
  wait(50ms);
  drive.monitors[1] = 8;
  EXPECT_EQ(transcript(1ms), "1:299#0800");
  drive.monitors[1] = 9;
  EXPECT_EQ(transcript(40ms), "20:299#0900");
}

TEST_F(OiFrE5ncoCanopenPdo, MasterThatSendsFasterThanTheInverterDecidesGetsTheLatest) {
  network();
  drive.ticks_to_decide = 10;
  for (unsigned i = 0; i < 100; ++i) {
    tell("219#0200" + hex(i, 2) + "00");
    advance(1ms);
  }
  drive.ticks_to_decide = 1;
  advance(50ms);
  EXPECT_LT(drive.executed.size(), 30u);
  EXPECT_EQ(drive.executed.back().kind == Kind::kFrequency ? drive.executed.back().value
                                                           : drive.executed[drive.executed.size() - 2].value,
            99u);
  bool command = false, frequency = false;
  for (const auto& write : drive.executed) {
    command = command || write.kind == Kind::kCommand;
    frequency = frequency || write.kind == Kind::kFrequency;
  }
  EXPECT_TRUE(command && frequency);  // neither starves the other
}

TEST_F(OiFrE5ncoCanopenPdo, SdoIsDecidedWhilePdosFlood) {
  network();
  drive.ticks_to_decide = 2;
  tell("619#2B07300037000000");
  std::string answer;
  for (unsigned i = 0; i < 20 && answer.empty(); ++i) {
    tell("219#02008813");
    answer = wait(1ms);
  }
  EXPECT_EQ(answer, "599#6007300000000000");
}

}  // namespace
}  // namespace vinv::test
