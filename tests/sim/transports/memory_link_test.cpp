#include "sim/transports/memory_link.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace vinv::transports {
namespace {

using kernel::Priority;
using std::chrono::milliseconds;

constexpr Instant at_ms(std::int64_t ms) { return instant_from_ns(ms * 1'000'000); }

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

// Writes down what one end sees.
struct Witness {
  std::string log;
  void listen(ByteStream& stream) {
    stream.set_handlers(
        [this](Instant now, ByteView bytes, bool) {
          log += std::to_string(to_ns(now) / 1'000'000) + ":" + std::string(bytes.begin(), bytes.end()) + " ";
        },
        [this](Instant now, const std::string& reason) {
          log += std::to_string(to_ns(now) / 1'000'000) + ":<" + reason + "> ";
        });
  }
};

TEST(MemoryLink, BytesArriveAfterTheDelayInOrderAtBothEnds) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s, {.delay = milliseconds(5), .name_a = "plc", .name_b = "board"});
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_a;
  Witness at_b;
  at_a.listen(*a);
  at_b.listen(*b);
  EXPECT_EQ(a->name(), "plc");
  EXPECT_EQ(b->name(), "board");
  s.schedule(at_ms(10), Priority::kStimulus, [&](Instant now) {
    a->send(now, bytes_of("one"));
    a->send(now, bytes_of("two"));
  });
  s.schedule(at_ms(12), Priority::kStimulus, [&](Instant now) { b->send(now, bytes_of("back")); });
  s.run_until(at_ms(14));
  EXPECT_EQ(at_b.log, "");
  s.run_until(at_ms(100));
  EXPECT_EQ(at_b.log, "15:one 15:two ");
  EXPECT_EQ(at_a.log, "17:back ");
}

TEST(MemoryLink, WithoutDelayBytesArriveInTheSamePassButNotFromWithinSend) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s);
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_b;
  at_b.listen(*b);
  s.schedule(at_ms(1), Priority::kStimulus, [&](Instant now) {
    a->send(now, bytes_of("x"));
    EXPECT_EQ(at_b.log, "");
  });
  s.run_until(at_ms(1));
  EXPECT_EQ(at_b.log, "1:x ");
}

TEST(MemoryLink, ClosingTellsTheOtherEndOnceBehindWhatWasSent) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s, {.delay = milliseconds(5)});
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_a;
  Witness at_b;
  at_a.listen(*a);
  at_b.listen(*b);
  a->send(at_ms(0), bytes_of("last"));
  a->close();
  a->close();
  a->send(at_ms(0), bytes_of("after"));
  s.run_until(at_ms(20));
  a.reset();
  s.run_until(at_ms(40));
  EXPECT_EQ(at_b.log, "5:last 5:<closed by the peer> ");
  b->send(at_ms(40), bytes_of("nobody"));
  s.run_until(at_ms(60));
  EXPECT_EQ(at_a.log, "");
}

TEST(MemoryLink, AnEndThatIsDestroyedInItsHandlerIsGone) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s);
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_a;
  at_a.listen(*a);
  int calls = 0;
  b->set_handlers(
      [&calls, &b, guard = std::string(64, 'g')](Instant, ByteView, bool) {
        b.reset();
        calls += static_cast<int>(guard.size());
      },
      {});
  a->send(at_ms(0), bytes_of("one"));
  a->send(at_ms(0), bytes_of("two"));
  s.run_until(at_ms(1));
  EXPECT_EQ(calls, 64);
  EXPECT_EQ(at_a.log, "0:<closed by the peer> ");
}

TEST(MemoryLink, BytesWaitForHandlersInOrderUpToTheLimit) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s);
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_a;
  at_a.listen(*a);
  a->send(at_ms(0), bytes_of("early "));
  s.run_until(at_ms(1));
  Witness at_b;
  a->send(at_ms(1), bytes_of("on its way "));
  at_b.listen(*b);
  EXPECT_EQ(at_b.log, "");
  s.run_until(at_ms(2));
  EXPECT_EQ(at_b.log, "1:early on its way  ");
  EXPECT_EQ(at_a.log, "");
}

TEST(MemoryLink, APeerThatNeverReadsIsDisconnectedAtTheLimit) {
  kernel::Scheduler s;
  MemoryLink link = make_memory_link(s);
  std::unique_ptr<ByteStream>& a = link.first;
  std::unique_ptr<ByteStream>& b = link.second;
  Witness at_a;
  at_a.listen(*a);
  const Bytes kilobyte(1024);
  for (int i = 0; i < 64; ++i) a->send(at_ms(0), kilobyte);
  s.run_until(at_ms(1));
  EXPECT_EQ(at_a.log, "");
  a->send(at_ms(1), bytes_of("x"));
  a->send(at_ms(1), bytes_of("x"));
  s.run_until(at_ms(2));
  EXPECT_EQ(at_a.log, "1:<disconnected: the peer does not read (65536 bytes wait for it)> ");
  std::size_t read = 0;
  std::string reason;
  b->set_handlers([&](Instant, ByteView bytes, bool) { read += bytes.size(); },
                  [&](Instant, const std::string& why) { reason = why; });
  s.run_until(at_ms(3));
  EXPECT_EQ(read, 65536u);
  EXPECT_EQ(reason, "closed by the peer");
}

TEST(MemoryLink, CharactersOfASerialLineTakeTheirTimeAndTheirTurn) {
  kernel::Scheduler s;
  auto [a, b] = make_memory_link(s, {.character = std::chrono::milliseconds(1)});
  std::string heard;
  b->set_handlers(
      [&](Instant now, ByteView bytes, bool) {
        heard += std::to_string(to_ns(now) / 1'000'000) + ":" + std::to_string(bytes.size()) + " ";
      },
      [&](Instant now, const std::string&) { heard += std::to_string(to_ns(now) / 1'000'000) + ":end"; });
  a->send(s.now(), Bytes(8));
  a->send(s.now(), Bytes(2));
  a->close();
  s.run_until(instant_from_ns(1'000'000'000));
  EXPECT_EQ(heard, "8:8 10:2 10:end");
}

}  // namespace
}  // namespace vinv::transports
