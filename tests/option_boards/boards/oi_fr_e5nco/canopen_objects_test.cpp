// Each object of the OI-FR-E5NCO manual, 6.2 and 7, as a master reads and writes it.
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

using port::NetTerminals;
using port::OperationMode;
using port::Refusal;

class OiFrE5ncoCanopenObjects : public CanopenBench {};

TEST_F(OiFrE5ncoCanopenObjects, IdentityObjectsHaveTheirConstants) {
  EXPECT_EQ(read(0x1000), "=00010192");  // 7.2
  EXPECT_EQ(read(0x67ff), "=00010192");
  EXPECT_EQ(read(0x6fff), "=00010192");
  EXPECT_EQ(read(0x0006), "=00000010");
  EXPECT_EQ(read(0x1008), "=434E3545");  // E5NC
  EXPECT_EQ(read(0x1009), "=30302E31");  // 1.00
  EXPECT_EQ(read(0x100a), "=32343031");  // 1042
  EXPECT_EQ(read(0x1018, 1), "06020000");
  EXPECT_EQ(read(0x1017), "06020000");
  EXPECT_EQ(read(0x1003), "06020000");
}

TEST_F(OiFrE5ncoCanopenObjects, NodeIdIsTheActiveOne) {
  EXPECT_EQ(read(0x100b), "=00000019");
  drive.parameters[345].value = 31;
  EXPECT_EQ(read(0x100b), "=00000019");
}

TEST_F(OiFrE5ncoCanopenObjects, StatusWordIsReadAtThreeObjects) {
  EXPECT_EQ(read(0x4000), "=0000");
  drive.status_now = {.running = true,
                      .forward = true,
                      .reverse = false,
                      .up_to_frequency = true,
                      .overload = false,
                      .power_failure = false,
                      .frequency_detected = true,
                      .alarm = false,
                      .ready = true};
  EXPECT_EQ(read(0x4000), "=804B");
  EXPECT_EQ(read(0x1002), "=0000804B");
  tell("000#0119");
  EXPECT_EQ(tell("199#R8"), "199#4B80000000000000");
}

TEST_F(OiFrE5ncoCanopenObjects, MonitorsAreObjects2000To2002) {
  drive.monitors = {{1, 5000}, {2, 123}, {3, 4001}};
  EXPECT_EQ(read(0x2000), "=1388");
  EXPECT_EQ(read(0x2001), "=007B");
  EXPECT_EQ(read(0x2002), "=0FA1");
  EXPECT_EQ(read(0x2003), "06020000");
  EXPECT_EQ(write(0x2000, 0, 0, 2), "06010002");
}

TEST_F(OiFrE5ncoCanopenObjects, AlarmsComeInPairsWithTheNewerInTheLowByte) {
  drive.history = {0xb1, 0xa3, 0x10, 0x20, 0x30, 0x40, 0x50, 0x60};
  advance(1ms);
  EXPECT_EQ(read(0x3400), "=A3B1");
  EXPECT_EQ(read(0x3401), "=2010");
  EXPECT_EQ(read(0x3402), "=4030");
  EXPECT_EQ(read(0x3403), "=6050");
  EXPECT_EQ(read(0x3404), "06020000");
  EXPECT_EQ(read(0x3400, 1), "06090011");
}

TEST_F(OiFrE5ncoCanopenObjects, CommandBitsBecomeTerminals) {
  network();
  const std::pair<unsigned, Terminal> bits[] = {{0, Terminal::kStop}, {1, Terminal::kStf}, {2, Terminal::kStr},
                                                {3, Terminal::kRh},   {4, Terminal::kRm},  {5, Terminal::kRl},
                                                {10, Terminal::kMrs}};
  for (const auto& [n, terminal] : bits) {
    drive.executed.clear();
    EXPECT_EQ(write(0x4000, 0, 1u << n, 2), "ok");
    ASSERT_EQ(drive.executed.size(), 1u);
    EXPECT_EQ(terminals(0), bit(terminal)) << n;
  }
  for (const unsigned reserved : {6u, 7u, 8u, 9u, 11u, 15u}) {
    drive.executed.clear();
    EXPECT_EQ(write(0x4000, 0, 1u << reserved, 2), "ok");
    EXPECT_EQ(terminals(0), 0) << reserved;
  }
}

