// Granted time: an outside co-simulation master says how far the plant may go, waits until it has got there, and learns
// when the plant's next event is, so that it can grant the longest step that misses nothing.
//
// The simulation's thread sits in run(); the master is any other thread. Between wait() and the next grant() the
// simulation stands still and everything it did is visible to the master, which may then read and change the plant.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>

#include "sim/kernel/scheduler.hpp"

namespace vinv::kernel {

class GrantedClock {
 public:
  struct Report {
    Instant now{};                         // how far the plant has run
    std::optional<Instant> next_event_at;  // empty: nothing is scheduled
    bool stopped = false;                  // run() has been told to end, or has ended; no further grant counts
  };

  // The scheduler outlives the clock. Time that the scheduler has run already counts as granted.
  explicit GrantedClock(Scheduler& scheduler) : scheduler_(scheduler), granted_(scheduler.now()) {}
  GrantedClock(const GrantedClock&) = delete;
  GrantedClock& operator=(const GrantedClock&) = delete;

  // The simulation's thread: runs events up to and including each grant, until stop(). An exception of an action
  // leaves run() and stops the clock, so that no master waits for ever.
  void run();

  // The plant may run up to and including until; the same time again runs what was scheduled for it since. Refused
  // (false) if until is before what was granted, or after a stop.
  bool grant(Instant until);
  // Blocks until all that was granted has run, or the clock is stopped and run() has left.
  Report wait();
  // From any thread or an action: run() returns after the current action.
  void stop();

 private:
  Scheduler& scheduler_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Instant granted_;
  bool has_grant_ = false;  // one that run() has not seen
  bool stop_requested_ = false;
  bool running_ = false;  // run() is executing events and owns the scheduler
};

}  // namespace vinv::kernel
