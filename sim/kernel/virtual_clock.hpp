// Virtual time: events run as fast as the machine allows, and simulated time jumps from event to event.
#pragma once

#include "sim/kernel/scheduler.hpp"

namespace vinv::kernel {

class VirtualClock {
 public:
  // The scheduler outlives the clock.
  explicit VirtualClock(Scheduler& scheduler) : scheduler_(scheduler) {}

  // Runs everything due up to and including until. False if an action called stop(): the scheduler's now() is then the
  // time of that action, and the next run goes on from there.
  bool run_until(Instant until);
  bool run_for(Duration span) { return run_until(scheduler_.now() + span); }
  // From an action: the run ends after it.
  void stop() { stop_requested_ = true; }

 private:
  Scheduler& scheduler_;
  bool stop_requested_ = false;
};

}  // namespace vinv::kernel
