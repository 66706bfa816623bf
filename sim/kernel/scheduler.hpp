// The event queue of a plant. Events run in the order (time, priority, sequence of scheduling), whatever the clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "sim/base/time.hpp"

namespace vinv::kernel {

// At one instant: what people and scenarios do, then what arrives on wires and what boards owe, then the drives.
enum class Priority : std::uint8_t { kStimulus = 0, kWire = 1, kBoard = 2, kDrive = 3, kObserver = 4 };

using EventId = std::uint64_t;  // never 0, never reused

class Scheduler {
 public:
  using Action = std::function<void(Instant now)>;

  Scheduler();
  ~Scheduler();
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  // at may not be before now(); an event scheduled for now() from within an action runs in this pass.
  EventId schedule(Instant at, Priority priority, Action action);
  // Every period from first on; the next is scheduled at the previous time plus period before the action runs.
  EventId schedule_every(Instant first, Duration period, Priority priority, Action action);
  // False if it has run already or is unknown. Cancelling a periodic event ends it, also from within its action.
  bool cancel(EventId id);

  // Time of the earliest event; empty if there is none.
  std::optional<Instant> next_event_at() const;
  // Runs everything due up to and including until; now() is then until.
  void run_until(Instant until);
  // The time of the event that runs, or up to which the last run_until went.
  Instant now() const;
  std::uint64_t events_run() const;

 private:
  struct Impl;
  Impl* impl_;
};

}  // namespace vinv::kernel
