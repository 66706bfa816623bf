// I/O packets with time: intervals, triggers, sequence counts, run and idle, time-outs. CIP Vol 1, 3-4; Vol 2, 3-4.
#include <gtest/gtest.h>

#include "tests/bench/allocation_count.hpp"
#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using namespace std::chrono_literals;
using test::AdapterBench;
using test::from_hex;
using test::item;
using test::join;
using test::le16;
using test::le32;
using test::Master;
using test::OpenWish;
using test::SentPacket;
using test::to_hex;

class IoConnectionsTest : public ::testing::Test {
 protected:
  IoConnectionsTest() : master(Master::registered(bench)) {}
  std::uint32_t open(const OpenWish& w = {}) {
    const std::uint32_t id = master.open_id(w);
    EXPECT_NE(id, 0u);
    bench.take_log();
    return id;
  }
  std::vector<SentPacket> io() { return bench.take(Channel::kIo); }
  // Times of packets since a moment, in microseconds.
  static std::vector<std::int64_t> times(const std::vector<SentPacket>& packets, Instant from) {
    std::vector<std::int64_t> all;
    for (const auto& p : packets) all.push_back((p.at - from).count() / 1000);
    return all;
  }
  AdapterBench bench;
  Master master;
};

TEST_F(IoConnectionsTest, ProductionStartsWithTheAnswer) {
  const Bytes bytes = master.open({});
  ASSERT_FALSE(bytes.empty());
  const auto packets = io();
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0].to, (Ipv4Endpoint{ipv4(127, 0, 0, 1), 2222}));
  EXPECT_EQ(to_hex(packets[0].bytes), "02 00 02 80 08 00 44 33 22 11 01 00 00 00 B1 00 06 00 01 00 01 02 03 04");
  EXPECT_EQ(packets[0].dscp, 47);  // scheduled
}

TEST_F(IoConnectionsTest, CyclicPacketsKeepTheirIntervalAndDoNotDrift) {
  const Instant from = bench.now;
  OpenWish w;
  w.t2o_rpi_us = 2500;
  const auto id = open(w);
  for (unsigned i = 1; i <= 100; ++i) {
    master.send_io(id, i, i, "00 00 00 00");
    bench.advance(10ms);
  }
  const auto packets = io();
  ASSERT_EQ(packets.size(), 401u);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    ASSERT_EQ((packets[i].at - from).count(), static_cast<std::int64_t>(i) * 2'500'000);
    ASSERT_EQ(read_le32(packets[i].bytes, 10), i + 1);
    ASSERT_EQ(read_le16(packets[i].bytes, 18), i + 1);
  }
}

