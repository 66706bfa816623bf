// Pr.347 bit 7: when a write is answered. OI-FR-E5NCO manual, 8.3.4.
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using namespace std::chrono_literals;

class OiFrE5ncoImmediateAnswer : public BoardBench {
 protected:
  void start(bool immediate) {
    drive.parameters[347].value = immediate ? 0x84 : 0x04;
    drive.mode = port::OperationMode::kNetwork;
    power_on();
  }
  static constexpr Duration kFrameEnd = 3645833ns;  // 3.5 characters at 9600 baud, 10 bits
};

TEST_F(OiFrE5ncoImmediateAnswer, OffWaitsForTheInvertersDecision) {
  start(false);
  drive.ticks_to_decide = 20;
  const Instant asked_at = now;
  EXPECT_EQ(write(24002, 100), echo(24002, 100));
  EXPECT_GT(sent.at(0).at - asked_at, kFrameEnd + 18ms);
  EXPECT_LT(sent.at(0).at - asked_at, kFrameEnd + 22ms);
}

TEST_F(OiFrE5ncoImmediateAnswer, OnAcknowledgesBeforeTheInverterDecides) {
  start(true);
  drive.ticks_to_decide = 20;
  const Instant asked_at = now;
  EXPECT_EQ(write(24002, 100), echo(24002, 100));
  EXPECT_EQ(sent.at(0).at, asked_at + kFrameEnd);
  EXPECT_EQ(drive.executed.size(), 1u);
}

TEST_F(OiFrE5ncoImmediateAnswer, OnHidesWhatTheInverterRefuses) {
  start(true);
  drive.mode = port::OperationMode::kExternal;
  EXPECT_EQ(write(24000, 2), echo(24000, 2));
  drive.mode = port::OperationMode::kNetwork;
  EXPECT_EQ(write(20002, 12001), echo(20002, 12001));
  EXPECT_EQ(write(20056, 1), echo(20056, 1));  // not even a parameter
  drive.write_disabled = true;
  EXPECT_EQ(write(20014, 1), echo(20014, 1));
  EXPECT_EQ(drive.posted.size(), 4u);
  EXPECT_TRUE(drive.executed.empty());
}

TEST_F(OiFrE5ncoImmediateAnswer, OnStillRefusesWhatTheOptionKnowsAtOnce) {
  start(true);
  EXPECT_EQ(write(26000, 3), "86 03");
  EXPECT_EQ(write(24006, 256), "86 03");
  EXPECT_EQ(write(30000, 0), "86 02");
  EXPECT_EQ(write(23000, 0), "86 05");
  EXPECT_EQ(ask("10 4E 20 00 01 02 00 00"), "90 01");
  drive.is_ready = false;
  EXPECT_EQ(write(24002, 1), "86 04");
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoImmediateAnswer, OnRefusesASecondWriteWhileTheFirstIsInTheMailbox) {
  start(true);
  drive.ticks_to_decide = 50;
  unit().handle_request(now, 1, modbus::Addressing::kUnit, write_pdu(24002, 100));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 1).value()), echo(24002, 100));
  unit().handle_request(now, 1, modbus::Addressing::kUnit, write_pdu(24002, 200));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 1).value()), "86 06");
  advance(60ms);
  unit().handle_request(now, 1, modbus::Addressing::kUnit, write_pdu(24002, 200));
  EXPECT_EQ(to_hex(unit().poll_answer(now, 1).value()), echo(24002, 200));
}

TEST_F(OiFrE5ncoImmediateAnswer, OnLeavesReadsAsTheyAre) {
  start(true);
  EXPECT_EQ(read(20000), words({60}));
  EXPECT_EQ(read(30000), "83 02");
}

}  // namespace
}  // namespace vinv::test
