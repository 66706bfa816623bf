// The queue in a snapshot: owners save where their events wait and arm them again; the order of events is then the same
// as in the run that was not interrupted.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/random.hpp"
#include "sim/kernel/scheduler.hpp"

namespace vinv::kernel {
namespace {

constexpr Instant at(std::int64_t ns) { return instant_from_ns(ns); }

// Components whose events fall together all the time: periodic ones, one-shot ones that each schedule a next, events
// that cancel others. What runs, and when, goes into a log. Coarse times, so that order at one instant decides
// everything.
class Toy {
 public:
  static constexpr int kParts = 12;

  explicit Toy(bool observed = false) {
    for (int i = 0; i < kParts; ++i) parts_.push_back({Random(static_cast<std::uint64_t>(i) + 1), 0, 0, 0});
    if (observed) scheduler_.schedule_every(at(3), Duration{3}, Priority::kObserver, [](Instant) {});
  }
  void start() {
    for (int i = 0; i < kParts; ++i) {
      parts_[i].tick = scheduler_.schedule_every(at(10), Duration{10 * (1 + i % 3)}, priority(i), ticker(i));
    }
  }

  Scheduler& scheduler() { return scheduler_; }
  std::string& log() { return log_; }

  friend void archive(Archive& a, Toy& toy) {
    a.io(toy.scheduler_);
    for (int i = 0; i < kParts; ++i) {
      Part& p = toy.parts_[i];
      VINV_FIELDS(a, Part, p.random, p.runs);
      toy.scheduler_.archive_event(a, p.tick, toy.ticker(i));
      if (!toy.forgets_) toy.scheduler_.archive_event(a, p.once, toy.one_shot(i));
    }
    toy.scheduler_.archive_waiting(a);
  }
  void forget() { forgets_ = true; }

 private:
  struct Part {
    Random random;
    EventId tick = 0;
    EventId once = 0;
    std::uint32_t runs = 0;
  };

  static Priority priority(int i) { return static_cast<Priority>(i % 4); }
  void note(char what, int i) {
    log_ += what;
    log_ += static_cast<char>('a' + i);
    log_ += std::to_string(to_ns(scheduler_.now())) + ' ';
  }
  Scheduler::Action ticker(int i) {
    return [this, i](Instant now) {
      Part& p = parts_[i];
      note('t', i);
      ++p.runs;
      if (p.random.below(3) == 0) {
        scheduler_.cancel(p.once);
        p.once =
            scheduler_.schedule(now + Duration{10} * static_cast<int>(p.random.below(4)), priority(i + 1), one_shot(i));
      }
      if (p.random.below(5) == 0) scheduler_.cancel(parts_[p.random.below(kParts)].once);
      if (p.random.below(40) == 0) {
        scheduler_.cancel(p.tick);
        p.tick = scheduler_.schedule_every(now + Duration{10}, Duration{10 * (1 + i % 3)}, priority(i), ticker(i));
      }
    };
  }
  Scheduler::Action one_shot(int i) {
    return [this, i](Instant) {
      note('o', i);
      parts_[i].once = 0;
    };
  }

