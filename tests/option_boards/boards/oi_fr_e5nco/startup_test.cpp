// Start-up settings: Pr.345 and switches (OI-FR-E5NCO manual, 2.3, 5.1, 8.4), Pr.347 (8.3).
#include "option_boards/boards/oi_fr_e5nco/startup_settings.hpp"
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using namespace std::chrono_literals;
using boards::LineSettings;
using boards::oi_fr_e5nco::AddressSwitches;
using boards::oi_fr_e5nco::node_address;
using boards::oi_fr_e5nco::parse_pr347;
using Parity = LineSettings::Parity;

TEST(OiFrE5ncoPr347, AllValuesMeanWhatTheBitTablesSay) {
  constexpr std::uint32_t kBauds[] = {9600, 1200, 2400, 4800, 9600, 19200, 38400, 9600};
  constexpr Parity kParities[] = {Parity::kNone, Parity::kNone, Parity::kOdd, Parity::kEven};
  for (unsigned value = 0; value < 256; ++value) {
    const auto setup = parse_pr347(value);
    EXPECT_EQ(setup.line.baud, kBauds[value % 8]) << value;
    EXPECT_EQ(setup.line.parity, kParities[value / 8 % 4]) << value;
    EXPECT_EQ(setup.answer_delay, std::chrono::milliseconds(value / 32 % 4)) << value;
    EXPECT_EQ(setup.immediate_answer, value >= 128) << value;
  }
}

TEST(OiFrE5ncoPr347, ManualsThreeExamples) {
  const auto first = parse_pr347(0x04);  // 8.3.5
  EXPECT_EQ(first.line, (LineSettings{9600, Parity::kNone}));
  EXPECT_EQ(first.answer_delay, 0ms);
  EXPECT_FALSE(first.immediate_answer);
  const auto second = parse_pr347(221);  // 8.3.6
  EXPECT_EQ(second.line, (LineSettings{19200, Parity::kEven}));
  EXPECT_EQ(second.answer_delay, 2ms);
  EXPECT_TRUE(second.immediate_answer);
  const auto third = parse_pr347(116);  // 8.3.7
  EXPECT_EQ(third.line, (LineSettings{9600, Parity::kOdd}));
  EXPECT_EQ(third.answer_delay, 3ms);
  EXPECT_FALSE(third.immediate_answer);
}

TEST(OiFrE5ncoNode, Pr345OverridesTheSwitchesFromOneToNinetyNine) {
  constexpr AddressSwitches kSwitches{4, 2};
  for (unsigned value = 0; value < 256; ++value) {
    const unsigned expected = value >= 1 && value <= 99 ? value : 42;
    EXPECT_EQ(node_address(value, kSwitches), expected) << value;
  }
}

TEST(OiFrE5ncoNode, SwitchesAreTensAndUnitsAndDoubleZeroIsNoAddress) {
  for (std::uint8_t tens = 0; tens <= 9; ++tens) {
    for (std::uint8_t units = 0; units <= 9; ++units) {
      EXPECT_EQ(node_address(100, {tens, units}), 10 * tens + units);
    }
  }
}

class OiFrE5ncoStartup : public BoardBench {
 protected:
  OiFrE5ncoStartup() : BoardBench(42) { drive.mode = port::OperationMode::kNetwork; }
  bool answers(std::uint8_t node) { return !ask("03 69 78 00 01", node).empty(); }
};

TEST_F(OiFrE5ncoStartup, BoardWithoutSupplyIsSilent) {
  EXPECT_EQ(unit().address(), 0);
  EXPECT_FALSE(answers(25));
  EXPECT_EQ(board->next_deadline(), std::nullopt);
  power_on();
  EXPECT_TRUE(answers(25));
  board->handle_power(now, false);
  EXPECT_FALSE(answers(25));
  EXPECT_EQ(unit().address(), 0);
  EXPECT_EQ(board->next_deadline(), std::nullopt);
}

TEST_F(OiFrE5ncoStartup, NodeComesFromPr345OrTheSwitches) {
  for (const auto& [pr345, node] : {std::pair{1, 1}, {25, 25}, {99, 99}, {100, 42}, {0, 42}, {101, 42}, {255, 42}}) {
    drive.parameters[345].value = static_cast<std::uint32_t>(pr345);
    power_cycle();
    EXPECT_EQ(unit().address(), node) << pr345;
    EXPECT_TRUE(answers(static_cast<std::uint8_t>(node))) << pr345;
    EXPECT_FALSE(answers(node == 42 ? 25 : 42)) << pr345;
  }
}

TEST_F(OiFrE5ncoStartup, NodeChangesAtTheNextPowerOnOnly) {
  power_on();
  EXPECT_EQ(write(20690, 7), echo(20690, 7));
  EXPECT_TRUE(answers(25));
  EXPECT_EQ(write(25002, 0), echo(25002, 0));
  advance(200ms);
  EXPECT_TRUE(answers(25));  // an inverter reset is no power-on
  power_cycle();
  EXPECT_FALSE(answers(25));
  EXPECT_TRUE(answers(7));
}

