// Explicit messages: unconnected, in an Unconnected_Send, over class 3; answers that come later. CIP Vol 1, 3-4.4.6,
// 3-5.5.4; Vol 2, 2-4.7 and 2-4.8.
#include <gtest/gtest.h>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using namespace std::chrono_literals;
using test::AdapterBench;
using test::from_hex;
using test::Master;
using test::OpenWish;
using test::to_hex;

constexpr const char* kGet = "0E 03 20 70 24 01 30 01";
constexpr const char* kSet = "10 03 20 70 24 01 30 01 05 00";

class ExplicitMessagesTest : public ::testing::Test {
 protected:
  ExplicitMessagesTest() : master(Master::registered(bench)) {
    wish.serial = 7;
    wish.transport = 0xa3;
    wish.o2t = wish.t2o = 0x4000 | 500;
    wish.path = "20 02 24 01";
    wish.t2o_id = 0xcafe0001;
  }
  void finish(std::size_t i) {
    cip::Reply reply;
    bench.device.router().complete(bench.device.object.tickets.at(i), reply);
  }
  std::vector<std::string> tcp() { return bench.take_hex(Channel::kTcp); }

  AdapterBench bench;
  Master master;
  OpenWish wish;
};

TEST_F(ExplicitMessagesTest, WholeFrameOfAGetAttributeSingle) {
  EXPECT_EQ(master.request_hex(kGet), "8E 00 00 00 34 12");
  const std::string session = to_hex(test::le32(master.session));
  EXPECT_EQ(to_hex(master.last), "6F 00 16 00 " + session +
                                     " 00 00 00 00 01 02 03 04 05 06 07 08 00 00 00 00 00 00 00 00 00 00 02 00 "
                                     "00 00 00 00 B2 00 06 00 8E 00 00 00 34 12");
}

TEST_F(ExplicitMessagesTest, RouterRefusals) {
  EXPECT_EQ(master.request_hex("0E 03 20 99 24 01 30 01"), "8E 00 05 00");
  EXPECT_EQ(master.request_hex("0E 02 30 01 20 70"), "8E 00 04 00");
  EXPECT_EQ(master.request_hex("0E 09 20 70"), "8E 00 26 00");
  EXPECT_EQ(master.request_hex("4B 03 20 70 24 01 30 01"), "CB 00 08 00");
}

TEST_F(ExplicitMessagesTest, UnconnectedSendIsAnsweredByWhatIsInIt) {
  EXPECT_EQ(master.request_hex("52 02 20 06 24 01 0A 0E 08 00 0E 03 20 70 24 01 30 01 00 00"), "8E 00 00 00 34 12");
}

TEST_F(ExplicitMessagesTest, UnconnectedSendElsewhereIsRefused) {
  EXPECT_EQ(master.request_hex("52 02 20 06 24 01 0A 0E 08 00 0E 03 20 70 24 01 30 01 01 00 01 00"),
            "D2 00 01 01 11 03 01 00");
  EXPECT_EQ(master.request_hex("52 02 20 06 24 01 0A 0E 09 00 0E 03 20 70 24 01 30 01 00 00"),
            "D2 00 01 01 05 02 00 00");
  EXPECT_EQ(bench.device.object.requests, 0);
}

TEST_F(ExplicitMessagesTest, AnswerThatComesLaterGoesToWhoAsked) {
  auto other = Master::registered(bench);
  EXPECT_EQ(master.request(from_hex(kSet)), Bytes{});
  EXPECT_EQ(other.request_hex(kGet), "8E 00 00 00 34 12");  // nobody else waits
  finish(0);
  const auto sent = bench.take(Channel::kTcp);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].connection, master.tcp);
  EXPECT_EQ(to_hex(ByteView(sent[0].bytes).last(4)), "90 00 00 00");
  EXPECT_EQ(to_hex(ByteView(sent[0].bytes).subspan(12, 8)), "01 02 03 04 05 06 07 08");
}