TEST_F(IoConnectionsTest, LateCallsMakeUpForMissedPacketsWithinALimit) {
  open();
  io();
  const Instant from = bench.now;
  bench.now += 35ms;
  bench.poll();
  EXPECT_EQ(io().size(), 3u);
  bench.advance(5ms);
  EXPECT_EQ(times(io(), from), (std::vector<std::int64_t>{40'000}));
  bench.now += 5s;
  bench.poll();
  EXPECT_EQ(io().size(), 1u);
}

TEST_F(IoConnectionsTest, PacketsGoToThePortOfTheSocketAddressItemButOnlyToTheOriginator) {
  OpenWish w;
  w.extra_items = item(0x8001, from_hex("00 02 30 39 0A 00 00 63 00 00 00 00 00 00 00 00"));
  w.item_count = 3;
  open(w);
  const auto packets = io();
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0].to, (Ipv4Endpoint{ipv4(127, 0, 0, 1), 12'345}));
}

TEST_F(IoConnectionsTest, SocketAddressWithoutPortMeansTheStandardOne) {
  OpenWish w;
  w.extra_items = item(0x8001, from_hex("00 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00"));
  w.item_count = 3;
  open(w);
  EXPECT_EQ(io().at(0).to, (Ipv4Endpoint{ipv4(127, 0, 0, 1), 2222}));
}

TEST_F(IoConnectionsTest, PacketsAreMarkedByTheirPriority) {
  constexpr std::uint8_t kMarks[] = {31, 43, 47, 55};
  for (unsigned priority = 0; priority < 4; ++priority) {
    OpenWish w;
    w.t2o = 0x4000 | priority << 10 | 6;
    open(w);
    EXPECT_EQ(io().at(0).dscp, kMarks[priority]);
    master.close(w);
  }
}

TEST_F(IoConnectionsTest, Class0TimesOutLikeClass1) {
  OpenWish w;
  w.transport = 0x00;
  w.o2t = 0x4800 | 8;
  w.t2o = 0x4800 | 4;
  const auto id = open(w);
  const Bytes packet = join({le16(2), item(0xa1, le32(id)), item(0xb1, join({le32(1), from_hex("09 08 07 06")}))});
  bench.adapter.handle_io(bench.now, {ipv4(127, 0, 0, 1), 2222}, packet);
  bench.take_log();
  bench.advance(39ms);
  EXPECT_TRUE(bench.take_log().empty());
  bench.advance(1ms);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 timed out"});
}

TEST_F(IoConnectionsTest, FirstTimeoutIsLongerIfTheOrdinaryOneIs) {
  OpenWish w;
  w.o2t_rpi_us = 100'000;
  w.multiplier = 7;  // 512 times
  open(w);
  bench.advance(51'199ms);
  EXPECT_TRUE(bench.take_log().empty());
  bench.advance(1ms);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 timed out"});
}

TEST_F(IoConnectionsTest, VariableT2oSizeIsFilledWithoutHeader) {
  OpenWish w;
  w.t2o = 0x4a00 | 100;
  open(w);
  EXPECT_EQ(to_hex(io().at(0).bytes), "02 00 02 80 08 00 44 33 22 11 01 00 00 00 B1 00 06 00 01 00 01 02 03 04");
}

TEST_F(IoConnectionsTest, DataGoToTheDeviceWithRunAndIdle) {
  const auto id = open();
  EXPECT_FALSE(bench.adapter.connections().owner_mode()) << "it has not said anything yet";
  master.send_io(id, 1, 1, "01 02 03 04");
  master.send_io(id, 2, 2, "05 06 07 08", false);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"run 21: 01 02 03 04", "idle 21: 05 06 07 08"}));
  EXPECT_EQ(bench.adapter.connections().owner_mode(), cip::RunMode::kIdle);
}

TEST_F(IoConnectionsTest, OldAndRepeatedPacketsAreDropped) {
  const auto id = open();
  master.send_io(id, 10, 10, "01 00 00 00");
  master.send_io(id, 10, 11, "02 00 00 00");          // same sequence
  master.send_io(id, 9, 12, "03 00 00 00");           // overtaken
  master.send_io(id, 0x8000000a, 13, "04 00 00 00");  // half the circle away
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"run 21: 01 00 00 00"});
  master.send_io(id, 11, 10, "05 00 00 00");  // a new packet with the old count: nothing new
  master.send_io(id, 12, 9, "06 00 00 00");
  EXPECT_TRUE(bench.take_log().empty());
  master.send_io(id, 13, 11, "07 00 00 00");
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"run 21: 07 00 00 00"});
}

TEST_F(IoConnectionsTest, SequencesWrap) {
  const auto id = open();
  master.send_io(id, 0xfffffffe, 0xfffe, "01 00 00 00");
  master.send_io(id, 0xffffffff, 0xffff, "02 00 00 00");
  master.send_io(id, 0, 0, "03 00 00 00");
  EXPECT_EQ(bench.take_log().size(), 3u);
}

TEST_F(IoConnectionsTest, RepeatedCountKeepsTheConnectionUpAndOldSequenceDoesNot) {
  OpenWish w;
  w.o2t_rpi_us = 10'000;  // 40 ms to the time-out
  const auto id = open(w);
  for (unsigned i = 1; i < 20; ++i) {
    master.send_io(id, i, 1, "01 00 00 00");
    bench.advance(30ms);
  }
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"run 21: 01 00 00 00"});
  for (int i = 0; i < 4; ++i) {
    master.send_io(id, 3, 2, "01 00 00 00");
    bench.advance(10ms);
  }
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 timed out"});
}

TEST_F(IoConnectionsTest, TimeoutIsFourIntervalsTimesTwoToTheMultiplier) {
  for (const unsigned multiplier : {0u, 1u, 3u, 7u}) {
    OpenWish w;
    w.serial = 10 + multiplier;
    w.multiplier = multiplier;
    w.o2t_rpi_us = 5000;
    const auto id = open(w);
    master.send_io(id, 1, 1, "00 00 00 00");
    bench.take_log();
    const Duration timeout = 5ms * (4 << multiplier);
    bench.advance(timeout - 1us);
    EXPECT_TRUE(bench.take_log().empty()) << multiplier;
    bench.advance(1us);
    EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 timed out"}) << multiplier;
    io();
    bench.advance(1s);
    EXPECT_TRUE(io().empty());  // and nothing is sent any more
  }
}

