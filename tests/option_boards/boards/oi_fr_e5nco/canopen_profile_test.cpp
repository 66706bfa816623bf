// Velocity mode. OI-FR-E5NCO manual, 7.4 to 7.15; CiA DSP-402 v1.1.
#include "option_boards/boards/oi_fr_e5nco/drive_profile.hpp"
#include "tests/option_boards/boards/oi_fr_e5nco/canopen_bench.hpp"

namespace vinv::test {
namespace {

using boards::oi_fr_e5nco::DriveAction;
using boards::oi_fr_e5nco::DriveProfile;
using boards::oi_fr_e5nco::DriveState;
using port::Refusal;

class OiFrE5ncoCanopenProfile : public CanopenBench {
 protected:
  OiFrE5ncoCanopenProfile() {
    drive.parameters[20] = {5000, 100, 40000};
    drive.parameters[2] = {0, 0, 12000};
    drive.parameters[8] = {50, 0, 36000};
    drive.parameters[21] = {0, 0, 1};
    drive.parameters[44] = {30, 0, 36000};
    drive.parameters[45] = {65535, 0, 65535};
    drive.parameters[180] = {0, 0, 18};
    network();
  }
  std::string control(unsigned word) { return write(0x6040, 0, word, 2); }
  // State bits of the statusword: 0-3, 5 and 6.
  unsigned state() { return statusword() & 0x6fu; }
  unsigned statusword() { return static_cast<unsigned>(std::stoul(read(0x6041).substr(1), nullptr, 16)); }
  void enable() {
    ASSERT_EQ(control(0x06), "ok");
    ASSERT_EQ(control(0x07), "ok");
    ASSERT_EQ(control(0x0f), "ok");
    ASSERT_EQ(state(), 0x27u);
    drive.executed.clear();
  }
  static constexpr unsigned kSwitchOnDisabled = 0x40, kReady = 0x21, kSwitchedOn = 0x23, kEnabled = 0x27,
                            kQuickStop = 0x07, kFault = 0x08;
};

TEST(OiFrE5ncoDriveProfile, EveryCommandInEveryState) {
  using S = DriveState;
  using A = DriveAction;
  // Shutdown, switch on, disable voltage, quick stop, disable operation (same bits as switch on), enable operation.
  const std::uint16_t words[] = {0x06, 0x07, 0x00, 0x02, 0x0f};
  struct Row {
    S from;
    std::pair<S, A> to[5];
  };
  const Row rows[] = {
      {S::kSwitchOnDisabled,
       {{S::kReadyToSwitchOn, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kSwitchOnDisabled, A::kNone}}},
      {S::kReadyToSwitchOn,
       {{S::kReadyToSwitchOn, A::kNone},
        {S::kSwitchedOn, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kOperationEnabled, A::kRun}}},
      {S::kSwitchedOn,
       {{S::kReadyToSwitchOn, A::kNone},
        {S::kSwitchedOn, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kSwitchOnDisabled, A::kNone},
        {S::kOperationEnabled, A::kRun}}},
      {S::kOperationEnabled,
       {{S::kReadyToSwitchOn, A::kCoast},
        {S::kSwitchedOn, A::kRampDown},
        {S::kSwitchOnDisabled, A::kCoast},
        {S::kQuickStopActive, A::kQuickStop},
        {S::kOperationEnabled, A::kRun}}},
      {S::kQuickStopActive,
       {{S::kQuickStopActive, A::kNone},
        {S::kQuickStopActive, A::kNone},
        {S::kSwitchOnDisabled, A::kCoast},
        {S::kQuickStopActive, A::kNone},
        {S::kQuickStopActive, A::kNone}}},
      {S::kFault,
       {{S::kFault, A::kNone},
        {S::kFault, A::kNone},
        {S::kFault, A::kNone},
        {S::kFault, A::kNone},
        {S::kFault, A::kNone}}},
  };
  const auto in = [](S state) {
    DriveProfile profile;
    const auto tell = [&](std::initializer_list<std::uint16_t> all) {
      for (const std::uint16_t word : all) profile.handle_controlword(word);
    };
    switch (state) {
      case S::kSwitchOnDisabled: break;
      case S::kReadyToSwitchOn: tell({0x06}); break;
      case S::kSwitchedOn: tell({0x06, 0x07}); break;
      case S::kOperationEnabled: tell({0x06, 0x07, 0x0f}); break;
      case S::kQuickStopActive: tell({0x06, 0x07, 0x0f, 0x02}); break;
      case S::kFault: profile.follow(true, false); break;
    }
    return profile;
  };
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < std::size(words); ++i) {
      DriveProfile profile = in(row.from);
      ASSERT_EQ(profile.state(), row.from);
      const DriveAction action = profile.handle_controlword(words[i]);
      EXPECT_EQ(profile.state(), row.to[i].first) << static_cast<int>(row.from) << " " << words[i];
      EXPECT_EQ(action, row.to[i].second) << static_cast<int>(row.from) << " " << words[i];
    }
    DriveProfile profile = in(row.from);
    profile.follow(true, true);
    EXPECT_EQ(profile.state(), S::kFault);
  }
}

