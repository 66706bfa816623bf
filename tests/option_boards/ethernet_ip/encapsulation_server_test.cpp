// Encapsulation commands over TCP and UDP as bytes. CIP Vol 2, 2-4 (commands), table 2-3.3 (status).
#include "option_boards/ethernet_ip/encapsulation_server.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using namespace std::chrono_literals;
using test::AdapterBench;
using test::encapsulated;
using test::from_hex;
using test::join;
using test::le16;
using test::le32;
using test::Master;
using test::to_hex;

constexpr Ipv4Endpoint kAsker{ipv4(127, 0, 0, 1), 40'000};

std::uint32_t status_of(const Bytes& answer) { return answer.size() < 24 ? 0xffffffff : read_le32(answer, 8); }

class EncapsulationServerTest : public ::testing::Test {
 protected:
  AdapterBench bench;
};

TEST_F(EncapsulationServerTest, ListServicesTellsTcpAndClass0And1) {
  Master m(bench);
  EXPECT_EQ(to_hex(m.command(0x04)),
            "04 00 1A 00 00 00 00 00 00 00 00 00 01 02 03 04 05 06 07 08 00 00 00 00 "
            "01 00 00 01 14 00 01 00 20 01 43 6F 6D 6D 75 6E 69 63 61 74 69 6F 6E 73 00 00");
}

constexpr const char* kIdentityAnswer =
    "63 00 2C 00 00 00 00 00 00 00 00 00 01 02 03 04 05 06 07 08 00 00 00 00 "
    "01 00 0C 00 26 00 01 00 00 02 AF 12 7F 00 00 05 00 00 00 00 00 00 00 00 "
    "A1 00 02 00 38 00 01 0A 30 00 EE FF C0 00 04 41 37 30 30 03";

TEST_F(EncapsulationServerTest, ListIdentityTellsWhoAndWhere) {
  Master m(bench);
  EXPECT_EQ(to_hex(m.command(0x63)), kIdentityAnswer);
}

TEST_F(EncapsulationServerTest, ListIdentityByUdpIsAnsweredAtOnce) {
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x63, 0, {}));
  const auto sent = bench.take(Channel::kUdp);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(to_hex(sent[0].bytes), kIdentityAnswer);
  EXPECT_EQ(sent[0].to, kAsker);
}

TEST_F(EncapsulationServerTest, ListInterfacesHasNone) {
  Master m(bench);
  EXPECT_EQ(to_hex(m.command(0x64)), "64 00 02 00 00 00 00 00 00 00 00 00 01 02 03 04 05 06 07 08 00 00 00 00 00 00");
}

TEST_F(EncapsulationServerTest, NopIsNotAnswered) {
  Master m(bench);
  EXPECT_EQ(m.command(0x00, {1, 2, 3}), Bytes{});
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x00, 0, {}));
  EXPECT_TRUE(bench.take(Channel::kUdp).empty());
}

TEST_F(EncapsulationServerTest, BroadcastAnswersWaitForARandomTimeWithinTheOneAskedFor) {
  Bytes ask = encapsulated(0x63, 0, {});
  ask[12] = 0xe8;  // 1000 ms in the sender context
  ask[13] = 0x03;
  std::vector<Instant> answers;
  const Instant asked = bench.now;
  for (int i = 0; i < 20; ++i) bench.adapter.handle_udp(bench.now, kAsker, ask, Cast::kBroadcast);
  EXPECT_TRUE(bench.take(Channel::kUdp).empty());
  bench.advance(3s);
  for (const auto& p : bench.take(Channel::kUdp)) {
    answers.push_back(p.at);
    EXPECT_EQ(p.to, kAsker);
    EXPECT_EQ(p.dscp, kExplicitDscp);
    EXPECT_EQ(to_hex(ByteView(p.bytes).subspan(12, 8)), "E8 03 03 04 05 06 07 08") << "the sender's context";
  }
  ASSERT_EQ(answers.size(), 20u);
  EXPECT_LT(answers.back(), asked + 1000ms);
  EXPECT_GT(answers.back(), asked + 500ms);
  EXPECT_LT(answers.front(), asked + 300ms);
}

