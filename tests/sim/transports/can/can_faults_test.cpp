#include "sim/transports/can/can_faults.hpp"

#include <gtest/gtest.h>

#include "sim/transports/can/wire_format.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"

namespace vinv::transports {
namespace {

using std::chrono::microseconds;

CanFaultRule nth(CanFault fault, std::uint64_t n) {
  CanFaultRule rule;
  rule.fault = fault;
  rule.when.nth = n;
  return rule;
}

// Sends 001#01, 001#02 ... a millisecond apart and gives what the listener heard, without the times.
std::string heard(const CanFaultPlan& plan, int frames, bool times = false) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  b.bus->set_faults(plan);
  for (int i = 1; i <= frames; ++i) {
    b.run_to_us(1000 * i);
    a.node->send(b.now(), CanFrame::standard(1, {static_cast<std::uint8_t>(i)}));
  }
  b.run_to_us(1'000'000);
  std::string out;
  for (std::size_t at = 0; at < c.log.size();) {
    const std::size_t end = c.log.find('\n', at);
    const std::string line = c.log.substr(at, end - at);
    at = end + 1;
    if (line.find('#') == std::string::npos) continue;
    out += (times ? line : line.substr(line.find('#') + 1)) + " ";
  }
  return out;
}

TEST(CanFaults, ADroppedFrameIsSentButHeardByNobody) { EXPECT_EQ(heard({1, {nth(CanFault::kDrop, 2)}}, 3), "01 03 "); }

TEST(CanFaults, ADelayedFrameIsNotOvertakenByItsNode) {
  CanFaultRule rule = nth(CanFault::kDelay, 2);
  rule.delay = microseconds(5000);
  EXPECT_EQ(heard({1, {rule}}, 3), "01 02 03 ");
  const std::string with_times = heard({1, {rule}}, 3, true);
  // Handed over at 2 ms, on the wire from 7 ms; its 60 bits or so end before 7.6 ms.
  const auto bits = can_wire_bits(CanFrame::standard(1, {2})).frame_bits();
  EXPECT_NE(with_times.find(std::to_string(1'007'000 + bits * 8) + " 001#02"), std::string::npos) << with_times;
}

TEST(CanFaults, ADuplicateFollowsItsFrame) { EXPECT_EQ(heard({1, {nth(CanFault::kDuplicate, 2)}}, 3), "01 02 02 03 "); }

TEST(CanFaults, ACorruptedFrameIsAnErrorFrameAndComesAgain) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  CanFaultRule rule = nth(CanFault::kCorrupt, 1);
  rule.times = 2;
  b.bus->set_faults({9, {rule}});
  a.node->send(b.now(), CanFrame::standard(1, {7}));
  b.run_to_us(100'000);
  EXPECT_EQ(b.stats().error_frames, 2u);
  EXPECT_EQ(c.node->status().received, 1u);
  EXPECT_EQ(a.node->status().counters, (CanErrorCounters{15, 0}));
  EXPECT_EQ(c.node->status().counters, (CanErrorCounters{0, 1}));
  EXPECT_EQ(b.stats().faults_injected, 1u);
}

TEST(CanFaults, AnErrorFrameTakesArbitrationFlagsAndDelimiter) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  b.bus->set_faults({1, {nth(CanFault::kErrorFrame, 1)}});
  a.node->send(b.now(), CanFrame::standard(0, {}));
  b.run_to_us(100'000);
  // 14 bits, 12 of flags, 8 of delimiter, 3 of intermission, then the frame of 50 bits.
  EXPECT_EQ(c.log, std::to_string(1'000'000 + (14 + 12 + 8 + 3 + 50) * 8) + " 000#\n");
}

TEST(CanFaults, ThirtyTwoCorruptedAttemptsPutTheSenderOffTheBus) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  CanFaultRule rule = nth(CanFault::kCorrupt, 1);
  rule.times = 100;
  b.bus->set_faults({1, {rule}});
  a.node->send(b.now(), CanFrame::standard(1, {1}));
  b.run_to_us(1'000'000);
  EXPECT_EQ(b.stats().error_frames, 32u);
  EXPECT_EQ(c.node->status().received, 0u);
  EXPECT_NE(a.log.find("bus off"), std::string::npos);
  EXPECT_EQ(a.node->status().state, CanState::kErrorActive);  // recovered
  a.node->send(b.now(), CanFrame::standard(1, {2}));
  b.run_to_us(1'100'000);
  EXPECT_EQ(c.node->status().received, 1u);
}

TEST(CanFaults, ForcedBusOffLosesTheFrameAndWhatWaits) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  b.bus->set_faults({1, {nth(CanFault::kBusOff, 3)}});
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {1})), CanSend::kQueued);
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {2})), CanSend::kQueued);
  b.run_to_us(100);
  EXPECT_EQ(a.node->send(b.now(), CanFrame::standard(1, {3})), CanSend::kRefusedState);
  b.run_to_us(5'000);
  EXPECT_EQ(c.node->status().received, 1u);  // the one on the wire
  EXPECT_EQ(a.node->status().state, CanState::kBusOff);
  EXPECT_EQ(a.node->status().lost, 3u);
}

