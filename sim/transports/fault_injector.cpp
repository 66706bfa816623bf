#include "sim/transports/fault_injector.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/base/random.hpp"
#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {
namespace {

struct Piece {
  Duration after{};  // the piece before it
  Bytes bytes;
  VINV_ARCHIVE(Piece, after, bytes);
};
using Pieces = std::vector<Piece>;

void corrupt(Bytes& bytes, std::size_t count, Random& random) {
  if (bytes.empty()) return;
  const std::size_t first = random.below(bytes.size());
  for (std::size_t i = 0; i < std::min(count, bytes.size()); ++i) {
    bytes[(first + i) % bytes.size()] ^= static_cast<std::uint8_t>(1u << random.below(8));
  }
}

// What a UART makes of two that talk at once.
void garble(Pieces& pieces, Random& random) {
  for (Piece& p : pieces)
    for (std::uint8_t& byte : p.bytes) byte &= static_cast<std::uint8_t>(random.next());
}

void truncate(Pieces& pieces, std::size_t keep) {
  for (Piece& p : pieces) {
    p.bytes.resize(std::min(p.bytes.size(), keep));
    keep -= p.bytes.size();
  }
  std::erase_if(pieces, [](const Piece& p) { return p.bytes.empty(); });
}

Pieces split(const Pieces& pieces, Duration gap) {
  Pieces out;
  for (const Piece& p : pieces) {
    for (std::size_t i = 0; i < p.bytes.size(); ++i) out.push_back({i == 0 ? p.after : gap, {p.bytes[i]}});
  }
  return out;
}

void apply(const FaultRule& rule, Pieces& pieces, Random& random) {
  if (pieces.empty()) return;
  switch (rule.fault) {
    case Fault::kDrop: pieces.clear(); break;
    case Fault::kDelay: pieces.front().after += rule.delay; break;
    case Fault::kDuplicate: {
      Pieces copy = pieces;
      copy.front().after = rule.delay;
      pieces.insert(pieces.end(), copy.begin(), copy.end());
      break;
    }
    case Fault::kCorrupt: corrupt(pieces.front().bytes, rule.bytes, random); break;
    case Fault::kTruncate: truncate(pieces, rule.bytes); break;
    case Fault::kSplit: pieces = split(pieces, rule.delay); break;
    case Fault::kGarble: garble(pieces, random); break;
    case Fault::kReorder: break;  // see pass()
  }
}

struct Held {
  Pieces pieces;
  bool line_error = false;
  VINV_ARCHIVE(Held, pieces, line_error);
};
struct Lane {
  std::size_t delayed = 0;  // pieces
  std::size_t delayed_bytes = 0;
  Instant last_at{};         // when the last delayed piece passes
  std::optional<Held> held;  // waits for the piece after it
  kernel::EventId release = 0;
};
// What an event does when it is due: hands on a piece, or tells the owner of the end.
struct Late {
  std::uint64_t number = 0;
  kernel::EventId event = 0;
  bool is_end = false;
  Direction direction = Direction::kSend;
  Bytes bytes;
  bool line_error = false;
  std::string reason;
};

// All that an injector remembers, but for its course.
struct Data {
  std::array<Lane, 2> lanes{};
  std::deque<Late> late;  // in the order of their numbers
  std::uint64_t next_late = 0;
  std::uint64_t injected = 0;
  bool closed = false;
  bool half_open = false;
  bool overflowed = false;  // closed, but the owner has not been told
};

}  // namespace