TEST_F(IoConnectionsTest, BeforeTheFirstPacketTheTimeoutIsAtLeastTenSeconds) {
  open();
  bench.advance(9999ms);
  EXPECT_TRUE(bench.take_log().empty());
  bench.advance(1ms);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 timed out"});
}

TEST_F(IoConnectionsTest, PacketsThatDoNotFitAreDropped) {
  const auto id = open();
  master.send_io_raw(id, 1, join({le16(1), le32(1), from_hex("01 02 03")}));        // short
  master.send_io_raw(id, 2, join({le16(2), le32(1), from_hex("01 02 03 04 05")}));  // long
  master.send_io_raw(id + 128, 3, join({le16(3), le32(1), from_hex("01 02 03 04")}));
  master.send_io_raw(id ^ 1, 3, join({le16(3), le32(1), from_hex("01 02 03 04")}));
  bench.adapter.handle_io(bench.now, {ipv4(127, 0, 0, 1), 2222}, from_hex("02 00 00"));
  bench.adapter.handle_io(
      bench.now, {ipv4(127, 0, 0, 1), 2222},
      join({le16(2), item(0xa1, le32(id)), item(0xb1, join({le16(4), le32(1), from_hex("01 02 03 04")}))}));
  EXPECT_TRUE(bench.take_log().empty());
}

TEST_F(IoConnectionsTest, PacketsOfOthersAreDropped) {
  const auto id = open();
  auto other = Master(bench, ipv4(127, 0, 0, 77));
  other.send_io(id, 1, 1, "01 02 03 04");
  EXPECT_TRUE(bench.take_log().empty());
}

TEST_F(IoConnectionsTest, ModelessPacketsRunAndEmptyOnesAreIdle) {
  OpenWish w;
  w.o2t = 0x4800 | 6;
  const auto id = open(w);
  master.send_io_raw(id, 1, join({le16(1), from_hex("0A 0B 0C 0D")}));
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"run 21: 0A 0B 0C 0D"});
  master.send_io_raw(id, 2, le16(2));
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"idle 21: 00 00 00 00"});
}

TEST_F(IoConnectionsTest, T2oCanHaveTheRunIdleHeader) {
  OpenWish w;
  w.t2o = 0x4800 | 10;
  open(w);
  const auto packets = io();
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(to_hex(ByteView(packets[0].bytes).subspan(14)), "B1 00 0A 00 01 00 01 00 00 00 01 02 03 04");
}

TEST_F(IoConnectionsTest, Class0HasNeitherSequenceNorCount) {
  OpenWish w;
  w.transport = 0x00;
  w.o2t = 0x4800 | 8;
  w.t2o = 0x4800 | 4;
  const auto id = open(w);
  const auto packets = io();
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(to_hex(packets[0].bytes), "02 00 A1 00 04 00 44 33 22 11 B1 00 04 00 01 02 03 04");
  const Bytes packet = join({le16(2), item(0xa1, le32(id)), item(0xb1, join({le32(1), from_hex("09 08 07 06")}))});
  bench.adapter.handle_io(bench.now, {ipv4(127, 0, 0, 1), 2222}, packet);
  bench.adapter.handle_io(bench.now, {ipv4(127, 0, 0, 1), 2222}, packet);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"run 21: 09 08 07 06", "run 21: 09 08 07 06"}));
}

TEST_F(IoConnectionsTest, HeartbeatsKeepInputOnlyConnectionsUp) {
  OpenWish w;
  w.path = "20 04 2C 1E 2C 47";
  w.o2t = 0x4800 | 2;
  const auto id = open(w);
  for (unsigned i = 1; i < 100; ++i) {
    master.send_io_raw(id, i, le16(i));
    bench.advance(30ms);
  }
  EXPECT_TRUE(bench.take_log().empty());
  bench.advance(10ms);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"input only 30/71 timed out"});
}

TEST_F(IoConnectionsTest, T2oHeartbeatHasNoData) {
  OpenWish w;
  w.path = "20 04 2C 15 2C 50";
  w.t2o = 0x4800 | 2;
  open(w);
  const auto packets = io();
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(to_hex(ByteView(packets[0].bytes).subspan(14)), "B1 00 02 00 01 00");
}

