#include "sim/transports/can/can_bus.hpp"

#include <gtest/gtest.h>

#include "sim/base/random.hpp"
#include "sim/transports/can/wire_format.hpp"
#include "tests/sim/kernel/allocation_count.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"

namespace vinv::transports {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

CanFrame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f = CanFrame::standard(id, bytes);
  f.extended = true;
  return f;
}

TEST(CanBus, AFrameReachesAllOthersAfterItsBitsAndItsSenderIsTold) {
  BusBench b;  // 125k: 8 us for each bit
  auto& a = b.add("a");
  auto& c = b.add("c");
  auto& d = b.add("d");
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(0, {})), CanSend::kQueued);
  b.run_to_us(1'000'000);
  // 50 bits from start of frame to end of frame: see CanWireFormat.
  EXPECT_EQ(a.log, "1000400 sent 000#\n");
  EXPECT_EQ(c.log, "1000400 000#\n");
  EXPECT_EQ(d.log, "1000400 000#\n");
  EXPECT_EQ(b.stats().frames, 1u);
  EXPECT_EQ(b.stats().error_frames, 0u);
}

TEST(CanBus, EveryBitRateHasItsFrameTime) {
  for (const std::uint32_t rate : kCanBitrates) {
    CanBusOptions options;
    options.bitrate = rate;
    BusBench b(options);
    auto& a = b.add("a");
    auto& c = b.add("c");
    const CanFrame f = CanFrame::standard(0x581, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
    a.node->send(b.now(), f);
    const auto expected = b.start + can_bit_time(rate) * can_wire_bits(f).frame_bits();
    b.scheduler.run_until(expected - Duration(1));
    EXPECT_EQ(c.log, "") << rate;
    b.scheduler.run_until(expected);
    EXPECT_NE(c.log, "") << rate;
  }
}

TEST(CanBus, FramesFollowEachOtherAfterThreeBitsOfIntermission) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  for (int i = 0; i < 3; ++i) a.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(1'000'000);
  EXPECT_EQ(c.log, "1000400 000#\n1000824 000#\n1001248 000#\n");
}

TEST(CanBus, TheLowestIdentifierWinsWhateverTheOrderOfSending) {
  BusBench b;
  auto& listener = b.add("listener");
  const std::vector<CanFrame> frames = {extended(0x123u << 18, {}),         CanFrame::standard(0x124, {}),
                                        CanFrame::remote_request(0x123, 0), CanFrame::standard(0x123, {}),
                                        CanFrame::standard(0x7ff, {}),      CanFrame::standard(0x001, {}),
                                        extended((0x123u << 18) | 1, {})};
  for (const CanFrame& f : frames) b.add("sender").node->send(b.now(), f);
  b.run_to_us(1'000'000);
  std::string order;
  for (const char c : listener.log) order += c == '\n' ? ' ' : c;
  std::string ids;
  for (std::size_t at = 0; at < order.size();) {
    const std::size_t space = order.find(' ', at);
    const std::size_t end = order.find(' ', space + 1);
    ids += order.substr(space, end - space);
    at = end + 1;
  }
  EXPECT_EQ(ids, " 001# 123# 123#R0 048C0000# 048C0001# 124# 7FF#");
  EXPECT_EQ(b.stats().arbitrations_lost, 6u + 5 + 4 + 3 + 2 + 1);
}