TEST(OiFrE5ncoDriveProfile, QuickStopLastsUntilATickHasShownWhetherTheMotorTurns) {
  DriveProfile profile;
  for (const std::uint16_t word : {0x06, 0x07, 0x0f, 0x02}) profile.handle_controlword(word);
  profile.follow(false, false);
  EXPECT_EQ(profile.state(), DriveState::kQuickStopActive);
  profile.follow(false, true);
  EXPECT_EQ(profile.state(), DriveState::kQuickStopActive);
  profile.follow(false, false);
  EXPECT_EQ(profile.state(), DriveState::kSwitchOnDisabled);
}

TEST_F(OiFrE5ncoCanopenProfile, EveryTransitionOfTheStateMachine) {
  EXPECT_EQ(state(), kSwitchOnDisabled);  // after power-on
  EXPECT_EQ(control(0x06), "ok");         // 2
  EXPECT_EQ(state(), kReady);
  EXPECT_EQ(control(0x07), "ok");  // 3
  EXPECT_EQ(state(), kSwitchedOn);
  EXPECT_EQ(control(0x06), "ok");  // 6
  EXPECT_EQ(state(), kReady);
  EXPECT_EQ(control(0x00), "ok");  // 7
  EXPECT_EQ(state(), kSwitchOnDisabled);
  control(0x06);
  control(0x07);
  EXPECT_EQ(control(0x00), "ok");  // 10
  EXPECT_EQ(state(), kSwitchOnDisabled);
  EXPECT_TRUE(drive.executed.empty());  // so far these are states and nothing else
  control(0x06);
  control(0x07);
  EXPECT_EQ(control(0x0f), "ok");  // 4
  EXPECT_EQ(state(), kEnabled);
  ASSERT_EQ(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kFrequency);
  EXPECT_EQ(terminals(1), bit(Terminal::kStf));
  EXPECT_EQ(control(0x07), "ok");  // 5
  EXPECT_EQ(state(), kSwitchedOn);
  EXPECT_EQ(terminals(2), 0);
  control(0x0f);
  EXPECT_EQ(control(0x06), "ok");  // 8
  EXPECT_EQ(state(), kReady);
  EXPECT_EQ(drive.executed.back().terminals.bits, bit(Terminal::kMrs));
  control(0x0f);
  EXPECT_EQ(state(), kEnabled);
  EXPECT_EQ(control(0x00), "ok");  // 9
  EXPECT_EQ(state(), kSwitchOnDisabled);
  EXPECT_EQ(drive.executed.back().terminals.bits, bit(Terminal::kMrs));
  enable();
  drive.status_now.running = true;
  EXPECT_EQ(control(0x02), "ok");  // 11
  EXPECT_EQ(state(), kQuickStop);
  EXPECT_EQ(control(0x0f), "ok");
  wait(20ms);
  EXPECT_EQ(state(), kQuickStop);
  drive.status_now.running = false;
  wait(2ms);
  EXPECT_EQ(state(), kSwitchOnDisabled);  // 12, at standstill
  enable();
  drive.status_now.running = true;
  control(0x02);
  EXPECT_EQ(control(0x00), "ok");  // 12, by command
  EXPECT_EQ(state(), kSwitchOnDisabled);
  EXPECT_EQ(drive.executed.back().terminals.bits, bit(Terminal::kMrs));
  alarm(0x22);  // 13, 14
  wait(1ms);
  EXPECT_EQ(state(), kFault);
  EXPECT_EQ(control(0x06), "ok");
  EXPECT_EQ(state(), kFault);
  drive.executed.clear();
  EXPECT_EQ(control(0x80), "ok");
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(drive.executed[0].kind, Kind::kResetInverter);
  EXPECT_EQ(control(0x80), "ok");  // an edge resets, not a level
  EXPECT_EQ(drive.executed.size(), 1u);
  alarm(0);
  wait(1ms);
  EXPECT_EQ(state(), kSwitchOnDisabled);  // 15
}

