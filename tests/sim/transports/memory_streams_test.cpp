// Lines in memory are saved with everything under way, and go on between other owners as if nothing had been.
#include "sim/transports/memory_streams.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/random.hpp"
#include "tests/support/snapshot_checks.hpp"

namespace vinv::transports {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// Up to four connections between owners who write down what they hear; who hears something may answer or hang up.
struct Bench {
  struct Owner {
    std::unique_ptr<ByteStream> stream;
    bool listens = false;
    std::string heard;
  };

  void listen(std::size_t i) {
    Owner& o = owners[i];
    o.listens = true;
    o.stream->set_handlers([this, i](Instant now, ByteView bytes, bool) { hear(i, now, bytes); },
                           [this, i](Instant now, const std::string& why) {
                             owners[i].heard += std::to_string(to_ns(now)) + " <" + why + ">\n";
                           });
  }
  void hear(std::size_t i, Instant now, ByteView bytes) {
    Owner& o = owners[i];
    o.heard += std::to_string(to_ns(now)) + " " + std::string(bytes.begin(), bytes.end()) + "\n";
    if (bytes.front() == 'a') o.stream->send(now, Bytes{'b', bytes.back()});
    if (bytes.front() == 'c') o.stream->close();
    if (bytes.front() == 'd') o.stream.reset();
  }
  void connect(std::size_t pair, const MemoryLinkOptions& options) {
    MemoryLink link = net.connect(options);
    owners[2 * pair] = {std::move(link.first), false, std::move(owners[2 * pair].heard)};
    owners[2 * pair + 1] = {std::move(link.second), false, std::move(owners[2 * pair + 1].heard)};
  }
  void act(Random& random) {
    const std::size_t i = random.below(owners.size());
    Owner& o = owners[i];
    switch (random.below(10)) {
      case 0:
        connect(i / 2, {.delay = microseconds(random.below(3) * 700),
                        .name_a = "a",
                        .name_b = "b",
                        .character = microseconds(random.below(2) * 300)});
        return;
      case 1:
      case 2:
        if (o.stream) listen(i);
        return;
      case 3:
        if (o.stream && random.below(3) == 0) o.stream->close();
        return;
      case 4:
        if (random.below(3) == 0) o.stream.reset();
        return;
      default:
        if (o.stream)
          o.stream->send(scheduler.now(), Bytes{static_cast<std::uint8_t>('a' + random.below(7)),
                                                static_cast<std::uint8_t>('A' + random.below(26))});
    }
  }

  friend void archive(Archive& a, Bench& b) {
    a.io(b.scheduler);
    a.io(b.net);
    for (std::size_t i = 0; i < b.owners.size(); ++i) {
      Owner& o = b.owners[i];
      b.net.archive_end(a, o.stream);
      a.io(o.listens);
      a.io(o.heard);
      if (a.loads() && !a.failed() && o.stream && o.listens) b.listen(i);
    }
    b.net.archive_owners(a);
    b.scheduler.archive_waiting(a);
  }

  kernel::Scheduler scheduler;
  MemoryStreams net{scheduler};
  std::array<Owner, 8> owners;
};

void story(Bench& b, std::uint64_t seed) {
  Random random(seed * 1'000'003 + static_cast<std::uint64_t>(to_ns(b.scheduler.now())));
  for (std::uint64_t n = random.below(5); n > 0; --n) b.act(random);
  b.scheduler.run_until(b.scheduler.now() + microseconds(random.below(2000)));
  if (random.below(3) == 0) b.act(random);
}

class MemoryNetSnapshot : public testing::TestWithParam<std::uint64_t> {};

TEST_P(MemoryNetSnapshot, LinesInterruptedAfterEachStepGoOnAsThoseThatAreNot) {
  std::size_t heard = 0;
  std::size_t under_way = 0;
  expect_the_same_after_each_step(
      1500, GetParam(), [] { return std::make_unique<Bench>(); }, story, [&](const Bench& one, const Bench&) {
        under_way += one.scheduler.waiting();
        heard = 0;
        for (const auto& o : one.owners) heard += o.heard.size();
      });
  EXPECT_GT(heard, 2000u);
  EXPECT_GT(under_way, 200u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MemoryNetSnapshot, testing::Range<std::uint64_t>(1, 6));

TEST(MemoryStreams, AForgedSnapshotLeavesTheLinesAsTheyWere) {
  Bench one;
  for (int i = 0; i < 60; ++i) story(one, 9);
  Bench other;
  for (int i = 0; i < 80; ++i) story(other, 2);
  expect_forged_leave_no_trace(one, save_snapshot(other), 500, 5, 50, [](Bench& b) { story(b, 1); });
}

TEST(MemoryStreams, AStreamWithoutOwnerAfterTheLoadIsARefusal) {
  struct Forgetful {
    kernel::Scheduler scheduler;
    MemoryStreams net{scheduler};
    MemoryLink link = net.connect();
    bool both = true;
    static void archive_all(Archive& a, Forgetful& f) {
      a.io(f.scheduler);
      a.io(f.net);
      f.net.archive_end(a, f.link.first);
      if (f.both || !a.loads()) f.net.archive_end(a, f.link.second);
      f.net.archive_owners(a);
      f.scheduler.archive_waiting(a);
    }
  };
  Forgetful f;
  Bytes saved;
  Archive save = Archive::saving(saved);
  Forgetful::archive_all(save, f);
  save.seal();
  f.both = false;
  Archive load = Archive::loading(saved);
  Forgetful::archive_all(load, f);
  EXPECT_NE(load.error().find("lost its owner"), std::string::npos) << load.error();
}

}  // namespace
}  // namespace vinv::transports
