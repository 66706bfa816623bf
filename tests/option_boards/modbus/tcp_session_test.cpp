// Modbus/TCP connections. MODBUS Messaging on TCP/IP Implementation Guide V1.0b: 3.1.3, 4.4.1.
#include "option_boards/modbus/tcp_session.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "sim/base/random.hpp"
#include "tests/option_boards/modbus/scripted_unit.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::modbus {
namespace {

using namespace std::chrono_literals;
using test::adu;
using test::from_hex;
using test::to_hex;

class TcpSessionTest : public ::testing::Test {
 protected:
  TcpSessionTest() {
    table.add(unit);
    table.add(other);
  }
  std::vector<std::string> drain(TcpSession& from) {
    std::vector<std::string> answers;
    while (auto bytes = from.poll_transmit(now)) answers.push_back(to_hex(*bytes));
    return answers;
  }
  static Bytes concat(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  Instant now = instant_from_ns(3'000'000'000);
  test::ScriptedUnit unit{5}, other{6};
  UnitTable table;
  TcpSession session{1, table};
};

using Strings = std::vector<std::string>;

TEST_F(TcpSessionTest, AnswersWithTheRequestsTransactionAndUnitIdentifier) {
  session.handle_bytes(now, from_hex("15 01 00 00 00 06 05 03 00 04 00 01"));
  EXPECT_TRUE(session.awaiting_answer());
  EXPECT_EQ(drain(session), Strings{"15 01 00 00 00 06 05 03 00 04 00 01"});
  EXPECT_FALSE(session.awaiting_answer());
  ASSERT_EQ(unit.asked.size(), 1u);
  EXPECT_EQ(to_hex(unit.asked[0].pdu), "03 00 04 00 01");
  EXPECT_EQ(unit.asked[0].client, 1u);
  EXPECT_FALSE(session.close_requested());
}

TEST_F(TcpSessionTest, EverySplitOfTheStreamGivesTheSameAnswers) {
  const Bytes stream = concat({adu(1, 5, "03 00 04 00 01"), adu(2, 6, "06 65 90 00 01"), adu(3, 5, "2B 0E 01 00")});
  const Strings expected{"00 01 00 00 00 06 05 03 00 04 00 01", "00 02 00 00 00 06 06 06 65 90 00 01",
                         "00 03 00 00 00 05 05 2B 0E 01 00"};
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    TcpSession split(2, table);
    split.handle_bytes(now, ByteView(stream).first(cut));
    split.handle_bytes(now, ByteView(stream).subspan(cut));
    EXPECT_EQ(drain(split), expected) << cut;
  }
}

TEST_F(TcpSessionTest, OneBytePerSecondDelaysNoOtherConnection) {
  const Bytes slow = adu(9, 5, "03 00 04 00 01");
  TcpSession quick(2, table);
  std::uint16_t transaction = 100;
  for (const std::uint8_t byte : slow) {
    EXPECT_TRUE(drain(session).empty());
    session.handle_bytes(now, Bytes{byte});
    now += 1s;
    quick.handle_bytes(now, adu(++transaction, 5, "03 00 00 00 01"));
    EXPECT_EQ(drain(quick).size(), 1u);
  }
  EXPECT_EQ(drain(session), Strings{to_hex(slow)});
}

TEST_F(TcpSessionTest, PipelinedRequestsAreGivenToTheUnitOneByOneAndAnsweredInOrder) {
  unit.answer_at_once = false;
  session.handle_bytes(now,
                       concat({adu(1, 5, "06 00 01 00 01"), adu(2, 5, "06 00 01 00 02"), adu(3, 6, "03 00 01 00 01")}));
  EXPECT_TRUE(drain(session).empty());
  EXPECT_EQ(unit.asked.size(), 1u);
  EXPECT_TRUE(other.asked.empty());
  unit.decide();
  EXPECT_EQ(drain(session), Strings{"00 01 00 00 00 06 05 06 00 01 00 01"});
  EXPECT_EQ(unit.asked.size(), 2u);
  EXPECT_TRUE(session.awaiting_answer());
  unit.decide();
  EXPECT_EQ(drain(session), (Strings{"00 02 00 00 00 06 05 06 00 01 00 02", "00 03 00 00 00 06 06 03 00 01 00 01"}));
  EXPECT_FALSE(session.awaiting_answer());
}

TEST_F(TcpSessionTest, RequestBeyondTheQueueLimitIsRefusedAsBusyAtOnce) {
  unit.answer_at_once = false;
  for (std::uint16_t i = 0; i < TcpSession::kMaxQueuedRequests; ++i)
    session.handle_bytes(now, adu(i, 5, "06 00 01 00 01"));
  EXPECT_TRUE(drain(session).empty());
  session.handle_bytes(now, adu(0x77, 5, "06 00 01 00 01"));
  EXPECT_EQ(drain(session), Strings{"00 77 00 00 00 03 05 86 06"});
  for (std::uint16_t i = 0; i < TcpSession::kMaxQueuedRequests; ++i) {
    unit.decide();
    const Strings answers = drain(session);
    ASSERT_EQ(answers.size(), 1u) << i;
    EXPECT_EQ(answers[0].substr(0, 5), to_hex(Bytes{0, static_cast<std::uint8_t>(i)}));
  }
  EXPECT_FALSE(session.close_requested());
}

TEST_F(TcpSessionTest, FloodWithoutTakingRefusalsIsClosed) {
  unit.answer_at_once = false;
  const std::size_t limit = TcpSession::kMaxQueuedRequests + TcpSession::kMaxQueuedRefusals;
  for (std::size_t i = 0; i < limit; ++i) session.handle_bytes(now, adu(1, 5, "06 00 01 00 01"));
  EXPECT_FALSE(session.close_requested());
  session.handle_bytes(now, adu(1, 5, "06 00 01 00 01"));
  EXPECT_TRUE(session.close_requested());
}

TEST_F(TcpSessionTest, UnknownUnitIsAGatewayTargetThatFailedToRespond) {
  for (const unsigned id : {0u, 1u, 4u, 7u, 247u, 248u, 255u}) {
    session.handle_bytes(now, adu(1, static_cast<std::uint8_t>(id), "03 00 04 00 01"));
    const Strings answers = drain(session);
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_EQ(answers[0], to_hex(adu(1, static_cast<std::uint8_t>(id), "83 0B")));
  }
}

TEST_F(TcpSessionTest, OnlyUnitAnswersForZeroAndTwoHundredFiftyFive) {
  UnitTable single;
  single.add(unit);
  TcpSession direct(3, single);
  direct.handle_bytes(
      now, concat({adu(1, 0, "03 00 04 00 01"), adu(2, 255, "03 00 04 00 01"), adu(3, 1, "03 00 04 00 01")}));
  EXPECT_EQ(drain(direct), (Strings{"00 01 00 00 00 06 00 03 00 04 00 01", "00 02 00 00 00 06 FF 03 00 04 00 01",
                                    "00 03 00 00 00 03 01 83 0B"}));
  ASSERT_EQ(unit.asked.size(), 2u);
  EXPECT_EQ(unit.asked[0].addressing, Addressing::kUnit);  // 0 is no broadcast on TCP
}

TEST_F(TcpSessionTest, UnitSwitchedOffWithARequestFailedToRespond) {
  unit.answer_at_once = false;
  session.handle_bytes(now, concat({adu(1, 5, "06 00 01 00 01"), adu(2, 6, "03 00 01 00 01")}));
  EXPECT_TRUE(drain(session).empty());
  unit.address_ = 0;
  EXPECT_EQ(drain(session), (Strings{"00 01 00 00 00 03 05 86 0B", "00 02 00 00 00 06 06 03 00 01 00 01"}));
  EXPECT_EQ(unit.forgotten, std::vector<ClientId>{1});
}

TEST_F(TcpSessionTest, RequestLostInAShortPowerFailureFailedToRespond) {
  unit.answer_at_once = false;
  session.handle_bytes(now, adu(1, 5, "06 00 01 00 01"));
  EXPECT_TRUE(drain(session).empty());
  unit.outstanding.clear();  // off and on again before anybody asked
  EXPECT_EQ(drain(session), Strings{"00 01 00 00 00 03 05 86 0B"});
}

TEST_F(TcpSessionTest, HeaderThatCannotBeModbusAsksToClose) {
  const std::vector<std::pair<const char*, const char*>> cases{
      {"00 01 00 01 00 06 05", "protocol identifier is not 0 (Modbus)"},
      {"00 01 80 00 00 06 05", "protocol identifier is not 0 (Modbus)"},
      {"00 01 00 00 00 00", "length field is outside 2-254"},
      {"00 01 00 00 00 01", "length field is outside 2-254"},
      {"00 01 00 00 00 FF", "length field is outside 2-254"},
      {"00 01 00 00 FF FF", "length field is outside 2-254"},
      {"47 45 54 20 2F 20 48 54 54 50", "protocol identifier is not 0 (Modbus)"},  // "GET / HTTP"
  };
  for (const auto& [bytes, reason] : cases) {
    TcpSession bad(4, table);
    bad.handle_bytes(now, from_hex(bytes));
    ASSERT_TRUE(bad.close_requested()) << bytes;
    EXPECT_EQ(*bad.close_requested(), reason) << bytes;
    bad.handle_bytes(now, adu(1, 5, "03 00 04 00 01"));
    EXPECT_TRUE(drain(bad).empty()) << bytes;
  }
  EXPECT_TRUE(unit.asked.empty());
}

TEST_F(TcpSessionTest, GoodRequestBeforeABadHeaderIsStillAnswered) {
  session.handle_bytes(now, concat({adu(1, 5, "03 00 04 00 01"), from_hex("00 02 00 07 00 06 05 03 00 04 00 01")}));
  EXPECT_TRUE(session.close_requested());
  EXPECT_EQ(drain(session), Strings{"00 01 00 00 00 06 05 03 00 04 00 01"});
}

TEST_F(TcpSessionTest, ShortestAndLongestAdusAreTaken) {
  session.handle_bytes(now, adu(1, 5, "07"));
  const Bytes longest_pdu(kMaxPdu, 0x41);
  session.handle_bytes(now, adu(2, 5, to_hex(longest_pdu)));
  const Strings answers = drain(session);
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0], "00 01 00 00 00 02 05 07");
  ASSERT_EQ(unit.asked.size(), 2u);
  EXPECT_EQ(unit.asked[1].pdu, longest_pdu);
}

TEST_F(TcpSessionTest, ClosedConnectionIsForgottenByTheUnit) {
  unit.answer_at_once = false;
  {
    TcpSession gone(8, table);
    gone.handle_bytes(now, concat({adu(1, 5, "06 00 01 00 01"), adu(2, 5, "06 00 01 00 02")}));
    EXPECT_TRUE(drain(gone).empty());
  }
  EXPECT_EQ(unit.forgotten, std::vector<ClientId>{8});
  EXPECT_EQ(unit.asked.size(), 1u);  // what waited was never started
  session.handle_closed();
  EXPECT_EQ(unit.forgotten.size(), 1u);
}

}  // namespace
}  // namespace vinv::modbus
