#include "sim/transports/can/can_bus.hpp"

#include <algorithm>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/transports/can/can_bus_impl.hpp"

namespace vinv::transports {
namespace {

const std::string kTwinPrefix = "twin of ";

}  // namespace

void CanNodeData::push(const Waiting& waiting) {
  ring[(first + count) % ring.size()] = waiting;
  ++count;
}

void CanNodeData::pop() {
  first = (first + 1) % ring.size();
  --count;
  first_is_on_wire = false;
}

std::size_t CanNodeData::clear() {
  held.reset();
  const std::size_t kept = first_is_on_wire ? 1 : 0;
  return std::exchange(count, kept) - kept;
}

CanBus::Impl::Impl(kernel::Scheduler& s, CanBusOptions o)
    : CanWireData(s.now()), scheduler(s), options(std::move(o)), bit(can_bit_time(options.bitrate)) {}

CanBus::Impl::NodePtr CanBus::Impl::attach(Instant now, CanNodeOptions node_options) {
  now = std::max(now, scheduler.now());
  if (phase == Phase::kLone) leave_lone(now);
  auto node = std::make_shared<CanNodeState>();
  node->options = std::move(node_options);
  if (node->options.bitrate == 0) node->options.bitrate = options.bitrate;
  node->ring.resize(std::max<std::size_t>(node->options.queue_frames, 2));
  node->online = node->options.online;
  node->reported = node->state();
  node->joined_at = now;
  nodes.push_back(node);
  plan_start(now);
  return node;
}

void CanBus::Impl::detach(const NodePtr& node) {
  if (closed) return;
  const Instant now = scheduler.now();
  // Its attempts leave with it; the leaving of others, who are bus off or offline, changes nothing for it.
  if (phase == Phase::kLone && transmitters.front() == node) {
    sync_lone(now);
    phase = Phase::kFree;
    node->first_is_on_wire = false;
    transmitters.clear();
  }
  if (const NodePtr twin = twin_of(*node)) detach(twin);
  node->attached = false;
  stop_recovery(*node);
  cancel_bus_off(*node);
  if (node->release_event != 0) scheduler.cancel(std::exchange(node->release_event, 0));
  begin_reporting();
  set_handlers(*node, nullptr);
  node->clear();
  end_reporting();
  plan_start(now);
}

void CanBus::Impl::set_handlers(CanNodeState& node, std::shared_ptr<const CanHandlers> handlers) {
  if (reporting > 0 && node.handlers) retired.push_back(std::move(node.handlers));
  node.handlers = std::move(handlers);
}

void CanBus::Impl::end_reporting() {
  if (--reporting > 0) return;
  std::erase_if(nodes, [](const NodePtr& n) { return !n->attached; });
  // What they captured may have destructors that come back here.
  const auto gone = std::exchange(retired, {});
}

CanSend CanBus::Impl::put(CanNodeState& node, const CanNodeState::Waiting& waiting) const {
  CanSend result = CanSend::kQueued;
  if (node.count == node.ring.size()) {
    ++node.lost;
    if (node.options.when_full == CanQueuePolicy::kRefuseNewest) return CanSend::kRefusedFull;
    if (node.first_is_on_wire) node.ring[(node.first + 1) % node.ring.size()] = node.head();
    node.first = (node.first + 1) % node.ring.size();
    --node.count;
    result = CanSend::kDroppedOldest;
  }
  node.push(waiting);
  return result;
}

CanSend CanBus::Impl::send(Instant now, const NodePtr& node, const CanFrame& frame) {
  VINV_CHECK(is_well_formed(frame));
  if (closed || !node->may_send()) {
    ++node->lost;
    return CanSend::kRefusedState;
  }
  now = std::max(now, scheduler.now());
  const CanVerdict verdict = judge.judge(now, frame, node->options.name);
  if (verdict.bus_off) {
    ++node->lost;
    if (node->bus_off_event == 0) plan_bus_off(now, *node);
    return CanSend::kRefusedState;
  }
  if (verdict.silence) {
    ++node->lost;
    return CanSend::kQueued;
  }
  const CanNodeState::Waiting waiting{frame, now + verdict.delay, verdict};
  if (verdict.reorder && !node->held) {
    hold(*node, waiting, now + *verdict.reorder);
    return CanSend::kQueued;
  }
  const CanSend result = put(*node, waiting);
  if (result == CanSend::kRefusedFull) return result;
  for (unsigned i = 0; i < verdict.copies; ++i) {
    put(*node, {frame, now + verdict.delay + verdict.copies_after * (i + 1), CanVerdict{}});
  }
  if (verdict.twin) send_as_twin(now, node, waiting);
  release(now, *node);
  start_for(now, *node);
  return result;
}

void CanBus::Impl::start_for(Instant now, CanNodeState& node) {
  if (node.count == 0 || (phase != Phase::kFree && phase != Phase::kStarting)) return;
  const Instant start = start_of(node, now);
  if (phase == Phase::kFree || start < sof_at) plan_start_at(start);
}

void CanBus::Impl::hold(CanNodeState& node, const CanNodeState::Waiting& waiting, Instant until) {
  node.held = waiting;
  node.release_event = scheduler.schedule(until, kernel::Priority::kWire, [this, n = &node](Instant now) {
    n->release_event = 0;
    release(now, *n);
    start_for(now, *n);
  });
}

void CanBus::Impl::release(Instant now, CanNodeState& node) {
  if (node.release_event != 0) scheduler.cancel(std::exchange(node.release_event, 0));
  if (!node.held) return;
  CanNodeState::Waiting waiting = *std::exchange(node.held, std::nullopt);
  if (!node.may_send()) {
    ++node.lost;
    return;
  }
  waiting.ready_at = std::max(waiting.ready_at, now);
  put(node, waiting);
}

CanBus::Impl::NodePtr CanBus::Impl::twin_of(const CanNodeState& node) const {
  const auto it = std::find_if(nodes.begin(), nodes.end(), [&](const NodePtr& n) {
    return n->is_twin && n->attached && n->options.name == kTwinPrefix + node.options.name;
  });
  return it == nodes.end() ? nullptr : *it;
}

// The other device is set up alike and answers the same request with its own data.
void CanBus::Impl::send_as_twin(Instant now, const NodePtr& node, const CanNodeState::Waiting& waiting) {
  NodePtr twin = twin_of(*node);
  if (!twin) {
    CanNodeOptions options_of_twin = node->options;
    options_of_twin.name = kTwinPrefix + node->options.name;
    options_of_twin.online = true;
    options_of_twin.recovers = true;
    twin = attach(now, std::move(options_of_twin));
    twin->is_twin = true;
  }
  if (!twin->may_send()) return;
  CanNodeState::Waiting other{waiting.frame, waiting.ready_at, CanVerdict{}};
  if (!other.frame.remote && other.frame.length > 0)
    other.frame.data[judge.pick(other.frame.length)] ^= static_cast<std::uint8_t>(1 + judge.pick(255));
  put(*twin, other);
}

void CanBus::Impl::set_online(Instant now, const NodePtr& node, bool online) {
  if (closed || node->online == online) return;
  now = std::max(now, scheduler.now());
  if (phase == Phase::kLone) leave_lone(now);
  node->online = online;
  reset_controller(now, node);
}

void CanBus::Impl::reset_controller(Instant now, const NodePtr& node) {
  if (closed) return;
  now = std::max(now, scheduler.now());
  if (phase == Phase::kLone) leave_lone(now);
  node->lost += node->clear();
  node->counters = {};
  stop_recovery(*node);
  node->not_before = now;
  node->joined_at = now;
  states_changed = true;
  report_states(now);
  plan_start(now);
}

// In an event of its own, because send() does not call back.
void CanBus::Impl::plan_bus_off(Instant now, CanNodeState& node) {
  node.bus_off_event = scheduler.schedule(now, kernel::Priority::kWire, [this, n = &node](Instant at) {
    n->bus_off_event = 0;
    force_bus_off(at, *n);
  });
}

void CanBus::Impl::cancel_bus_off(CanNodeState& node) {
  if (node.bus_off_event != 0) scheduler.cancel(std::exchange(node.bus_off_event, 0));
}

void CanBus::Impl::force_bus_off(Instant now, CanNodeState& node) {
  if (closed || !node.participates()) return;
  now = std::max(now, scheduler.now());
  if (phase == Phase::kLone) leave_lone(now);
  node.counters.tec = CanErrorCounters::kBusOffLevel;
  states_changed = true;
  enter_bus_off(now, node);
  plan_recovery();
  report_states(now);
  plan_start(now);
}

// A frame on the wire is completed by what the bus remembers of it.
void CanBus::Impl::enter_bus_off(Instant now, CanNodeState& node) {
  node.lost += node.count + (node.held ? 1 : 0);
  node.held.reset();
  node.count = 0;
  node.first_is_on_wire = false;
  if (node.options.recovers) start_recovery(now, node);
}

void CanBus::Impl::start_recovery(Instant now, CanNodeState& node) {
  if (!node.attached || !node.online || !node.counters.is_bus_off() || node.recovering) return;
  node.recovering = true;
  ++recovering;
  node.recovery_left = kRecoverySequences;
  node.recovery_from = now;
}

void CanBus::Impl::stop_recovery(CanNodeState& node) {
  if (std::exchange(node.recovering, false)) --recovering;
}

void CanBus::Impl::cancel_events() {
  if (wire_event != 0) scheduler.cancel(std::exchange(wire_event, 0));
  if (recovery_event != 0) scheduler.cancel(std::exchange(recovery_event, 0));
  for (const NodePtr& n : nodes) {
    if (n->bus_off_event != 0) scheduler.cancel(std::exchange(n->bus_off_event, 0));
    if (n->release_event != 0) scheduler.cancel(std::exchange(n->release_event, 0));
  }
}

void CanBus::Impl::close() {
  closed = true;
  cancel_events();
  for (const NodePtr& n : nodes) n->online = false;
  observers.clear();
}

CanBus::CanBus(kernel::Scheduler& scheduler, CanBusOptions options) {
  VINV_CHECK(is_can_bitrate(options.bitrate));
  impl_ = std::make_shared<Impl>(scheduler, std::move(options));
}

CanBus::~CanBus() { impl_->close(); }

std::unique_ptr<CanNode> CanBus::attach(Instant now, CanNodeOptions options) {
  return std::unique_ptr<CanNode>(new CanNode(impl_, impl_->attach(now, std::move(options))));
}

void CanBus::observe(std::shared_ptr<CanBusObserver> observer) { impl_->observers.push_back(std::move(observer)); }

void CanBus::stop_observing(const CanBusObserver* observer) {
  std::erase_if(impl_->observers, [&](const auto& o) { return o.get() == observer; });
}

void CanBus::set_faults(CanFaultPlan plan) {
  impl_->injected_before += impl_->judge.injected();
  impl_->judge = CanFaultJudge(std::move(plan));
  const std::vector<Impl::NodePtr> all = impl_->nodes;
  for (const auto& n : all)
    if (n->is_twin) impl_->detach(n);
}

void CanBus::add_fault(CanFaultRule rule) { impl_->judge.add(std::move(rule)); }

void CanBus::reseed(std::uint64_t seed) { impl_->judge.reseed(seed); }

void CanBus::inject_error_frame(Instant now) { impl_->disturb(now); }
const CanBusOptions& CanBus::options() const { return impl_->options; }
kernel::Scheduler& CanBus::scheduler() const { return impl_->scheduler; }

CanBusStats CanBus::stats(Instant now) const {
  Impl& impl = *impl_;
  if (impl.phase == Impl::Phase::kLone) impl.sync_lone(now);
  CanBusStats s;
  s.frames = impl.frames;
  s.error_frames = impl.error_frames;
  s.arbitrations_lost = impl.arbitrations_lost;
  s.faults_injected = impl.injected_before + impl.judge.injected();
  s.nodes = static_cast<std::size_t>(
      std::count_if(impl.nodes.begin(), impl.nodes.end(), [](const auto& n) { return n->attached; }));
  s.load = impl.load.load(now);
  return s;
}

CanNode::CanNode(std::shared_ptr<CanBus::Impl> bus, std::shared_ptr<CanNodeState> state)
    : bus_(std::move(bus)), state_(std::move(state)) {}
CanNode::~CanNode() { bus_->detach(state_); }

void CanNode::set_handlers(CanHandlers handlers) {
  bus_->set_handlers(*state_, std::make_shared<const CanHandlers>(std::move(handlers)));
}
CanSend CanNode::send(Instant now, const CanFrame& frame) { return bus_->send(now, state_, frame); }
std::size_t CanNode::queue_room() const {
  if (bus_->closed || !state_->may_send()) return 0;
  return state_->ring.size() - state_->count;
}
void CanNode::clear_queue() { state_->lost += state_->clear(); }
void CanNode::set_online(Instant now, bool online) { bus_->set_online(now, state_, online); }

Result<void, std::string> CanNode::set_bitrate(Instant now, std::uint32_t bitrate) {
  if (bitrate == 0) return Unexpected(std::string("a CAN bit rate is above 0"));
  state_->options.bitrate = bitrate;
  bus_->reset_controller(now, state_);
  return {};
}

CanStatus CanNode::status() const { return state_->status(); }
std::string CanNode::name() const { return state_->options.name; }

void CanNode::set_listen_only(Instant now, bool listen_only) {
  state_->options.listen_only = listen_only;
  bus_->reset_controller(now, state_);
}
void CanNode::force_bus_off(Instant now) { bus_->force_bus_off(now, *state_); }
void CanNode::recover(Instant now) {
  if (bus_->closed) return;
  if (bus_->phase == CanBus::Impl::Phase::kLone) bus_->leave_lone(now);
  bus_->start_recovery(std::max(now, bus_->scheduler.now()), *state_);
  bus_->plan_recovery();
  bus_->plan_start(std::max(now, bus_->scheduler.now()));
}

}  // namespace vinv::transports
