#include "sim/rig/can_line.hpp"

#include <utility>
#include <vector>

#include "sim/base/check.hpp"

namespace vinv::rig {
namespace {

using transports::CanBusOptions;
using transports::CanState;

CanBusOptions bus_options(const CanNetwork& network) {
  CanBusOptions options;
  options.name = network.name;
  options.bitrate = network.bitrate;
  options.timing =
      network.kind == CanNetwork::Kind::kVirtual ? CanBusOptions::Timing::kExact : CanBusOptions::Timing::kNone;
  return options;
}

}  // namespace

CanLine::CanLine(kernel::Scheduler& scheduler, const CanNetwork& network) : bus_(scheduler, bus_options(network)) {}

// The boards hear nothing of the end.
CanLine::~CanLine() {
  for (const auto& c : controllers_) c->node->set_handlers({});
}

std::size_t CanLine::add(Instant now, boards::CanChannel& channel, const std::string& name, OnTraffic on_traffic) {
  auto made = std::make_unique<Controller>();
  Controller* const c = made.get();
  c->channel = &channel;
  c->on_traffic = std::move(on_traffic);
  transports::CanNodeOptions options;
  options.name = name;
  options.online = false;
  options.queue_frames = kBoardBuffers;
  c->node = bus_.attach(now, std::move(options));
  transports::CanHandlers handlers;
  handlers.on_frame = [c](Instant at, const CanFrame& frame) {
    c->channel->handle_frame(at, frame);
    c->on_traffic(at);
  };
  handlers.on_sent = [c](Instant at, const CanFrame&) { c->on_traffic(at); };
  handlers.on_state = [this, c](Instant at, const transports::CanStatus&) { follow_state(at, *c); };
  c->node->set_handlers(std::move(handlers));
  controllers_.push_back(std::move(made));
  return controllers_.size() - 1;
}

void CanLine::follow_state(Instant now, Controller& c) {
  const bool outside_off = bridge_ != nullptr && bridge_->outside().status().state == CanState::kBusOff;
  const bool off = outside_off || c.node->status().state == CanState::kBusOff;
  if (off == c.bus_off) return;
  c.bus_off = off;
  c.channel->set_bus_off(now, off);
  if (!c.settling) c.on_traffic(now);
}

void CanLine::settle(Instant now, std::size_t controller) {
  Controller& c = *controllers_[controller];
  if (c.settling) return;
  c.settling = true;
  const bool outside_up = bridge_ == nullptr || (bridge_->outside().status().state != CanState::kOffline &&
                                                 bridge_->outside().status().state != CanState::kBusOff);
  const std::uint32_t wanted = outside_up && c.plugged ? c.channel->bit_rate() : 0;
  if (wanted != c.bitrate) {
    c.bitrate = wanted;
    // The bus takes any rate above 0.
    if (wanted != 0) VINV_CHECK(c.node->set_bitrate(now, wanted).has_value());
    c.node->set_online(now, wanted != 0);
  }
  while (c.node->queue_room() > 0) {
    const auto frame = c.channel->poll_transmit(now);
    if (!frame) break;
    c.node->send(now, *frame);
  }
  c.settling = false;
}

void CanLine::plug(Instant now, std::size_t controller, bool plugged) {
  Controller& c = *controllers_[controller];
  if (std::exchange(c.plugged, plugged) != plugged) c.on_traffic(now);
}

void CanLine::set_fault(const transports::CanFaultRule& rule) {
  const auto replaced = std::erase_if(faults_, [&](const auto& r) {
    return r.fault == rule.fault && r.node == rule.node && r.not_nodes == rule.not_nodes && r.id == rule.id &&
           r.mask == rule.mask;
  });
  if (rule.when.acts()) faults_.push_back(rule);
  if (replaced > 0 || faults_.size() == 1)
    bus_.set_faults({.seed = seed_, .rules = faults_});
  else if (rule.when.acts())
    bus_.add_fault(rule);
}

void CanLine::clear_faults() {
  faults_.clear();
  bus_.set_faults({});
}

void CanLine::join(Instant now, std::unique_ptr<transports::CanPort> outside) {
  bridge_ = std::make_unique<transports::CanBridge>(now, bus_, std::move(outside));
  bridge_->on_outside_state([this](Instant at) { follow_outside(at); });
  follow_outside(now);
}

void CanLine::follow_outside(Instant now) {
  for (const auto& c : controllers_) {
    follow_state(now, *c);
    c->on_traffic(now);
  }
}

void CanLine::archive_state(Archive& a) {
  VINV_MEMBERS(*this, bus, controllers, bridge, seed, faults);
  VINV_CHECK(bridge == nullptr);
  VINV_FIELDS(a, CanLine, bus, seed, faults);
  a.must_match("number of boards on CAN bus " + bus.options().name, controllers.size());
  for (const auto& controller : controllers) {
    VINV_MEMBERS(*controller, channel, node, on_traffic, bitrate, settling, bus_off, plugged);
    VINV_CHECK(!settling);
    VINV_FIELDS(a, Controller, bitrate, bus_off, plugged);
  }
}

}  // namespace vinv::rig