TEST_F(EncapsulationServerTest, BroadcastDelayHasADefaultAndALeastMaximum) {
  Bytes ask = encapsulated(0x63, 0, {});
  for (const auto& [asked, longest] : {std::pair{0u, 2000ms}, std::pair{1u, 500ms}}) {
    ask[12] = static_cast<std::uint8_t>(asked);
    ask[13] = 0;
    const Instant from = bench.now;
    for (std::size_t i = 0; i < EncapsulationServer::kMaxDelayedAnswers + 5; ++i)
      bench.adapter.handle_udp(bench.now, kAsker, ask, Cast::kBroadcast);
    bench.advance(3s);
    const auto sent = bench.take(Channel::kUdp);
    ASSERT_EQ(sent.size(), EncapsulationServer::kMaxDelayedAnswers);  // the rest found no place
    EXPECT_LT(sent.back().at, from + longest);
    EXPECT_GT(sent.back().at, from + longest * 2 / 3);
  }
}

TEST_F(EncapsulationServerTest, SessionCommandsByUdpAreInvalid) {
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x65, 0, from_hex("01 00 00 00")));
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x6f, 0, {}));
  const auto sent = bench.take(Channel::kUdp);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(status_of(sent[0].bytes), 0x01u);
  EXPECT_EQ(status_of(sent[1].bytes), 0x01u);
}

TEST_F(EncapsulationServerTest, BrokenDatagramsAreNotAnswered) {
  const Bytes good = encapsulated(0x63, 0, {});
  bench.adapter.handle_udp(bench.now, kAsker, ByteView(good).first(23));
  bench.adapter.handle_udp(bench.now, kAsker, join({good, {0}}));
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x6f, 0, {}), Cast::kBroadcast);
  bench.advance(3s);
  EXPECT_TRUE(bench.take(Channel::kUdp).empty());
}

TEST_F(EncapsulationServerTest, RegisterSessionGivesAHandle) {
  Master m(bench);
  const Bytes answer = m.command(0x65, from_hex("01 00 00 00"));
  ASSERT_EQ(answer.size(), 28u);
  EXPECT_NE(read_le32(answer, 4), 0u);
  EXPECT_EQ(status_of(answer), 0u);
  EXPECT_EQ(to_hex(ByteView(answer).subspan(24)), "01 00 00 00");
  EXPECT_EQ(bench.adapter.sessions(), 1u);
}

TEST_F(EncapsulationServerTest, AnotherRevisionIsAnsweredWithOurs) {
  Master m(bench);
  for (const char* wrong : {"02 00 00 00", "00 00 00 00", "01 00 01 00"}) {
    const Bytes answer = m.command(0x65, from_hex(wrong));
    EXPECT_EQ(status_of(answer), 0x69u) << wrong;
    EXPECT_EQ(to_hex(ByteView(answer).subspan(24)), "01 00 00 00");
  }
  EXPECT_EQ(bench.adapter.sessions(), 0u);
}

TEST_F(EncapsulationServerTest, SecondSessionOnAConnectionIsInvalid) {
  auto m = Master::registered(bench);
  const Bytes answer = m.command(0x65, from_hex("01 00 00 00"));
  EXPECT_EQ(status_of(answer), 0x01u);
  EXPECT_EQ(read_le32(answer, 4), m.session);
  EXPECT_EQ(bench.adapter.sessions(), 1u);
}

TEST_F(EncapsulationServerTest, SessionIsOfNoUseOnAnotherConnection) {
  auto a = Master::registered(bench);
  auto b = Master::registered(bench);
  EXPECT_NE(a.session, b.session);
  b.session = a.session;
  b.request(from_hex("0E 03 20 70 24 01 30 01"));
  EXPECT_EQ(status_of(b.last), 0x64u);
  EXPECT_EQ(status_of(b.command(0x66)), 0x64u);
  EXPECT_TRUE(bench.closed.empty());
  EXPECT_EQ(bench.device.object.requests, 0);
}

