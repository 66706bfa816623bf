#include "sim/transports/fault_injector.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "sim/base/random.hpp"
#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {
namespace {

struct Piece {
  Duration after{};  // the piece before it
  Bytes bytes;
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

}  // namespace

struct FaultInjector::Impl : std::enable_shared_from_this<Impl> {
  struct Held {
    Pieces pieces;
    bool line_error = false;
  };
  struct Lane {
    std::size_t delayed = 0;   // pieces
    std::size_t delayed_bytes = 0;
    Instant last_at{};  // when the last delayed piece passes
    std::optional<Held> held;  // waits for the piece after it
    kernel::EventId release = 0;
  };

  Impl(kernel::Scheduler& s, std::unique_ptr<ByteStream> i, FaultPlan p)
      : scheduler(s), inner(std::move(i)), plan(std::move(p)), counts(plan.rules.size()), random(plan.seed) {}
  ~Impl() {
    for (const Lane& l : lanes)
      if (l.release != 0) scheduler.cancel(l.release);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;


  Lane& lane(Direction d) { return lanes[static_cast<std::size_t>(d)]; }

  void pass(Direction direction, Instant now, ByteView bytes, bool line_error) {
    if (closed || half_open) return;
    Lane& l = lane(direction);
    if (plan.rules.empty() && l.delayed == 0 && !l.held) return deliver(direction, now, bytes, line_error);
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
                                     [this, direction](Instant at) {
                                       lane(direction).release = 0;
                                       release(direction, at);
                                     });
      return;
    }
    if (!emit(direction, now, pieces, line_error)) return;
    release(direction, now);
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
    scheduler.schedule(at, kernel::Priority::kWire,
                       [weak = weak_from_this(), direction, bytes, line_error](Instant now) {
                         const auto self = weak.lock();
                         if (!self || self->closed) return;
                         Lane& waited = self->lane(direction);
                         --waited.delayed;
                         waited.delayed_bytes -= bytes.size();
                         if (!self->half_open) self->deliver(direction, now, bytes, line_error);
                       });
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
    scheduler.schedule(std::max(at, scheduler.now()), kernel::Priority::kWire,
                       [weak = weak_from_this(), reason](Instant now) {
                         if (const auto self = weak.lock()) self->finish(now, reason);
                       });
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

  kernel::Scheduler& scheduler;
  std::unique_ptr<ByteStream> inner;
  FaultPlan plan;
  std::vector<FaultCount> counts;  // by rule
  Random random;
  StreamHandlers handlers;
  std::array<Lane, 2> lanes{};
  std::uint64_t injected = 0;
  bool closed = false;
  bool half_open = false;
  bool overflowed = false;  // closed, but the owner has not been told
};

FaultInjector::FaultInjector(kernel::Scheduler& scheduler, std::unique_ptr<ByteStream> inner, FaultPlan plan)
    : impl_(std::make_shared<Impl>(scheduler, std::move(inner), std::move(plan))) {}

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
      [weak](Instant now, ByteView bytes, bool line_error) {
        if (const auto impl = weak.lock()) impl->pass(Direction::kReceive, now, bytes, line_error);
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

void FaultInjector::Handle::add(const FaultRule& rule) const {
  const auto impl = impl_.lock();
  if (!impl) return;
  impl->plan.rules.push_back(rule);
  impl->counts.emplace_back();
}

void FaultInjector::Handle::clear() const {
  const auto impl = impl_.lock();
  if (!impl) return;
  impl->plan.rules.clear();
  impl->counts.clear();
}

void FaultInjector::Handle::half_open() const {
  if (const auto impl = impl_.lock()) impl->half_open = true;
}

std::string FaultInjector::name() const { return impl_->inner->name(); }
std::uint32_t FaultInjector::end_number() const { return impl_->inner->end_number(); }
std::uint64_t FaultInjector::injected() const { return impl_->injected; }

}  // namespace vinv::transports