TEST_F(OiFrE5ncoCanopenProfile, OneControlwordMayPassSwitchedOn) {
  control(0x06);
  EXPECT_EQ(control(0x0f), "ok");
  EXPECT_EQ(state(), kEnabled);
  EXPECT_EQ(read(0x6040), "=000F");
}

TEST_F(OiFrE5ncoCanopenProfile, TargetVelocityHasASign) {
  EXPECT_EQ(write(0x6042, 0, 1500, 2), "ok");
  EXPECT_EQ(read(0x6042), "=05DC");
  EXPECT_TRUE(drive.executed.empty());  // not before operation is enabled
  control(0x06);
  control(0x0f);
  ASSERT_EQ(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[0].value, 5000u);
  EXPECT_EQ(terminals(1), bit(Terminal::kStf));
  drive.executed.clear();
  EXPECT_EQ(write(0x6042, 0, static_cast<std::uint16_t>(-750), 2), "ok");
  ASSERT_EQ(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[0].value, 2500u);
  EXPECT_EQ(terminals(1), bit(Terminal::kStr));
  EXPECT_EQ(read(0x6042), "=FD12");
  drive.executed.clear();
  EXPECT_EQ(write(0x6042, 0, 0, 2), "ok");  // down to 0 in the same direction
  EXPECT_EQ(drive.executed[0].value, 0u);
  EXPECT_EQ(terminals(1), bit(Terminal::kStr));
}

TEST_F(OiFrE5ncoCanopenProfile, TargetThatTheInverterRefusesIsTakenBack) {
  write(0x6042, 0, 1500, 2);
  enable();
  EXPECT_EQ(write(0x6042, 0, 15000, 2), "06090030");  // 500 Hz
  EXPECT_EQ(read(0x6042), "=05DC");
  EXPECT_EQ(write(0x6042, 0, 0x8000, 2), "06090030");
  EXPECT_EQ(read(0x6042), "=05DC");
  EXPECT_EQ(state(), kEnabled);
}

TEST_F(OiFrE5ncoCanopenProfile, OperationThatTheInverterRefusesIsNotEnabled) {
  control(0x06);
  control(0x07);
  drive.mode = port::OperationMode::kExternal;
  EXPECT_EQ(control(0x0f), "08000021");
  EXPECT_EQ(state(), kSwitchedOn);
  drive.mode = port::OperationMode::kNetwork;
  EXPECT_EQ(control(0x0f), "ok");
  EXPECT_EQ(state(), kEnabled);
}

TEST_F(OiFrE5ncoCanopenProfile, OperationIsNotEnabledWhileTheInverterIsNotReady) {
  control(0x06);
  control(0x07);
  drive.is_ready = false;
  EXPECT_EQ(control(0x0f), "08000022");
  EXPECT_EQ(state(), kSwitchedOn);
}

