// What happens on the wire of a CanBus. ISO 11898-1:2015, 10.4 (frames), 10.9 (arbitration), 12 (fault confinement).
#include <algorithm>
#include <utility>

#include "sim/transports/can/can_bus_impl.hpp"

namespace vinv::transports {
namespace {

constexpr unsigned kFlagBits = 6;
constexpr unsigned kDelimiterBits = 8;
constexpr unsigned kSuspendBits = 8;
// ACK delimiter and end of frame, or an error delimiter: what precedes the intermission is 8 recessive bits either way.
constexpr unsigned kRecessiveTailBits = 8;

// From start of frame to RTR, with at least one bit of the control field, so that a fault does not change arbitration.
unsigned arbitration_bits(const CanFrame& frame) { return frame.extended ? 34 : 14; }

unsigned first_difference(const CanWireBits& a, const CanWireBits& b) {
  const unsigned count = std::min(a.count, b.count);
  unsigned i = 0;
  while (i < count && a.bits[i] == b.bits[i]) ++i;
  return i;
}

}  // namespace

Instant CanBus::Impl::start_of(CanNodeState& n, Instant now) const {
  return std::max({next_sof_at, n.not_before, n.head().ready_at, now});
}

void CanBus::Impl::plan_start(Instant now) {
  // While handlers run, whoever called them plans afterwards.
  if (closed || reporting > 0 || phase == Phase::kBusy || phase == Phase::kLone) return;
  if (phase == Phase::kStarting && sof_at <= now && is_timed()) return;  // it is on the wire
  Instant earliest = kForever;
  for (const NodePtr& n : nodes) {
    if (n->may_send() && n->count > 0) earliest = std::min(earliest, start_of(*n, now));
  }
  if (earliest == kForever) {
    if (wire_event != 0) scheduler.cancel(std::exchange(wire_event, 0));
    phase = Phase::kFree;
    return;
  }
  if (const NodePtr lone = lone_sender()) return enter_lone(lone, earliest);
  if (phase != Phase::kStarting || sof_at != earliest) plan_start_at(earliest);
}

void CanBus::Impl::plan_start_at(Instant start) {
  if (wire_event != 0) scheduler.cancel(std::exchange(wire_event, 0));
  phase = Phase::kStarting;
  sof_at = start;
  // One bit later, so that what is sent in the same instant or bit takes part, whatever its priority in the queue.
  schedule_arbitration();
}

void CanBus::Impl::schedule_arbitration() {
  wire_event =
      scheduler.schedule(std::max(sof_at + bits(1), scheduler.now()), kernel::Priority::kWire, [this](Instant) {
        wire_event = 0;
        arbitrate();
      });
}

void CanBus::Impl::arbitrate() {
  transmitters.clear();
  const auto takes_part = [&](const CanNodeState& n) {
    return n.count > 0 && n.may_send() && n.head().ready_at <= sof_at + bits(1) && n.not_before <= sof_at;
  };
  std::uint32_t best = ~std::uint32_t{0};
  bool garbled = false;
  competitors.clear();
  for (NodePtr& n : nodes) {
    if (!takes_part(*n)) continue;
    competitors.push_back(&n);
    best = std::min(best, can_arbitration_key(n->head().frame));
    garbled = garbled || !has_bus_rate(*n);
  }
  if (competitors.empty()) {
    phase = Phase::kFree;
    disturb_start = false;
    plan_recovery();
    return plan_start(scheduler.now());
  }
  for (const NodePtr* n : competitors) {
    if (garbled || can_arbitration_key((*n)->head().frame) == best) transmitters.push_back(*n);
  }
  arbitrations_lost += competitors.size() - transmitters.size();
  end_recessive(sof_at);
  for (const NodePtr& n : transmitters) n->first_is_on_wire = true;
  const CanNodeState::Waiting& head = transmitters.front()->head();
  on_wire = head.frame;
  drop_on_wire = head.verdict.drop;
  decide(garbled);
  phase = Phase::kBusy;
  if (is_timed())
    schedule_end();
  else
    finish(scheduler.now());
}

void CanBus::Impl::decide(bool garbled) {
  bool acknowledged = !is_timed();
  bool disturbed = false;
  for (const NodePtr& n : nodes) {
    if (!was_there(*n) || n->options.listen_only || is_transmitter(*n)) continue;
    if (has_bus_rate(*n))
      acknowledged = true;
    else
      disturbed = disturbed || !n->counters.is_passive();
  }
  CanVerdict& verdict = transmitters.front()->head().verdict;
  if (std::exchange(disturb_start, false)) return destroy_after(1, CanErrorCause::kErrorFrame);
  if (disturbed || (garbled && (acknowledged || transmitters.size() > 1))) {
    return destroy_after(kGarbledBits, CanErrorCause::kOtherBitrate);
  }
  // Its bits are of no interest where it takes no time.
  if (!is_timed() && transmitters.size() == 1 && verdict.corrupt == 0 && verdict.error_frames == 0) {
    outcome = Outcome::kSuccess;
    ends_at = sof_at;
    return;
  }
  const CanWireBits wire = can_wire_bits(on_wire);
  for (std::size_t i = 1; i < transmitters.size(); ++i) {
    const CanFrame& other = transmitters[i]->head().frame;
    if (other == on_wire) continue;
    return destroy_after(first_difference(wire, can_wire_bits(other)) + 1, CanErrorCause::kCollision);
  }
  const unsigned arbitration = arbitration_bits(on_wire);
  if (verdict.corrupt > 0) {
    --verdict.corrupt;
    const auto offset = static_cast<unsigned>(judge.pick(wire.count - arbitration));
    return destroy_after(arbitration + offset + 1, CanErrorCause::kCorrupted);
  }
  if (verdict.error_frames > 0) {
    --verdict.error_frames;
    return destroy_after(arbitration, CanErrorCause::kErrorFrame);
  }
  if (acknowledged) {
    outcome = Outcome::kSuccess;
    ends_at = sof_at + bits(wire.frame_bits());
  } else {
    outcome = Outcome::kNoAcknowledge;
    cause = CanErrorCause::kNoAcknowledge;
    ends_at = sof_at + bits(wire.count + 2 + kFlagBits + kDelimiterBits);
  }
}

void CanBus::Impl::destroy_after(std::int64_t wire_bits, CanErrorCause why) {
  outcome = Outcome::kDestroyed;
  cause = why;
  bool others = why != CanErrorCause::kCorrupted || transmitters.size() > 1;
  for (const NodePtr& n : nodes) others = others || (hears(*n) && !n->options.listen_only && !is_transmitter(*n));
  ends_at = sof_at + bits(wire_bits + (others ? 2 * kFlagBits : kFlagBits) + kDelimiterBits);
}

void CanBus::Impl::schedule_end() {
  wire_event = scheduler.schedule(std::max(ends_at, scheduler.now()), kernel::Priority::kWire, [this](Instant now) {
    wire_event = 0;
    finish(now);
  });
}

void CanBus::Impl::finish(Instant now) {
  const auto keep = shared_from_this();  // a handler may destroy the bus
  phase = Phase::kFree;
  next_sof_at = ends_at + bits(kCanIntermissionBits);
  load.add(sof_at, next_sof_at);
  recessive_since = ends_at - bits(kRecessiveTailBits);
  // The flag of a passive node is recessive too, and so is all that nobody acknowledged from the CRC delimiter on.
  if (outcome == Outcome::kNoAcknowledge && transmitters.front()->counters.is_passive()) {
    recessive_since -= bits(kFlagBits + 2);
  }
  count(now);
  begin_reporting();
  finishing = true;
  report_attempt(now);
  report_states(now);
  finishing = false;
  end_reporting();
  transmitters.clear();
  if (closed) return;
  if (std::exchange(disturb_after, false)) return disturb(now);
  plan_recovery();
  plan_start(now);
}

void CanBus::Impl::count(Instant now) {
  if (outcome == Outcome::kSuccess)
    ++frames;
  else
    ++error_frames;
  for (const NodePtr& n : nodes) {
    if (!was_there(*n) || is_transmitter(*n) || n->options.listen_only) continue;
    const CanState before = n->counters.state();
    if (outcome == Outcome::kSuccess && has_bus_rate(*n)) n->counters.on_received();
    if (outcome != Outcome::kDestroyed) continue;
    if (has_bus_rate(*n)) {
      n->counters.on_receive_error();
    } else if (!n->counters.is_passive()) {
      n->counters.on_receive_error();
      n->counters.on_dominant_after_flag();
    }
    states_changed = states_changed || n->counters.state() != before;
  }
  for (const NodePtr& t : transmitters) {
    // Switched off, or bus off by force, since its frame began.
    const bool left = !t->participates();
    const CanState before = t->counters.state();
    if (!left) {
      switch (outcome) {
        case Outcome::kSuccess: t->counters.on_transmitted(); break;
        case Outcome::kNoAcknowledge: t->counters.on_no_acknowledge(); break;
        case Outcome::kDestroyed: t->counters.on_transmit_error(); break;
      }
    }
    if (t->first_is_on_wire) {
      if (outcome == Outcome::kSuccess || left) t->pop();
      t->first_is_on_wire = false;
      if (outcome == Outcome::kSuccess)
        ++t->sent;
      else if (left)
        ++t->lost;
    }
    if (left) continue;
    states_changed = states_changed || t->counters.state() != before;
    if (t->counters.is_bus_off())
      enter_bus_off(now, *t);
    else if (t->counters.is_passive())
      t->not_before = next_sof_at + bits(kSuspendBits);
  }
}

// Handlers may do anything, but the next frame cannot end before they return.
void CanBus::Impl::report_attempt(Instant now) {
  const bool repeated = row_of_no_acknowledge && outcome == Outcome::kNoAcknowledge;
  row_of_no_acknowledge = outcome == Outcome::kNoAcknowledge;
  const std::string_view sender = transmitters.empty() ? std::string_view() : transmitters.front()->options.name;
  for (std::size_t i = 0; i < observers.size(); ++i) {
    const auto observer = observers[i];
    if (outcome == Outcome::kSuccess)
      observer->on_frame(now, on_wire, sender);
    else if (!repeated)
      observer->on_error_frame(now, cause, sender);
  }
  if (outcome != Outcome::kSuccess) return;
  for (const NodePtr& t : transmitters) {
    const CanHandlers* const handlers = t->handlers.get();
    if (t->participates() && handlers != nullptr && handlers->on_sent) handlers->on_sent(now, on_wire);
  }
  if (drop_on_wire) return;
  const std::size_t count = nodes.size();
  for (std::size_t i = 0; i < count && !closed; ++i) {
    CanNodeState* const n = nodes[i].get();
    if (!hears(*n) || is_transmitter(*n)) continue;
    ++n->received;
    const CanHandlers* const handlers = n->handlers.get();
    if (handlers != nullptr && handlers->on_frame) handlers->on_frame(now, on_wire);
  }
}

void CanBus::Impl::report_states(Instant now) {
  if (!std::exchange(states_changed, false)) return;
  const auto keep = shared_from_this();
  begin_reporting();
  for (std::size_t i = 0; i < nodes.size() && !closed; ++i) {
    CanNodeState* const n = nodes[i].get();
    if (!n->attached || n->state() == n->reported) continue;
    n->reported = n->state();
    for (std::size_t k = 0; k < observers.size(); ++k) {
      const auto observer = observers[k];
      observer->on_node_state(now, n->options.name, n->status());
    }
    const CanHandlers* const handlers = n->handlers.get();
    if (handlers != nullptr && handlers->on_state) handlers->on_state(now, n->status());
  }
  end_reporting();
}

void CanBus::Impl::disturb(Instant now) {
  if (closed) return;
  now = std::max(now, scheduler.now());
  if (finishing) {  // by a handler: the ended attempt is still looked at
    disturb_after = true;
    return;
  }
  if (phase == Phase::kLone) leave_lone(now);
  if (phase == Phase::kStarting && sof_at <= now) {
    disturb_start = true;
    return;
  }
  if (phase == Phase::kBusy) {
    // In a flag, a delimiter or the last bit it changes nothing.
    if (outcome == Outcome::kDestroyed || now >= ends_at - bits(1)) return;
    const auto passed = is_timed() ? (now - sof_at) / bit + 1 : 1;
    scheduler.cancel(wire_event);
    destroy_after(passed, CanErrorCause::kErrorFrame);
    return schedule_end();
  }
  if (wire_event != 0) scheduler.cancel(std::exchange(wire_event, 0));
  transmitters.clear();
  end_recessive(now);
  sof_at = now;
  destroy_after(0, CanErrorCause::kErrorFrame);
  phase = Phase::kBusy;
  schedule_end();
}

// The recessive run that ends here held sequences for the nodes that count them.
void CanBus::Impl::end_recessive(Instant at) {
  if (!is_timed() || recovering == 0) return;
  if (recovery_event != 0) scheduler.cancel(std::exchange(recovery_event, 0));
  for (const NodePtr& n : nodes) {
    if (!n->recovering) continue;
    const Instant from = std::max(recessive_since, n->recovery_from);
    if (at <= from) continue;
    n->recovery_left -= static_cast<int>((at - from) / (bit * kRecoveryBits));
    n->recovery_left = std::max(n->recovery_left, 1);  // the event at the end of the last one comes before
  }
}

void CanBus::Impl::plan_recovery() {
  if (recovering == 0 && recovery_event == 0) return;
  if (is_timed() && phase == Phase::kBusy) return;
  Instant soonest = kForever;
  for (const NodePtr& n : nodes) {
    if (!n->recovering) continue;
    const Instant from = is_timed() ? std::max(recessive_since, n->recovery_from) : n->recovery_from;
    soonest = std::min(soonest, from + bit * kRecoveryBits * n->recovery_left);
  }
  if (recovery_event != 0) scheduler.cancel(std::exchange(recovery_event, 0));
  if (soonest == kForever) return;
  recovery_event = scheduler.schedule(std::max(soonest, scheduler.now()), kernel::Priority::kWire, [this](Instant now) {
    recovery_event = 0;
    check_recovery(now);
  });
}

void CanBus::Impl::check_recovery(Instant now) {
  // A frame has begun, and its arbitration counts the sequences before it.
  if (is_timed() && phase == Phase::kStarting && sof_at < now) return;
  const auto keep = shared_from_this();
  for (const NodePtr& n : nodes) {
    if (!n->recovering) continue;
    const Instant from = is_timed() ? std::max(recessive_since, n->recovery_from) : n->recovery_from;
    if (from + bit * kRecoveryBits * n->recovery_left > now) continue;
    stop_recovery(*n);
    states_changed = true;
    n->counters = {};
    n->joined_at = now;
    n->not_before = now;
  }
  report_states(now);
  if (closed) return;
  plan_recovery();
  plan_start(now);
}

// A passive node that nobody hears repeats the same attempt without any change of state. Only if the row has been
// reported, and nobody is on the way back from bus off.
CanBus::Impl::NodePtr CanBus::Impl::lone_sender() const {
  if (!is_timed() || !row_of_no_acknowledge) return nullptr;
  NodePtr only;
  for (const NodePtr& n : nodes) {
    if (n->recovering) return nullptr;
    if (!n->participates()) continue;
    if (only) return nullptr;
    only = n;
  }
  if (!only || !only->may_send() || only->count == 0 || !only->counters.is_passive()) return nullptr;
  const CanVerdict& verdict = only->head().verdict;
  return verdict.corrupt == 0 && verdict.error_frames == 0 ? only : nullptr;
}

void CanBus::Impl::enter_lone(const NodePtr& node, Instant start) {
  if (wire_event != 0) scheduler.cancel(std::exchange(wire_event, 0));
  const auto attempt = can_wire_bits(node->head().frame).count + 2 + kFlagBits + kDelimiterBits;
  lone_attempt = bits(attempt);
  lone_period = bits(attempt + kCanIntermissionBits + kSuspendBits);
  sof_at = start;
  phase = Phase::kLone;
  transmitters.assign(1, node);
  node->first_is_on_wire = true;
}

void CanBus::Impl::sync_lone(Instant now) {
  if (now < sof_at) return;
  const auto attempts = (now - sof_at) / lone_period;
  load.add(sof_at, sof_at + lone_period * attempts);
  error_frames += static_cast<std::uint64_t>(attempts);
  sof_at += lone_period * attempts;
}

void CanBus::Impl::leave_lone(Instant now) {
  sync_lone(now);
  const NodePtr node = transmitters.front();
  node->first_is_on_wire = false;
  phase = Phase::kFree;
  next_sof_at = sof_at;
  if (now < sof_at + bit) return;
  if (now < sof_at + lone_attempt) return arbitrate();
  const Instant end = sof_at + lone_attempt;
  ++error_frames;
  load.add(sof_at, sof_at + lone_period);
  recessive_since = end - bits(kRecessiveTailBits + kFlagBits + 2);
  next_sof_at = end + bits(kCanIntermissionBits);
  node->not_before = sof_at + lone_period;
}

}  // namespace vinv::transports
