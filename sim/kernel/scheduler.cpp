#include "sim/kernel/scheduler.hpp"

#include <array>
#include <utility>
#include <vector>

#include "sim/base/check.hpp"

namespace vinv::kernel {
namespace {

constexpr int kSlotBits = 24;
constexpr int kSequenceBits = 56;
constexpr std::uint32_t kSlotMask = (1u << kSlotBits) - 1;
constexpr std::uint64_t kMaxGeneration = (std::uint64_t{1} << (64 - kSlotBits)) - 1;
constexpr std::uint32_t kNowhere = 0xffffffffu;
constexpr std::size_t kArity = 4;
constexpr std::size_t kChunk = 256;

struct Slot {
  Scheduler::Action action;
  Duration period{};  // zero: runs once
  std::uint64_t generation = 1;
  bool running = false;  // its periodic action is on the stack: the slot may not be given away
  bool ended = false;
};

constexpr std::uint64_t order(Priority priority, std::uint64_t sequence) {
  return static_cast<std::uint64_t>(priority) << kSequenceBits | sequence;
}
constexpr Priority priority_of(std::uint64_t order) { return static_cast<Priority>(order >> kSequenceBits); }
constexpr std::uint64_t sequence_of(std::uint64_t order) { return order & ((std::uint64_t{1} << kSequenceBits) - 1); }

struct Entry {
  Instant at;
  std::uint64_t order;  // priority, then sequence
  std::uint32_t slot;

  bool before(const Entry& other) const { return at != other.at ? at < other.at : order < other.order; }
};

}  // namespace

struct Scheduler::Impl {
  std::vector<Entry> heap;
  // Where each slot's entry is in the heap. Apart from the slots, so that sifting stays within few cache lines.
  std::vector<std::uint32_t> place;
  // Chunks, so that a slot stays where it is while its action runs and schedules more.
  std::vector<std::unique_ptr<std::array<Slot, kChunk>>> chunks;
  std::vector<std::uint32_t> free_slots;
  // Counted per priority: observers, who come and go, shift no one else's numbers.
  std::array<std::uint64_t, kPriorities> next_sequence{};
  std::uint64_t events_run = 0;
  Instant now{};
  bool in_action = false;

  Slot& slot(std::uint32_t index) { return (*chunks[index / kChunk])[index % kChunk]; }

  std::uint64_t next_order(Priority priority) {
    return order(priority, next_sequence[static_cast<std::size_t>(priority)]++);
  }

  std::uint32_t take_slot() {
    if (free_slots.empty()) {
      const auto first = static_cast<std::uint32_t>(chunks.size() * kChunk);
      VINV_CHECK(first + kChunk <= kMaxWaiting);
      chunks.push_back(std::make_unique<std::array<Slot, kChunk>>());
      place.resize(first + kChunk, kNowhere);
      free_slots.reserve(first + kChunk);
      for (std::uint32_t i = kChunk; i-- > 0;) free_slots.push_back(first + i);
    }
    const std::uint32_t index = free_slots.back();
    free_slots.pop_back();
    return index;
  }

  void free_slot(std::uint32_t index) {
    Slot& s = slot(index);
    s.action = nullptr;
    s.period = Duration{};
    s.running = s.ended = false;
    // A slot whose generations are used up is retired, so that no id comes back.
    if (++s.generation <= kMaxGeneration) free_slots.push_back(index);
  }

  void put(std::size_t at, const Entry& e) {
    heap[at] = e;
    place[e.slot] = static_cast<std::uint32_t>(at);
  }

  void sift_up(std::size_t at) {
    const Entry e = heap[at];
    while (at > 0) {
      const std::size_t parent = (at - 1) / kArity;
      if (!e.before(heap[parent])) break;
      put(at, heap[parent]);
      at = parent;
    }
    put(at, e);
  }

  void sift_down(std::size_t at) {
    const Entry e = heap[at];
    const std::size_t n = heap.size();
    for (;;) {
      const std::size_t first = at * kArity + 1;
      if (first >= n) break;
      const std::size_t last = first + kArity < n ? first + kArity : n;
      std::size_t least = first;
      for (std::size_t child = first + 1; child < last; ++child) {
        if (heap[child].before(heap[least])) least = child;
      }
      if (!heap[least].before(e)) break;
      put(at, heap[least]);
      at = least;
    }
    put(at, e);
  }

  void push(const Entry& e) {
    heap.push_back(e);
    sift_up(heap.size() - 1);
  }

  void remove(std::size_t at) {
    place[heap[at].slot] = kNowhere;
    const Entry last = heap.back();
    heap.pop_back();
    if (at == heap.size()) return;
    heap[at] = last;
    if (at > 0 && last.before(heap[(at - 1) / kArity])) {
      sift_up(at);
    } else {
      sift_down(at);
    }
  }

  EventId add(Instant at, Duration period, std::uint64_t place_in_order, Action&& action) {
    VINV_CHECK(at >= now);
    VINV_CHECK(action != nullptr);
    const std::uint32_t index = take_slot();
    Slot& s = slot(index);
    s.action = std::move(action);
    s.period = period;
    push({at, place_in_order, index});
    return s.generation << kSlotBits | index;
  }

  // Place in the heap of an event that waits.
  std::optional<std::uint32_t> find(EventId id) {
    const auto index = static_cast<std::uint32_t>(id & kSlotMask);
    if (index >= place.size() || slot(index).generation != id >> kSlotBits || place[index] == kNowhere) {
      return std::nullopt;
    }
    return place[index];
  }
};

namespace {

// Restores what an action that throws would leave behind.
class Finally {
 public:
  explicit Finally(bool& flag) : flag_(flag) { flag_ = true; }
  ~Finally() { flag_ = false; }
  Finally(const Finally&) = delete;
  Finally& operator=(const Finally&) = delete;

