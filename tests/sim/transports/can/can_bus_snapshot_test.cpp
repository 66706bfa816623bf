// A bus that loads a snapshot goes on as the bus that was never interrupted.
#include <gtest/gtest.h>

#include <algorithm>

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
  std::stable_sort(out.begin(), out.end(), [](const Stimulus& x, const Stimulus& y) { return x.at_us < y.at_us; });
  return out;
}

CanFaultPlan faults() {
  CanFaultPlan plan{7, {}};
  for (const CanFault fault : {CanFault::kDrop, CanFault::kDelay, CanFault::kDuplicate, CanFault::kCorrupt,
                               CanFault::kErrorFrame, CanFault::kBusOff, CanFault::kReorder, CanFault::kSilence}) {
    CanFaultRule rule;
    rule.fault = fault;
    rule.when.probability = fault == CanFault::kBusOff ? 0.01 : 0.04;
    rule.delay = std::chrono::microseconds(700);
    rule.times = 3;
    plan.rules.push_back(rule);
  }
  return plan;
}

struct Story : BusBench {
  explicit Story(const std::vector<Stimulus>& stimuli) : BusBench(options_of()), all(stimuli) {
    for (const char* name : {"a", "b", "c", "d"}) {
      CanNodeOptions node;
      node.name = name;
      node.queue_frames = 6;
      node.recovers = name[0] != 'd';
      if (name[0] == 'c') node.when_full = CanQueuePolicy::kDropOldest;
      add(node);
    }
    arm();
  }
  friend void archive(Archive& a, Story& story) {
    a.io(story.scheduler);
    a.io(*story.bus);
    a.io(story.next);
    story.scheduler.archive_event(a, story.event, [&story](Instant t) { story.run_stimulus(t); });
    story.scheduler.archive_waiting(a);
  }
  void arm() {
    if (next < all.size())
      event = scheduler.schedule(start + std::chrono::microseconds(all[next].at_us), kernel::Priority::kStimulus,
                                 [this](Instant t) { run_stimulus(t); });
  }
  void run_stimulus(Instant t) {
    event = 0;
    const Stimulus& s = all[next++];
    arm();
    act(t, s);
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

  const std::vector<Stimulus>& all;
  std::uint64_t next = 0;
  kernel::EventId event = 0;
};

TEST(CanBusSnapshot, ARunFromACopyAtAnyInstantEqualsTheUninterruptedOne) {
  const std::vector<Stimulus> all = story();
  Random random(1);
  std::vector<bool> phases(4, false);
  bool recovering = false;
  for (int i = 0; i < 200; ++i) {
    const auto cut_us = static_cast<std::int64_t>(random.below(kStoryUs));
    Story whole(all);
    whole.bus->set_faults(faults());
    whole.run_to_us(cut_us);
    const Bytes saved = save_snapshot(whole);
    const std::string listed = list_snapshot(whole);
    for (std::size_t phase = 0; phase < phases.size(); ++phase)
      if (listed.find(".phase = " + std::to_string(phase) + "\n") != std::string::npos) phases[phase] = true;
    recovering = recovering || listed.find(".recovering = 1\n") != std::string::npos;
    whole.take();
    whole.run_to_us(kStoryUs);

    // Each other one has a past of its own, and may be behind the cut.
    Story rest(all);
    if (i % 2 == 1) {
      rest.bus->set_faults(faults());
      rest.run_to_us(static_cast<std::int64_t>(random.below(kStoryUs)));
      rest.take();
    }
    const auto loaded = load_snapshot(rest, saved);
    ASSERT_TRUE(loaded) << loaded.error();
    ASSERT_EQ(rest.take(), "a:\nb:\nc:\nd:\n") << "a load tells nobody";
    ASSERT_EQ(save_snapshot(rest), saved);
    rest.run_to_us(kStoryUs);
    ASSERT_EQ(rest.take(), whole.take()) << "cut at " << cut_us << " us";
    ASSERT_EQ(rest.numbers(), whole.numbers()) << "cut at " << cut_us << " us";
    ASSERT_EQ(list_snapshot(rest), list_snapshot(whole)) << "cut at " << cut_us << " us";
  }
  EXPECT_EQ(phases, std::vector<bool>(4, true)) << "a phase of the wire was never cut";
  EXPECT_TRUE(recovering);
}

TEST(CanBusSnapshot, AForcedBusOffThatIsDueHappensAfterwards) {
  CanFaultPlan plan;
  plan.rules.push_back({});
  plan.rules[0].fault = CanFault::kBusOff;
  plan.rules[0].when.nth = 1;
  BusBench first;
  first.bus->set_faults(plan);
  LoggingNode& sender = first.add("a");
  sender.node->send(first.now(), CanFrame::standard(1, {}));
  const Bytes saved = save_snapshot(first);
  BusBench second;
  LoggingNode& same = second.add("a");
  const auto loaded = load_snapshot(second, saved);
  ASSERT_TRUE(loaded) << loaded.error();
  second.run_to_us(0);
  EXPECT_EQ(same.log, us(second.start) + " bus off\n");
}

TEST(CanBusSnapshot, AFrameWhoseSenderHasLeftIsCompleted) {
  BusBench first;
  first.add("a");
  CanNodeOptions leaving;
  leaving.name = "leaves";
  auto node = first.bus->attach(first.now(), leaving);
  node->send(first.now(), CanFrame::standard(0x123, {1}));
  first.run_to_us(100);
  node.reset();
  const Bytes saved = save_snapshot(first);
  BusBench second;
  LoggingNode& hearer = second.add("a");
  const auto loaded = load_snapshot(second, saved);
  ASSERT_TRUE(loaded) << loaded.error();
  first.run_to_us(5'000);
  second.run_to_us(5'000);
  EXPECT_EQ(hearer.log, first.nodes[0].log);
  EXPECT_NE(hearer.log, "");
}

TEST(CanBusSnapshot, AnotherNameOrRateOrOtherNodesAreRefusedAndChangeNothing) {
  BusBench first;
  first.add("a");
  first.add("b");
  first.run_to_us(1);
  const Bytes saved = save_snapshot(first);
  const auto expect_refused = [&](const CanBusOptions& options, const std::vector<CanNodeOptions>& nodes) {
    BusBench other(options);
    for (const CanNodeOptions& n : nodes) other.add(n);
    const Bytes before = save_snapshot(other);
    const auto loaded = load_snapshot(other, saved);
    ASSERT_FALSE(loaded);
    EXPECT_NE(loaded.error().find("the snapshot is of another CAN bus"), std::string::npos) << loaded.error();
    EXPECT_EQ(save_snapshot(other), before);
  };
  CanNodeOptions a;
  a.name = "a";
  CanNodeOptions b;
  b.name = "b";
  CanBusOptions named;
  named.name = "can1";
  expect_refused(named, {a, b});
  CanBusOptions fast;
  fast.bitrate = 500'000;
  expect_refused(fast, {a, b});
  expect_refused({}, {a});
  expect_refused({}, {a, b, b});
  CanNodeOptions c;
  c.name = "c";
  expect_refused({}, {a, c});
  CanNodeOptions shorter = b;
  shorter.queue_frames = 6;
  expect_refused({}, {a, shorter});
}

TEST(CanBusSnapshot, NodesInAnotherOrderAtAnotherTimeTakeThoseOfTheSnapshot) {
  BusBench first;
  first.add("a");
  first.add("b").node->send(first.now(), CanFrame::standard(0x123, {1}));
  const Bytes saved = save_snapshot(first);
  BusBench second;
  LoggingNode& b = second.add("b");
  LoggingNode& a = second.add("a");
  second.run_to_us(700);
  const auto loaded = load_snapshot(second, saved);
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(second.now(), first.now());
  EXPECT_EQ(save_snapshot(second), saved);
  first.run_to_us(5'000);
  second.run_to_us(5'000);
  EXPECT_EQ(a.log, first.nodes[0].log);
  EXPECT_EQ(b.log, first.nodes[1].log);
  EXPECT_NE(a.log, "");
}

// A twin is a node that a fault makes; a bus without it gets it with the snapshot, and one with it loses it.
TEST(CanBusSnapshot, TwinsComeAndGoWithIt) {
  CanFaultPlan plan;
  CanFaultRule rule;
  rule.fault = CanFault::kTwin;
  rule.when.every = 3;
  plan.rules.push_back(rule);
  const std::vector<Stimulus> all = story();
  for (const std::int64_t cut_us : {kStoryUs / 7, kStoryUs / 3, kStoryUs / 2}) {
    Story whole(all);
    const Bytes without = save_snapshot(whole);
    whole.bus->set_faults(plan);
    whole.run_to_us(cut_us);
    const Bytes saved = save_snapshot(whole);
    EXPECT_GT(whole.stats().nodes, 4u);
    whole.take();
    whole.run_to_us(kStoryUs);
    Story rest(all);
    const auto loaded = load_snapshot(rest, saved);
    ASSERT_TRUE(loaded) << loaded.error();
    rest.run_to_us(kStoryUs);
    EXPECT_EQ(rest.take(), whole.take()) << "cut at " << cut_us << " us";
    EXPECT_EQ(rest.numbers(), whole.numbers()) << "cut at " << cut_us << " us";
    const auto back = load_snapshot(rest, without);
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(rest.stats().nodes, 4u);
    EXPECT_EQ(save_snapshot(rest), without);
  }
}

}  // namespace
}  // namespace vinv::transports
