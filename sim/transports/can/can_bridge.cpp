#include "sim/transports/can/can_bridge.hpp"

#include <utility>

namespace vinv::transports {

struct CanBridge::Impl {
  std::unique_ptr<CanPort> outside;
  std::unique_ptr<CanNode> inside;
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
  impl->outside->set_handlers(std::move(out));
  CanHandlers in;
  in.on_frame = [impl](Instant t, const CanFrame& frame) {
    const CanSend result = impl->outside->send(t, frame);
    if (result == CanSend::kRefusedFull || result == CanSend::kDroppedOldest) ++impl->lost;
  };
  impl->inside->set_handlers(std::move(in));
}

CanBridge::~CanBridge() = default;
CanPort& CanBridge::outside() { return *impl_->outside; }
std::uint64_t CanBridge::lost() const { return impl_->lost; }

}  // namespace vinv::transports
