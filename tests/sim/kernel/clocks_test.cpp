#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "sim/base/random.hpp"
#include "sim/kernel/granted_clock.hpp"
#include "sim/kernel/virtual_clock.hpp"

namespace vinv::kernel {
namespace {

constexpr Instant at(std::int64_t ns) { return instant_from_ns(ns); }

// A little plant whose trace depends on the order of everything that happens in it.
struct Plant {
  Scheduler scheduler;
  Random random{7};
  std::string trace;

  Plant() {
    for (int i = 0; i < 3; ++i) {
      scheduler.schedule_every(at(0), Duration{1000 + i}, Priority::kDrive, [this, i](Instant now) {
        note("d" + std::to_string(i), now);
        scheduler.schedule(now + Duration{static_cast<std::int64_t>(random.below(700))}, Priority::kWire,
                           [this](Instant t) { note("w", t); });
      });
    }
  }
  void note(const std::string& what, Instant now) {
    trace += what + "@" + std::to_string(to_ns(now)) + " r" + std::to_string(random.below(100)) + "\n";
  }
};

std::string virtual_trace(std::int64_t until) {
  Plant plant;
  VirtualClock(plant.scheduler).run_until(at(until));
  return plant.trace;
}

TEST(VirtualClock, RunsUntilTheTimeAndStopsThere) {
  Scheduler s;
  VirtualClock clock(s);
  EXPECT_TRUE(clock.run_until(at(100)));
  EXPECT_EQ(s.now(), at(100));
  EXPECT_TRUE(clock.run_for(Duration{50}));
  EXPECT_EQ(s.now(), at(150));
}

TEST(VirtualClock, StopFromAnActionEndsTheRunAfterItAndTheNextRunGoesOn) {
  Scheduler s;
  VirtualClock clock(s);
  int ran = 0;
  s.schedule(at(10), Priority::kWire, [&](Instant) { clock.stop(); });
  s.schedule(at(10), Priority::kDrive, [&](Instant) { ++ran; });
  EXPECT_FALSE(clock.run_until(at(100)));
  EXPECT_EQ(s.now(), at(10));
  EXPECT_EQ(ran, 0);
  EXPECT_TRUE(clock.run_until(at(100)));
  EXPECT_EQ(ran, 1);
}

TEST(VirtualClock, TwoRunsOfOnePlantAreByteIdentical) {
  const std::string first = virtual_trace(1'000'000);
  EXPECT_GT(first.size(), 10'000u);
  EXPECT_EQ(first, virtual_trace(1'000'000));
}

TEST(GrantedClock, RunsToTheGrantAndReportsTheNextEvent) {
  Scheduler s;
  std::vector<std::int64_t> ran;
  s.schedule_every(at(0), Duration{100}, Priority::kDrive, [&](Instant now) { ran.push_back(to_ns(now)); });
  GrantedClock clock(s);
  std::thread simulation([&] { clock.run(); });
  EXPECT_TRUE(clock.grant(at(0)));
  GrantedClock::Report report = clock.wait();
  EXPECT_EQ(report.now, at(0));
  EXPECT_EQ(ran, (std::vector<std::int64_t>{0}));
  EXPECT_EQ(report.next_event_at, at(100));
  EXPECT_TRUE(clock.grant(at(250)));
  report = clock.wait();
  EXPECT_EQ(report.now, at(250));
  EXPECT_EQ(report.next_event_at, at(300));
  EXPECT_EQ(ran, (std::vector<std::int64_t>{0, 100, 200}));
  EXPECT_FALSE(report.stopped);
  clock.stop();
  simulation.join();
}

TEST(GrantedClock, RefusesAGrantInThePastAndAfterAStop) {
  Scheduler s;
  s.run_until(at(10));
  GrantedClock clock(s);
  EXPECT_FALSE(clock.grant(at(9)));
  EXPECT_TRUE(clock.grant(at(20)));
  EXPECT_FALSE(clock.grant(at(19)));
  clock.stop();
  EXPECT_FALSE(clock.grant(at(30)));
  EXPECT_TRUE(clock.wait().stopped);
}

TEST(GrantedClock, WhatTheMasterSchedulesForTheGrantedInstantRunsWhenItIsGrantedAgain) {
  Scheduler s;
  GrantedClock clock(s);
  std::thread simulation([&] { clock.run(); });
  clock.grant(at(100));
  clock.wait();
  bool ran = false;
  s.schedule(at(100), Priority::kStimulus, [&](Instant) { ran = true; });
  EXPECT_TRUE(clock.grant(at(100)));
  clock.wait();
  EXPECT_TRUE(ran);
  clock.stop();
  simulation.join();
}

TEST(GrantedClock, AnySequenceOfGrantsGivesTheTraceOfVirtualTime) {
  Plant plant;
  GrantedClock clock(plant.scheduler);
  std::thread simulation([&] { clock.run(); });
  Random steps(99);
  for (std::int64_t t = 0; t < 1'000'000;) {
    t = std::min<std::int64_t>(1'000'000, t + static_cast<std::int64_t>(steps.below(4000)));
    ASSERT_TRUE(clock.grant(at(t)));
    if (steps.below(3) != 0) {  // some grants overlap a run
      clock.wait();
    }
  }
  EXPECT_EQ(clock.wait().now, at(1'000'000));
  EXPECT_EQ(plant.trace, virtual_trace(1'000'000));
  clock.stop();
  simulation.join();
}

TEST(GrantedClock, StopFromAnActionEndsTheRunAfterThatAction) {
  Scheduler s;
  GrantedClock clock(s);
  int ran = 0;
  s.schedule(at(5), Priority::kWire, [&](Instant) { clock.stop(); });
  s.schedule(at(5), Priority::kDrive, [&](Instant) { ++ran; });
  clock.grant(at(100));
  clock.run();
  EXPECT_EQ(ran, 0);
  const GrantedClock::Report report = clock.wait();
  EXPECT_TRUE(report.stopped);
  EXPECT_EQ(report.now, at(5));
}

TEST(GrantedClock, AnExceptionOfAnActionReachesTheRunnerAndFreesTheMaster) {
  Scheduler s;
  GrantedClock clock(s);
  s.schedule(at(5), Priority::kDrive, [](Instant) { throw std::runtime_error("solver"); });
  std::atomic<bool> caught{false};
  clock.grant(at(100));
  std::thread simulation([&] {
    try {
      clock.run();
    } catch (const std::runtime_error&) {
      caught = true;
    }
  });
  EXPECT_TRUE(clock.wait().stopped);
  simulation.join();
  EXPECT_TRUE(caught);
}

}  // namespace
}  // namespace vinv::kernel
