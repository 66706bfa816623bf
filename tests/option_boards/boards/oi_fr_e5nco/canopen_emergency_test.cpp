// Emergency messages: alarms, refused commands, guarding, PDO lengths, storing. OI-FR-E5NCO manual, 6.3, 6.4, 7.1, 7.3.
#include <fstream>
#include <sstream>

#include "option_boards/boards/oi_fr_e5nco/emergency_codes.hpp"
#include "option_boards/boards/oi_fr_e5nco/refusal_codes.hpp"
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

using boards::oi_fr_e5nco::command_error_of;
using boards::oi_fr_e5nco::CommandError;
using boards::oi_fr_e5nco::emergency_code_of;
using port::OperationMode;
using port::Refusal;

class OiFrE5ncoCanopenEmergency : public CanopenBench {};

TEST_F(OiFrE5ncoCanopenEmergency, EveryAlarmHasItsCodeAndErrorRegister) {
  struct Row {
    std::uint8_t data_code;
    const char* emergency;
  };
  // 7.1; byte 3 is 0 (62 for a storage fault), byte 4 the inverter's data code, byte 5 PRE-OPERATIONAL.
  const Row rows[] = {
      {0x10, "13220300107F0000"}, {0x11, "14220300117F0000"}, {0x12, "13220300127F0000"}, {0x20, "10320500207F0000"},
      {0x21, "10320500217F0000"}, {0x22, "10320500227F0000"}, {0x30, "00230300307F0000"}, {0x31, "00100100317F0000"},
      {0x40, "10430900407F0000"}, {0x60, "00230300607F0000"}, {0x70, "10712100707F0000"}, {0x80, "30230300807F0000"},
      {0x81, "10540100817F0000"}, {0x90, "00100100907F0000"}, {0xa0, "00500100A07F0000"}, {0xa3, "00100100A37F0000"},
      {0xb0, "3055013EB07F0000"}, {0xb1, "10751100B17F0000"}, {0xb2, "00100100B27F0000"}, {0xc0, "00500100C07F0000"},
      {0xc1, "10751100C17F0000"}, {0xc2, "12510500C27F0000"}, {0xf3, "00100100F37F0000"}, {0xf6, "00600100F67F0000"},
      {0xf7, "00600100F77F0000"}, {0x55, "00100100557F0000"}};
  for (const Row& row : rows) {
    alarm(row.data_code);
    EXPECT_EQ(wait(60ms), std::string("099#") + row.emergency);
    EXPECT_EQ(read(0x1001), "=" + std::string(row.emergency).substr(4, 2));
    EXPECT_EQ(read(0x3400).substr(3), hex(row.data_code, 2));
    alarm(0);
    EXPECT_EQ(wait(60ms), "099#00000000007F0000");  // error reset
    EXPECT_EQ(read(0x1001), "=00");
  }
}

TEST_F(OiFrE5ncoCanopenEmergency, TableAgreesWithTheFamilysAlarms) {
  std::ifstream file(std::string(VINV_SOURCE_DIR) + "/motor_model/families/mitsubishi_e500/alarms.csv");
  std::string line;
  std::getline(file, line);
  unsigned rows = 0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string name, data_code, source, error_code, bits, error_register;
    std::getline(fields, name, ',');
    std::getline(fields, data_code, ',');
    std::getline(fields, source, ',');
    std::getline(fields, error_code, ',');
    std::getline(fields, bits, ',');
    std::getline(fields, error_register, ',');
    if (name == "none") continue;
    if (source.starts_with('"')) continue;
    ++rows;
    const auto code = emergency_code_of(static_cast<std::uint8_t>(std::stoul(data_code, nullptr, 16)));
    EXPECT_EQ(code.error_code, std::stoul(error_code, nullptr, 16)) << name;
    EXPECT_EQ(code.error_register, std::stoul(error_register, nullptr, 16)) << name;
  }
  EXPECT_EQ(rows, 25u);
}

TEST_F(OiFrE5ncoCanopenEmergency, AlarmIsKnownFortyMillisecondsLater) {
  network();
  drive.history = {0x10};
  wait(1ms);
  alarm(0x22);
  EXPECT_EQ(transcript(30ms), "");
  EXPECT_EQ(read(0x4000), "=0080");  // the status word has it at once
  EXPECT_EQ(read(0x3400), "=0010");  // the code is not there yet
  EXPECT_EQ(read(0x1001), "=00");
  EXPECT_EQ(tell("199#R8"), "199#8000000000001000");
  EXPECT_EQ(transcript(30ms), "11:099#1032050022050000");  // seen at the first tick, 40 ms after it
  EXPECT_EQ(read(0x3400), "=1022");
  EXPECT_EQ(tell("199#R8"), "199#8000000000002210");
}

