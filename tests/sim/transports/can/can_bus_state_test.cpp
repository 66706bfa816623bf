// A bus put back to what it was goes on as the bus that was never interrupted.
#include "sim/transports/can/can_bus_state.hpp"

#include <gtest/gtest.h>

#include "sim/base/random.hpp"
#include "tests/sim/transports/can/bus_fixture.hpp"

namespace vinv::transports {
namespace {

constexpr std::int64_t kStoryUs = 60'000;
constexpr std::int64_t kAloneFromUs = 25'000;
constexpr std::int64_t kAloneToUs = 37'000;
constexpr unsigned kAlone = 1'000;  // an action of its own

struct Stimulus {
  std::int64_t at_us = 0;
  std::size_t node = 0;
  unsigned action = 0;
  CanFrame frame;
};

// Traffic in bursts with pauses; a time in which one node is alone with its frame; nodes that go and come, are shorted
// and change their rate.
std::vector<Stimulus> story() {
  Random random(20'260);
  std::vector<Stimulus> out;
  std::int64_t at = 0;
  while (at < kStoryUs - 5'000) {
    at += static_cast<std::int64_t>(random.below(random.below(20) == 0 ? 3'000 : 150));
    Stimulus s{at, random.below(4), static_cast<unsigned>(random.below(60)), {}};
    s.frame.id = static_cast<std::uint32_t>(random.below(5) * 0x101);
    s.frame.extended = random.below(4) == 0;
    s.frame.remote = random.below(6) == 0;
    s.frame.length = static_cast<std::uint8_t>(random.below(9));
    for (std::uint8_t& byte : s.frame.data) byte = s.frame.remote ? 0 : static_cast<std::uint8_t>(random.next());
    if (s.at_us < kAloneFromUs || s.at_us > kAloneToUs) out.push_back(s);
  }
  out.push_back({kAloneFromUs, 0, kAlone, CanFrame::standard(0x55, {1, 2, 3})});
  out.push_back({kAloneToUs, 0, 1, {}});
  return out;
}

CanFaultPlan faults() {
  CanFaultPlan plan{7, {}};
  for (const CanFault fault : {CanFault::kDrop, CanFault::kDelay, CanFault::kDuplicate, CanFault::kCorrupt,
                               CanFault::kErrorFrame, CanFault::kBusOff, CanFault::kReorder, CanFault::kSilence,
                               CanFault::kTwin}) {
    CanFaultRule rule;
    rule.fault = fault;
    rule.when.probability = fault == CanFault::kBusOff ? 0.01 : 0.04;
    rule.delay = std::chrono::microseconds(700);
    rule.times = 3;
    plan.rules.push_back(rule);
  }
  return plan;
}

// The plant without its past: the same nodes on a bus at the same time.
struct Story : BusBench {
  explicit Story(std::int64_t from_us, const std::vector<Stimulus>& all) : BusBench(options_of()) {
    run_to_us(from_us);
    for (const char* name : {"a", "b", "c", "d"}) {
      CanNodeOptions node;
      node.name = name;
      node.queue_frames = 6;
      node.recovers = name[0] != 'd';
      if (name[0] == 'c') node.when_full = CanQueuePolicy::kDropOldest;
      add(node);
    }
    for (const Stimulus& s : all) {
      if (s.at_us > from_us)
        scheduler.schedule(start + std::chrono::microseconds(s.at_us), kernel::Priority::kStimulus,
                           [this, s](Instant t) { act(t, s); });
    }
  }
  static CanBusOptions options_of() {
    CanBusOptions o;
    o.bitrate = 500'000;
    return o;
  }
  void act(Instant t, const Stimulus& s) {
    CanNode& node = *nodes[s.node].node;
    switch (s.action) {
      case 0: return node.set_online(t, false);
      case 1:
      case 2: return nodes[0].node->set_online(t, true), nodes[s.node].node->set_online(t, true);
      case 3: return node.force_bus_off(t);
      case 4: return node.recover(t);
      case 5: return bus->inject_error_frame(t);
      case 6: return void(node.set_bitrate(t, 250'000));
      case 7:
      case 8:
        for (auto& n : nodes) EXPECT_TRUE(n.node->set_bitrate(t, 500'000));
        return;
      case 9: return node.set_listen_only(t, s.node == 1);
      case 10: return node.clear_queue();
      case kAlone:
        for (auto& n : nodes) n.node->set_online(t, false);
        node.set_online(t, true);
        EXPECT_TRUE(node.set_bitrate(t, 500'000));
        node.set_listen_only(t, false);
        return void(node.send(t, s.frame));
      default: node.send(t, s.frame);
    }
  }
  std::string take() {
    std::string out;
    for (LoggingNode& n : nodes) out += n.node->name() + ":\n" + std::exchange(n.log, {});
    return out;
  }
  std::string numbers() {
    const CanBusStats s = stats();
    std::string out = std::to_string(s.frames) + ' ' + std::to_string(s.error_frames) + ' ' +
                      std::to_string(s.arbitrations_lost) + ' ' + std::to_string(s.faults_injected) + ' ' +
                      std::to_string(s.load.total);
    for (const LoggingNode& n : nodes) {
      const CanStatus status = n.node->status();
      out += std::string("\n") + text(status.state) + ' ' + std::to_string(status.counters.tec) + ' ' +
             std::to_string(status.counters.rec) + ' ' + std::to_string(status.sent) + ' ' +
             std::to_string(status.received) + ' ' + std::to_string(status.lost);
    }
    return out;
  }
};

TEST(CanBusState, ARunFromACopyAtAnyInstantEqualsTheUninterruptedOne) {
  const std::vector<Stimulus> all = story();
  Random random(1);
  std::vector<bool> phases(4, false);
  bool recovering = false;
  for (int i = 0; i < 200; ++i) {
    const auto cut_us = static_cast<std::int64_t>(random.below(kStoryUs));
    Story whole(0, all);
    whole.bus->set_faults(faults());
    whole.run_to_us(cut_us);
    const CanBusState state = whole.bus->save();
    phases[static_cast<std::size_t>(state.wire.phase)] = true;
    for (const CanNodeData& n : state.nodes) recovering = recovering || n.recovering;
    whole.take();
    whole.run_to_us(kStoryUs);

    Story rest(cut_us, all);
    const auto restored = rest.bus->restore(state);
    ASSERT_TRUE(restored) << restored.error();
    rest.run_to_us(kStoryUs);
    ASSERT_EQ(rest.take(), whole.take()) << "cut at " << cut_us << " us";
    ASSERT_EQ(rest.numbers(), whole.numbers()) << "cut at " << cut_us << " us";
  }
  EXPECT_EQ(phases, std::vector<bool>(4, true)) << "a phase of the wire was never cut";
  EXPECT_TRUE(recovering);
}

TEST(CanBusState, AForcedBusOffThatIsDueHappensAfterwards) {
  CanFaultPlan plan;
  plan.rules.push_back({});
  plan.rules[0].fault = CanFault::kBusOff;
  plan.rules[0].when.nth = 1;
  BusBench first;
  first.bus->set_faults(plan);
  LoggingNode& sender = first.add("a");
  sender.node->send(first.now(), CanFrame::standard(1, {}));
  const CanBusState state = first.bus->save();
  BusBench second;
  LoggingNode& same = second.add("a");
  ASSERT_TRUE(second.bus->restore(state));
  second.run_to_us(0);
  EXPECT_EQ(same.log, us(second.start) + " bus off\n");
}

TEST(CanBusState, AFrameWhoseSenderHasLeftIsCompleted) {
  BusBench first;
  first.add("a");
  CanNodeOptions leaving;
  leaving.name = "leaves";
  auto node = first.bus->attach(first.now(), leaving);
  node->send(first.now(), CanFrame::standard(0x123, {1}));
  first.run_to_us(100);
  node.reset();
  const CanBusState state = first.bus->save();
  EXPECT_EQ(state.nodes.size(), 2u);
  BusBench second;
  second.run_to_us(100);
  LoggingNode& hearer = second.add("a");
  ASSERT_TRUE(second.bus->restore(state));
  first.run_to_us(5'000);
  second.run_to_us(5'000);
  EXPECT_EQ(hearer.log, first.nodes[0].log);
  EXPECT_NE(hearer.log, "");
}

TEST(CanBusState, AnotherTimeOrRateOrOtherNodesAreRefused) {
  BusBench first;
  first.add("a");
  first.add("b");
  const CanBusState state = first.bus->save();
  BusBench late;
  late.add("a");
  late.add("b");
  late.run_to_us(1);
  EXPECT_EQ(late.bus->restore(state).error(), "cannot restore CAN bus can0: the state is of another time");
  CanBusOptions options;
  options.bitrate = 500'000;
  BusBench fast(options);
  EXPECT_EQ(fast.bus->restore(state).error(), "cannot restore CAN bus can0: the state is of another bit rate");
  BusBench few;
  few.add("a");
  EXPECT_EQ(few.bus->restore(state).error(), "cannot restore CAN bus can0: it has 1 nodes, the state 2");
  BusBench other;
  other.add("b");
  other.add("a");
  EXPECT_EQ(other.bus->restore(state).error(), "cannot restore CAN bus can0: node 1 is b, in the state a");
}

}  // namespace
}  // namespace vinv::transports
