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
  std::uint64_t next_sequence = 0;
  std::uint64_t events_run = 0;
  Instant now{};
  bool in_action = false;

  Slot& slot(std::uint32_t index) { return (*chunks[index / kChunk])[index % kChunk]; }

  std::uint64_t next_order(Priority priority) {
    return static_cast<std::uint64_t>(priority) << kSequenceBits | next_sequence++;
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

  EventId add(Instant at, Duration period, Priority priority, Action&& action) {
    VINV_CHECK(at >= now);
    VINV_CHECK(action != nullptr);
    const std::uint32_t index = take_slot();
    Slot& s = slot(index);
    s.action = std::move(action);
    s.period = period;
    push({at, next_order(priority), index});
    return s.generation << kSlotBits | index;
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
  return impl_->add(at, Duration{}, priority, std::move(action));
}

EventId Scheduler::schedule_every(Instant first, Duration period, Priority priority, Action action) {
  VINV_CHECK(period > Duration{});
  return impl_->add(first, period, priority, std::move(action));
}

bool Scheduler::cancel(EventId id) {
  const auto index = static_cast<std::uint32_t>(id & kSlotMask);
  if (index >= impl_->place.size()) return false;
  Slot& s = impl_->slot(index);
  if (s.generation != id >> kSlotBits || impl_->place[index] == kNowhere) return false;
  impl_->remove(impl_->place[index]);
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
  impl.heap.front() = {e.at + s.period, impl.next_order(static_cast<Priority>(e.order >> kSequenceBits)), e.slot};
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

}  // namespace vinv::kernel