  Scheduler scheduler_;
  std::vector<Part> parts_;
  std::string log_;
  bool forgets_ = false;
};

TEST(SchedulerSnapshot, ResumedRunHasTheSameOrderOfEvents) {
  constexpr std::int64_t kEnd = 6000;
  Toy whole;
  whole.start();
  whole.scheduler().run_until(at(kEnd));
  EXPECT_GT(whole.log().size(), 10'000u);

  // One run in pieces, each in a new process, at 200 instants and between two events of one instant.
  Random random(4);
  auto toy = std::make_unique<Toy>();
  toy->start();
  std::string log;
  for (int n = 0; n < 200; ++n) {
    toy->scheduler().run_until(std::max(toy->scheduler().now(), at(kEnd / 200 * n)));
    for (auto steps = random.below(6); steps > 0; --steps) toy->scheduler().run_next(at(kEnd));
    const Bytes snapshot = save_snapshot(*toy);
    log += toy->log();
    toy = std::make_unique<Toy>(n % 2 == 0);
    if (n % 3 == 0) toy->start();  // one that has events of its own
    const auto ok = load_snapshot(*toy, snapshot);
    ASSERT_TRUE(ok.has_value()) << ok.error();
    EXPECT_EQ(save_snapshot(*toy), snapshot);
  }
  toy->scheduler().run_until(at(kEnd));
  EXPECT_TRUE(log + toy->log() == whole.log());
  EXPECT_EQ(save_snapshot(*toy), save_snapshot(whole));
}

TEST(SchedulerSnapshot, ObserversChangeNothing) {
  Toy alone;
  Toy observed(true);
  for (Toy* toy : {&alone, &observed}) {
    toy->start();
    toy->scheduler().run_until(at(500));
  }
  EXPECT_EQ(save_snapshot(alone), save_snapshot(observed));
  EXPECT_GT(observed.scheduler().waiting(), alone.scheduler().waiting());
}

TEST(SchedulerSnapshot, AForgottenEventIsRefused) {
  Toy toy;
  toy.start();
  toy.scheduler().run_until(at(995));
  toy.forget();
  const Bytes snapshot = save_snapshot(toy);
  Toy other;
  other.forget();
  const auto ok = load_snapshot(other, snapshot);
  ASSERT_FALSE(ok.has_value());
  EXPECT_NE(ok.error().find("events were waiting when it was saved"), std::string::npos) << ok.error();
}

TEST(SchedulerSnapshot, LoadDropsWhatWaitsAndItsIdsAreUnknown) {
  Scheduler empty;
  const Bytes snapshot = save_snapshot(empty);
  Scheduler s;
  bool ran = false;
  const EventId id = s.schedule(at(10), Priority::kDrive, [&](Instant) { ran = true; });
  s.schedule(at(5), Priority::kObserver, [&](Instant) { ran = true; });
  ASSERT_TRUE(load_snapshot(s, snapshot).has_value());
  EXPECT_EQ(s.waiting(), 0u);
  EXPECT_FALSE(s.cancel(id));
  EXPECT_EQ(s.place_of(id), std::nullopt);
  s.run_until(at(100));
  EXPECT_FALSE(ran);
}

TEST(SchedulerSnapshot, APlaceTellsWhereAnEventWaits) {
  Scheduler s;
  s.schedule(at(1), Priority::kWire, [](Instant) {});
  const EventId id = s.schedule_every(at(20), Duration{7}, Priority::kWire, [](Instant) {});
  auto place = s.place_of(id);
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(place->at, at(20));
  EXPECT_EQ(place->period, Duration{7});
  EXPECT_EQ(place->priority, Priority::kWire);
  EXPECT_EQ(place->sequence, 1u);
  s.run_until(at(20));
  EXPECT_EQ(s.place_of(id)->at, at(27));
  s.cancel(id);
  EXPECT_EQ(s.place_of(id), std::nullopt);
  EXPECT_EQ(s.place_of(0), std::nullopt);
}

// One event and the clock: forged numbers never get into the queue.
struct OneEvent {
  Scheduler scheduler;
  EventId id = 0;
  friend void archive(Archive& a, OneEvent& o) {
    a.io(o.scheduler);
    o.scheduler.archive_event(a, o.id, [](Instant) {});
    o.scheduler.archive_waiting(a);
  }
};

TEST(SchedulerSnapshot, ForgedPlacesAreRefused) {
  OneEvent o;
  o.id = o.scheduler.schedule_every(at(50), Duration{5}, Priority::kBoard, [](Instant) {});
  o.scheduler.run_until(at(60));
  const Bytes snapshot = save_snapshot(o);
  OneEvent target;
  const Bytes before = save_snapshot(target);
  Random random(9);
  for (int i = 0; i < 5000; ++i) {
    Bytes forged = snapshot;
    forged[kSnapshotHeader + random.below(forged.size() - kSnapshotHeader)] = static_cast<std::uint8_t>(random.next());
    seal_snapshot(forged);
    if (forged == snapshot) continue;
    // What is taken can only be another clock or count with the same event.
    if (load_snapshot(target, forged)) {
      EXPECT_EQ(target.scheduler.place_of(target.id)->at, at(65));
      ASSERT_TRUE(load_snapshot(target, before).has_value());
    }
    ASSERT_EQ(save_snapshot(target), before);
  }
}

}  // namespace
}  // namespace vinv::kernel
