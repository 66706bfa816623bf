// Several masters at one board: serial line and Modbus/TCP connections side by side, broadcasts, lost connections.
#include "option_boards/modbus/tcp_session.hpp"
#include "tests/option_boards/support/board_bench.hpp"

namespace vinv::test {
namespace {

using namespace std::chrono_literals;

class OiFrE5ncoClients : public BoardBench {
 protected:
  OiFrE5ncoClients() {
    drive.mode = port::OperationMode::kNetwork;
    power_on();
    table.add(unit());
  }
  std::vector<std::string> drain_tcp(modbus::TcpSession& from) {
    std::vector<std::string> answers;
    while (auto bytes = from.poll_transmit(now)) answers.push_back(to_hex(*bytes));
    return answers;
  }
  modbus::UnitTable table;
};

using Strings = std::vector<std::string>;

TEST_F(OiFrE5ncoClients, TcpHasTheSameMapAsTheSerialLine) {
  modbus::TcpSession session(0, table);
  session.handle_bytes(now, adu(1, 25, "03 4E 20 00 02"));
  EXPECT_EQ(drain_tcp(session), Strings{to_hex(adu(1, 25, "03 04 00 3C 2E E0"))});
  EXPECT_EQ(read(20000, 2), words({60, 12000}));
  session.handle_bytes(now, adu(2, 25, "06 4E 2E 00 64"));
  EXPECT_TRUE(drain_tcp(session).empty());
  advance(2ms);
  EXPECT_EQ(drain_tcp(session), Strings{to_hex(adu(2, 25, "06 4E 2E 00 64"))});
  session.handle_bytes(now, adu(3, 25, "03 4E 20 00"));
  EXPECT_EQ(drain_tcp(session), Strings{to_hex(adu(3, 25, "83 03"))});
}

TEST_F(OiFrE5ncoClients, WriteOfOneClientRefusesTheOthersWritesButNotTheirReads) {
  drive.ticks_to_decide = 60;
  modbus::TcpSession first(0, table), second(1, table);
  first.handle_bytes(now, adu(1, 25, "06 5D C2 00 64"));
  EXPECT_TRUE(drain_tcp(first).empty());
  second.handle_bytes(now, adu(2, 25, "06 5D C2 00 C8"));
  EXPECT_EQ(drain_tcp(second), Strings{to_hex(adu(2, 25, "86 06"))});
  sent.clear();
  receive(frame("19 06 5D C2 01 2C"));
  advance(10ms);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(sent[0].bytes), to_hex(frame("19 86 06")));
  second.handle_bytes(now, adu(3, 25, "03 5D C2 00 01"));
  EXPECT_EQ(drain_tcp(second), Strings{to_hex(adu(3, 25, "03 02 00 00"))});
  advance(60ms);
  EXPECT_EQ(drain_tcp(first), Strings{to_hex(adu(1, 25, "06 5D C2 00 64"))});
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(drive.executed[0].value, 100u);
}

TEST_F(OiFrE5ncoClients, WriteOfALostConnectionIsStillExecuted) {
  drive.ticks_to_decide = 10;
  {
    modbus::TcpSession gone(3, table);
    gone.handle_bytes(now, adu(1, 25, "06 5D C2 00 64"));
    EXPECT_TRUE(drain_tcp(gone).empty());
  }
  advance(20ms);
  EXPECT_EQ(drive.executed.size(), 1u);
  modbus::TcpSession next(3, table);  // the same client id again: nothing of the old one is left
  next.handle_bytes(now, adu(7, 25, "03 69 7C 00 01"));
  EXPECT_EQ(drain_tcp(next), Strings{to_hex(adu(7, 25, "03 02 00 01"))});
}

TEST_F(OiFrE5ncoClients, BoardSwitchedOffIsAGatewayTargetThatFailedToRespond) {
  drive.ticks_to_decide = 50;
  modbus::TcpSession session(0, table);
  session.handle_bytes(now, adu(1, 25, "06 5D C2 00 64"));
  EXPECT_TRUE(drain_tcp(session).empty());
  board->handle_power(now, false);
  EXPECT_EQ(drain_tcp(session), Strings{to_hex(adu(1, 25, "86 0B"))});
  session.handle_bytes(now, adu(2, 25, "03 4E 20 00 01"));
  EXPECT_EQ(drain_tcp(session), Strings{to_hex(adu(2, 25, "83 0B"))});
}

TEST_F(OiFrE5ncoClients, BroadcastWriteIsExecutedAndNotAnswered) {
  EXPECT_EQ(exchange(frame("00 06 5D C2 00 64")), "");
  ASSERT_EQ(drive.executed.size(), 1u);
  EXPECT_EQ(drive.executed[0].value, 100u);
}

TEST_F(OiFrE5ncoClients, BroadcastThatIsNoGoodWriteDoesNothing) {
  for (const char* hex : {"00 03 4E 20 00 01", "00 06 65 90 00 03", "00 06 75 30 00 00", "00 10 4E 20 00 01 02 00 00",
                          "00 06 5D C2 00"}) {
    EXPECT_EQ(exchange(frame(hex)), "") << hex;
  }
  EXPECT_TRUE(drive.posted.empty());
}

TEST_F(OiFrE5ncoClients, RequestRightAfterABroadcastIsServed) {
  drive.ticks_to_decide = 30;
  receive(frame("00 06 5D C2 00 64"));
  advance(5ms);
  EXPECT_EQ(drive.posted.size(), 1u);
  sent.clear();
  receive(frame("19 06 5D C2 00 C8"));
  advance(5ms);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(sent[0].bytes), to_hex(frame("19 86 06")));  // the broadcast is still in the mailbox
  EXPECT_EQ(read(20000), words({60}));
  EXPECT_EQ(write(24002, 300), echo(24002, 300));
}