TEST_F(ExplicitMessagesTest, WhoIsGoneGetsNoAnswer) {
  master.request(from_hex(kSet));
  bench.adapter.handle_tcp_closed(bench.now, master.tcp);
  EXPECT_FALSE(bench.device.router().awaits(bench.device.object.tickets[0]));
  finish(0);
  EXPECT_TRUE(tcp().empty());
  EXPECT_EQ(to_hex(bench.device.object.last_write), "05 00");
}

TEST_F(ExplicitMessagesTest, Class3CarriesRequestsWithTheirSequenceCount) {
  const auto id = master.open_id(wish);
  ASSERT_NE(id, 0u);
  EXPECT_EQ(to_hex(master.connected(id, 1, from_hex(kGet))), "01 00 8E 00 00 00 34 12");
  EXPECT_EQ(to_hex(master.connected(id, 2, from_hex(kGet))), "02 00 8E 00 00 00 34 12");
  EXPECT_EQ(bench.device.object.requests, 2);
}

TEST_F(ExplicitMessagesTest, Class3AnswerGoesToTheOriginatorsIdentifier) {
  const auto id = master.open_id(wish);
  const Bytes whole =
      master.command(0x70, test::join({test::le32(0), test::le16(0), test::le16(2), test::item(0xa1, test::le32(id)),
                                       test::item(0xb1, test::join({test::le16(1), from_hex(kGet)}))}));
  EXPECT_EQ(to_hex(ByteView(whole).subspan(24, 20)), "00 00 00 00 00 00 02 00 A1 00 04 00 01 00 FE CA B1 00 08 00");
}

TEST_F(ExplicitMessagesTest, RepeatedClass3RequestGetsTheOldAnswerAndIsNotCarriedOutAgain) {
  const auto id = master.open_id(wish);
  master.connected(id, 5, from_hex(kGet));
  bench.device.object.data = {9, 9};
  EXPECT_EQ(to_hex(master.connected(id, 5, from_hex(kGet))), "05 00 8E 00 00 00 34 12");
  EXPECT_EQ(bench.device.object.requests, 1);
}

TEST_F(ExplicitMessagesTest, RepeatedClass3RequestThatIsUnderWayStaysOne) {
  const auto id = master.open_id(wish);
  EXPECT_EQ(master.connected(id, 1, from_hex(kSet)), Bytes{});
  EXPECT_EQ(master.connected(id, 1, from_hex(kSet)), Bytes{});
  EXPECT_EQ(bench.device.object.requests, 1);
  finish(0);
  ASSERT_EQ(tcp().size(), 1u);
  EXPECT_EQ(to_hex(master.connected(id, 1, from_hex(kSet))), "01 00 90 00 00 00");
}

TEST_F(ExplicitMessagesTest, NewClass3RequestReplacesTheOneUnderWay) {
  const auto id = master.open_id(wish);
  master.connected(id, 1, from_hex(kSet));
  EXPECT_EQ(to_hex(master.connected(id, 2, from_hex(kGet))), "02 00 8E 00 00 00 34 12");
  finish(0);
  EXPECT_TRUE(tcp().empty());
}

TEST_F(ExplicitMessagesTest, Class3AnswerThatDoesNotFitIsRefused) {
  wish.t2o = 0x4000 | 16;
  const auto id = master.open_id(wish);
  bench.device.object.data = Bytes(10, 1);
  EXPECT_EQ(master.connected(id, 1, from_hex(kGet)).size(), 16u);
  bench.device.object.data = Bytes(11, 1);
  EXPECT_EQ(to_hex(master.connected(id, 2, from_hex(kGet))), "02 00 8E 00 11 00");
}

TEST_F(ExplicitMessagesTest, Class3MessageLargerThanAgreedIsDropped) {
  wish.o2t = 0x4000 | 10;
  const auto id = master.open_id(wish);
  EXPECT_EQ(to_hex(master.connected(id, 1, from_hex(kGet))), "01 00 8E 00 00 00 34 12");
  EXPECT_EQ(master.connected(id, 2, from_hex(kSet)), Bytes{});
  EXPECT_EQ(bench.device.object.requests, 1) << "nobody has seen it";
}