TEST_F(IoConnectionsTest, ChangeOfStateSendsAtOnceButNotWithinTheInhibitTime) {
  OpenWish w;
  w.transport = 0x11;
  w.t2o_rpi_us = 100'000;
  w.path = "43 14 20 04 2C 15 2C 47";  // 20 ms
  const Instant from = bench.now;
  open(w);
  const auto change = [&](const char* hex) {
    bench.device.set_input(hex);
    bench.adapter.handle_new_data(bench.now);
  };
  bench.advance(50ms);
  change("05 00 00 00");  // at 50 ms: at once
  bench.advance(5ms);
  change("06 00 00 00");  // at 55 and 58 ms: one packet at 70 ms with the last
  bench.advance(3ms);
  change("07 00 00 00");
  bench.advance(200ms);
  const auto packets = io();
  EXPECT_EQ(times(packets, from), (std::vector<std::int64_t>{0, 50'000, 70'000, 170'000}));
  EXPECT_EQ(to_hex(ByteView(packets[2].bytes).last(6)), "03 00 07 00 00 00");
  EXPECT_EQ(to_hex(ByteView(packets[3].bytes).last(6)), "03 00 07 00 00 00");  // the interval is over: the old count
  EXPECT_EQ(read_le32(packets[3].bytes, 10), 4u);
}

TEST_F(IoConnectionsTest, WithoutSegmentTheInhibitTimeIsAQuarterOfTheInterval) {
  OpenWish w;
  w.transport = 0x11;
  w.t2o_rpi_us = 100'000;
  const Instant from = bench.now;
  open(w);
  bench.advance(1ms);
  bench.device.set_input("05 00 00 00");
  bench.adapter.handle_new_data(bench.now);
  bench.advance(50ms);
  EXPECT_EQ(times(io(), from), (std::vector<std::int64_t>{0, 25'000}));
}

TEST_F(IoConnectionsTest, UnchangedDataAreSentAtTheIntervalOnly) {
  OpenWish w;
  w.transport = 0x11;
  const Instant from = bench.now;
  open(w);
  bench.adapter.handle_new_data(bench.now);
  bench.advance(25ms);
  EXPECT_EQ(times(io(), from), (std::vector<std::int64_t>{0, 10'000, 20'000}));
}

TEST_F(IoConnectionsTest, ApplicationTriggerSendsWhenTheApplicationSaysSo) {
  OpenWish w;
  w.transport = 0x21;
  w.t2o_rpi_us = 100'000;
  const Instant from = bench.now;
  open(w);
  bench.advance(30ms);
  bench.device.set_input("05 00 00 00");
  bench.adapter.handle_new_data(bench.now);  // is nothing to it
  bench.advance(10ms);
  bench.adapter.trigger(bench.now, 70);
  bench.adapter.trigger(bench.now, 71);
  bench.advance(10ms);
  EXPECT_EQ(times(io(), from), (std::vector<std::int64_t>{0, 40'000}));
}

TEST_F(IoConnectionsTest, CloseMatchesOnTheTriadAlone) {
  open();
  OpenWish other;
  other.path = "01 00 20 02 24 01";
  other.serial = 2;
  EXPECT_EQ(to_hex(master.close(other)), "CE 00 01 01 07 01 02 00 37 13 2A 00 00 00 03 00");
  other.serial = 1;
  EXPECT_EQ(to_hex(master.close(other)), "CE 00 00 00 01 00 37 13 2A 00 00 00 00 00");
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 closed"});
  io();
  bench.advance(1s);
  EXPECT_TRUE(io().empty());
}

// Vol 2, 3-3.10: another session of the same host may, another host may not.
TEST_F(IoConnectionsTest, OnlyTheHostThatOpenedCanClose) {
  open();
  auto other = Master::registered(bench, ipv4(127, 0, 0, 2));
  EXPECT_EQ(to_hex(other.close({})), "CE 00 0F 00 01 00 37 13 2A 00 00 00 03 00");
  EXPECT_TRUE(bench.take_log().empty());
  EXPECT_EQ(bench.adapter.connections().io_connections(), 1u);
  auto second = Master::registered(bench);
  EXPECT_EQ(to_hex(second.close({})), "CE 00 00 00 01 00 37 13 2A 00 00 00 00 00");
  EXPECT_EQ(bench.adapter.connections().io_connections(), 0u);
}

TEST_F(IoConnectionsTest, IoOutlivesTheTcpConnectionThatOpenedIt) {
  const auto id = open();
  bench.adapter.handle_tcp_closed(bench.now, master.tcp);
  master.send_io(id, 1, 1, "01 02 03 04");
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"run 21: 01 02 03 04"});
}

class ListenOnlyTest : public IoConnectionsTest {
 protected:
  ListenOnlyTest() {
    owner_wish.t2o = 0x2800 | 6;
    listener_wish.serial = 2;
    listener_wish.path = "20 04 2C 1F 2C 47";
    listener_wish.o2t = 0x4800 | 2;
    listener_wish.t2o = 0x2800 | 6;
    input_wish = listener_wish;
    input_wish.serial = 3;
    input_wish.path = "20 04 2C 1E 2C 47";
  }
  OpenWish owner_wish, listener_wish, input_wish;
};

TEST_F(ListenOnlyTest, EndsWithTheOwnersClose) {
  open(owner_wish);
  open(listener_wish);
  master.close(owner_wish);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"owner 21/71 closed", "listen only 31/71 closed"}));
  EXPECT_EQ(master.open_status(listener_wish), "01 0119");
  io();
  bench.advance(1s);
  EXPECT_TRUE(io().empty());
}

TEST_F(ListenOnlyTest, EndsWithTheOwnersTimeout) {
  const auto owner = open(owner_wish);
  const auto listener = open(listener_wish);
  master.send_io(owner, 1, 1, "00 00 00 00");
  bench.take_log();
  for (unsigned i = 1; i <= 4; ++i) {
    master.send_io_raw(listener, i, le16(i));
    bench.advance(10ms);
  }
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"owner 21/71 timed out", "listen only 31/71 closed"}));
}

TEST_F(ListenOnlyTest, StaysWhileAnInputOnlyConnectionKeepsTheProductionUp) {
  open(owner_wish);
  open(input_wish);
  open(listener_wish);
  master.close(owner_wish);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"owner 21/71 closed"});
  io();
  bench.advance(20ms);
  EXPECT_EQ(io().size(), 2u);
  master.close(input_wish);
  EXPECT_EQ(bench.take_log(), (std::vector<std::string>{"input only 30/71 closed", "listen only 31/71 closed"}));
}