TEST(CanFaults, RulesChooseByIdentifierFormatAndNode) {
  CanFaultRule rule = nth(CanFault::kDrop, 1);
  rule.id = 0x580;
  rule.mask = 0x780;
  rule.extended = false;
  rule.node = "a";
  CanFaultJudge judge({1, {rule}});
  CanFrame ext = CanFrame::standard(0x585, {});
  ext.extended = true;
  EXPECT_FALSE(judge.judge(Instant{}, CanFrame::standard(0x605, {}), "a").drop);
  EXPECT_FALSE(judge.judge(Instant{}, ext, "a").drop);
  EXPECT_FALSE(judge.judge(Instant{}, CanFrame::standard(0x585, {}), "b").drop);
  EXPECT_TRUE(judge.judge(Instant{}, CanFrame::standard(0x585, {}), "a").drop);  // the first of those it chooses
  EXPECT_FALSE(judge.judge(Instant{}, CanFrame::standard(0x585, {}), "a").drop);
  EXPECT_EQ(judge.injected(), 1u);
}

TEST(CanFaults, TheSeedDecidesByProbability) {
  CanFaultPlan plan;
  CanFaultRule rule;
  rule.when.probability = 0.25;
  plan.rules.push_back(rule);
  rule.fault = CanFault::kCorrupt;
  rule.when.probability = 0.1;
  plan.rules.push_back(rule);
  const std::string first = heard(plan, 200, true);
  EXPECT_EQ(first, heard(plan, 200, true));
  const auto count = std::count(first.begin(), first.end(), '#');
  EXPECT_NEAR(static_cast<double>(count), 150, 25);
  plan.seed = 2;
  EXPECT_NE(first, heard(plan, 200, true));
}

TEST(CanFaults, TwoNodesWithOneAddressDriveEachOtherBusOff) {
  BusBench b;
  auto& a = b.add("a");
  auto& c = b.add("c");
  CanFaultRule rule;
  rule.fault = CanFault::kTwin;
  rule.node = "a";
  rule.when = FaultTrigger::only(1);
  b.bus->set_faults({3, {rule}});
  a.node->send(b.now(), CanFrame::standard(0x585, {1, 2, 3}));
  b.run_to_us(100'000);
  // 8 for each attempt; 256 is bus off. The frames are lost.
  EXPECT_EQ(b.stats().error_frames, 32u);
  EXPECT_EQ(c.node->status().received, 0u);
  EXPECT_EQ(a.node->status().counters, (CanErrorCounters{0, 0})) << "recovered";
  a.node->send(b.now(), CanFrame::standard(0x585, {4}));
  b.run_to_us(200'000);
  EXPECT_EQ(c.node->status().received, 1u);
  EXPECT_EQ(b.stats().nodes, 3u);
  b.bus->set_faults({});
  EXPECT_EQ(b.stats().nodes, 2u);
}

TEST(CanFaults, AReorderedFrameGoesBehindTheNextOrWhenItsTimeIsOver) {
  CanFaultRule rule = nth(CanFault::kReorder, 1);
  rule.delay = microseconds(50'000);
  EXPECT_EQ(heard({1, {rule}}, 3), "02 01 03 ");
  EXPECT_EQ(heard({1, {rule}}, 1), "01 ");
}

TEST(CanFaults, ASilencedFrameNeverGetsToTheWire) {
  CanFaultRule rule;
  rule.fault = CanFault::kSilence;
  rule.when = FaultTrigger::always();
  rule.not_nodes = {"c"};
  EXPECT_EQ(heard({1, {rule}}, 3), "");
  rule.not_nodes = {"a"};
  EXPECT_EQ(heard({1, {rule}}, 3), "01 02 03 ");
}

TEST(FaultTrigger, ChoosesByNumberStepTimesAndSpan) {
  const auto hits = [](const FaultTrigger& when) {
    FaultCount count;
    Random random(1);
    std::string out;
    for (int i = 1; i <= 9; ++i)
      if (count.hit(when, instant_from_ns(i), random)) out += std::to_string(i);
    return out;
  };
  EXPECT_EQ(hits(FaultTrigger::only(4)), "4");
  FaultTrigger every;
  every.every = 3;
  EXPECT_EQ(hits(every), "369");
  every.times = 2;
  EXPECT_EQ(hits(every), "36");
  FaultTrigger span = FaultTrigger::always();
  span.from = instant_from_ns(3);
  span.until = instant_from_ns(6);
  EXPECT_EQ(hits(span), "345");
  span.nth = 2;
  EXPECT_EQ(hits(span), "4") << "counted within the span";
  EXPECT_EQ(hits(FaultTrigger{}), "");
}

}  // namespace
}  // namespace vinv::transports
