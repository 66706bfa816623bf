#include "sim/transports/memory_link.hpp"

#include <algorithm>
#include <utility>

#include "sim/transports/stream_handlers.hpp"

namespace vinv::transports {
namespace {

struct End {
  StreamHandlers handlers;
  std::size_t on_the_way = 0;  // bytes sent to this end that no handler has seen
  Bytes waiting;               // of those, what arrived before there were handlers
  std::string farewell;        // the end, which arrived before there were handlers; empty: not yet
  bool open = true;

  void arrive(Instant now, ByteView bytes) {
    if (!open) return;
    if (!handlers.are_set() || !waiting.empty()) {
      waiting.insert(waiting.end(), bytes.begin(), bytes.end());
      return;
    }
    on_the_way -= bytes.size();
    handlers.bytes(now, bytes, false);
  }
  void end(Instant now, const std::string& reason) {
    if (!open) return;
    if (!handlers.are_set() || !waiting.empty()) {
      farewell = reason;
      return;
    }
    open = false;
    handlers.closed(now, reason);
  }
  void catch_up(Instant now) {
    const Bytes bytes = std::exchange(waiting, {});
    if (!bytes.empty()) arrive(now, bytes);
    const std::string reason = std::exchange(farewell, {});
    if (!reason.empty()) end(now, reason);
  }
};

class MemoryStream : public ByteStream {
 public:
  MemoryStream(kernel::Scheduler& scheduler, Duration delay, Duration character, std::string name,
               std::shared_ptr<End> self, std::shared_ptr<End> peer)
      : scheduler_(scheduler),
        delay_(delay),
        character_(character),
        name_(std::move(name)),
        self_(std::move(self)),
        peer_(std::move(peer)) {}
  ~MemoryStream() override { close(); }
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;

  void set_handlers(OnBytes on_bytes, OnClosed on_closed) override {
    if (!self_->open) return;
    self_->handlers.set(std::move(on_bytes), std::move(on_closed));
    if (self_->waiting.empty() && self_->farewell.empty()) return;
    // Not from within this call, whose caller does not expect to be called back.
    post(scheduler_.now(), Duration{}, self_, [](End& end, Instant t) { end.catch_up(t); });
  }

  void send(Instant now, ByteView bytes) override {
    if (!self_->open || cut_ || bytes.empty()) return;
    if (peer_->on_the_way + bytes.size() > kMaxQueuedBytes) {
      cut_ = true;
      post(now, Duration{}, self_, [](End& end, Instant t) {
        end.end(t, "disconnected: the peer does not read (" + std::to_string(kMaxQueuedBytes) + " bytes wait for it)");
      });
      post(std::max(now, sent_until_), delay_, peer_, [](End& end, Instant t) { end.end(t, "closed by the peer"); });
      return;
    }
    peer_->on_the_way += bytes.size();
    sent_until_ = std::max({now, scheduler_.now(), sent_until_}) + character_ * static_cast<std::int64_t>(bytes.size());
    post(sent_until_, delay_, peer_,
         [copy = Bytes(bytes.begin(), bytes.end())](End& end, Instant t) { end.arrive(t, copy); });
  }

  void close() override {
    if (!self_->open) return;
    self_->open = false;
    self_->handlers.clear();
    if (!cut_)
      post(std::max(scheduler_.now(), sent_until_), delay_, peer_,
           [](End& end, Instant t) { end.end(t, "closed by the peer"); });
  }

  std::string name() const override { return name_; }

 private:
  template <class Do>
  void post(Instant now, Duration delay, const std::shared_ptr<End>& end, Do action) {
    scheduler_.schedule(std::max(now, scheduler_.now()) + delay, kernel::Priority::kWire,
                        [weak = std::weak_ptr<End>(end), action = std::move(action)](Instant t) {
                          if (const auto target = weak.lock()) action(*target, t);
                        });
  }

  kernel::Scheduler& scheduler_;
  Duration delay_;
  Duration character_;
  Instant sent_until_{};  // the last character of what was sent so far
  std::string name_;
  std::shared_ptr<End> self_;
  std::shared_ptr<End> peer_;
  bool cut_ = false;  // more was sent than the other end may owe
};

}  // namespace

MemoryLink make_memory_link(kernel::Scheduler& scheduler, const MemoryLinkOptions& options) {
  const auto a = std::make_shared<End>();
  const auto b = std::make_shared<End>();
  return {std::make_unique<MemoryStream>(scheduler, options.delay, options.character, options.name_a, a, b),
          std::make_unique<MemoryStream>(scheduler, options.delay, options.character, options.name_b, b, a)};
}

}  // namespace vinv::transports
