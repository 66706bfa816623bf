// The event queue of a plant. Events run in the order (time, priority, sequence of scheduling), whatever the clock.
//
// A 4-ary heap over reused slots: once the largest number of waiting events has been seen, the queue itself allocates
// nothing more. An action that captures more than std::function keeps inline (two pointers) still allocates when it is
// made, so what runs every tick is one periodic event, or captures little.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::kernel {

// At one instant: what people and scenarios do, then what arrives on wires and what boards owe, then the drives.
enum class Priority : std::uint8_t { kStimulus = 0, kWire = 1, kBoard = 2, kDrive = 3, kObserver = 4 };
VINV_ENUM_RANGE(Priority, kStimulus, kObserver);
inline constexpr std::size_t kPriorities = 5;

using EventId = std::uint64_t;  // never 0, never reused

// Where a waiting event stands: what its owner needs to arm it again in another process at the same place in the order.
struct EventPlace {
  Instant at{};
  Duration period{};  // zero: runs once
  Priority priority = Priority::kStimulus;
  std::uint64_t sequence = 0;  // among the events of its priority
  friend bool operator==(const EventPlace&, const EventPlace&) = default;
  VINV_ARCHIVE(EventPlace, at, period, priority, sequence);
};

class Scheduler {
 public:
  using Action = std::function<void(Instant now)>;

  // Limit of events that wait at one time; more is a leak of ours.
  static constexpr std::size_t kMaxWaiting = std::size_t{1} << 24;

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
  // Runs everything due up to and including until; now() is then until. Not from within an action.
  void run_until(Instant until);
  // Runs the earliest event if it is due by until; false if none is. now() is then that event's time: the step from
  // which clocks are made. Not from within an action.
  bool run_next(Instant until);
  // The time of the event that runs, or up to which the last run_until went.
  Instant now() const;
  std::uint64_t events_run() const;
  // Events waiting now.
  std::size_t waiting() const;

  // --- snapshots (docs/decisions/0005-snapshots.md) ---
  //
  // Actions are closures, which no snapshot holds. So the scheduler archives its clock and counters and, when loading,
  // drops all that waits; each owner then archives its events, which arms them anew at the place in the order that they
  // had; and in the end the queue is compared, so that no event is forgotten. Observers are not part of the state:
  // their events are dropped by a load, too, but neither saved nor compared, and no one else's order depends on them.
  // What counts work (events_run) goes on. A load is not for within an action.
  friend void archive(Archive& a, Scheduler& scheduler) { scheduler.archive_clock(a); }
  // The event id, or nothing if it is 0 or has run. Loading sets id; action is what the event does.
  void archive_event(Archive& a, EventId& id, Action action);
  // After all owners. A load is refused if other events wait than when the snapshot was saved.
  void archive_waiting(Archive& a);
  // Empty if the event has run or is unknown. A periodic event's place is its next one, within its action too.
  std::optional<EventPlace> place_of(EventId id) const;

 private:
  void archive_clock(Archive& a);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vinv::kernel
