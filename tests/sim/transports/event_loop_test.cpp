#include "sim/transports/event_loop.hpp"

#include <gtest/gtest.h>

#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "sim/kernel/virtual_clock.hpp"

namespace vinv::transports {
namespace {

using kernel::Priority;
using std::chrono::milliseconds;

constexpr Instant at_ms(std::int64_t ms) { return instant_from_ns(ms * 1'000'000); }

TEST(EventLoop, RunsEventsInTheOrderOfVirtualTime) {
  const auto plan = [](kernel::Scheduler& s, std::vector<std::string>& trace, const std::function<void()>& stop) {
    for (int i = 0; i < 3; ++i) {
      s.schedule_every(
          at_ms(0), milliseconds(i + 1), i == 0 ? Priority::kDrive : Priority::kBoard,
          [&trace, i](Instant now) { trace.push_back(std::to_string(i) + "@" + std::to_string(to_ns(now))); });
    }
    s.schedule(at_ms(30), Priority::kObserver, [stop](Instant) { stop(); });
  };
  std::vector<std::string> real;
  EventLoop loop;
  plan(loop.scheduler(), real, [&] { loop.stop(); });
  loop.run();

  std::vector<std::string> expected;
  kernel::Scheduler s;
  kernel::VirtualClock clock(s);
  plan(s, expected, [&] { clock.stop(); });
  clock.run_until(at_ms(1000));
  EXPECT_EQ(real, expected);
  EXPECT_EQ(loop.lateness().count(), expected.size() + 1);
}

TEST(EventLoop, NoEventRunsBeforeItsTime) {
  EventLoop loop;
  const auto start = std::chrono::steady_clock::now();
  bool early = false;
  loop.scheduler().schedule_every(at_ms(1), milliseconds(1), Priority::kDrive, [&](Instant now) {
    if (std::chrono::steady_clock::now() - start < now.time_since_epoch()) early = true;
    if (now >= at_ms(20)) loop.stop();
  });
  loop.run();
  EXPECT_FALSE(early);
}

TEST(EventLoop, StopFromAnActionReturnsAfterThatActionAndTheNextRunGoesOn) {
  EventLoop loop;
  int ran = 0;
  loop.scheduler().schedule(at_ms(1), Priority::kWire, [&](Instant) { loop.stop(); });
  loop.scheduler().schedule(at_ms(1), Priority::kDrive, [&](Instant) {
    ++ran;
    loop.stop();
  });
  loop.run();
  EXPECT_EQ(ran, 0);
  EXPECT_EQ(loop.now(), at_ms(1));
  loop.run();
  EXPECT_EQ(ran, 1);
}

TEST(EventLoop, StopFromAnotherThreadWakesALoopThatHasNothingToDo) {
  EventLoop loop;
  std::thread other([&] { loop.stop(); });
  loop.run();
  other.join();
}

TEST(EventLoop, OverdueEventsAllRunInOrderAndSocketsAreServedMeanwhile) {
  EventLoop loop;
  std::vector<std::int64_t> ran;
  std::int64_t ran_before_socket = -1;
  // A first event that takes 50 ms makes 500 others overdue, each of which takes longer than its period.
  const auto busy = [](Duration span) {
    const auto end = std::chrono::steady_clock::now() + span;
    while (std::chrono::steady_clock::now() < end) {
    }
  };
  loop.scheduler().schedule(at_ms(0), Priority::kStimulus, [&](Instant) {
    busy(milliseconds(50));
    asio::post(loop.io(), [&] { ran_before_socket = static_cast<std::int64_t>(ran.size()); });
  });
  loop.scheduler().schedule_every(at_ms(0), std::chrono::microseconds(100), Priority::kDrive, [&](Instant now) {
    ran.push_back(to_ns(now));
    busy(std::chrono::microseconds(150));
    if (ran.size() == 500) loop.stop();
  });
  loop.run();
  ASSERT_EQ(ran.size(), 500u);
  for (std::size_t i = 0; i < ran.size(); ++i) ASSERT_EQ(ran[i], static_cast<std::int64_t>(i) * 100'000);
  EXPECT_GE(ran_before_socket, 0);
  EXPECT_LT(ran_before_socket, 500);
  EXPECT_GE(loop.lateness().maximum(), Duration(milliseconds(50)));
}

TEST(EventLoop, SocketHandlersThatNeverEndDoNotStopEvents) {
  EventLoop loop;
  bool stopped = false;
  std::function<void()> flood = [&] {
    if (!stopped) asio::post(loop.io(), flood);
  };
  asio::post(loop.io(), flood);
  int ticks = 0;
  loop.scheduler().schedule_every(at_ms(0), milliseconds(1), Priority::kDrive, [&](Instant) {
    if (++ticks == 20) {
      stopped = true;
      loop.stop();
    }
  });
  loop.run();
  EXPECT_EQ(ticks, 20);
}

TEST(EventLoop, NowIsNeverPastAWaitingEventNorBeforeTheLast) {
  EventLoop loop;
  bool wrong = false;
  Instant last{};
  std::function<void()> look = [&] {
    const Instant now = loop.now();
    const auto next = loop.scheduler().next_event_at();
    if (now < last || now < loop.scheduler().now() || (next && now > *next)) wrong = true;
    last = now;
    asio::post(loop.io(), look);
  };
  asio::post(loop.io(), look);
  loop.scheduler().schedule_every(at_ms(0), std::chrono::microseconds(200), Priority::kDrive, [&](Instant now) {
    if (now < last) wrong = true;
    if (now >= at_ms(20)) loop.stop();
  });
  loop.run();
  EXPECT_FALSE(wrong);
  EXPECT_GE(last, at_ms(1));
}

TEST(EventLoop, TimeStandsStillOutsideRun) {
  EventLoop loop;
  EXPECT_EQ(loop.now(), Instant{});
  loop.scheduler().schedule(at_ms(2), Priority::kDrive, [&](Instant) { loop.stop(); });
  loop.run();
  const Instant stopped = loop.now();
  EXPECT_GE(stopped, at_ms(2));
  std::this_thread::sleep_for(milliseconds(3));
  EXPECT_EQ(loop.now(), stopped);
  Instant resumed{};
  asio::post(loop.io(), [&] { resumed = loop.now(); });
  loop.scheduler().schedule(stopped + milliseconds(1), Priority::kDrive, [&](Instant) { loop.stop(); });
  loop.run();
  EXPECT_GE(resumed, stopped);
  EXPECT_LE(resumed, stopped + milliseconds(1));
}

TEST(EventLoop, AnEventFromASocketHandlerThatIsEarlierThanTheTimerRunsAtItsTime) {
  EventLoop loop;
  std::string order;
  loop.scheduler().schedule(at_ms(3'600'000), Priority::kDrive, [&](Instant) { order += "late"; });
  std::thread other([&] {
    asio::post(loop.io(), [&] {
      loop.scheduler().schedule(loop.now() + milliseconds(1), Priority::kDrive, [&](Instant) {
        order += "early";
        loop.stop();
      });
    });
  });
  loop.run();
  other.join();
  EXPECT_EQ(order, "early");
}

TEST(EventLoop, TerminationSignalsReachTheHandler) {
  EventLoop loop;
  std::vector<int> signals;
  loop.on_signal([&](int signal) {
    signals.push_back(signal);
    if (signals.size() == 2) {
      loop.stop();
    } else {
      std::raise(SIGTERM);
    }
  });
  loop.scheduler().schedule(at_ms(1), Priority::kStimulus, [](Instant) { std::raise(SIGINT); });
  loop.run();
  EXPECT_EQ(signals, (std::vector<int>{SIGINT, SIGTERM}));
}

}  // namespace
}  // namespace vinv::transports
