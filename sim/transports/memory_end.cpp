#include "sim/transports/memory_end.hpp"

#include <algorithm>
#include <utility>

namespace vinv::transports {

void MemoryEnd::post(Instant at, Kind kind, Bytes bytes, std::string farewell) {
  const std::uint64_t number = next_delivery_++;
  const kernel::EventId event = scheduler_.schedule(at, kernel::Priority::kWire, action(number));
  deliveries_.push_back({kind, std::move(bytes), std::move(farewell), number, event});
}

kernel::Scheduler::Action MemoryEnd::action(std::uint64_t number) {
  return [this, number](Instant now) { run(now, number); };
}

void MemoryEnd::run(Instant now, std::uint64_t number) {
  const auto at =
      std::find_if(deliveries_.begin(), deliveries_.end(), [&](const auto& d) { return d.number == number; });
  const Delivery due = std::move(*at);
  deliveries_.erase(at);
  switch (due.kind) {
    case Kind::kBytes: return arrive(now, due.bytes);
    case Kind::kEnd: return end(now, due.farewell);
    case Kind::kCatchUp: return catch_up(now);
  }
}

MemoryEnd::~MemoryEnd() { shut(); }

void MemoryEnd::shut() {
  for (const Delivery& d : deliveries_) scheduler_.cancel(d.event);
  deliveries_.clear();
  waiting_.clear();
  farewell_.clear();
  on_the_way_ = 0;
  open_ = false;
}

void MemoryEnd::arrive(Instant now, ByteView bytes) {
  if (!handlers_.are_set() || !waiting_.empty()) {
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    return;
  }
  on_the_way_ -= bytes.size();
  handlers_.bytes(now, bytes, false);
}

void MemoryEnd::end(Instant now, const std::string& reason) {
  if (!handlers_.are_set() || !waiting_.empty()) {
    farewell_ = reason;
    return;
  }
  shut();
  handlers_.closed(now, reason);
}

void MemoryEnd::catch_up(Instant now) {
  const Bytes bytes = std::exchange(waiting_, {});
  if (!farewell_.empty()) post(now, Kind::kEnd, {}, std::exchange(farewell_, {}));
  if (!bytes.empty()) arrive(now, bytes);
}

void MemoryEnd::set_handlers(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed) {
  if (!open_) return;
  handlers_.set(std::move(on_bytes), std::move(on_closed));
  if (waiting_.empty() && farewell_.empty()) return;
  // After a load it is under way already.
  const bool comes =
      std::any_of(deliveries_.begin(), deliveries_.end(), [](const auto& d) { return d.kind == Kind::kCatchUp; });
  if (!comes) post(scheduler_.now(), Kind::kCatchUp);
}

void MemoryEnd::send(Instant now, ByteView bytes, MemoryEnd& peer, const MemoryLinkOptions& options) {
  if (!open_ || cut_ || bytes.empty()) return;
  now = std::max(now, scheduler_.now());
  if (peer.on_the_way_ + bytes.size() > ByteStream::kMaxQueuedBytes) {
    cut_ = true;
    post(
        now, Kind::kEnd, {},
        "disconnected: the peer does not read (" + std::to_string(ByteStream::kMaxQueuedBytes) + " bytes wait for it)");
    say_goodbye(now, peer, options);
    return;
  }
  sent_until_ = std::max(now, sent_until_) + options.character * static_cast<std::int64_t>(bytes.size());
  if (!peer.open_) return;
  peer.on_the_way_ += bytes.size();
  peer.post(sent_until_ + options.delay, Kind::kBytes, Bytes(bytes.begin(), bytes.end()));
}

// Behind what was sent.
void MemoryEnd::say_goodbye(Instant now, MemoryEnd& peer, const MemoryLinkOptions& options) {
  if (!peer.open_) return;
  peer.post(std::max(now, sent_until_) + options.delay, Kind::kEnd, {}, "closed by the peer");
}

void MemoryEnd::close(MemoryEnd& peer, const MemoryLinkOptions& options) {
  if (!open_) return;
  shut();
  handlers_.clear();
  if (!cut_) say_goodbye(scheduler_.now(), peer, options);
}

void MemoryEnd::retire() {
  shut();
  handlers_.clear();
}

void MemoryEnd::archive_state(Archive& a) {
  // Handlers come from the owner; deliveries are counted anew.
  VINV_MEMBERS(*this, scheduler, number, held, handlers, deliveries, next_delivery, on_the_way, waiting, farewell, open,
               sent_until, cut);
  VINV_FIELDS(a, MemoryEnd, held, waiting, farewell, open, sent_until, cut);
  const std::size_t count = a.count(deliveries.size());
  if (a.loads()) {
    deliveries.clear();
    next_delivery = 0;
    on_the_way = waiting.size();
  }
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    if (a.loads()) deliveries.emplace_back().number = next_delivery++;
    Delivery& d = deliveries[i];
    VINV_MEMBERS(d, kind, bytes, reason, serial, event);
    VINV_FIELDS(a, Delivery, kind, bytes, reason);
    scheduler.archive_event(a, event, action(serial));
    a.require(event != 0, "what is on a line never arrives");
    if (a.loads()) on_the_way += bytes.size();
  }
  a.require(open || (deliveries.empty() && waiting.empty()), "a closed line has something on it");
  a.require(on_the_way <= ByteStream::kMaxQueuedBytes, "more is on a line than it can hold");
}

MemoryStream::MemoryStream(std::shared_ptr<MemoryEnd> self, std::shared_ptr<MemoryEnd> peer,
                           std::shared_ptr<const MemoryLinkOptions> options, std::string name)
    : self_(std::move(self)), peer_(std::move(peer)), options_(std::move(options)), name_(std::move(name)) {
  self_->set_held(true);
}

MemoryStream::~MemoryStream() {
  close();
  self_->set_held(false);
}

}  // namespace vinv::transports