TEST(CanBus, WhoComesWithinTheFirstBitTakesPartAndLaterOnesWait) {
  for (const int late_ns : {0, 7'999, 8'001}) {
    BusBench b;
    auto& a = b.add("a");
    auto& c = b.add("c");
    auto& listener = b.add("listener");
    a.node->send(b.now(), CanFrame::standard(0x200, {}));
    b.scheduler.run_until(b.start + Duration(late_ns));
    c.node->send(b.now(), CanFrame::standard(0x100, {}));
    b.run_to_us(10'000);
    const bool first = listener.log.find("100#") < listener.log.find("200#");
    EXPECT_EQ(first, late_ns < 8'000) << late_ns;
  }
}

// Nodes send in the order of what they were given, as a driver with one transmit buffer does.
TEST(CanBus, FramesOfOneNodeKeepTheirOrder) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  auto& listener = b.add("listener");
  a.node->send(b.now(), CanFrame::standard(0x300, {}));
  a.node->send(b.now(), CanFrame::standard(0x100, {}));
  c.node->send(b.now(), CanFrame::standard(0x200, {}));
  b.run_to_us(1'000'000);
  EXPECT_LT(listener.log.find("200#"), listener.log.find("300#"));
  EXPECT_LT(listener.log.find("300#"), listener.log.find("100#"));
}

TEST(CanBus, AFullQueueRefusesOrThrowsTheOldestAwayAsAsked) {
  BusBench b;
  CanNodeOptions options;
  options.name = "refuses";
  options.queue_frames = 4;
  auto& refuses = b.add(options);
  options.name = "drops";
  options.when_full = CanQueuePolicy::kDropOldest;
  auto& drops = b.add(options);
  auto& listener = b.add("listener");
  EXPECT_EQ(refuses.node->queue_room(), 4u);
  for (std::uint8_t i = 0; i < 4; ++i)
    EXPECT_EQ(refuses.node->send(b.now(), CanFrame::standard(1, {i})), CanSend::kQueued);
  EXPECT_EQ(refuses.node->queue_room(), 0u);
  EXPECT_EQ(refuses.node->send(b.now(), CanFrame::standard(1, {9})), CanSend::kRefusedFull);
  b.run_to_us(10'000);
  EXPECT_EQ(refuses.node->status().sent, 4u);
  EXPECT_EQ(refuses.node->status().lost, 1u);

  listener.log.clear();
  for (std::uint8_t i = 0; i < 4; ++i) drops.node->send(b.now(), CanFrame::standard(2, {i}));
  b.scheduler.run_until(b.now() + microseconds(100));  // the first is on the wire: it stays
  EXPECT_EQ(drops.node->send(b.now(), CanFrame::standard(2, {4})), CanSend::kDroppedOldest);
  EXPECT_EQ(drops.node->send(b.now(), CanFrame::standard(2, {5})), CanSend::kDroppedOldest);
  b.run_to_us(20'000);
  std::string data;
  for (std::size_t at = listener.log.find('#'); at != std::string::npos; at = listener.log.find('#', at + 1)) {
    data += listener.log.substr(at + 1, 2) + " ";
  }
  EXPECT_EQ(data, "00 03 04 05 ");
  EXPECT_EQ(drops.node->status().lost, 2u);
}

TEST(CanBus, ClearingTheQueueLeavesTheFrameOnTheWire) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  for (std::uint8_t i = 0; i < 3; ++i) a.node->send(b.now(), CanFrame::standard(1, {i}));
  b.run_to_us(50);
  a.node->clear_queue();
  b.run_to_us(10'000);
  EXPECT_NE(c.log.find("001#00"), std::string::npos);
  EXPECT_EQ(c.log.find("001#01"), std::string::npos);
  EXPECT_EQ(a.node->status().lost, 2u);
}

TEST(CanBus, AnAnswerInTheHandlerCompetesForTheNextFrame) {
  BusBench b;
  auto& master = b.add("master");
  auto& slave = b.add("slave");
  slave.node->set_handlers({[&](Instant t, const CanFrame& f) {
                              CanFrame answer = f;
                              answer.id = 0x581;
                              slave.node->send(t, answer);
                            },
                            {},
                            {}});
  master.node->send(b.now(), CanFrame::standard(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0}));
  b.run_to_us(100'000);
  const auto bits = can_wire_bits(CanFrame::standard(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0})).frame_bits() + 3 +
                    can_wire_bits(CanFrame::standard(0x581, {0x40, 0, 0x10, 0, 0, 0, 0, 0})).frame_bits();
  EXPECT_NE(master.log.find(std::to_string(1'000'000 + bits * 8) + " 581#4000100000000000\n"), std::string::npos)
      << master.log;
}

TEST(CanBus, NodesComeAndGoInHandlersAndWhileTheySend) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  std::unique_ptr<CanNode> late;
  int heard_late = 0;
  c.node->set_handlers({[&](Instant, const CanFrame&) {
                          CanNodeOptions options;
                          options.name = "late";
                          late = b.bus->attach(b.now(), options);
                          late->set_handlers({[&](Instant, const CanFrame&) { ++heard_late; }, {}, {}});
                          c.node.reset();
                        },
                        {},
                        {}});
  a.node->send(b.now(), CanFrame::standard(1, {}));
  a.node->send(b.now(), CanFrame::standard(2, {}));
  b.run_to_us(10'000);
  EXPECT_EQ(a.node->status().sent, 2u);
  EXPECT_EQ(heard_late, 1);
  EXPECT_EQ(b.stats().nodes, 2u);

  // Destroyed in the middle of its frame: the frame is completed.
  a.node->send(b.now(), CanFrame::standard(3, {}));
  b.run_to_us(10'100);
  a.node.reset();
  b.run_to_us(20'000);
  EXPECT_EQ(heard_late, 2);
}

TEST(CanBus, ANodeThatComesInTheMiddleOfAFrameHearsTheNext) {
  BusBench b;
  auto& a = b.add("a");
  b.add("c");
  a.node->send(b.now(), CanFrame::standard(1, {}));
  a.node->send(b.now(), CanFrame::standard(2, {}));
  b.run_to_us(100);
  auto& late = b.add("late");
  b.run_to_us(10'000);
  EXPECT_EQ(late.log.find("001#"), std::string::npos);
  EXPECT_NE(late.log.find("002#"), std::string::npos);
}

TEST(CanBus, OfflineNodesNeitherHearNorSendAndComeBackFresh) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  auto& d = b.add("d");
  c.node->set_online(b.now(), false);
  EXPECT_EQ(c.node->status().state, CanState::kOffline);
  EXPECT_EQ(c.node->queue_room(), 0u);
  EXPECT_EQ(c.node->send(b.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  a.node->send(b.now(), CanFrame::standard(2, {}));
  b.run_to_us(10'000);
  c.node->set_online(b.now(), true);
  a.node->send(b.now(), CanFrame::standard(3, {}));
  b.run_to_us(20'000);
  EXPECT_EQ(c.log.find("002#"), std::string::npos);
  EXPECT_NE(c.log.find("003#"), std::string::npos);
  EXPECT_EQ(c.log.substr(0, 36), "1000000 offline\n1010000 error active");
  EXPECT_EQ(d.node->status().received, 2u);
}

TEST(CanBus, TheBusMayGoBeforeItsNodes) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  a.node->send(b.now(), CanFrame::standard(1, {}));
  c.node->set_handlers({[&](Instant, const CanFrame&) { b.bus.reset(); }, {}, {}});
  b.run_to_us(10'000);
  EXPECT_EQ(b.bus, nullptr);
  EXPECT_EQ(a.node->status().state, CanState::kOffline);
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {})), CanSend::kRefusedState);
  EXPECT_FALSE(b.scheduler.next_event_at());
}

TEST(CanBus, ASaturatedBusHasALoadOfOneAndItsFramesPerSecond) {
  BusBench b;
  auto& a = b.add("a");
  b.add("c");
  a.node->set_handlers({{}, [&](Instant t, const CanFrame& f) { a.node->send(t, f); }, {}});
  a.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(1'000'000);
  EXPECT_NEAR(b.stats().load.last_second, 1.0, 0.001);
  // 50 bits and 3 of intermission, 8 us each.
  EXPECT_NEAR(static_cast<double>(b.stats().frames), 1e6 / (53 * 8), 1.0);
  a.node->set_online(b.now(), false);
  b.run_to_us(2'000'000);
  EXPECT_NEAR(b.stats().load.total, 0.5, 0.001);
  EXPECT_NEAR(b.stats().load.last_second, 0.0, 0.001);
  EXPECT_NEAR(b.stats().load.peak_second, 1.0, 0.001);
}

TEST(CanBus, WithoutTimingFramesPassInTheirInstantInOrderOfPriority) {
  CanBusOptions options;
  options.timing = CanBusOptions::Timing::kNone;
  BusBench b(options);
  auto& a = b.add("a");
  auto& c = b.add("c");
  a.node->send(b.now(), CanFrame::standard(0x200, {}));
  c.node->send(b.now(), CanFrame::standard(0x100, {}));
  b.run_to_us(0);
  EXPECT_EQ(a.log, "1000000 100#\n1000000 sent 200#\n");
  EXPECT_EQ(c.log, "1000000 sent 100#\n1000000 200#\n");
  c.node.reset();
  a.node->send(b.now(), CanFrame::standard(0x300, {}));  // nobody else there
  b.run_to_us(0);
  EXPECT_EQ(a.node->status().sent, 2u);
}

TEST(CanBus, SteadyTrafficAllocatesNothing) {
  CanBusOptions options;
  options.bitrate = 1'000'000;
  BusBench b(options);
  std::deque<std::unique_ptr<CanNode>> nodes;
  std::uint64_t heard = 0;
  for (std::uint8_t i = 0; i < 20; ++i) {
    CanNodeOptions node_options;
    node_options.name = "a node with a name that is too long for the small string";
    nodes.push_back(b.bus->attach(b.now(), node_options));
    CanNode* const node = nodes.back().get();
    // Each answers the one before it, and the last the first.
    node->set_handlers({[&heard, node, i](Instant now, const CanFrame& f) {
                          ++heard;
                          if (f.id % 20 + 1 != i + (f.id % 20 == 19 ? 20u : 0u)) return;
                          node->send(now, CanFrame::standard(0x100u + i, {1, 2, 3, 4}));
                        },
                        {},
                        {}});
  }
  nodes[0]->send(b.now(), CanFrame::standard(0x100, {}));
  b.run_to_us(100'000);
  const std::uint64_t before = allocation_count();
  const std::uint64_t heard_before = heard;
  b.run_to_us(200'000);
  EXPECT_GT(heard, heard_before + 1000);
  EXPECT_EQ(allocation_count(), before);
}

// A hundred nodes at random for ten seconds: all get through, everybody hears the same, and two runs are the same.
std::string random_run(std::uint64_t seed) {
  CanBusOptions options;
  options.bitrate = 500'000;
  BusBench b(options);
  constexpr int kNodes = 100;
  for (int i = 0; i < kNodes; ++i) b.add("n" + std::to_string(i));
  Random random(seed);
  std::size_t sent = 0;
  for (int step = 0; step < 2000; ++step) {
    b.scheduler.run_until(b.now() + microseconds(random.below(1000)));
    CanFrame f;
    f.id = static_cast<std::uint32_t>(random.below(0x800) & ~std::uint64_t{0x7f}) |
           static_cast<std::uint32_t>(step % kNodes);
    f.length = static_cast<std::uint8_t>(random.below(9));
    for (auto& byte : f.data) byte = static_cast<std::uint8_t>(random.next());
    for (std::size_t i = f.length; i < 8; ++i) f.data[i] = 0;
    if (b.nodes[static_cast<std::size_t>(step % kNodes)].node->send(b.now(), f) == CanSend::kQueued) ++sent;
  }
  b.scheduler.run_until(b.now() + milliseconds(500));
  EXPECT_EQ(b.stats().frames, sent);
  EXPECT_EQ(b.stats().error_frames, 0u);
  for (auto& n : b.nodes) EXPECT_EQ(n.node->status().sent + n.node->status().received, sent);
  return b.nodes[0].log;
}

TEST(CanBus, ARunIsDecidedByItsInputAlone) {
  const std::string first = random_run(1);
  EXPECT_GT(first.size(), 20'000u);
  EXPECT_EQ(first, random_run(1));
  EXPECT_NE(first, random_run(2));
}

}  // namespace
}  // namespace vinv::transports