TEST_F(EncapsulationServerTest, WithoutSessionNothingIsServed) {
  Master m(bench);
  m.request(from_hex("0E 03 20 70 24 01 30 01"));
  EXPECT_EQ(status_of(m.last), 0x64u);
  EXPECT_EQ(status_of(m.command(0x70, Bytes(8, 0))), 0x64u);
  EXPECT_EQ(bench.device.object.requests, 0);
}

TEST_F(EncapsulationServerTest, UnRegisterSessionClosesWithoutAnswer) {
  auto m = Master::registered(bench);
  EXPECT_EQ(m.command(0x66), Bytes{});
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
  EXPECT_EQ(bench.adapter.tcp_connections(), 0u);
}

TEST_F(EncapsulationServerTest, UnknownCommandsAreInvalid) {
  Master m(bench);
  for (const unsigned command : {0x0001u, 0x0072u, 0x0073u, 0x00c8u, 0xffffu})
    EXPECT_EQ(status_of(m.command(command)), 0x01u) << command;
}

TEST_F(EncapsulationServerTest, WrongLengthsAreRefused) {
  auto m = Master::registered(bench);
  EXPECT_EQ(status_of(m.command(0x65, from_hex("01 00 00"))), 0x65u);
  EXPECT_EQ(status_of(m.command(0x63, {0})), 0x65u);
  EXPECT_EQ(status_of(m.command(0x04, {0})), 0x65u);
  EXPECT_EQ(status_of(m.command(0x64, {0})), 0x65u);
  EXPECT_EQ(status_of(m.command(0x66, {0})), 0x65u);
  EXPECT_EQ(status_of(m.command(0x6f, Bytes(5, 0))), 0x65u);
  EXPECT_EQ(status_of(m.command(0x70, Bytes(5, 0))), 0x65u);
  EXPECT_EQ(status_of(m.command(0x6f, Bytes(kMaxEncapsulatedData + 1, 0))), 0x65u);
  EXPECT_EQ(status_of(m.command(0x63)), 0x00u);  // and the stream goes on
}

TEST_F(EncapsulationServerTest, MalformedPacketsAreIncorrectData) {
  auto m = Master::registered(bench);
  const Bytes null_item = test::item(0, {});
  const Bytes prefix = join({le32(0), le16(0)});
  EXPECT_EQ(status_of(m.command(0x6f, join({prefix, le16(0)}))), 0x03u);
  EXPECT_EQ(status_of(m.command(0x6f, prefix)), 0x03u);
  EXPECT_EQ(status_of(m.command(0x6f, join({prefix, le16(2), null_item, test::item(0xb1, {})}))), 0x03u);
  const Bytes other_interface = join({le32(1), le16(0), le16(2), null_item, test::item(0xb2, {1})});
  EXPECT_EQ(status_of(m.command(0x6f, other_interface)), 0x03u);
  // Connected data does not come with SendRRData, nor unconnected data with SendUnitData.
  EXPECT_EQ(status_of(m.command(0x6f, join({prefix, le16(2), test::item(0xa1, le32(1)), test::item(0xb1, {0, 0})}))),
            0x03u);
  EXPECT_EQ(status_of(m.command(0x70, join({prefix, le16(2), null_item, test::item(0xb2, {1})}))), 0x03u);
}

TEST_F(EncapsulationServerTest, RequestsWithStatusOrOptionsAreIgnored) {
  Master m(bench);
  Bytes with_status = encapsulated(0x63, 0, {});
  with_status[8] = 1;
  EXPECT_EQ(m.send(with_status), Bytes{});
  Bytes with_options = encapsulated(0x63, 0, {});
  with_options[20] = 1;
  EXPECT_EQ(m.send(with_options), Bytes{});
}

TEST_F(EncapsulationServerTest, HalfAMessageClosesTheConnectionAfterAWhile) {
  auto m = Master::registered(bench);
  m.send(from_hex("6F 00 10 00"));
  bench.advance(kPartialMessageTimeout - 1ms);
  EXPECT_TRUE(bench.closed.empty());
  bench.advance(1ms);
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
}