TEST_F(OiFrE5ncoCanopenObjects, SpeedInHertzAndRpm) {
  network();
  EXPECT_EQ(write(0x4001, 0, 10000, 2), "ok");
  EXPECT_EQ(drive.executed.back().kind, Kind::kFrequency);
  EXPECT_EQ(drive.executed.back().value, 10000u);
  EXPECT_EQ(write(0x4001, 1, 100, 2), "ok");  // 8.7.7: ((10 * 4) / 4) / 3
  EXPECT_EQ(drive.executed.back().value, 333u);
  drive.parameters[144].value = 6;
  EXPECT_EQ(write(0x4001, 1, 100, 2), "ok");
  EXPECT_EQ(drive.executed.back().value, 500u);
  drive.monitors[1] = 5000;
  EXPECT_EQ(read(0x4001, 0), "=1388");
  EXPECT_EQ(read(0x4001, 1), "=03E8");  // 1000
  EXPECT_EQ(write(0x4001, 0, 40001, 2), "06090030");
  EXPECT_EQ(write(0x4001, 1, 0xffff, 2), "06090030");
}

TEST_F(OiFrE5ncoCanopenObjects, AnalogSpeedIsAByteAndWriteOnly) {
  network();
  EXPECT_EQ(write(0x4001, 2, 255, 2), "ok");
  EXPECT_EQ(drive.executed.back().kind, Kind::kAnalogReference);
  EXPECT_EQ(drive.executed.back().value, 255u);
  EXPECT_EQ(write(0x4001, 2, 256, 2), "06090030");
  EXPECT_EQ(read(0x4001, 2), "06010001");
  EXPECT_EQ(read(0x4001, 3), "06090011");
}

TEST_F(OiFrE5ncoCanopenObjects, ClearAndResetTakeOnlyZero) {
  network();
  drive.history = {0x22};
  EXPECT_EQ(write(0x2106, 0, 1, 2), "06090030");
  EXPECT_EQ(write(0x2107, 0, 1, 2), "06090030");
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_EQ(read(0x2106), "06010001");
  EXPECT_EQ(read(0x2107), "06010001");
  EXPECT_EQ(write(0x2106, 0, 0, 2), "ok");
  EXPECT_EQ(drive.history[0], 0);
  EXPECT_EQ(write(0x2107, 0, 0, 2), "ok");
  EXPECT_EQ(drive.executed.back().kind, Kind::kResetInverter);
  EXPECT_EQ(read(0x2000), "08000022");  // the dead time
  EXPECT_EQ(read(0x1000), "=00010192");
  EXPECT_EQ(write(0x4000, 0, 2, 2), "08000022");
  advance(200ms);
  EXPECT_EQ(read(0x2000), "=0000");
}

TEST_F(OiFrE5ncoCanopenObjects, RestoreTakesTheSignatureLoad) {
  network();
  EXPECT_EQ(read(0x1011), "=00000001");
  for (const std::uint32_t wrong : {0u, 1u, 0x65766173u, 0x6c6f6164u}) {
    EXPECT_EQ(write(0x1011, 0, wrong, 4), "08000022") << wrong;
  }
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_EQ(write(0x1011, 1, 0x64616f6c, 4), "06090011");
  frames.clear();
  receive_frame(can("619#2311100060000000"));
  receive_frame(can("619#231110006C6F6164"));  // l o a d
  advance(5ms);
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kRestoreDefaults);
  EXPECT_EQ(drive.executed[0].value, 0u);  // parameter clear, not all clear
}

TEST_F(OiFrE5ncoCanopenObjects, AbortOptionTakesZeroTwoAndThree) {
  EXPECT_EQ(read(0x6007), "=0000");
  for (const std::uint32_t value : {2u, 3u, 0u}) {
    EXPECT_EQ(write(0x6007, 0, value, 2), "ok");
    EXPECT_EQ(read(0x6007), "=" + hex(value, 4));
  }
  for (const std::uint32_t value : {1u, 4u, 0xffffu, 0x8000u}) {
    EXPECT_EQ(write(0x6007, 0, value, 2), "06090030") << value;
  }
}

TEST_F(OiFrE5ncoCanopenObjects, OnlyVelocityModeIsThere) {
  EXPECT_EQ(write(0x6060, 0, 2, 1), "ok");
  for (const std::uint32_t mode : {0u, 1u, 3u, 6u, 0xffu}) EXPECT_EQ(write(0x6060, 0, mode, 1), "06090030") << mode;
  EXPECT_EQ(read(0x6060), "06010001");
  EXPECT_EQ(read(0x6061), "=02");
  EXPECT_EQ(write(0x6061, 0, 2, 1), "06010002");
}