 private:
  bool& flag_;
};

}  // namespace

Scheduler::Scheduler() : impl_(std::make_unique<Impl>()) {}
Scheduler::~Scheduler() = default;

EventId Scheduler::schedule(Instant at, Priority priority, Action action) {
  return impl_->add(at, Duration{}, impl_->next_order(priority), std::move(action));
}

EventId Scheduler::schedule_every(Instant first, Duration period, Priority priority, Action action) {
  VINV_CHECK(period > Duration{});
  return impl_->add(first, period, impl_->next_order(priority), std::move(action));
}

bool Scheduler::cancel(EventId id) {
  const auto place = impl_->find(id);
  if (!place) return false;
  const auto index = static_cast<std::uint32_t>(id & kSlotMask);
  Slot& s = impl_->slot(index);
  impl_->remove(*place);
  if (s.running) {
    s.ended = true;  // its own action does this: the slot is freed after the action
  } else {
    impl_->free_slot(index);
  }
  return true;
}

std::optional<Instant> Scheduler::next_event_at() const {
  if (impl_->heap.empty()) return std::nullopt;
  return impl_->heap.front().at;
}

bool Scheduler::run_next(Instant until) {
  Impl& impl = *impl_;
  VINV_CHECK(!impl.in_action);
  if (impl.heap.empty() || impl.heap.front().at > until) return false;
  const Entry e = impl.heap.front();
  Slot& s = impl.slot(e.slot);
  impl.now = e.at;
  ++impl.events_run;
  const Finally in_action(impl.in_action);
  if (s.period == Duration{}) {
    impl.remove(0);
    const Action action = std::move(s.action);
    impl.free_slot(e.slot);
    action(e.at);
    return true;
  }
  impl.heap.front() = {e.at + s.period, impl.next_order(priority_of(e.order)), e.slot};
  impl.sift_down(0);
  struct Release {
    Impl& impl;
    std::uint32_t index;
    ~Release() {
      Slot& done = impl.slot(index);
      done.running = false;
      if (done.ended) impl.free_slot(index);
    }
  } const release{impl, e.slot};
  s.running = true;
  s.action(e.at);
  return true;
}

void Scheduler::run_until(Instant until) {
  VINV_CHECK(until >= impl_->now);
  while (run_next(until)) {
  }
  impl_->now = until;
}

Instant Scheduler::now() const { return impl_->now; }
std::uint64_t Scheduler::events_run() const { return impl_->events_run; }
std::size_t Scheduler::waiting() const { return impl_->heap.size(); }

// --- snapshots ---

std::optional<EventPlace> Scheduler::place_of(EventId id) const {
  const auto place = impl_->find(id);
  if (!place) return std::nullopt;
  const Entry& e = impl_->heap[*place];
  return EventPlace{e.at, impl_->slot(e.slot).period, priority_of(e.order), sequence_of(e.order)};
}

void Scheduler::archive_clock(Archive& a) {
  Impl& impl = *impl_;
  Instant now = impl.now;
  auto sequences = impl.next_sequence;
  sequences.back() = 0;  // observers
  VINV_FIELDS(a, Scheduler, now, sequences);
  for (const std::uint64_t n : sequences) a.require(sequence_of(n) == n, "an event number is too large");
  if (!a.loads() || a.failed()) return;
  VINV_CHECK(!impl.in_action);
  while (!impl.heap.empty()) {
    const std::uint32_t index = impl.heap.back().slot;
    impl.remove(impl.heap.size() - 1);
    impl.free_slot(index);
  }
  sequences.back() = impl.next_sequence.back();
  impl.next_sequence = sequences;
  impl.now = now;
}

void Scheduler::archive_event(Archive& a, EventId& id, Action action) {
  std::optional<EventPlace> place = place_of(id);
  a.io(place);
  if (!a.loads() || a.failed()) return;
  id = 0;
  if (!place) return;
  a.require(place->at >= impl_->now && place->period >= Duration{}, "an event lies in the past");
  a.require(place->sequence < impl_->next_sequence[static_cast<std::size_t>(place->priority)],
            "an event has a number that was not given");
  if (a.failed()) return;
  id = impl_->add(place->at, place->period, order(place->priority, place->sequence), std::move(action));
}

void Scheduler::archive_waiting(Archive& a) {
  std::uint64_t count = 0;
  std::uint64_t sum = 0;  // of a hash per event: the heap's own order does not matter
  for (const Entry& e : impl_->heap) {
    if (priority_of(e.order) == Priority::kObserver) continue;
    ++count;
    std::array<std::int64_t, 3> words{to_ns(e.at), static_cast<std::int64_t>(e.order),
                                      impl_->slot(e.slot).period.count()};
    sum += snapshot_checksum({reinterpret_cast<const std::uint8_t*>(words.data()), sizeof words});
  }
  std::uint64_t saved_count = count;
  std::uint64_t saved_sum = sum;
  VINV_FIELDS(a, WaitingEvents, saved_count, saved_sum);
  if (!a.loads() || (saved_count == count && saved_sum == sum)) return;
  a.fail("the snapshot does not fit this plant: " + std::to_string(saved_count) +
         " events were waiting when it was saved, " + std::to_string(count) + " of them wait after the load" +
         (saved_count == count ? ", but at other times" : ""));
}

}  // namespace vinv::kernel
