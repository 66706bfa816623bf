// Lawicel CAN232 and CANUSB manuals: commands and answers.
#include <gtest/gtest.h>

#include "sim/transports/can/slcan_adapter.hpp"
#include "sim/transports/can/slcan_client.hpp"
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

TEST(SlcanText, FramesAreReadAndWritten) {
  CanFrame ext_remote = CanFrame::remote_request(0x1abcdef0, 0);
  ext_remote.extended = true;
  const std::pair<const char*, CanFrame> rows[] = {
      {"t10021133", CanFrame::standard(0x100, {0x11, 0x33})},
      {"t0200", CanFrame::standard(0x020, {})},
      {"T0000010021133", extended(0x100, {0x11, 0x33})},
      {"r7051", CanFrame::remote_request(0x705, 1)},
      {"R1ABCDEF00", ext_remote},
      {"t7FF8FFFFFFFFFFFFFFFF", CanFrame::standard(0x7ff, {255, 255, 255, 255, 255, 255, 255, 255})}};
  for (const auto& [line, frame] : rows) {
    const auto got = parse_slcan_frame(line);
    ASSERT_TRUE(got) << line;
    EXPECT_EQ(*got, frame) << line;
    EXPECT_EQ(slcan_frame(frame), line);
    EXPECT_FALSE(parse_slcan_frame(std::string(line) + "1234")) << line;
    ASSERT_TRUE(parse_slcan_frame(std::string(line) + "1234", true)) << line;
    EXPECT_EQ(*parse_slcan_frame(std::string(line) + "1234", true), frame) << line;
  }
  EXPECT_EQ(parse_slcan_frame("t1002aBcD")->data[0], 0xab);
  EXPECT_EQ(slcan_frame(CanFrame::standard(1, {2}), std::uint16_t{0xea5f}), "t001102EA5F");
}

TEST(SlcanText, WhatIsNoFrameIsRefused) {
  for (const char* bad : {"", "t", "t1", "t100", "t1001", "t10011", "t1001111", "t80000", "t1009112233445566778899",
                          "T1001", "T200000000", "r10011", "x1000", "t1 00", "t10g0", "t1001 1", "t10-0"}) {
    EXPECT_FALSE(parse_slcan_frame(bad)) << bad;
  }
}

