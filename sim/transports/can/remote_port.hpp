// What the ports of buses that are not ours have in common: handlers, state, counts, and the confirmation of a frame
// that was handed over. RemotePort is the port itself where the far end confirms nothing.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "sim/base/check.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/can/can_port.hpp"
#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {

// Shared, so that events and handlers of streams find out that the port is gone.
struct RemotePortState : std::enable_shared_from_this<RemotePortState> {
  explicit RemotePortState(kernel::Scheduler& s) : scheduler(s) {}
  ~RemotePortState() {
    if (confirmation != 0) scheduler.cancel(confirmation);
  }
  RemotePortState(const RemotePortState&) = delete;
  RemotePortState& operator=(const RemotePortState&) = delete;

  void received(Instant now, const CanFrame& frame) {
    if (!is_up()) return;
    ++status.received;
    const auto keep = handlers;
    if (keep && keep->on_frame) keep->on_frame(now, frame);
  }
  void confirm(Instant now, const CanFrame& frame) {
    ++status.sent;
    const auto keep = handlers;
    if (keep && keep->on_sent) keep->on_sent(now, frame);
  }
  // For buses that do not confirm: in an event of its own, because send() does not call back.
  void confirm_later(Instant now, const CanFrame& frame) {
    unconfirmed.push_back({now, frame});
    if (confirmation != 0) return;
    confirmation = scheduler.schedule(std::max(now, scheduler.now()), kernel::Priority::kWire, [this](Instant t) {
      confirmation = 0;
      const auto keep = shared_from_this();  // a handler may destroy the port
      confirming.swap(unconfirmed);
      for (const auto& [sent_at, sent] : confirming) confirm(std::max(t, sent_at), sent);
      confirming.clear();
    });
  }
  std::size_t room(std::size_t limit) const { return may_send() ? limit - std::min(unconfirmed.size(), limit) : 0; }
  void enter(Instant now, CanState state) {
    if (status.state == state) return;
    status.state = state;
    const auto keep = handlers;
    if (keep && keep->on_state) keep->on_state(now, status);
  }
  bool is_up() const { return online && status.state != CanState::kOffline; }
  bool may_send() const { return is_up() && status.state != CanState::kBusOff; }

  kernel::Scheduler& scheduler;
  std::shared_ptr<const CanHandlers> handlers;
  CanStatus status{CanState::kOffline, {}, 0, 0, 0};
  bool online = true;  // as its owner wants it
  std::vector<std::pair<Instant, CanFrame>> unconfirmed;
  std::vector<std::pair<Instant, CanFrame>> confirming;
  kernel::EventId confirmation = 0;
};

class RemotePort : public CanPort {
 public:
  RemotePort(const RemotePort&) = delete;
  RemotePort& operator=(const RemotePort&) = delete;

  void set_handlers(CanHandlers handlers) final {
    state_->handlers = std::make_shared<const CanHandlers>(std::move(handlers));
  }
  CanSend send(Instant now, const CanFrame& frame) final {
    VINV_CHECK(is_well_formed(frame));
    if (queue_room() == 0 || !hand_over(now, frame)) {
      ++state_->status.lost;
      return state_->may_send() ? CanSend::kRefusedFull : CanSend::kRefusedState;
    }
    state_->confirm_later(now, frame);
    return CanSend::kQueued;
  }
  std::size_t queue_room() const final { return state_->room(kMaxQueuedFrames); }
  void clear_queue() final {}  // nothing waits on our side
  CanStatus status() const final { return state_->status; }

 protected:
  explicit RemotePort(std::shared_ptr<RemotePortState> state) : state_(std::move(state)) {}

 private:
  // False: the far end's transport does not take it now.
  virtual bool hand_over(Instant now, const CanFrame& frame) = 0;

  std::shared_ptr<RemotePortState> state_;
};

}  // namespace vinv::transports