TEST_F(OiFrE5ncoClients, SlowClientDelaysNoOther) {
  modbus::TcpSession slow(0, table), quick(1, table);
  std::uint16_t transaction = 0;
  for (const std::uint8_t byte : adu(0x4444, 25, "06 5D C2 00 64")) {
    slow.handle_bytes(now, Bytes{byte});
    receive({byte});  // the serial line gets noise at the same pace
    advance(1s);
    quick.handle_bytes(now, adu(++transaction, 25, "06 5D C2 00 01"));
    EXPECT_TRUE(drain_tcp(quick).empty());
    advance(2ms);
    EXPECT_EQ(drain_tcp(quick).size(), 1u);
    EXPECT_EQ(write(24002, 2), echo(24002, 2));
  }
  EXPECT_TRUE(drain_tcp(slow).empty());
  advance(2ms);
  EXPECT_EQ(drain_tcp(slow), Strings{to_hex(adu(0x4444, 25, "06 5D C2 00 64"))});
}

TEST(OiFrE5ncoLine, TwoBoardsShareOneLine) {
  FakeDrive first_drive, second_drive;
  second_drive.parameters[345].value = 26;
  auto a = boards::make_board({"oi-fr-e5nco", 1}, first_drive);
  auto b = boards::make_board({"oi-fr-e5nco", 2}, second_drive);
  Instant now = instant_from_ns(1'000'000'000);
  const auto pass = [&](Duration by) {
    now += by;
    for (auto* board : {&*a, &*b}) (*board)->handle_timeout(now);
  };
  for (auto* board : {&*a, &*b}) (*board)->handle_power(now, true);
  pass(10ms);
  for (const auto& [node, own] : {std::pair{"19", &*a}, std::pair{"1A", &*b}}) {
    const Bytes request = frame(std::string(node) + " 03 4E 20 00 01");
    for (auto* board : {&*a, &*b}) (*board)->serial_channel()->handle_bytes(now, request, false);
    pass(10ms);
    std::optional<Bytes> answer;
    for (auto* board : {&*a, &*b}) {
      auto bytes = (*board)->serial_channel()->poll_transmit(now);
      EXPECT_EQ(bytes.has_value(), board == own);
      if (bytes) answer = bytes;
    }
    ASSERT_TRUE(answer);
    // The other board hears the answer on the line and keeps silent.
    auto* other = own == &*a ? &*b : &*a;
    (*other)->serial_channel()->handle_bytes(now, *answer, false);
    pass(10ms);
    EXPECT_FALSE((*other)->serial_channel()->poll_transmit(now));
  }
}

}  // namespace
}  // namespace vinv::test
