#include "sim/transports/can/can_bridge.hpp"

#include <deque>
#include <utility>

namespace vinv::transports {

struct CanBridge::Impl {
  void send_out(Instant now) {
    while (!waiting.empty() && outside->queue_room() > 0) {
      if (outside->send(now, waiting.front()) != CanSend::kQueued) ++lost;
      waiting.pop_front();
    }
  }
  bool is_outside_up() const {
    const CanState state = outside->status().state;
    return state != CanState::kOffline && state != CanState::kBusOff;
  }

  std::unique_ptr<CanPort> outside;
  std::unique_ptr<CanNode> inside;
  std::deque<CanFrame> waiting;  // for the outside
  std::function<void(Instant)> on_state;
  std::uint64_t lost = 0;
};

CanBridge::CanBridge(Instant now, CanBus& bus, std::unique_ptr<CanPort> outside) : impl_(std::make_unique<Impl>()) {
  Impl* const impl = impl_.get();
  CanNodeOptions options;
  options.name = "bridge to " + outside->name();
  options.queue_frames = kMaxQueuedFrames;
  impl->inside = bus.attach(now, std::move(options));
  impl->outside = std::move(outside);
  CanHandlers out;
  out.on_frame = [impl](Instant t, const CanFrame& frame) {
    if (impl->inside->send(t, frame) != CanSend::kQueued) ++impl->lost;
  };
  out.on_sent = [impl](Instant t, const CanFrame&) { impl->send_out(t); };
  out.on_state = [impl](Instant t, const CanStatus&) {
    if (!impl->is_outside_up()) {
      impl->lost += impl->waiting.size();
      impl->waiting.clear();
    }
    if (impl->on_state) impl->on_state(t);
  };
  impl->outside->set_handlers(std::move(out));
  CanHandlers in;
  in.on_frame = [impl](Instant t, const CanFrame& frame) {
    if (!impl->is_outside_up()) return;
    if (impl->waiting.size() >= kMaxQueuedFrames) {
      ++impl->lost;
      return;
    }
    impl->waiting.push_back(frame);
    impl->send_out(t);
  };
  impl->inside->set_handlers(std::move(in));
}

CanBridge::~CanBridge() = default;
CanPort& CanBridge::outside() { return *impl_->outside; }
const CanPort& CanBridge::outside() const { return *impl_->outside; }
void CanBridge::on_outside_state(std::function<void(Instant now)> action) { impl_->on_state = std::move(action); }
std::uint64_t CanBridge::lost() const { return impl_->lost; }

}  // namespace vinv::transports
