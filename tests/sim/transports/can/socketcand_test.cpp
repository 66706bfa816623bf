// linux-can/socketcand, doc/protocol.md, and what python-can 4.1 compares literally.
#include <gtest/gtest.h>

#include "sim/transports/can/socketcand_client.hpp"
#include "sim/transports/can/socketcand_session.hpp"
#include "tests/sim/kernel/allocation_count.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"
#include "tests/sim/transports/can/direct_stream.hpp"
#include "tests/sim/transports/can/text_client.hpp"

namespace vinv::transports {
namespace {

using std::chrono::milliseconds;

CanFrame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f = CanFrame::standard(id, bytes);
  f.extended = true;
  return f;
}

Result<CanFrame, std::string> parse(const std::string& inside) {
  return parse_socketcand_send(socketcand_words(inside));
}

TEST(SocketcandText, SendsAreParsedAsPythonCanAndTheProjectWriteThem) {
  EXPECT_EQ(*parse(" send 123 4 DE AD BE EF "), CanFrame::standard(0x123, {0xde, 0xad, 0xbe, 0xef}));
  EXPECT_EQ(*parse(" send 5 2 0 f "), CanFrame::standard(5, {0x00, 0x0f}));  // no leading zeros
  EXPECT_EQ(*parse(" send 123 0 "), CanFrame::standard(0x123, {}));
  EXPECT_EQ(*parse(" send 123 0  "), CanFrame::standard(0x123, {}));  // python-can leaves two blanks
  EXPECT_EQ(*parse(" send 1AAAAAAA 2 1 F1 "), extended(0x1aaaaaaa, {0x01, 0xf1}));
  EXPECT_EQ(*parse(" send 00000123 1 1 "), extended(0x123, {1}));
  EXPECT_EQ(*parse(" send 18FF0 1 1 "), extended(0x18ff0, {1}));  // 29 bits without leading zeros
  EXPECT_EQ(*parse(" sendrtr 705 1 "), CanFrame::remote_request(0x705, 1));
  EXPECT_EQ(parse(" sendrtr 1AAAAAAA 2 ")->extended, true);
}

TEST(SocketcandText, WhatIsNoFrameIsRefused) {
  for (const char* bad : {"send", "send 123", "send 123 9 1 2 3 4 5 6 7 8 9", "send 123 2 1", "send 123 1 1 2",
                          "send 123 1 100", "send 123 1 xy", "send 20000000 0", "send 123456789 0", "send -1 0",
                          "send 123 01 1", "sendrtr 123 1 FF", "send 1g3 0"}) {
    EXPECT_FALSE(parse(bad)) << bad;
  }
}

TEST(SocketcandText, FramesAreWrittenAsTheProjectWritesThem) {
  constexpr std::int64_t kTime = 1'700'000'000'123'456;
  EXPECT_EQ(socketcand_received(CanFrame::standard(0x123, {0xde, 0xad, 0xbe, 0xef}), kTime),
            "< frame 123 1700000000.123456 DEADBEEF >");
  EXPECT_EQ(socketcand_received(CanFrame::standard(0x005, {}), 1), "< frame 005 0.000001  >");
  EXPECT_EQ(socketcand_received(extended(0x1abc, {0x01}), kTime), "< frame 00001ABC 1700000000.123456 01 >");
  EXPECT_EQ(socketcand_received(CanFrame::remote_request(0x705, 4), 23'424'242), "< rtr 705 23.424242 4 >");
  EXPECT_EQ(socketcand_error(0x04, 1'000'000), "< error 004 1.000000 >");
}

TEST(SocketcandText, EitherSideReadsWhatTheOtherWrites) {
  CanFrame remote = CanFrame::remote_request(0x1abcdef, 8);
  remote.extended = true;
  for (const CanFrame& f :
       {CanFrame::standard(0x7ff, {1, 2, 3, 4, 5, 6, 7, 8}), CanFrame::standard(0, {}), extended(0x1fffffff, {0xff}),
        extended(5, {}), CanFrame::remote_request(0x705, 0), remote}) {
    const std::string sent = socketcand_send(f);
    EXPECT_EQ(*parse(sent.substr(1, sent.size() - 2)), f) << sent;
    const std::string received = socketcand_received(f, 1'700'000'000'000'042);
    const auto back = parse_socketcand_received(socketcand_words(received.substr(1, received.size() - 2)));
    ASSERT_TRUE(back) << received;
    EXPECT_EQ(back->frame, f);
    EXPECT_EQ(back->unix_us, 1'700'000'000'000'042);
  }
  // The project's bcm mode leaves blanks between the bytes.
  const auto spaced = parse_socketcand_received(socketcand_words(" frame 123 23.42 11 22 33 "));
  ASSERT_TRUE(spaced);
  EXPECT_EQ(spaced->frame, CanFrame::standard(0x123, {0x11, 0x22, 0x33}));
  EXPECT_EQ(spaced->unix_us, 23'420'000);
  for (const char* bad : {"frame 123", "frame 123 x 11", "frame 123 1.0 1", "frame 123 1.0 112233445566778899",
                          "frame 123 1.0000001 11", "rtr 123 1.0 9", "rtr 123 1.0 1 1", "frame 123 1.0 1x"}) {
    EXPECT_FALSE(parse_socketcand_received(socketcand_words(bad))) << bad;
  }
}

struct Server {
  explicit Server(CanBusOptions bus = {}) : bench(std::move(bus)) {
    options.buses = {{"vcan0", bench.bus.get()}};
    options.start_unix_ns = 1'700'000'000'000'000'000;
  }
  TextClient& connect() {
    TextClient& client = clients.emplace_back(bench.scheduler);
    sessions.push_back(std::make_unique<SocketcandSession>(bench.scheduler, bench.now(), options, std::move(client.far),
                                                           [this] { ++ended; }));
    bench.scheduler.run_until(bench.now());
    return client;
  }
  TextClient& connect_raw() {
    TextClient& client = connect();
    client.send("< open vcan0 >");
    client.send("< rawmode >");
    run(milliseconds(100));
    client.take();
    return client;
  }
  void run(Duration span) { bench.scheduler.run_until(bench.now() + span); }

  BusBench bench;
  SocketcandOptions options;
  std::deque<TextClient> clients;
  std::vector<std::unique_ptr<SocketcandSession>> sessions;
  int ended = 0;
};

TEST(SocketcandSession, TheHandshakeIsByteForByteAndLockStep) {
  Server s;
  TextClient& c = s.connect();
  EXPECT_EQ(c.take(), "< hi >");
  c.send("< open vcan0 >");
  EXPECT_EQ(c.take(), "< ok >");
  c.send("< rawmode >");
  EXPECT_EQ(c.take(), "< ok >");
  c.send("< echo >");
  EXPECT_EQ(c.take(), "< echo >");
  c.send("< bcmmode >");
  EXPECT_EQ(c.take(), "< ok >");
  EXPECT_EQ(s.bench.stats().nodes, 1u);
}

TEST(SocketcandSession, FramesPassBothWaysWithTheTimeOfTheBus) {
  Server s;
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect_raw();
  c.send("< send 601 8 40 0 10 0 0 0 0 0 >");
  s.run(milliseconds(10));
  EXPECT_NE(slave.log.find("601#4000100000000000"), std::string::npos);
  slave.node->send(s.bench.now(), CanFrame::standard(0, {}));  // 50 bits of 8 us from now
  s.run(milliseconds(10));
  // 1 s at the start, 100 ms for the handshake, 10 ms for the request.
  EXPECT_EQ(c.take(), " < frame 000 1700000001.110400  >");
  slave.node->send(s.bench.now(), CanFrame::remote_request(0x705, 1));
  s.run(milliseconds(10));
  EXPECT_EQ(c.take().substr(0, 29), " < rtr 705 1700000001.120368 ");
}

TEST(SocketcandSession, ABurstOfOneInstantIsOnePiece) {
  CanBusOptions options;
  options.timing = CanBusOptions::Timing::kNone;
  Server s(options);
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect_raw();
  const int before = c.pieces;
  for (std::uint8_t i = 0; i < 3; ++i) slave.node->send(s.bench.now(), CanFrame::standard(0x180, {i}));
  s.run(milliseconds(1));
  EXPECT_EQ(
      c.take(),
      " < frame 180 1700000001.100000 00 > < frame 180 1700000001.100000 01 > < frame 180 1700000001.100000 02 >");
  EXPECT_EQ(c.pieces, before + 1);
}

TEST(SocketcandSession, ARoundTripAllocatesNothing) {
  Server s;
  auto node = s.bench.bus->attach(s.bench.now(), {});
  node->set_handlers({[&](Instant now, const CanFrame& f) { node->send(now, f); }, {}, {}});
  DirectEnd client;
  const SocketcandSession session(s.bench.scheduler, s.bench.now(), s.options, std::make_unique<DirectStream>(client),
                                  {});
  for (const char* message : {"< open vcan0 >", "< rawmode >"}) client.say(s.bench.now(), message);
  s.run(milliseconds(100));
  std::uint64_t allocations = 0;
  for (int i = 0; i < 20; ++i) {
    if (i == 10) allocations = allocation_count();
    client.size = 0;
    client.say(s.bench.now(), "< send 601 8 40 0 10 0 0 0 0 0 >");
    s.run(milliseconds(10));
    EXPECT_EQ(client.size, 49u);
  }
  EXPECT_EQ(allocation_count(), allocations);
}

TEST(SocketcandSession, ManyMessagesInOnePieceOrOneInManyAreTheSame) {
  Server s;
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect();
  c.take();
  for (const char byte : std::string("< open vcan0 >< rawmode >")) c.send(std::string(1, byte));
  EXPECT_EQ(c.take(), "< ok >< ok >");
  c.send("noise\r\n< send 1 1 1 >\n< send 2 1 2 ><send 3 1 3>< se");
  c.send("nd 4 1 4 >< send 9 1 < send 5 1 5 >");  // an opening bracket begins anew
  s.run(milliseconds(10));
  EXPECT_EQ(slave.node->status().received, 5u);
  EXPECT_EQ(c.take(), "");
}

TEST(SocketcandSession, WhatIsUnknownOrWrongIsAnsweredWithAnError) {
  Server s;
  TextClient& c = s.connect();
  c.take();
  c.send("< send 123 0 >");
  EXPECT_EQ(c.take(), "< error no bus is open >");
  c.send("< open vcan0 >");
  c.take();
  for (const char* unknown : {"< nonsense >", "< >", "< open vcan0 >", "< add 1 0 123 1 11 >", "< isotpmode >",
                              "< controlmode >", "< echo echo >"}) {
    c.send(unknown);
    EXPECT_EQ(c.take(), "< error unknown command >") << unknown;
  }
  c.send("< send 123 3 1 >");
  EXPECT_EQ(c.take(), "< error length and data differ >");
  c.send("<" + std::string(1000, 'x') + ">");
  EXPECT_EQ(c.take(), "< error message too long >");
  c.send("< echo >");
  EXPECT_EQ(c.take(), "< echo >");
  EXPECT_EQ(s.ended, 0);
}

TEST(SocketcandSession, OfSeveralBusesTheNameChoosesAndAnUnknownOneEndsTheConnection) {
  Server s;
  CanBusOptions second;
  second.name = "line_b";
  CanBus other(s.bench.scheduler, second);
  s.options.buses.push_back({"line_b", &other});
  TextClient& c = s.connect();
  c.send("< open line_b >");
  EXPECT_EQ(c.take(), "< hi >< ok >");
  EXPECT_EQ(other.stats(s.bench.now()).nodes, 1u);
  TextClient& d = s.connect();
  d.send("< open can7 >");
  EXPECT_EQ(d.take(), "< hi >< error could not open bus >");
  EXPECT_TRUE(d.closed);
  EXPECT_EQ(s.ended, 1);
  s.sessions.clear();
}

TEST(SocketcandSession, FramesWaitWhileTheClientStillReadsAnOk) {
  Server s;
  auto& slave = s.bench.add("slave");
  auto& other = s.bench.add("other");
  TextClient& c = s.connect();
  c.send("< open vcan0 >");
  c.send("< rawmode >");
  slave.node->send(s.bench.now(), CanFrame::standard(1, {1}));
  s.run(milliseconds(10));
  EXPECT_EQ(other.node->status().received, 1u);
  EXPECT_EQ(c.take(), "< hi >< ok >< ok >");
  s.run(milliseconds(10));
  EXPECT_EQ(c.take().substr(0, 13), " < frame 001 ");
  // Whatever the client says shows that it has read the ok.
  c.send("< bcmmode >");
  c.send("< rawmode >");
  slave.node->send(s.bench.now(), CanFrame::standard(2, {}));
  s.run(milliseconds(2));
  EXPECT_EQ(c.take(), "< ok >< ok >");
  c.send("< send 3 0 >");
  EXPECT_EQ(c.take().substr(0, 13), " < frame 002 ");
}

TEST(SocketcandSession, InBcmModeOnlySendingWorks) {
  Server s;
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect();
  c.send("< open vcan0 >");
  c.take();
  c.send("< sendrtr 705 1 >");
  s.run(milliseconds(10));
  EXPECT_NE(slave.log.find("705#R1"), std::string::npos);
  slave.node->send(s.bench.now(), CanFrame::standard(1, {}));
  s.run(milliseconds(100));
  EXPECT_EQ(c.take(), "");
}

TEST(SocketcandSession, ItsNodeAcknowledgesAndLeavesWithTheClient) {
  Server s;
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect_raw();
  slave.node->send(s.bench.now(), CanFrame::standard(1, {}));
  s.run(milliseconds(10));
  EXPECT_EQ(slave.node->status().sent, 1u);
  c.end->close();
  s.run(milliseconds(10));
  EXPECT_EQ(s.ended, 1);
  EXPECT_EQ(s.bench.stats().nodes, 1u);
}

TEST(SocketcandSession, AFloodIsRefusedAtTheQueueAndTheRestArrives) {
  Server s;
  auto& slave = s.bench.add("slave");
  TextClient& c = s.connect_raw();
  std::string flood;
  for (int i = 0; i < 1000; ++i) flood += "< send 10 1 1 >";
  c.send(flood);
  const std::string answer = c.take();
  const std::string refusal = "< error transmit queue full >";
  const std::size_t refusals = answer.size() / refusal.size();
  EXPECT_EQ(answer.substr(0, refusal.size()), refusal);
  EXPECT_EQ(refusals, 1000 - SocketcandSession::kMaxQueuedFrames);
  s.run(std::chrono::seconds(2));
  EXPECT_EQ(slave.node->status().received, SocketcandSession::kMaxQueuedFrames);
}

TEST(SocketcandSession, ChangesOfItsControllerAreTold) {
  Server s;
  TextClient& c = s.connect_raw();
  c.send("< send 1 0 >");  // nobody acknowledges
  s.run(milliseconds(100));
  const std::string told = c.take();
  EXPECT_EQ(told.substr(0, 13), " < error 204 ");           // controller state, and counters
  EXPECT_EQ(std::count(told.begin(), told.end(), '<'), 2);  // warning, passive
}

// Our client against our server, in virtual time.
TEST(SocketcandClient, IsANodeOnTheBusOfTheServer) {
  Server s;
  auto& slave = s.bench.add("slave");
  auto link = make_memory_link(s.bench.scheduler);
  SocketcandSession session(s.bench.scheduler, s.bench.now(), s.options, std::move(link.first), {});
  SocketcandClient client(s.bench.scheduler, "vcan0", std::move(link.second));
  std::string log;
  client.set_handlers({[&](Instant, const CanFrame& f) { log += show(f) + " "; },
                       [&](Instant, const CanFrame& f) { log += "sent:" + show(f) + " "; },
                       [&](Instant, const CanStatus& st) { log += std::string(text(st.state)) + " "; }});
  EXPECT_EQ(client.status().state, CanState::kOffline);
  EXPECT_EQ(client.queue_room(), 0u);
  EXPECT_EQ(client.send(s.bench.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  s.run(milliseconds(50));
  EXPECT_EQ(log, "error active ");
  log.clear();
  EXPECT_EQ(client.send(s.bench.now(), extended(0x1abc, {1, 2})), CanSend::kQueued);
  EXPECT_EQ(log, "");  // send() does not call back
  s.run(milliseconds(50));
  slave.node->send(s.bench.now(), CanFrame::remote_request(0x705, 1));
  s.run(milliseconds(50));
  EXPECT_EQ(log, "sent:00001ABC#0102 705#R1 ");
  EXPECT_NE(slave.log.find("00001ABC#0102"), std::string::npos);
  EXPECT_FALSE(client.set_bitrate(s.bench.now(), 125'000));

  client.set_online(s.bench.now(), false);
  slave.node->send(s.bench.now(), CanFrame::standard(3, {}));
  s.run(milliseconds(50));
  EXPECT_EQ(log, "sent:00001ABC#0102 705#R1 offline ");
  client.set_online(s.bench.now(), true);
  EXPECT_EQ(client.status().state, CanState::kErrorActive);
}

TEST(SocketcandClient, ComplaintsAndTheEndOfTheServerAreSeen) {
  Server s;
  auto link = make_memory_link(s.bench.scheduler);
  TextClient server(s.bench.scheduler);
  SocketcandClient client(s.bench.scheduler, "line_b", std::move(server.far));
  s.run(milliseconds(1));
  server.send("< hi >");
  EXPECT_EQ(server.take(), "< open line_b >");
  server.send("< ok >");
  EXPECT_EQ(server.take(), "< rawmode >");
  server.send("< ok >");
  EXPECT_EQ(client.status().state, CanState::kErrorActive);
  server.send("< error 204 1.000000 >");  // a controller's, without detail in this protocol
  EXPECT_EQ(client.status().state, CanState::kErrorActive);
  server.send("< error 040 1.000000 >");
  EXPECT_EQ(client.status().state, CanState::kBusOff);
  EXPECT_EQ(client.send(s.bench.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  server.send("< error 100 1.000000 >");
  EXPECT_EQ(client.status().state, CanState::kErrorActive);
  server.send("< error transmit queue full >");
  EXPECT_EQ(client.error(), " error transmit queue full ");
  EXPECT_EQ(client.status().lost, 2u);
  server.end->close();
  s.run(milliseconds(1));
  EXPECT_EQ(client.status().state, CanState::kOffline);
  EXPECT_EQ(client.error(), "closed by the peer");
}

TEST(SocketcandClient, AServerThatRefusesTheBusIsNamed) {
  Server s;
  TextClient server(s.bench.scheduler);
  SocketcandClient client(s.bench.scheduler, "no_such", std::move(server.far));
  server.send("< hi >");
  server.send("< error could not open bus >");
  EXPECT_EQ(client.error(), "the server answered \" error could not open bus \"");
  EXPECT_TRUE(server.closed);
}

}  // namespace
}  // namespace vinv::transports