TEST_F(OiFrE5ncoCanopenEmergency, AlarmThatIsGoneWithinFortyMillisecondsIsNoEmergency) {
  alarm(0x22);
  EXPECT_EQ(wait(20ms), "");
  alarm(0);
  EXPECT_EQ(wait(100ms), "");
}

TEST_F(OiFrE5ncoCanopenEmergency, SecondAlarmIsAnotherEmergency) {
  alarm(0x22);
  EXPECT_EQ(wait(50ms), "099#10320500227F0000");
  alarm(0x31);
  EXPECT_EQ(wait(50ms), "099#00100100317F0000");
}

TEST_F(OiFrE5ncoCanopenEmergency, ResetThroughTheNetworkEndsTheError) {
  network();
  alarm(0x22);
  EXPECT_EQ(wait(50ms), "099#1032050022050000");
  EXPECT_EQ(write(0x2107, 0, 0, 2), "ok");
  alarm(0);
  EXPECT_EQ(wait(50ms), "099#0000000000050000");
  EXPECT_EQ(read(0x1001), "=00");
}

TEST_F(OiFrE5ncoCanopenEmergency, AlarmOfAStoppedNodeIsSentLater) {
  tell("000#0219");
  wait(5ms);
  alarm(0x22);
  EXPECT_EQ(wait(100ms), "");
  EXPECT_EQ(tell("000#8019"), "099#1032050022040000");
}

TEST_F(OiFrE5ncoCanopenEmergency, RefusedPdoCommandsHaveTheirReasons) {
  network();
  // The inverter's reasons, as they come from each.
  const std::pair<Refusal, const char*> reasons[] = {
      {Refusal::kOutOfRange, "11"}, {Refusal::kReadOnly, "14"},         {Refusal::kWriteDisabled, "14"},
      {Refusal::kNoSuchItem, "16"}, {Refusal::kWriteOnly, "19"},        {Refusal::kNotReady, "19"},
      {Refusal::kFaulted, "19"},    {Refusal::kNotFaulted, "19"},       {Refusal::kRunning, "21"},
      {Refusal::kWrongMode, "12"},  {Refusal::kModeChangeRefused, "24"}};
  map(0x1601, {0x30070010});
  frames.clear();
  for (const auto& [refusal, reason] : reasons) {
    drive.refuse_decision.reset();
    tell("319#3200");
    wait(5ms);
    drive.refuse_decision = refusal;
    tell("319#3200");
    EXPECT_EQ(wait(10ms), "099#00100015" + std::string(reason) + "050000");
  }
}

TEST_F(OiFrE5ncoCanopenEmergency, ReasonsThatDependOnTheSituation) {
  using boards::oi_fr_e5nco::RefusedIn;
  port::NetTerminals stf, str;
  stf.set(Terminal::kStf, true);
  str.set(Terminal::kStr, true);
  const auto reason = [](Refusal refusal, const RefusedIn& in) { return command_error_of(refusal, in); };
  EXPECT_EQ(reason(Refusal::kWrongMode, {OperationMode::kExternal, false, {}}), CommandError::kExternalOperation);
  EXPECT_EQ(reason(Refusal::kWrongMode, {OperationMode::kNetwork, false, {}}), CommandError::kExternalOperation);
  EXPECT_EQ(reason(Refusal::kWrongMode, {OperationMode::kPu, false, {}}), CommandError::kOperational);
  EXPECT_EQ(reason(Refusal::kModeChangeRefused, {OperationMode::kExternal, true, stf}),
            CommandError::kOperatingModeSet);
  EXPECT_EQ(reason(Refusal::kModeChangeRefused, {OperationMode::kExternal, false, stf}), CommandError::kStf);
  EXPECT_EQ(reason(Refusal::kModeChangeRefused, {OperationMode::kExternal, false, str}), CommandError::kStr);
  EXPECT_EQ(reason(Refusal::kModeChangeRefused, {OperationMode::kPu, false, {}}), CommandError::kOperatingModeSet);
}

TEST_F(OiFrE5ncoCanopenEmergency, PdoCommandInExternalOperationIsReportedOnceForEachThing) {
  network();
  drive.mode = OperationMode::kExternal;
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "099#0010001512050000 099#0010001512050000");  // command, frequency
  for (int i = 0; i < 50; ++i) tell("219#02008813");
  EXPECT_EQ(wait(50ms), "");
  drive.mode = OperationMode::kNetwork;
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "");
  drive.mode = OperationMode::kPu;
  tell("219#02008813");
  EXPECT_EQ(wait(10ms), "099#0010001513050000 099#0010001513050000");
}