// The answer before is not the answer to what is under way.
TEST_F(ExplicitMessagesTest, RepeatedClass3RequestUnderWayHasNoAnswerOfAnEarlierOne) {
  const auto id = master.open_id(wish);
  EXPECT_EQ(to_hex(master.connected(id, 1, from_hex(kGet))), "01 00 8E 00 00 00 34 12");
  EXPECT_EQ(master.connected(id, 2, from_hex(kSet)), Bytes{});
  EXPECT_EQ(master.connected(id, 2, from_hex(kSet)), Bytes{});
}

TEST_F(ExplicitMessagesTest, EndOfATcpConnectionIsThatOfItsOwnClass3ConnectionsOnly) {
  auto other = Master::registered(bench);
  OpenWish second = wish;
  second.serial = 2;
  ASSERT_NE(master.open_id(wish), 0u);
  const auto id = other.open_id(second);
  bench.adapter.handle_tcp_closed(bench.now, master.tcp);
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 1u);
  EXPECT_EQ(to_hex(other.connected(id, 1, from_hex(kGet))), "01 00 8E 00 00 00 34 12");
}

TEST_F(ExplicitMessagesTest, Class3ConnectionBelongsToItsTcpConnection) {
  const auto id = master.open_id(wish);
  auto other = Master::registered(bench);
  EXPECT_EQ(other.connected(id, 1, from_hex(kGet)), Bytes{});
  bench.adapter.handle_tcp_closed(bench.now, master.tcp);
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 0u);
}

TEST_F(ExplicitMessagesTest, Class3TimesOutWithoutRequests) {
  wish.o2t_rpi_us = 1'000'000;
  wish.multiplier = 1;
  const auto id = master.open_id(wish);
  bench.advance(9s);
  master.connected(id, 1, from_hex(kGet));
  bench.advance(7s);
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 1u);
  bench.advance(1s);
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 0u);
  EXPECT_EQ(master.connected(id, 2, from_hex(kGet)), Bytes{});
}

TEST_F(ExplicitMessagesTest, DeviceHearsOfClass3Connections) {
  wish.o2t_rpi_us = 1'000'000;
  master.open_id(wish);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"explicit opened"});
  bench.advance(10s);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"explicit timed out"});
  master.open_id(wish);
  master.close(wish);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"explicit opened", "explicit closed"}));
  master.open_id(wish);
  bench.adapter.handle_tcp_closed(bench.now, master.tcp);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"explicit opened", "explicit closed"}));
}

TEST_F(ExplicitMessagesTest, Class3TimeoutForgetsTheAnswerUnderWay) {
  const auto id = master.open_id(wish);
  master.connected(id, 1, from_hex(kSet));
  bench.advance(11s);
  EXPECT_FALSE(bench.device.router().awaits(bench.device.object.tickets[0]));
}

TEST_F(ExplicitMessagesTest, ConnectionClosedThroughItself) {
  const auto id = master.open_id(wish);
  const Bytes close = from_hex("4E 02 20 06 24 01 0A 0E 07 00 37 13 2A 00 00 00 02 00 20 02 24 01");
  EXPECT_EQ(master.connected(id, 1, close), Bytes{});
  EXPECT_EQ(bench.adapter.connections().explicit_connections(), 0u);
}

TEST_F(ExplicitMessagesTest, IoIsOpenedThroughClass3) {
  const auto id = master.open_id(wish);
  const Bytes open = from_hex(
      "54 02 20 06 24 01 0A 0E 00 00 00 00 44 33 22 11 01 00 37 13 2A 00 00 00 00 00 00 00 10 27 00 00 0A 48 "
      "10 27 00 00 06 48 01 03 20 04 2C 15 2C 47");
  EXPECT_EQ(to_hex(ByteView(master.connected(id, 1, open)).first(6)), "01 00 D4 00 00 00");
  const auto packets = bench.take(Channel::kIo);
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0].to, (Ipv4Endpoint{ipv4(127, 0, 0, 1), 2222}));
}

}  // namespace
}  // namespace vinv::ethernet_ip