struct FaultInjector::Impl : Data, std::enable_shared_from_this<Impl> {
  Impl(kernel::Scheduler& s, std::unique_ptr<ByteStream> i, std::shared_ptr<FaultCourse> c)
      : scheduler(s), inner(std::move(i)), course(std::move(c)) {}
  ~Impl() {
    for (const Lane& l : lanes)
      if (l.release != 0) scheduler.cancel(l.release);
    for (const Late& l : late) scheduler.cancel(l.event);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Lane& lane(Direction d) { return lanes[static_cast<std::size_t>(d)]; }

  void pass(Direction direction, Instant now, ByteView bytes, bool line_error) {
    if (closed || half_open) return;
    Lane& l = lane(direction);
    auto& [plan, counts, random] = *course;
    if (plan.rules.empty() && l.delayed == 0 && !l.held) return deliver(direction, now, bytes, line_error);
    const auto self = shared_from_this();  // a handler may destroy the stream
    Pieces pieces{{Duration{}, Bytes(bytes.begin(), bytes.end())}};
    std::optional<Duration> hold;
    for (std::size_t i = 0; i < plan.rules.size(); ++i) {
      const FaultRule& rule = plan.rules[i];
      if (rule.direction != direction || !counts[i].hit(rule.when, now, random)) continue;
      ++injected;
      if (rule.fault == Fault::kReorder) hold = rule.delay;
      apply(rule, pieces, random);
    }
    if (hold && !l.held && !pieces.empty()) {
      l.held = Held{std::move(pieces), line_error};
      l.release = scheduler.schedule(std::max(now, scheduler.now()) + *hold, kernel::Priority::kWire,
                                     release_action(direction));
      return;
    }
    if (!emit(direction, now, pieces, line_error)) return;
    release(direction, now);
  }

  kernel::Scheduler::Action release_action(Direction direction) {
    return [this, direction](Instant at) {
      lane(direction).release = 0;
      release(direction, at);
    };
  }

  void release(Direction direction, Instant now) {
    Lane& l = lane(direction);
    if (l.release != 0) scheduler.cancel(std::exchange(l.release, 0));
    const std::optional<Held> held = std::exchange(l.held, std::nullopt);
    if (held && !closed) emit(direction, now, held->pieces, held->line_error);
  }

  // False: closed on the way.
  bool emit(Direction direction, Instant now, const Pieces& pieces, bool line_error) {
    // A handler may destroy the stream.
    const auto self = shared_from_this();
    Lane& l = lane(direction);
    const Instant start = std::max(now, scheduler.now());
    Instant at = l.delayed > 0 ? std::max(start, l.last_at) : start;
    for (const Piece& p : pieces) {
      at += p.after;
      if (l.delayed == 0 && at == start) {
        deliver(direction, now, p.bytes, line_error);
        if (closed) return false;
      } else {
        if (l.delayed_bytes + p.bytes.size() > kMaxQueuedBytes) return overflow(), false;
        delay(direction, at, p.bytes, line_error);
      }
    }
    return true;
  }

  void delay(Direction direction, Instant at, const Bytes& bytes, bool line_error) {
    Lane& l = lane(direction);
    ++l.delayed;
    l.delayed_bytes += bytes.size();
    l.last_at = at;
    post(at, {0, 0, false, direction, bytes, line_error, {}});
  }

  void post(Instant at, Late what) {
    what.number = next_late++;
    what.event = scheduler.schedule(at, kernel::Priority::kWire, late_action(what.number));
    late.push_back(std::move(what));
  }

  kernel::Scheduler::Action late_action(std::uint64_t number) {
    return [this, number](Instant now) { run_late(now, number); };
  }

  void run_late(Instant now, std::uint64_t number) {
    // A handler may destroy the stream.
    const auto self = shared_from_this();
    const auto at = std::find_if(late.begin(), late.end(), [&](const Late& l) { return l.number == number; });
    const Late due = std::move(*at);
    late.erase(at);
    if (due.is_end) return finish(now, due.reason);
    if (closed) return;
    Lane& waited = lane(due.direction);
    --waited.delayed;
    waited.delayed_bytes -= due.bytes.size();
    if (!half_open) deliver(due.direction, now, due.bytes, due.line_error);
  }

  void deliver(Direction direction, Instant now, ByteView bytes, bool line_error) {
    if (direction == Direction::kSend) {
      inner->send(now, bytes);
    } else {
      handlers.bytes(now, bytes, line_error);
    }
  }

  // Behind what is still on its way to the owner.
  void end(Instant now, const std::string& reason) {
    if (closed || half_open) return;
    release(Direction::kReceive, now);
    if (closed) return;
    const Lane& l = lane(Direction::kReceive);
    if (l.delayed == 0) return finish(now, reason);
    end_at(l.last_at, reason);
  }

  void end_at(Instant at, const std::string& reason) {
    post(std::max(at, scheduler.now()), {0, 0, true, Direction::kReceive, {}, false, reason});
  }

  void finish(Instant now, const std::string& reason) {
    if (std::exchange(closed, true) && !overflowed) return;
    overflowed = false;
    handlers.closed(now, reason);
  }

  void overflow() {
    closed = overflowed = true;
    inner->close();
    end_at(scheduler.now(),
           "disconnected: the peer does not read (" + std::to_string(kMaxQueuedBytes) + " bytes wait for it)");
  }

  void archive_state(Archive& a) {
    // The stream inside and the handlers are there before the load.
    VINV_MEMBERS(static_cast<Data&>(*this), lanes, late, next_late, injected, closed, half_open, overflowed);
    VINV_FIELDS(a, FaultInjector, next_late, injected, closed, half_open, overflowed);
    for (const Direction direction : {Direction::kSend, Direction::kReceive}) {
      Lane& l = lane(direction);
      VINV_MEMBERS(l, delayed, delayed_bytes, last_at, held, release);
      VINV_FIELDS(a, Lane, delayed, delayed_bytes, last_at, held);
      scheduler.archive_event(a, release, release_action(direction));
    }
    const std::size_t count = a.count(late.size());
    if (a.loads()) late.clear();
    for (std::size_t i = 0; i < count && !a.failed(); ++i) {
      if (a.loads()) late.emplace_back();
      VINV_MEMBERS(late[i], number, event, is_end, direction, bytes, line_error, reason);
      VINV_FIELDS(a, Late, number, is_end, direction, bytes, line_error, reason);
      scheduler.archive_event(a, event, late_action(number));
      a.require(event != 0, "a delayed piece never passes");
    }
    if (!a.loads() || a.failed()) return;
    // Sums by which they are taken off again.
    for (const Direction direction : {Direction::kSend, Direction::kReceive}) {
      std::size_t pieces = 0, bytes = 0;
      for (const Late& l : late) {
        if (l.is_end || l.direction != direction) continue;
        ++pieces;
        bytes += l.bytes.size();
      }
      const Lane& l = lane(direction);
      a.require(l.delayed == pieces && l.delayed_bytes == bytes, "delayed pieces of a stream are missing");
    }
  }

  kernel::Scheduler& scheduler;
  std::unique_ptr<ByteStream> inner;
  std::shared_ptr<FaultCourse> course;
  StreamHandlers handlers;
};

FaultInjector::FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner, FaultPlan plan)
    : FaultInjector(scheduler, std::move(inner), std::make_shared<FaultCourse>(std::move(plan))) {}