TEST_F(OiFrE5ncoStartup, SwitchesAreSampledAtPowerOn) {
  drive.parameters[345].value = 100;
  power_on();
  EXPECT_TRUE(answers(42));
  ASSERT_TRUE(board->set_switch("SW1", 0));
  ASSERT_TRUE(board->set_switch("SW2", 9));
  EXPECT_TRUE(answers(42));
  EXPECT_FALSE(answers(9));
  power_cycle();
  EXPECT_FALSE(answers(42));
  EXPECT_TRUE(answers(9));
}

TEST_F(OiFrE5ncoStartup, SwitchesAtDoubleZeroLeaveTheBoardSilent) {
  drive.parameters[345].value = 100;
  ASSERT_TRUE(board->set_switch("SW1", 0));
  ASSERT_TRUE(board->set_switch("SW2", 0));
  power_on();
  EXPECT_EQ(unit().address(), 0);
  for (unsigned node = 0; node < 256; ++node) EXPECT_FALSE(answers(static_cast<std::uint8_t>(node))) << node;
  EXPECT_EQ(exchange(frame("00 06 65 90 00 01")), "");
  EXPECT_TRUE(drive.posted.empty());
  drive.parameters[345].value = 3;
  power_cycle();
  EXPECT_TRUE(answers(3));
}

TEST_F(OiFrE5ncoStartup, BoardWaitsForParametersThatAreNotReadableYet) {
  drive.parameters_readable = false;
  power_on();
  EXPECT_EQ(unit().address(), 0);
  drive.parameters_readable = true;
  advance(10ms);
  EXPECT_EQ(unit().address(), 25);
  EXPECT_TRUE(answers(25));
}

TEST_F(OiFrE5ncoStartup, FamilyWithoutTheParametersHasTheirDefaults) {
  drive.parameters.erase(345);
  drive.parameters.erase(347);
  power_on();
  EXPECT_EQ(unit().address(), 42);
  EXPECT_EQ(line().line_settings(), (LineSettings{9600, Parity::kNone}));
}

TEST_F(OiFrE5ncoStartup, LineSettingsFollowPr347AtPowerOnAndAfterAReset) {
  drive.parameters[347].value = 0x04;
  power_on();
  EXPECT_EQ(line().line_settings(), (LineSettings{9600, Parity::kNone}));
  EXPECT_EQ(write(20694, 0x1e), echo(20694, 0x1e));
  EXPECT_EQ(line().line_settings(), (LineSettings{9600, Parity::kNone}));
  EXPECT_EQ(write(25002, 0), echo(25002, 0));  // still answered at the old speed
  advance(200ms);
  EXPECT_EQ(line().line_settings(), (LineSettings{38400, Parity::kEven}));
  EXPECT_TRUE(answers(25));
  drive.parameters[347].value = 0x11;
  EXPECT_EQ(line().line_settings(), (LineSettings{38400, Parity::kEven}));
  power_cycle();
  EXPECT_EQ(line().line_settings(), (LineSettings{1200, Parity::kOdd}));
}

TEST_F(OiFrE5ncoStartup, AnswerComesAfterSilenceAndTheDelayOfPr347) {
  struct Case {
    std::uint32_t pr347;
    Duration after_last_byte;
  };
  const Case cases[] = {{0x04, 3645833ns},       {0x24, 3645833ns + 1ms}, {0x44, 3645833ns + 2ms},
                        {0x64, 3645833ns + 3ms}, {0x14, 4010416ns},       {0x06, 1750us},
                        {0x66, 1750us + 3ms},    {0x01, 29166666ns},      {0x19 + 0x60, 32083333ns + 3ms}};
  for (const Case& c : cases) {
    drive.parameters[347].value = c.pr347;
    power_cycle();
    const Instant asked_at = now;
    EXPECT_FALSE(exchange(frame("19 03 4E 20 00 01")).empty());
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].at - asked_at, c.after_last_byte) << c.pr347;
  }
}

TEST_F(OiFrE5ncoStartup, SupplyLostWithARequestOutstandingLeavesNothingBehind) {
  power_on();
  drive.ticks_to_decide = 30;
  receive(frame("19 06 5D C2 00 64"));
  advance(10ms);
  power_cycle();
  drive.ticks_to_decide = 1;
  EXPECT_TRUE(sent.empty());
  EXPECT_EQ(write(24002, 200), echo(24002, 200));
  EXPECT_EQ(drive.executed.size(), 1u);
}

TEST_F(OiFrE5ncoStartup, ReceiveSlackOfARealTtyBridgesItsBursts) {
  power_on();
  line().set_receive_slack(now, 16ms);
  advance(50ms);
  const Bytes request = frame("19 03 4E 20 00 01");
  sent.clear();
  receive({request.begin(), request.begin() + 2});
  advance(15ms);
  receive({request.begin() + 2, request.end()});
  advance(50ms);
  EXPECT_EQ(sent.size(), 1u);
}

}  // namespace
}  // namespace vinv::test