TEST_F(OiFrE5ncoCanopenProfile, TargetsThatWaitAreTakenBackTogether) {
  write(0x6042, 0, 1500, 2);
  enable();
  map(0x1601, {0x30070010});
  map(0x1602, {0x60420010});
  drive.ticks_to_decide = 5;
  tell("319#3200");  // is with the inverter
  tell("419#E803");  // 1000 rpm waits,
  tell("419#204E");  // and 20000 rpm takes its place and is refused
  EXPECT_EQ(read(0x6042), "=4E20");
  EXPECT_EQ(wait(20ms), "099#0010001511050000");
  EXPECT_EQ(read(0x6042), "=05DC");
}

TEST_F(OiFrE5ncoCanopenProfile, HaltReleasesTheStartSignals) {
  enable();
  drive.status_now.running = drive.status_now.up_to_frequency = true;
  EXPECT_EQ(control(0x10f), "ok");
  EXPECT_EQ(state(), kEnabled);
  EXPECT_EQ(statusword() & 0x0400u, 0u);  // the target is standstill now
  drive.status_now.running = drive.status_now.up_to_frequency = false;
  EXPECT_EQ(statusword() & 0x0400u, 0x0400u);
  EXPECT_EQ(drive.executed.back().terminals.bits, 0);
  EXPECT_EQ(control(0x0f), "ok");
  EXPECT_EQ(drive.executed.back().terminals.bits, bit(Terminal::kStf));
}

TEST_F(OiFrE5ncoCanopenProfile, QuickStopUsesTheSecondFunctionWhereTerminalRlHasIt) {
  for (const auto& [pr180, expected] :
       {std::pair{3u, bit(Terminal::kRl)}, {0u, std::uint16_t{0}}, {2u, std::uint16_t{0}}}) {
    drive.parameters[180].value = pr180;
    enable();
    EXPECT_EQ(control(0x02), "ok");
    ASSERT_EQ(drive.executed.size(), 1u);
    EXPECT_EQ(terminals(0), expected) << pr180;
    wait(5ms);
  }
}

TEST_F(OiFrE5ncoCanopenProfile, StatusBitsFollowTheDrive) {
  enable();
  EXPECT_EQ(statusword(), 0x0237u);  // remote, voltage
  drive.status_now.up_to_frequency = true;
  EXPECT_EQ(statusword(), 0x0637u);
  drive.status_now.overload = true;
  EXPECT_EQ(statusword(), 0x06b7u);
  drive.mode = port::OperationMode::kExternal;
  EXPECT_EQ(statusword(), 0x04b7u);
  drive.is_ready = false;
  EXPECT_EQ(statusword(), 0x04a7u);
  drive.is_ready = true;
  control(0x06);
  EXPECT_EQ(statusword() & 0x0400u, 0u);  // no target in other states
  EXPECT_EQ(statusword() & 0x0800u, 0u);  // bit 11 never
}

TEST_F(OiFrE5ncoCanopenProfile, DemandAndEffortAreTheOutputFrequency) {
  drive.monitors[1] = 5000;
  drive.status_now.forward = true;
  EXPECT_EQ(read(0x6043), "=05DC");
  EXPECT_EQ(read(0x6044), "=05DC");
  drive.status_now.forward = false;
  drive.status_now.reverse = true;
  EXPECT_EQ(read(0x6043), "=FA24");
  EXPECT_EQ(read(0x6044), "=FA24");
}