FaultInjector::FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner,
                             std::shared_ptr<FaultCourse> course)
    : impl_(std::make_shared<Impl>(scheduler, std::move(inner), std::move(course))) {}

FaultInjector::~FaultInjector() {
  close();
  impl_->inner.reset();
}

void FaultInjector::set_handlers(OnBytes on_bytes, OnClosed on_closed) {
  const bool first = !impl_->handlers.are_set();
  impl_->handlers.set(std::move(on_bytes), std::move(on_closed));
  if (!first) return;
  const std::weak_ptr<Impl> weak = impl_;
  impl_->inner->set_handlers(
      // The stream inside is destroyed before what is around it, and calls nobody then.
      [impl = impl_.get()](Instant now, ByteView bytes, bool line_error) {
        impl->pass(Direction::kReceive, now, bytes, line_error);
      },
      [weak](Instant now, const std::string& reason) {
        if (const auto impl = weak.lock()) impl->end(now, reason);
      });
}

void FaultInjector::send(Instant now, ByteView bytes) {
  if (!bytes.empty()) impl_->pass(Direction::kSend, now, bytes, false);
}

void FaultInjector::close() {
  impl_->closed = true;
  impl_->overflowed = false;
  impl_->handlers.clear();
  if (!impl_->half_open) impl_->inner->close();
}

void FaultInjector::Handle::half_open() const {
  if (const auto impl = impl_.lock()) impl->half_open = true;
}

std::uint32_t FaultInjector::Handle::end_number() const {
  const auto impl = impl_.lock();
  return impl ? impl->inner->end_number() : 0;
}

void FaultInjector::Handle::archive_state(Archive& a) {
  const auto impl = impl_.lock();
  VINV_CHECK(impl != nullptr);
  impl->archive_state(a);
}

std::string FaultInjector::name() const { return impl_->inner->name(); }
std::uint32_t FaultInjector::end_number() const { return impl_->inner->end_number(); }
std::uint64_t FaultInjector::injected() const { return impl_->injected; }

}  // namespace vinv::transports
