// Inside CanBus: its nodes and the wire. For can_bus*.cpp only.
//
// The wire is free, or a start of frame is planned (or just happened, and arbitration is decided one bit later), or an
// attempt is under way whose end is known, or one passive node repeats an attempt that nobody acknowledges. The last
// changes nothing until another node comes, so it costs no events: see sync_lone().
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/wire_format.hpp"

namespace vinv::transports {

struct CanNodeState {
  struct Waiting {
    CanFrame frame;
    Instant ready_at{};
    CanVerdict verdict;
  };

  CanNodeOptions options;
  std::shared_ptr<const CanHandlers> handlers;
  CanErrorCounters counters;
  CanState reported = CanState::kErrorActive;
  bool attached = true;
  bool online = true;
  std::vector<Waiting> ring;  // of fixed size
  std::size_t first = 0;
  std::size_t count = 0;
  bool first_is_on_wire = false;
  std::optional<Waiting> held;  // by a fault, behind the next frame
  kernel::EventId release = 0;
  std::shared_ptr<CanNodeState> twin;  // by a fault
  Instant not_before{};  // suspend transmission of a passive node
  Instant joined_at{};   // hears frames that start from then on
  bool recovering = false;
  int recovery_left = 0;    // sequences of recessive bits
  Instant recovery_from{};  // the sequences before it are counted
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;

  CanState state() const { return online ? counters.state() : CanState::kOffline; }
  CanStatus status() const { return {state(), counters, sent, received, lost}; }
  bool participates() const { return attached && online && !counters.is_bus_off(); }
  bool may_send() const { return participates() && !options.listen_only; }
  Waiting& head() { return ring[first]; }
  void push(const Waiting& waiting);
  void pop();
  // What is not on the wire; returns how many.
  std::size_t clear();
};

struct CanBus::Impl : std::enable_shared_from_this<Impl> {
  enum class Phase { kFree, kStarting, kBusy, kLone };
  enum class Outcome { kSuccess, kNoAcknowledge, kDestroyed };
  using NodePtr = std::shared_ptr<CanNodeState>;

  Impl(kernel::Scheduler& s, CanBusOptions o);

  // Operations on nodes.
  NodePtr attach(Instant now, CanNodeOptions node_options);
  void detach(const NodePtr& node);
  CanSend send(Instant now, const NodePtr& node, const CanFrame& frame);
  void hold(Instant now, const NodePtr& node, const CanNodeState::Waiting& waiting, Duration patience);
  void release(Instant now, CanNodeState& node);
  void send_as_twin(Instant now, const NodePtr& node, const CanNodeState::Waiting& waiting);
  void start_for(Instant now, CanNodeState& node);
  void set_online(Instant now, const NodePtr& node, bool online);
  void reset_controller(Instant now, const NodePtr& node);
  void force_bus_off(Instant now, const NodePtr& node);
  void start_recovery(Instant now, CanNodeState& node);
  void disturb(Instant now);
  void close();

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
  void decide(bool garbled, const CanWireBits& wire);
  void destroy_after(std::int64_t wire_bits, CanErrorCause why);
  bool is_transmitter(const CanNodeState& n) const;
  void schedule_end();
  void finish(Instant now);
  void count(Instant now);
  void report_attempt(Instant now);
  void report_states(Instant now);
  void forget_detached();
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
  CanFaultJudge judge{CanFaultPlan{}};
  std::uint64_t injected_before = 0;
  CanLoadMeter load;
  bool closed = false;
  int reporting = 0;  // handlers are running: no node may leave the table

  Phase phase = Phase::kFree;
  kernel::EventId wire_event = 0;
  kernel::EventId recovery_event = 0;
  Instant sof_at{};       // of the attempt that is planned or under way
  Instant next_sof_at{};  // not before
  Instant recessive_since{};
  bool disturb_start = false;

  // The attempt under way.
  std::vector<NodePtr> transmitters;  // none: an error frame on a free bus
  CanFrame on_wire;
  unsigned on_wire_bits = 0;  // to the last bit of end of frame
  bool drop_on_wire = false;
  Outcome outcome = Outcome::kSuccess;
  CanErrorCause cause = CanErrorCause::kCorrupted;
  Instant ends_at{};
  bool row_of_no_acknowledge = false;

  // Phase::kLone: attempts start at sof_at and every lone_period from there.
  Duration lone_period{};
  Duration lone_attempt{};  // to the end of its error delimiter

  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t arbitrations_lost = 0;
};

}  // namespace vinv::transports