TEST_F(EncapsulationServerTest, DrippingBytesDoNotKeepAHalfMessageAlive) {
  auto m = Master::registered(bench);
  const Bytes message = encapsulated(0x6f, m.session, Bytes(100, 0));
  for (std::size_t i = 0; i < 30 && bench.closed.empty(); ++i) {
    m.send({message[i]});
    bench.advance(500ms);
  }
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
}

TEST_F(EncapsulationServerTest, ConnectionWithoutSessionIsClosedAfterAWhile) {
  Master m(bench);
  auto registered = Master::registered(bench);
  bench.advance(29s);
  EXPECT_TRUE(bench.closed.empty());
  bench.advance(1s);
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
  bench.advance(1h);
  EXPECT_EQ(bench.closed.size(), 1u);
}

TEST(EncapsulationLimitsTest, InactiveSessionIsClosedIfTheDeviceHasSuchATime) {
  AdapterOptions options;
  options.encapsulation.inactivity_timeout = 120s;
  AdapterBench bench(options);
  auto m = Master::registered(bench);
  bench.advance(100s);
  m.command(0x00);
  bench.advance(119s);
  EXPECT_TRUE(bench.closed.empty());
  bench.advance(1s);
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
}

TEST(EncapsulationLimitsTest, NewcomerTakesThePlaceOfTheOldestWithoutSession) {
  AdapterOptions options;
  options.encapsulation.tcp_connections = 3;
  AdapterBench bench(options);
  auto a = Master::registered(bench);
  bench.advance(1s);
  Master b(bench);
  bench.advance(1s);
  Master c(bench);
  Master d(bench);
  EXPECT_NE(d.tcp, 0u);
  bench.poll();
  EXPECT_EQ(bench.closed, std::vector<TcpId>{b.tcp});
  c.register_session();
  d.register_session();
  Master e(bench);
  EXPECT_EQ(e.tcp, 0u);
  EXPECT_NE(a.request(from_hex("0E 03 20 70 24 01 30 01")), Bytes{});
}

TEST(EncapsulationLimitsTest, OneSessionTooManyIsInsufficientMemory) {
  AdapterOptions options;
  options.encapsulation.sessions = 1;
  AdapterBench bench(options);
  auto a = Master::registered(bench);
  Master b(bench);
  EXPECT_EQ(status_of(b.command(0x65, from_hex("01 00 00 00"))), 0x02u);
  bench.adapter.handle_tcp_closed(bench.now, a.tcp);
  EXPECT_EQ(status_of(b.command(0x65, from_hex("01 00 00 00"))), 0x00u);
}

TEST(EncapsulationLimitsTest, FloodOfRequestsInOneCallIsBounded) {
  AdapterBench bench;
  Master m(bench);
  Bytes flood;
  for (int i = 0; i < 20'000; ++i) {
    const Bytes one = encapsulated(0x63, 0, {});
    flood.insert(flood.end(), one.begin(), one.end());
  }
  EXPECT_LE(m.send(flood).size(), OutQueue::kMaxQueuedBytes + 512);
  EXPECT_EQ(m.command(0x63).size(), 68u);
}

TEST_F(EncapsulationServerTest, StoppedAdapterIsDeafAndClosesItsConnections) {
  auto m = Master::registered(bench);
  bench.adapter.stop();
  bench.poll();
  EXPECT_EQ(bench.closed, std::vector<TcpId>{m.tcp});
  EXPECT_FALSE(bench.adapter.handle_tcp_open(bench.now, kAsker));
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x63, 0, {}));
  bench.advance(10s);
  EXPECT_TRUE(bench.take(Channel::kUdp).empty());
  bench.adapter.start({ipv4(127, 0, 0, 9), 0, 2222});
  bench.adapter.handle_udp(bench.now, kAsker, encapsulated(0x63, 0, {}));
  EXPECT_EQ(bench.take(Channel::kUdp).size(), 1u);
}

}  // namespace
}  // namespace vinv::ethernet_ip