TEST_F(OiFrE5ncoCanopenObjects, ReservedEntryOfATpdoKeepsItsByte) {
  EXPECT_EQ(read(0x1800, 0), "=05");
  EXPECT_EQ(write(0x1800, 4, 7, 1), "ok");
  EXPECT_EQ(read(0x1800, 4), "=07");
  EXPECT_EQ(read(0x1800, 6), "06090011");
  EXPECT_EQ(read(0x1400, 3), "06090011");
  EXPECT_EQ(read(0x1804, 0), "06020000");
}

TEST_F(OiFrE5ncoCanopenObjects, ManualsParameterExamples) {
  drive.parameters[244] = {1, 0, 2};
  EXPECT_EQ(read(0x30f4), "=0001");  // 6.2.2.2
  drive.calibration[{904, 1}] = {321};
  drive.calibration[{904, 2}] = {200};
  EXPECT_EQ(read(0x3388, 0), "=02");  // 6.2.2.1
  EXPECT_EQ(read(0x3388, 1), "=0141");
  EXPECT_EQ(read(0x3388, 2), "=00C8");
  EXPECT_EQ(read(0x3388, 3), "06090011");
}

TEST_F(OiFrE5ncoCanopenObjects, EveryRefusalOfTheInverterHasItsAbortCode) {
  network();
  const std::pair<Refusal, const char*> codes[] = {
      {Refusal::kNoSuchItem, "06020000"}, {Refusal::kOutOfRange, "06090030"},
      {Refusal::kReadOnly, "06010002"},   {Refusal::kWriteOnly, "06010001"},
      {Refusal::kRunning, "08000022"},    {Refusal::kWriteDisabled, "08000022"},
      {Refusal::kWrongMode, "08000021"},  {Refusal::kModeChangeRefused, "08000022"},
      {Refusal::kNotReady, "08000022"},   {Refusal::kFaulted, "08000022"},
      {Refusal::kNotFaulted, "08000022"}, {Refusal::kBusy, "08000022"}};
  for (const auto& [refusal, code] : codes) {
    drive.refuse_decision = refusal;
    EXPECT_EQ(write(0x4000, 0, 2, 2), code);
  }
}

TEST_F(OiFrE5ncoCanopenObjects, WriteThatTheInverterLosesIsAGeneralErrorAndAResetIsNot) {
  network();
  drive.ticks_to_decide = 1000;
  frames.clear();
  receive_frame(sdo(0x2b, 0x4000, 0, 2));
  drive.lose_mailbox();
  advance(2ms);
  EXPECT_EQ(answer(0x4000, 0), "08000000");
  frames.clear();
  receive_frame(sdo(0x2b, 0x2107, 0, 0));
  drive.lose_mailbox();
  advance(2ms);
  EXPECT_EQ(answer(0x2107, 0), "ok");
}

TEST_F(OiFrE5ncoCanopenObjects, ValueThatCannotBeStoredIsAHardwareError) {
  network();
  EXPECT_EQ(write(0x3007, 0, 60, 2), "ok");
  drive.storage_fails = true;
  EXPECT_EQ(write(0x3007, 0, 70, 2), "06060000");
  EXPECT_EQ(drive.parameters[7].value, 70u);  // it acts
}

TEST_F(OiFrE5ncoCanopenObjects, ValueOfMoreThanAWordCannotBeRead) {
  drive.parameters[37] = {70000, 0, 9998000};
  EXPECT_EQ(read(0x3025), "08000000");
}

TEST_F(OiFrE5ncoCanopenObjects, CommandsNeedTheNetworkMode) {
  EXPECT_EQ(write(0x4000, 0, 2, 2), "08000021");
  EXPECT_EQ(write(0x4001, 0, 100, 2), "08000021");
  EXPECT_EQ(write(0x3007, 0, 60, 2), "08000021");
  EXPECT_EQ(write(0x2107, 0, 0, 2), "08000021");
  EXPECT_EQ(read(0x3007), "=0032");  // reading does not
}

TEST_F(OiFrE5ncoCanopenObjects, AnswerComesWhenTheInverterHasDecided) {
  network();
  drive.ticks_to_decide = 30;
  EXPECT_EQ(tell("619#2B00400002000000"), "");
  EXPECT_EQ(transcript(40ms), "30:599#6000400000000000");
}

TEST_F(OiFrE5ncoCanopenObjects, AbandonedWriteIsCarriedOutWithoutAnAnswer) {
  network();
  drive.ticks_to_decide = 10;
  EXPECT_EQ(tell("619#2B00400002000000"), "");
  EXPECT_EQ(tell("619#8000400000000405"), "");
  EXPECT_EQ(tell("619#4061600000000000"), "599#4F61600002000000");
  EXPECT_EQ(wait(20ms), "");
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(terminals(0), bit(Terminal::kStf));
}

}  // namespace
}  // namespace vinv::test
