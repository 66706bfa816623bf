// Inside CanBus: its nodes and the wire. For can_bus*.cpp only.
//
// A passive node that repeats an attempt which nobody acknowledges changes nothing until another node comes, so it
// costs no events: see sync_lone().
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {

struct CanNodeState : CanNodeData {
  std::shared_ptr<const CanHandlers> handlers;
  kernel::EventId bus_off_event = 0;  // by a fault plan
  kernel::EventId release_event = 0;
};

struct CanBus::Impl : CanWireData, std::enable_shared_from_this<Impl> {
  using NodePtr = std::shared_ptr<CanNodeState>;

  Impl(kernel::Scheduler& s, CanBusOptions o);

  // Operations on nodes.
  NodePtr attach(Instant now, CanNodeOptions node_options);
  void detach(const NodePtr& node);
  CanSend send(Instant now, const NodePtr& node, const CanFrame& frame);
  void hold(CanNodeState& node, const CanNodeState::Waiting& waiting, Instant until);
  void release(Instant now, CanNodeState& node);
  NodePtr twin_of(const CanNodeState& node) const;
  void send_as_twin(Instant now, const NodePtr& node, const CanNodeState::Waiting& waiting);
  void start_for(Instant now, CanNodeState& node);
  void set_online(Instant now, const NodePtr& node, bool online);
  void reset_controller(Instant now, const NodePtr& node);
  void set_handlers(CanNodeState& node, std::shared_ptr<const CanHandlers> handlers);
  void force_bus_off(Instant now, CanNodeState& node);
  void plan_bus_off(Instant now, CanNodeState& node);
  void cancel_bus_off(CanNodeState& node);
  void start_recovery(Instant now, CanNodeState& node);
  void stop_recovery(CanNodeState& node);
  void disturb(Instant now);
  void close();

  void cancel_events();
  void archive_state(Archive& a);
  void archive_nodes(Archive& a);

  // The wire.
  bool is_timed() const { return options.timing == CanBusOptions::Timing::kExact; }
  bool has_bus_rate(const CanNodeState& n) const { return !is_timed() || n.options.bitrate == options.bitrate; }
  bool was_there(const CanNodeState& n) const { return n.participates() && n.joined_at <= sof_at; }
  bool hears(const CanNodeState& n) const { return was_there(n) && has_bus_rate(n); }
  Duration bits(std::int64_t n) const { return is_timed() ? bit * n : Duration{}; }
  Instant start_of(CanNodeState& n, Instant now) const;
  CanSend put(CanNodeState& node, const CanNodeState::Waiting& waiting) const;
  void plan_start(Instant now);
  void plan_start_at(Instant start);
  void arbitrate();
  void decide(bool garbled);
  void destroy_after(std::int64_t wire_bits, CanErrorCause why);
  bool is_transmitter(const CanNodeState& n) const {
    for (const NodePtr& t : transmitters) {
      if (t.get() == &n) return true;
    }
    return false;
  }
  void schedule_arbitration();
  void schedule_end();
  void finish(Instant now);
  void count(Instant now);
  void report_attempt(Instant now);
  void report_states(Instant now);
  void begin_reporting() { ++reporting; }
  void end_reporting();
  void end_recessive(Instant at);
  void plan_recovery();
  void check_recovery(Instant now);
  void enter_bus_off(Instant now, CanNodeState& node);

  // One node alone.
  NodePtr lone_sender() const;
  void enter_lone(const NodePtr& node, Instant start);
  void sync_lone(Instant now);
  // The attempt under way goes on as any other, or the wire is free; then plan_start() is due.
  void leave_lone(Instant now);

  kernel::Scheduler& scheduler;
  CanBusOptions options;
  Duration bit;
  std::vector<NodePtr> nodes;  // in the order of attaching
  std::vector<std::shared_ptr<CanBusObserver>> observers;
  bool closed = false;
  bool finishing = false;      // handlers hear of an attempt that has ended
  bool disturb_after = false;  // one of them asked for it
  // Handlers are running: no node may leave the table, and handlers that were replaced stay.
  int reporting = 0;
  std::vector<std::shared_ptr<const CanHandlers>> retired;

  kernel::EventId wire_event = 0;
  kernel::EventId recovery_event = 0;
  int recovering = 0;           // nodes
  bool states_changed = false;  // some node's state may not be what was reported
  // Of the attempt under way; none: an error frame on a free bus.
  std::vector<NodePtr> transmitters;
  std::vector<NodePtr*> competitors;  // while arbitrate() runs
};

}  // namespace vinv::transports
