// Faults on datagrams.
#include "sim/transports/faulty_udp.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "sim/transports/memory_datagrams.hpp"

namespace vinv::transports {
namespace {

using namespace std::chrono_literals;

constexpr Ipv4Endpoint kOwn{ipv4(10, 0, 0, 1), 100}, kFar{ipv4(10, 0, 0, 2), 100};

struct Bench {
  Bench() : course(std::make_shared<FaultCourse>(FaultPlan{})) {
    own = std::make_unique<FaultyUdp>(scheduler, std::move(*network.open(kOwn)), course);
    far = std::move(*network.open(kFar));
    own->set_handler([this](Instant now, const Ipv4Endpoint&, ByteView b) { note("in", now, b); });
    far->set_handler([this](Instant now, const Ipv4Endpoint&, ByteView b) { note("out", now, b); });
  }
  void note(const char* way, Instant now, ByteView b) {
    heard +=
        std::string(way) + " " + std::to_string(to_ns(now) / 1'000'000) + " " + std::string(b.begin(), b.end()) + "\n";
  }
  void rule(Fault fault, FaultTrigger when, Duration delay = {}, std::size_t bytes = 1,
            Direction direction = Direction::kSend) {
    course->add({fault, direction, when, delay, bytes});
  }
  void send(const std::string& text) {
    own->send(scheduler.now(), kFar, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void receive(const std::string& text) {
    far->send(scheduler.now(), kOwn, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  std::string run(Duration time = 100ms) {
    scheduler.run_until(scheduler.now() + time);
    return std::exchange(heard, {});
  }
  kernel::Scheduler scheduler;
  MemoryDatagrams network{scheduler, 0ms};
  std::shared_ptr<FaultCourse> course;
  std::unique_ptr<FaultyUdp> own;
  std::unique_ptr<UdpPort> far;
  std::string heard;
};

TEST(FaultyUdp, WithoutRulesEverythingPasses) {
  Bench b;
  b.send("a");
  b.receive("b");
  EXPECT_EQ(b.run(), "out 0 a\nin 0 b\n");
}

TEST(FaultyUdp, DropsTheNthOfItsDirection) {
  Bench b;
  b.rule(Fault::kDrop, FaultTrigger::only(2));
  for (const char* text : {"1", "2", "3"}) b.send(text), b.receive(text);
  EXPECT_EQ(b.run(), "out 0 1\nin 0 1\nin 0 2\nout 0 3\nin 0 3\n");
}

TEST(FaultyUdp, DelayedOneIsOvertakenAndADuplicateComesAgain) {
  Bench b;
  b.rule(Fault::kDelay, FaultTrigger::only(1), 5ms);
  b.rule(Fault::kDuplicate, FaultTrigger::only(2), 2ms);
  b.send("1");
  b.send("2");
  EXPECT_EQ(b.run(), "out 0 2\nout 2 2\nout 5 1\n");
}

TEST(FaultyUdp, ReorderedOneGoesBehindTheNextOrAtItsTime) {
  Bench b;
  b.rule(Fault::kReorder, FaultTrigger::only(1), 50ms);
  b.send("1");
  b.send("2");
  b.send("3");
  EXPECT_EQ(b.run(), "out 0 2\nout 0 1\nout 0 3\n");
  Bench alone;
  alone.rule(Fault::kReorder, FaultTrigger::only(1), 50ms);
  alone.send("1");
  EXPECT_EQ(alone.run(), "out 50 1\n");
}

TEST(FaultyUdp, CorruptsBitsAndTruncates) {
  Bench b;
  b.rule(Fault::kCorrupt, FaultTrigger::only(1));
  b.rule(Fault::kTruncate, FaultTrigger::only(2), {}, 3, Direction::kReceive);
  b.send("abcdef");
  const std::string once = b.run();
  ASSERT_EQ(once.size(), std::string("out 0 abcdef\n").size());
  EXPECT_NE(once, "out 0 abcdef\n");
  b.receive("abcdef");
  b.receive("abcdef");
  EXPECT_EQ(b.run(), "in 100 abcdef\nin 100 abc\n");
}

struct Whole {
  Bench& b;
  friend void archive(Archive& a, Whole& whole) {
    a.io(whole.b.scheduler);
    a.io(whole.b.network);
    a.io(*whole.b.course);
    a.io(*whole.b.own);
    whole.b.scheduler.archive_waiting(a);
  }
};

TEST(FaultyUdp, SnapshotHoldsWhatIsDelayed) {
  Bench b;
  b.rule(Fault::kDelay, FaultTrigger::by_chance(0.5), 20ms);
  b.rule(Fault::kCorrupt, FaultTrigger::by_chance(0.3));
  for (int i = 0; i < 10; ++i) b.send("datagram " + std::to_string(i));
  b.run(10ms);
  Whole whole{b};
  Bytes saved;
  save_snapshot(whole, saved);
  const auto story = [](Bench& bench) {
    for (int i = 0; i < 10; ++i) bench.send("later " + std::to_string(i));
    return bench.run();
  };
  const std::string first = story(b);
  EXPECT_NE(first.find("out 20 "), std::string::npos) << first;
  Bench other;
  Whole into{other};
  ASSERT_TRUE(load_snapshot(into, saved));
  EXPECT_EQ(story(other), first);
}

}  // namespace
}  // namespace vinv::transports