TEST_F(OiFrE5ncoCanopenEmergency, PdoValueOutsideTheRangeIsReported) {
  map(0x1601, {0x40010210});
  network();
  EXPECT_EQ(tell("319#0001"), "099#0010001511050000");
  EXPECT_EQ(wait(10ms), "");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenEmergency, PdoCommandDuringTheDeadTimeIsReported) {
  network();
  drive.is_ready = false;
  EXPECT_EQ(tell("219#02008813"), "099#0010001519050000 099#0010001519050000");
  drive.is_ready = true;
  EXPECT_EQ(wait(10ms), "");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoCanopenEmergency, ShortRpdoIsAnErrorUntilAGoodOneComes) {
  network();
  EXPECT_EQ(tell("219#020088"), "099#1082112A00050000");  // 42
  EXPECT_EQ(read(0x1001), "=11");
  EXPECT_EQ(tell("219#02"), "");
  EXPECT_TRUE(drive.posted.empty());
  EXPECT_EQ(tell("219#02008813"), "099#0000000000050000");
  EXPECT_EQ(read(0x1001), "=00");
}

TEST_F(OiFrE5ncoCanopenEmergency, ShortRpdoStaysAnErrorUntilThePdoIsSetUpAnewOrTheNodeReset) {
  network();
  tell("219#02");
  tell("000#8019");
  EXPECT_EQ(read(0x1001), "=11");
  tell("000#0119");
  EXPECT_EQ(tell("219#02"), "");
  EXPECT_EQ(tell("619#2300140119020080"), "099#0000000000050000 599#6000140100000000");  // 1400H:1 with bit 31
  EXPECT_EQ(read(0x1001), "=00");
  EXPECT_EQ(write(0x1400, 1, 0x219, 4), "ok");
  tell("219#02");
  tell("000#8219");
  EXPECT_EQ(read(0x1001), "=00");
}

TEST_F(OiFrE5ncoCanopenEmergency, SynchronousTpdoAskedForBeforeASyncIsAnError) {
  EXPECT_EQ(write(0x1800, 2, 252, 1), "ok");
  network();
  EXPECT_EQ(tell("199#R8"), "099#0082002C00050000");  // 44
  EXPECT_EQ(tell("199#R8"), "");
  tell("080#");
  EXPECT_EQ(tell("199#R8"), "199#0000000000000000");
}

TEST_F(OiFrE5ncoCanopenEmergency, StoringThatFailsBehindAnotherAlarmIsReportedOnce) {
  network();
  map(0x1601, {0x30070010});
  alarm(0x22);
  wait(50ms);
  drive.storage_fails = true;
  EXPECT_EQ(write(0x3007, 0, 70, 2), "06060000");
  EXPECT_EQ(emergencies(), "3055053E00050000");
  tell("319#4600");
  EXPECT_EQ(wait(20ms), "");  // told already
  drive.storage_fails = false;
  tell("319#4600");
  EXPECT_EQ(wait(20ms), "");
  drive.storage_fails = true;
  tell("319#4600");  // a PDO has no other answer
  EXPECT_EQ(wait(20ms), "099#3055053E00050000");
  alarm(0xb0);
  EXPECT_EQ(wait(60ms), "099#3055013EB0050000");  // the alarm of the storage itself
}

TEST_F(OiFrE5ncoCanopenEmergency, LifeTimeExpiredIsAnErrorUntilTheMasterAsksAgain) {
  EXPECT_EQ(write(0x100c, 0, 100, 2), "ok");
  EXPECT_EQ(write(0x100d, 0, 3, 1), "ok");
  EXPECT_EQ(tell("719#R1"), "719#7F");
  EXPECT_EQ(transcript(400ms), "300:099#3081111F007F0000");  // 31
  EXPECT_EQ(read(0x1001), "=11");
  EXPECT_EQ(tell("719#R1"), "099#00000000007F0000 719#FF");
  EXPECT_EQ(read(0x1001), "=00");
}

TEST_F(OiFrE5ncoCanopenEmergency, ErrorsAtTheSameTimeShareTheRegister) {
  network();
  tell("219#02");
  alarm(0x22);
  EXPECT_EQ(wait(50ms), "099#1032150022050000");
  EXPECT_EQ(read(0x1001), "=15");
  alarm(0);
  EXPECT_EQ(wait(50ms), "099#0000110000050000");  // one of two is gone
}

}  // namespace
}  // namespace vinv::test