TEST_F(ListenOnlyTest, ItsOwnEndLeavesTheOwnerAlone) {
  open(owner_wish);
  open(listener_wish);
  master.close(listener_wish);
  EXPECT_EQ(bench.take_log(), std::vector<std::string>{"listen only 31/71 closed"});
  io();
  bench.advance(20ms);
  EXPECT_EQ(io().size(), 2u);
}

TEST_F(IoConnectionsTest, PacketsAndRequestsTakeNoMemoryOnceTheyHaveIt) {
  OpenWish w;
  w.multiplier = 7;
  const auto id = open(w);
  const Bytes request = test::encapsulated(
      0x6f, master.session,
      join({le32(0), le16(5), le16(2), item(0, {}), item(0xb2, from_hex("10 03 20 99 24 01 30 01 05 00"))}));
  const Bytes packet = join({le16(2), item(0x8002, join({le32(id), le32(1)})),
                             item(0xb1, join({le16(1), le32(1), from_hex("01 02 03 04")}))});
  const auto round = [&] {
    bench.now += 10ms;
    bench.adapter.handle_timeout(bench.now);
    bench.adapter.handle_io(bench.now, {ipv4(127, 0, 0, 1), 2222}, packet);
    bench.adapter.handle_tcp(bench.now, master.tcp, request);
    int transmissions = 0;
    while (bench.adapter.poll_transmit(bench.now)) ++transmissions;
    bench.adapter.next_deadline();
    return transmissions;
  };
  round();
  round();
  const auto before = test::allocation_count();
  int transmissions = 0;
  for (int i = 0; i < 3; ++i) transmissions += round();
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(transmissions, 6);
}

TEST_F(IoConnectionsTest, StopEndsConnectionsWithoutAWord) {
  open();
  bench.adapter.stop();
  EXPECT_TRUE(bench.take_log().empty());
  io();
  bench.advance(20s);
  EXPECT_TRUE(io().empty());
}

}  // namespace
}  // namespace vinv::ethernet_ip