TEST(SlcanText, RegistersGiveTheRatesOfTheManual) {
  // BTR0 BTR1 of the SJA1000 at 16 MHz for 10k to 1M.
  EXPECT_EQ(slcan_bitrate_of_registers(0x31, 0x1c), 10'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x18, 0x1c), 20'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x09, 0x1c), 50'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x04, 0x1c), 100'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x03, 0x1c), 125'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x01, 0x1c), 250'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x00, 0x1c), 500'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x00, 0x14), 1'000'000u);
  EXPECT_EQ(slcan_bitrate_of_registers(0x07, 0x1c), 62'500u);
  EXPECT_EQ(slcan_bitrate_command(62'500), "s071C");
  EXPECT_EQ(slcan_bitrate_command(125'000), "S4");
  EXPECT_EQ(slcan_bitrate_command(1'000'000), "S8");
  EXPECT_EQ(slcan_bitrate_command(300'000), "");
}

struct Adapter {
  Adapter() : client(bench.scheduler) {
    adapter = std::make_unique<SlcanAdapter>(*bench.bus, std::move(client.far), [this] { ended = true; });
  }
  std::string ask(const std::string& text) {
    client.take();
    client.send(text);
    return client.take();
  }
  void run(Duration span) { bench.scheduler.run_until(bench.now() + span); }

  BusBench bench;
  TextClient client;
  std::unique_ptr<SlcanAdapter> adapter;
  bool ended = false;
};

TEST(SlcanAdapter, CommandsAreAnsweredWithReturnOrBell) {
  Adapter a;
  EXPECT_EQ(a.ask("\r"), "\r");
  EXPECT_EQ(a.ask("C\r"), "\a");  // not open
  EXPECT_EQ(a.ask("F\r"), "\a");
  EXPECT_EQ(a.ask("V\r"), "V1013\r");
  EXPECT_EQ(a.ask("N\r"), "NVINV\r");
  EXPECT_EQ(a.ask("S9\r"), "\a");
  EXPECT_EQ(a.ask("S\r"), "\a");
  EXPECT_EQ(a.ask("S4\r"), "\r");
  EXPECT_EQ(a.ask("s031C\r"), "\r");
  EXPECT_EQ(a.ask("s031\r"), "\a");
  EXPECT_EQ(a.ask("Z2\r"), "\a");
  EXPECT_EQ(a.ask("Z0\r"), "\r");
  EXPECT_EQ(a.ask("X1\r"), "\r");
  EXPECT_EQ(a.ask("X0\r"), "\a");
  EXPECT_EQ(a.ask("M00000000\r"), "\r");
  EXPECT_EQ(a.ask("mFFFFFFFF\r"), "\r");
  EXPECT_EQ(a.ask("M00000001\r"), "\a");
  EXPECT_EQ(a.ask("t1000\r"), "\a");  // not open
  EXPECT_EQ(a.ask("O\r"), "\r");
  EXPECT_EQ(a.ask("O\r"), "\a");
  EXPECT_EQ(a.ask("S4\r"), "\a");  // only while closed
  EXPECT_EQ(a.ask("Z1\r"), "\a");
  EXPECT_EQ(a.ask("F\r"), "F00\r");
  EXPECT_EQ(a.ask("W0\r"), "\a");
  EXPECT_EQ(a.ask("t1000\n\r"), "\a");  // no line feed inside
  EXPECT_EQ(a.ask("C\r\nC\r\n"), "\r\a");
}

TEST(SlcanAdapter, AnswersOfOneInstantAreOnePiece) {
  Adapter a;
  EXPECT_EQ(a.ask("O\rV\rN\rt1000\r"), "\rV1013\rNVINV\rz\r");
  EXPECT_EQ(a.client.pieces, 1);
}

TEST(SlcanAdapter, ARoundTripAllocatesNothing) {
  BusBench bench;
  auto node = bench.bus->attach(bench.now(), {});
  node->set_handlers({[&](Instant now, const CanFrame& f) { node->send(now, f); }, {}, {}});
  DirectEnd client;
  const SlcanAdapter adapter(*bench.bus, std::make_unique<DirectStream>(client), nullptr);
  client.say(bench.now(), "Z1\rO\r");
  std::uint64_t allocations = 0;
  for (int i = 0; i < 20; ++i) {
    if (i == 10) allocations = allocation_count();
    client.say(bench.now(), "T0000060184000100000000000\r");
    bench.scheduler.run_until(bench.now() + std::chrono::milliseconds(10));
    EXPECT_EQ(client.heard().substr(0, 26), "T0000060184000100000000000");
  }
  EXPECT_EQ(allocation_count(), allocations);
}

TEST(SlcanAdapter, LinesMayBeCutAnywhereAndLongOnesAreOneError) {
  Adapter a;
  EXPECT_EQ(a.ask("O"), "");
  EXPECT_EQ(a.ask("\r"), "\r");
  EXPECT_EQ(a.ask("t1002"), "");
  EXPECT_EQ(a.ask("1133\r"), "z\r");
  EXPECT_EQ(a.ask(std::string(100'0, 'T')), "");
  EXPECT_EQ(a.ask("\r"), "\a");
  EXPECT_EQ(a.ask("T1ABCDEF00\r"), "Z\r");
  // The longest line that is right.
  EXPECT_EQ(a.ask("T1ABCDEF081122334455667788\r"), "Z\r");
}

TEST(SlcanAdapter, FramesPassBothWaysRemoteOnesToo) {
  Adapter a;
  auto& slave = a.bench.add("slave");
  EXPECT_EQ(a.ask("O\rr7051\rR1ABCDEF00\rt60140A0B0C0D\rt60140A0B0C\r"), "\rz\rZ\rz\r\a");
  a.run(milliseconds(10));
  EXPECT_NE(slave.log.find("705#R1"), std::string::npos);
  EXPECT_NE(slave.log.find("1ABCDEF0#R0"), std::string::npos);
  EXPECT_NE(slave.log.find("601#0A0B0C0D"), std::string::npos);
  a.client.take();
  slave.node->send(a.bench.now(), CanFrame::standard(0x585, {1, 2}));
  slave.node->send(a.bench.now(), CanFrame::remote_request(0x185, 8));
  a.run(milliseconds(10));
  EXPECT_EQ(a.client.take(), "t58520102\rr1858\r");
  a.ask("C\rZ1\rO\r");
  a.run(milliseconds(5));
  slave.node->send(a.bench.now(), CanFrame::standard(0, {}));
  a.run(milliseconds(5));
  EXPECT_EQ(a.client.take(), "t00000401\r");  // 1025 ms: 1 s at the start, 25 ms since
}

TEST(SlcanAdapter, ListenOnlyHearsAndDoesNotSend) {
  Adapter a;
  auto& slave = a.bench.add("slave");
  a.bench.add("third");
  EXPECT_EQ(a.ask("L\r"), "\r");
  EXPECT_EQ(a.ask("t1000\r"), "\a");
  slave.node->send(a.bench.now(), CanFrame::standard(7, {}));
  a.run(milliseconds(10));
  EXPECT_EQ(a.client.take(), "t0070\r");
}

TEST(SlcanAdapter, AWrongBitRateDisturbsAndIsSeenInTheFlags) {
  Adapter a;
  auto& slave = a.bench.add("slave");
  a.bench.add("third");
  EXPECT_EQ(a.ask("S8\rO\r"), "\r\r");
  slave.node->send(a.bench.now(), CanFrame::standard(7, {}));
  a.run(milliseconds(100));
  EXPECT_EQ(a.client.take(), "");
  EXPECT_EQ(a.ask("F\r"), "F24\r");  // warning, passive
  EXPECT_EQ(a.bench.stats().error_frames, 15u);
  // Closed, set right, and opened: all is well.
  EXPECT_EQ(a.ask("C\rS4\rO\r"), "\r\r\r");
  slave.node->send(a.bench.now(), CanFrame::standard(8, {}));
  a.run(milliseconds(100));
  EXPECT_EQ(a.client.take(), "t0080\r");
}

TEST(SlcanAdapter, AFullQueueIsABellAndAFlag) {
  Adapter a;
  a.bench.add("slave");
  a.ask("O\r");
  std::string flood;
  for (std::size_t i = 0; i <= SlcanAdapter::kMaxQueuedFrames; ++i) flood += "t0000\r";
  const std::string answers = a.ask(flood);
  EXPECT_EQ(answers.substr(answers.size() - 3), "z\r\a");
  EXPECT_EQ(a.ask("F\r"), "F02\r");
  EXPECT_EQ(a.ask("F\r"), "F00\r");
}

TEST(SlcanAdapter, TheNodeLeavesWithTheClient) {
  Adapter a;
  a.ask("O\r");
  EXPECT_EQ(a.bench.stats().nodes, 1u);
  EXPECT_TRUE(a.adapter->is_open());
  a.client.end->close();
  a.run(milliseconds(1));
  EXPECT_TRUE(a.ended);
  EXPECT_EQ(a.bench.stats().nodes, 0u);
}

TEST(SlcanClient, SetsTheAdapterUpAndIsANode) {
  BusBench b;
  auto& slave = b.add("slave");
  auto link = make_memory_link(b.scheduler);
  SlcanAdapter adapter(*b.bus, std::move(link.first), {});
  auto client = SlcanClient::open_stream(b.scheduler, b.now(), std::move(link.second), 125'000);
  ASSERT_TRUE(client);
  std::string log;
  (*client)->set_handlers({[&](Instant, const CanFrame& f) { log += show(f) + " "; },
                           [&](Instant, const CanFrame& f) { log += "sent:" + show(f) + " "; },
                           {}});
  b.scheduler.run_until(b.now());
  EXPECT_TRUE(adapter.is_open());
  EXPECT_EQ((*client)->send(b.now(), CanFrame::remote_request(0x705, 1)), CanSend::kQueued);
  b.run_to_us(10'000);
  slave.node->send(b.now(), extended(0x1abc, {9}));
  b.run_to_us(20'000);
  EXPECT_EQ(log, "sent:705#R1 00001ABC#09 ");
  EXPECT_NE(slave.log.find("705#R1"), std::string::npos);
  EXPECT_EQ((*client)->status().lost, 0u);  // the bell for the C of a closed channel is not one

  // With another rate it is the node that disturbs; the flags tell it within their interval.
  EXPECT_TRUE((*client)->set_bitrate(b.now(), 500'000));
  EXPECT_FALSE((*client)->set_bitrate(b.now(), 123'456));
  b.add("third");
  b.run_to_us(30'000);
  slave.node->send(b.now(), CanFrame::standard(1, {}));
  b.run_to_us(2'500'000);
  EXPECT_EQ((*client)->status().state, CanState::kErrorPassive);
  EXPECT_EQ(log, "sent:705#R1 00001ABC#09 ");

  (*client)->set_online(b.now(), false);
  b.scheduler.run_until(b.now());
  EXPECT_FALSE(adapter.is_open());
  EXPECT_EQ((*client)->send(b.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  EXPECT_TRUE((*client)->set_bitrate(b.now(), 125'000));
  (*client)->set_online(b.now(), true);
  b.scheduler.run_until(b.now());
  EXPECT_TRUE(adapter.is_open());
  EXPECT_EQ((*client)->status().state, CanState::kErrorActive);
  client->reset();
  b.scheduler.run_until(b.now());
  EXPECT_FALSE(adapter.is_open());
}

TEST(SlcanClient, ReadsAdaptersThatAnswerInTheirOwnWay) {
  BusBench b;
  TextClient adapter(b.scheduler);
  auto client = SlcanClient::open_stream(b.scheduler, b.now(), std::move(adapter.far), 62'500);
  ASSERT_TRUE(client);
  b.scheduler.run_until(b.now());
  EXPECT_EQ(adapter.take(), "\r\rC\rs071C\rZ0\rO\r");
  std::string log;
  (*client)->set_handlers({[&](Instant, const CanFrame& f) { log += show(f) + " "; }, {}, {}});
  adapter.send("\a\r\r\rt00110");
  adapter.send("7\rt001105ABCD\rz\rgarbage\rV1013\r");  // a stamp that was not asked for
  EXPECT_EQ(log, "001#07 001#05 ");
  b.run_to_us(1'500'000);
  EXPECT_EQ(adapter.take(), "F\r");
  adapter.send("F80\r");
  EXPECT_EQ((*client)->status().state, CanState::kBusOff);
  adapter.send("F00\r");
  EXPECT_EQ((*client)->status().state, CanState::kErrorActive);
  adapter.send("\a");
  EXPECT_EQ((*client)->status().lost, 1u);
  adapter.end->close();
  b.run_to_us(1'600'000);
  EXPECT_EQ((*client)->status().state, CanState::kOffline);
  EXPECT_FALSE(SlcanClient::open_stream(b.scheduler, b.now(), nullptr, 1234));
}

}  // namespace
}  // namespace vinv::transports
