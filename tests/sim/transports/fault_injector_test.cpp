#include "sim/transports/fault_injector.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sim/transports/memory_link.hpp"

namespace vinv::transports {
namespace {

using std::chrono::milliseconds;

constexpr Instant at_ms(std::int64_t ms) { return instant_from_ns(ms * 1'000'000); }

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

// Sends numbered pieces from the faulty end, one each 10 ms from 10 ms on, and back, and notes what arrives when.
struct Bench {
  kernel::Scheduler scheduler;
  std::unique_ptr<ByteStream> peer;
  std::shared_ptr<FaultCourse> course;
  std::unique_ptr<FaultInjector> faulty;
  std::string at_peer;
  std::string at_us;

  explicit Bench(FaultPlan plan) : course(std::make_shared<FaultCourse>(std::move(plan))) {
    auto link = make_memory_link(scheduler);
    peer = std::move(link.second);
    faulty = std::make_unique<FaultInjector>(scheduler, std::move(link.first), course);
    listen(*peer, at_peer);
    listen(*faulty, at_us);
  }
  static void listen(ByteStream& stream, std::string& log) {
    stream.set_handlers(
        [&log](Instant now, ByteView bytes, bool) {
          log += std::to_string(to_ns(now) / 1'000'000) + ":" + std::string(bytes.begin(), bytes.end()) + " ";
        },
        [&log](Instant now, const std::string& reason) {
          log += std::to_string(to_ns(now) / 1'000'000) + ":<" + reason + "> ";
        });
  }
  void run(int pieces) {
    for (int i = 1; i <= pieces; ++i) {
      scheduler.run_until(at_ms(10 * i));
      faulty->send(scheduler.now(), bytes_of("s" + std::to_string(i)));
      peer->send(scheduler.now(), bytes_of("r" + std::to_string(i)));
    }
    scheduler.run_until(at_ms(10'000));
  }
};

FaultRule nth(Fault fault, std::uint64_t n, Duration delay = {}, std::size_t bytes = 1) {
  FaultRule rule;
  rule.fault = fault;
  rule.when.nth = n;
  rule.delay = delay;
  rule.bytes = bytes;
  return rule;
}

TEST(FaultInjector, WithoutRulesEverythingPassesUntouched) {
  Bench b({});
  b.run(3);
  EXPECT_EQ(b.at_peer, "10:s1 20:s2 30:s3 ");
  EXPECT_EQ(b.at_us, "10:r1 20:r2 30:r3 ");
  EXPECT_EQ(b.faulty->injected(), 0u);
}

TEST(FaultInjector, DropsTheNthPieceOfTheNamedDirectionOnly) {
  FaultRule receive = nth(Fault::kDrop, 3);
  receive.direction = Direction::kReceive;
  Bench b({.rules = {nth(Fault::kDrop, 2), receive}});
  b.run(3);
  EXPECT_EQ(b.at_peer, "10:s1 30:s3 ");
  EXPECT_EQ(b.at_us, "10:r1 20:r2 ");
  EXPECT_EQ(b.faulty->injected(), 2u);
}

TEST(FaultInjector, ADelayedPieceIsNotOvertaken) {
  Bench b({.rules = {nth(Fault::kDelay, 1, milliseconds(15))}});
  b.run(3);
  EXPECT_EQ(b.at_peer, "25:s1 25:s2 30:s3 ");
}

TEST(FaultInjector, DuplicatesSplitsAndTruncates) {
  Bench b({.rules = {nth(Fault::kDuplicate, 1), nth(Fault::kDuplicate, 2, milliseconds(3)),
                     nth(Fault::kSplit, 3, milliseconds(2)), nth(Fault::kTruncate, 4, {}, 1),
                     nth(Fault::kTruncate, 5, {}, 0)}});
  b.run(6);
  EXPECT_EQ(b.at_peer, "10:s1 10:s1 20:s2 23:s2 30:s 32:3 40:s 60:s6 ");
}

TEST(FaultInjector, CorruptsExactlyOneBitInEachOfTheNamedBytes) {
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{3}}) {
    kernel::Scheduler s;
    auto link = make_memory_link(s);
    FaultInjector faulty(s, std::move(link.first), {.seed = 5, .rules = {nth(Fault::kCorrupt, 1, {}, bytes)}});
    Bytes got;
    link.second->set_handlers([&](Instant, ByteView b, bool) { got.assign(b.begin(), b.end()); }, {});
    const Bytes sent(8, 0x55);
    faulty.send(at_ms(0), sent);
    s.run_until(at_ms(1));
    ASSERT_EQ(got.size(), sent.size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const int difference = got[i] ^ sent[i];
      changed += difference != 0 ? 1 : 0;
      EXPECT_EQ(difference & (difference - 1), 0);
    }
    EXPECT_EQ(changed, bytes);
  }
}

TEST(FaultInjector, LaterRulesActOnWhatEarlierOnesLeft) {
  Bench b({.rules = {nth(Fault::kDuplicate, 1), nth(Fault::kSplit, 1, milliseconds(1)), nth(Fault::kDrop, 2),
                     nth(Fault::kDuplicate, 2)}});
  b.run(2);
  EXPECT_EQ(b.at_peer, "10:s 11:1 11:s 12:1 ");
}

FaultPlan random_plan(std::uint64_t seed) {
  FaultPlan plan{.seed = seed, .rules = {}};
  for (const Fault fault :
       {Fault::kDrop, Fault::kDelay, Fault::kDuplicate, Fault::kCorrupt, Fault::kTruncate, Fault::kSplit}) {
    for (const Direction direction : {Direction::kSend, Direction::kReceive}) {
      FaultRule rule;
      rule.fault = fault;
      rule.direction = direction;
      rule.when.probability = 0.1;
      rule.delay = milliseconds(7);
      plan.rules.push_back(rule);
    }
  }
  return plan;
}

TEST(FaultInjector, TheSeedDecidesAndOnlyTheSeed) {
  const auto trace = [](std::uint64_t seed) {
    Bench b(random_plan(seed));
    b.run(200);
    EXPECT_GT(b.faulty->injected(), 100u);
    return b.at_peer + "|" + b.at_us;
  };
  EXPECT_EQ(trace(1), trace(1));
  EXPECT_NE(trace(1), trace(2));
}

TEST(FaultInjector, ProbabilityIsAboutTheShareOfPieces) {
  FaultRule rule;
  rule.when.probability = 0.25;
  Bench b({.seed = 11, .rules = {rule}});
  b.run(800);
  EXPECT_NEAR(static_cast<double>(b.faulty->injected()), 200, 40);
}

TEST(FaultInjector, TheEndComesBehindDelayedBytesAndOnce) {
  FaultRule rule = nth(Fault::kDelay, 1, milliseconds(20));
  rule.direction = Direction::kReceive;
  Bench b({.rules = {rule}});
  b.peer->send(at_ms(0), bytes_of("slow"));
  b.peer->close();
  b.scheduler.run_until(at_ms(100));
  EXPECT_EQ(b.at_us, "20:slow 20:<closed by the peer> ");
}

TEST(FaultInjector, DelayedBytesAreLimited) {
  FaultRule rule;
  rule.fault = Fault::kDelay;
  rule.when.probability = 1;
  rule.delay = milliseconds(1000);
  Bench b({.rules = {rule}});
  for (int i = 0; i < 65; ++i) b.faulty->send(at_ms(0), Bytes(1024));
  b.scheduler.run_until(at_ms(1));
  EXPECT_EQ(b.at_us, "0:<disconnected: the peer does not read (65536 bytes wait for it)> ");
  EXPECT_EQ(b.at_peer, "0:<closed by the peer> ");
}

TEST(FaultInjector, DestroyedInItsHandlerOrWithDelayedBytesItStaysQuiet) {
  FaultRule rule = nth(Fault::kDelay, 2, milliseconds(20));
  rule.direction = Direction::kReceive;
  Bench b({.rules = {rule, nth(Fault::kDelay, 1, milliseconds(20))}});
  b.faulty->send(at_ms(0), bytes_of("never"));
  int calls = 0;
  b.faulty->set_handlers(
      [&](Instant, ByteView, bool) {
        ++calls;
        b.faulty.reset();
      },
      {});
  b.peer->send(at_ms(0), bytes_of("1"));
  b.peer->send(at_ms(0), bytes_of("2"));
  b.scheduler.run_until(at_ms(100));
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(b.at_peer, "0:<closed by the peer> ");
}

TEST(FaultInjector, AReorderedPieceGoesBehindTheNextOrWhenItsTimeIsOver) {
  Bench b({.rules = {nth(Fault::kReorder, 1, milliseconds(100)), nth(Fault::kReorder, 3, milliseconds(100))}});
  b.run(3);
  EXPECT_EQ(b.at_peer, "20:s2 20:s1 130:s3 ");
}

TEST(FaultInjector, AHeldPieceComesBeforeTheEnd) {
  FaultRule rule = nth(Fault::kReorder, 1, milliseconds(100));
  rule.direction = Direction::kReceive;
  Bench b({.rules = {rule}});
  b.peer->send(b.scheduler.now(), bytes_of("r1"));
  b.peer->close();
  b.run(0);
  EXPECT_EQ(b.at_us, "0:r1 0:<closed by the peer> ");
}

TEST(FaultInjector, AHalfOpenStreamIsSilentAndTellsNoEnd) {
  Bench b({});
  b.run(1);
  b.faulty->handle().half_open();
  b.faulty->send(b.scheduler.now(), bytes_of("s2"));
  b.peer->send(b.scheduler.now(), bytes_of("r2"));
  b.run(0);
  b.peer->close();
  b.scheduler.run_until(at_ms(20'000));
  EXPECT_EQ(b.at_peer, "10:s1 ");
  EXPECT_EQ(b.at_us, "10:r1 ");
}

TEST(FaultInjector, RulesThatComeLaterCountFromThen) {
  Bench b({});
  b.run(2);
  const FaultInjector::Handle handle = b.faulty->handle();
  b.course->add(nth(Fault::kDrop, 1));
  for (const char* text : {"a", "b"}) b.faulty->send(b.scheduler.now(), bytes_of(text));
  b.course->restart({});
  b.course->add(nth(Fault::kGarble, 1));
  b.faulty->send(b.scheduler.now(), bytes_of("cdefgh"));
  b.scheduler.run_until(at_ms(20'000));
  EXPECT_TRUE(b.at_peer.starts_with("10:s1 20:s2 10000:b 10000:")) << b.at_peer;
  EXPECT_EQ(b.at_peer.find("cdefgh"), std::string::npos);
  EXPECT_EQ(b.faulty->injected(), 2u);
  b.faulty.reset();
  EXPECT_FALSE(handle.alive());
}

TEST(FaultCourse, PiecesAreCountedOverTheConnectionsThatShareIt) {
  kernel::Scheduler s;
  const auto course = std::make_shared<FaultCourse>(FaultPlan{.seed = 1, .rules = {nth(Fault::kDrop, 3)}});
  std::string heard;
  for (int connection = 0; connection < 3; ++connection) {
    auto [ours, theirs] = make_memory_link(s);
    FaultInjector faulty(s, std::move(ours), course);
    Bench::listen(*theirs, heard);
    for (int piece = 0; piece < 2; ++piece)
      faulty.send(s.now(), bytes_of(std::to_string(connection) + std::to_string(piece)));
    s.run_until(s.now() + milliseconds(1));
    theirs->close();
  }
  EXPECT_EQ(heard, "0:00 0:01 1:11 2:20 2:21 ") << "the first piece of the second connection is the third";
}

}  // namespace
}  // namespace vinv::transports