TEST_F(OiFrE5ncoCanopenProfile, LimitsAndRampsAreParameters) {
  EXPECT_EQ(read(0x6046, 1), "=00000000");
  EXPECT_EQ(read(0x6046, 2), "=00000E10");  // 120 Hz: 3600 rpm
  EXPECT_EQ(write(0x6046, 1, 300, 4), "ok");
  EXPECT_EQ(drive.parameters[2].value, 1000u);
  EXPECT_EQ(write(0x6046, 2, 1000, 4), "ok");
  EXPECT_EQ(drive.parameters[1].value, 3333u);
  EXPECT_EQ(read(0x6046, 2), "=000003E8");  // what was written
  EXPECT_EQ(write(0x6046, 2, 3700, 4), "06090030");
  EXPECT_EQ(read(0x6048, 2), "=0005");
  EXPECT_EQ(read(0x604a, 2), "=0003");  // Pr.45 = 9999: Pr.44
  EXPECT_EQ(write(0x6048, 2, 7, 2), "ok");
  EXPECT_EQ(drive.parameters[7].value, 70u);
  EXPECT_EQ(write(0x6049, 2, 9, 2), "ok");
  EXPECT_EQ(drive.parameters[8].value, 90u);
  EXPECT_EQ(write(0x604a, 2, 2, 2), "ok");
  EXPECT_EQ(drive.parameters[45].value, 20u);
  EXPECT_EQ(read(0x604a, 2), "=0002");
  drive.parameters[21].value = 1;  // increments of 0.01 s
  EXPECT_EQ(write(0x6048, 2, 7, 2), "ok");
  EXPECT_EQ(drive.parameters[7].value, 700u);
  EXPECT_EQ(read(0x6048, 2), "=0007");
  EXPECT_EQ(write(0x6048, 2, 361, 2), "06090030");
  EXPECT_EQ(write(0x6048, 2, 0xffff, 2), "06090030");
}

TEST_F(OiFrE5ncoCanopenProfile, DeltaSpeedIsShared) {
  for (const unsigned index : {0x6048u, 0x6049u, 0x604au}) EXPECT_EQ(read(index, 1), "=000005DC");
  EXPECT_EQ(write(0x6049, 1, 1000, 4), "ok");
  EXPECT_EQ(drive.parameters[20].value, 3333u);
  for (const unsigned index : {0x6048u, 0x6049u, 0x604au}) EXPECT_EQ(read(index, 1), "=000003E8");
}

TEST_F(OiFrE5ncoCanopenProfile, RunsByPdo) {
  map(0x1601, {0x60400010, 0x60420010});
  map(0x1a01, {0x60410010, 0x60430010});
  EXPECT_EQ(write(0x1801, 2, 255, 1), "ok");
  frames.clear();
  EXPECT_EQ(tell("319#0600DC05"), "");
  EXPECT_EQ(wait(2ms), "299#31020000");
  tell("319#0700DC05");
  EXPECT_EQ(wait(2ms), "299#33020000");
  tell("319#0F00DC05");
  EXPECT_EQ(wait(5ms), "299#37020000");
  ASSERT_GE(drive.executed.size(), 2u);
  EXPECT_EQ(drive.executed[drive.executed.size() - 2].value, 5000u);
  EXPECT_EQ(drive.executed.back().terminals.bits, bit(Terminal::kStf));
  drive.mode = port::OperationMode::kExternal;
  tell("319#07000000");
  tell("319#0F000000");
  EXPECT_NE(wait(10ms).find("099#0010001512050000"), std::string::npos);
  EXPECT_EQ(state(), kSwitchedOn);
}

TEST_F(OiFrE5ncoCanopenProfile, RestartOfTheInverterDisablesOperation) {
  enable();
  EXPECT_EQ(write(0x2107, 0, 0, 2), "ok");
  wait(2ms);
  EXPECT_EQ(state(), kSwitchOnDisabled);
  wait(200ms);
  drive.executed.clear();
  EXPECT_EQ(control(0x0f), "ok");  // not before Ready to switch on
  EXPECT_EQ(state(), kSwitchOnDisabled);
  EXPECT_TRUE(drive.executed.empty());
}

TEST_F(OiFrE5ncoCanopenProfile, ResetNodeForgetsTheStateAndResetCommunicationDoesNot) {
  tell("000#8019");
  write(0x6007, 0, 2, 2);
  write(0x6042, 0, 100, 2);
  control(0x06);
  tell("000#8219");
  EXPECT_EQ(state(), kReady);
  EXPECT_EQ(read(0x6007), "=0002");
  tell("000#8119");
  EXPECT_EQ(state(), kSwitchOnDisabled);
  EXPECT_EQ(read(0x6007), "=0000");
  EXPECT_EQ(read(0x6042), "=0000");
}

}  // namespace
}  // namespace vinv::test
