#include "sim/kernel/scheduler.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "sim/base/random.hpp"
#include "tests/sim/kernel/allocation_count.hpp"

namespace vinv::kernel {
namespace {

constexpr Instant at(std::int64_t ns) { return instant_from_ns(ns); }

TEST(Scheduler, RunsByTimeThenPriorityThenSequence) {
  Scheduler s;
  std::string order;
  const auto add = [&](int ns, Priority p, char name) {
    s.schedule(at(ns), p, [&order, name](Instant) { order += name; });
  };
  add(20, Priority::kStimulus, 'f');
  add(10, Priority::kObserver, 'e');
  add(10, Priority::kDrive, 'c');
  add(10, Priority::kDrive, 'd');
  add(10, Priority::kStimulus, 'a');
  add(10, Priority::kWire, 'b');
  s.run_until(at(100));
  EXPECT_EQ(order, "abcdef");
  EXPECT_EQ(s.now(), at(100));
  EXPECT_EQ(s.events_run(), 6u);
}

TEST(Scheduler, RunsUpToAndIncludingTheLimit) {
  Scheduler s;
  std::vector<std::int64_t> ran;
  for (int ns : {9, 10, 11}) s.schedule(at(ns), Priority::kDrive, [&](Instant now) { ran.push_back(to_ns(now)); });
  s.run_until(at(10));
  EXPECT_EQ(ran, (std::vector<std::int64_t>{9, 10}));
  EXPECT_EQ(s.next_event_at(), at(11));
  s.run_until(at(11));
  EXPECT_EQ(ran.size(), 3u);
  EXPECT_EQ(s.next_event_at(), std::nullopt);
}

TEST(Scheduler, AnEventScheduledForNowRunsInThisPassInItsPriority) {
  Scheduler s;
  std::string order;
  s.schedule(at(5), Priority::kWire, [&](Instant now) {
    order += 'w';
    s.schedule(now, Priority::kBoard, [&](Instant) { order += 'b'; });
    s.schedule(now, Priority::kStimulus, [&](Instant) { order += 's'; });
  });
  s.schedule(at(5), Priority::kDrive, [&](Instant) { order += 'd'; });
  s.run_until(at(5));
  EXPECT_EQ(order, "wsbd");
}

TEST(Scheduler, PeriodicEventsDoNotDrift) {
  Scheduler s;
  std::vector<std::int64_t> ran;
  s.schedule_every(at(7), Duration{333'333}, Priority::kDrive, [&](Instant now) { ran.push_back(to_ns(now)); });
  s.run_until(at(1'000'000'000));
  ASSERT_EQ(ran.size(), 3001u);  // 7 + 3000 * 333333 <= 1e9 < 7 + 3001 * 333333
  for (std::size_t i = 0; i < ran.size(); ++i) ASSERT_EQ(ran[i], 7 + static_cast<std::int64_t>(i) * 333'333);
}

TEST(Scheduler, ThePeriodicSuccessorIsQueuedBeforeTheActionRuns) {
  Scheduler s;
  std::string order;
  s.schedule_every(at(10), Duration{10}, Priority::kDrive, [&](Instant now) {
    order += 'p';
    if (now == at(10)) s.schedule(at(20), Priority::kDrive, [&](Instant) { order += 'x'; });
  });
  s.run_until(at(20));
  EXPECT_EQ(order, "ppx");
}

TEST(Scheduler, CancelledEventsDoNotRunAndCancelSaysWhatItFound) {
  Scheduler s;
  int ran = 0;
  const EventId once = s.schedule(at(1), Priority::kDrive, [&](Instant) { ++ran; });
  const EventId gone = s.schedule(at(1), Priority::kDrive, [&](Instant) { ++ran; });
  const EventId periodic = s.schedule_every(at(1), Duration{1}, Priority::kDrive, [&](Instant) { ++ran; });
  EXPECT_TRUE(s.cancel(gone));
  EXPECT_FALSE(s.cancel(gone));
  s.run_until(at(1));
  EXPECT_EQ(ran, 2);
  EXPECT_FALSE(s.cancel(once));
  EXPECT_TRUE(s.cancel(periodic));
  s.run_until(at(10));
  EXPECT_EQ(ran, 2);
  EXPECT_FALSE(s.cancel(0));
  EXPECT_FALSE(s.cancel(~EventId{0}));
}

TEST(Scheduler, APeriodicEventCancelsItselfFromWithinItsAction) {
  Scheduler s;
  std::vector<int> ran;
  EventId id = 0;
  // The capture is larger than std::function keeps inline, so that a slot freed too early shows under the sanitizer.
  id = s.schedule_every(at(1), Duration{1}, Priority::kDrive, [&s, &ran, &id, guard = std::string(64, 'x')](Instant) {
    if (ran.size() == 2) {
      EXPECT_TRUE(s.cancel(id));
      EXPECT_FALSE(s.cancel(id));
      for (int i = 0; i < 1000; ++i) s.schedule(at(100), Priority::kDrive, [](Instant) {});
    }
    ran.push_back(static_cast<int>(guard.size()));
  });
  s.run_until(at(50));
  EXPECT_EQ(ran, (std::vector<int>{64, 64, 64}));
  EXPECT_EQ(s.waiting(), 1000u);
}

TEST(Scheduler, AnActionCancelsAnEventDueAtTheSameInstant) {
  Scheduler s;
  bool ran = false;
  const EventId later = s.schedule(at(1), Priority::kDrive, [&](Instant) { ran = true; });
  s.schedule(at(1), Priority::kWire, [&](Instant) { EXPECT_TRUE(s.cancel(later)); });
  s.run_until(at(1));
  EXPECT_FALSE(ran);
}

TEST(Scheduler, AnActionCannotCancelItsOwnSingleEvent) {
  Scheduler s;
  EventId id = 0;
  bool cancelled = true;
  id = s.schedule(at(1), Priority::kDrive, [&](Instant) { cancelled = s.cancel(id); });
  s.run_until(at(1));
  EXPECT_FALSE(cancelled);
}

TEST(Scheduler, AnIdIsNotReusedThoughItsSlotIs) {
  Scheduler s;
  EventId last = 0;
  for (int i = 0; i < 5000; ++i) {
    const EventId id = s.schedule(at(1), Priority::kDrive, [](Instant) {});
    EXPECT_NE(id, last);
    EXPECT_FALSE(s.cancel(last));
    EXPECT_TRUE(s.cancel(id));
    last = id;
  }
}

TEST(Scheduler, RunNextTakesOneEventAndLeavesTheTimeThere) {
  Scheduler s;
  int ran = 0;
  for (int i = 0; i < 2; ++i) s.schedule(at(5), Priority::kDrive, [&](Instant) { ++ran; });
  EXPECT_FALSE(s.run_next(at(4)));
  EXPECT_EQ(s.now(), at(0));
  EXPECT_TRUE(s.run_next(at(9)));
  EXPECT_EQ(ran, 1);
  EXPECT_EQ(s.now(), at(5));
  EXPECT_TRUE(s.run_next(at(9)));
  EXPECT_FALSE(s.run_next(at(9)));
}

TEST(Scheduler, AnActionThatThrowsLeavesTheQueueUsable) {
  Scheduler s;
  int ran = 0;
  EventId id = 0;
  id = s.schedule_every(at(1), Duration{1}, Priority::kDrive, [&](Instant now) {
    if (now == at(2)) {
      s.cancel(id);
      throw std::runtime_error("model");
    }
    ++ran;
  });
  EXPECT_THROW(s.run_until(at(10)), std::runtime_error);
  EXPECT_EQ(s.now(), at(2));
  s.run_until(at(10));
  EXPECT_EQ(ran, 1);
  EXPECT_EQ(s.waiting(), 0u);
}

TEST(SchedulerDeathTest, SchedulingInThePastIsABugOfOurs) {
  Scheduler s;
  s.run_until(at(10));
  EXPECT_DEATH(s.schedule(at(9), Priority::kDrive, [](Instant) {}), "broken invariant: at >= now");
  EXPECT_DEATH(s.schedule_every(at(10), Duration{0}, Priority::kDrive, [](Instant) {}), "period > Duration");
  s.schedule(at(11), Priority::kDrive, [&](Instant) { s.run_until(at(12)); });
  EXPECT_DEATH(s.run_until(at(11)), "in_action");
}

// A multimap keyed by (time, priority, sequence) is the specification. Random events, a third of which schedule, cancel
// or reschedule others from within their action.
TEST(Scheduler, HundredThousandRandomEventsRunAsInAReferenceMultimap) {
  using Key = std::tuple<std::int64_t, int, std::uint64_t>;
  Scheduler s;
  Random random(20240607);
  std::multimap<Key, std::uint64_t> reference;  // -> label
  std::map<std::uint64_t, std::pair<EventId, Key>> waiting;
  std::uint64_t sequence = 0;
  std::uint64_t labels = 0;
  std::uint64_t ran = 0;
  std::uint64_t cancelled = 0;
  std::int64_t now_ns = 0;

  std::function<void()> add;
  const auto erase = [&](const Key& key, std::uint64_t label) {
    const auto it = reference.find(key);
    ASSERT_NE(it, reference.end());
    ASSERT_EQ(it->second, label);
    reference.erase(it);
  };
  add = [&] {
    const std::int64_t when = now_ns + static_cast<std::int64_t>(random.below(50));
    const auto priority = static_cast<Priority>(random.below(5));
    const std::uint64_t label = labels++;
    const Key key{when, static_cast<int>(priority), sequence++};
    const EventId id = s.schedule(at(when), priority, [&, label](Instant now) {
      now_ns = to_ns(now);
      ASSERT_FALSE(reference.empty());
      ASSERT_EQ(reference.begin()->second, label);
      ASSERT_EQ(std::get<0>(reference.begin()->first), now_ns);
      reference.erase(reference.begin());
      waiting.erase(label);
      ++ran;
      if (labels < 100'000 && random.below(3) == 0) {
        for (std::uint64_t n = random.below(6); n > 0; --n) add();
      }
      if (!waiting.empty() && random.below(5) == 0) {
        const auto victim = waiting.lower_bound(random.below(labels));
        if (victim == waiting.end()) return;
        ASSERT_TRUE(s.cancel(victim->second.first));
        erase(victim->second.second, victim->first);
        waiting.erase(victim);
        ++cancelled;
      }
    });
    reference.emplace(key, label);
    waiting.emplace(label, std::pair(id, key));
  };
  while (labels < 100'000) {
    for (std::uint64_t n = random.below(200); n > 0; --n) add();
    now_ns += static_cast<std::int64_t>(random.below(40));
    s.run_until(at(now_ns));
    ASSERT_EQ(s.waiting(), reference.size());
    if (!reference.empty()) {
      ASSERT_GT(std::get<0>(reference.begin()->first), now_ns);
    }
  }
  s.run_until(at(now_ns + 1000));
  EXPECT_TRUE(reference.empty());
  EXPECT_EQ(ran + cancelled, labels);
  EXPECT_GT(cancelled, 1000u);
}

TEST(Scheduler, PeriodicAndReusedSingleEventsAllocateNothingInSteadyState) {
  Scheduler s;
  std::uint64_t ticks = 0;
  for (int i = 0; i < 200; ++i) {
    s.schedule_every(at(i), Duration{1000}, Priority::kDrive, [&](Instant now) {
      ++ticks;
      s.schedule(now + Duration{10}, Priority::kBoard, [&ticks](Instant) { ++ticks; });
      const EventId timeout = s.schedule(now + Duration{1'000'000}, Priority::kBoard, [](Instant) {});
      s.cancel(timeout);
    });
  }
  s.run_until(at(10'000));
  const std::uint64_t before = allocation_count();
  const std::uint64_t ticks_before = ticks;
  s.run_until(at(1'000'000));
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(ticks - ticks_before, 990u * 200 * 2);
}

}  // namespace
}  // namespace vinv::kernel
