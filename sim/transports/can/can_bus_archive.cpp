// Snapshots of a CAN bus: its plain data (can_bus_state.hpp), and its events at their places in the order.
#include <algorithm>
#include <memory>
#include <string>

#include "sim/base/check.hpp"
#include "sim/transports/can/can_bus_impl.hpp"

namespace vinv::transports {

VINV_ENUM_RANGE(CanFault, kDrop, kTwin);
VINV_ENUM_RANGE(CanQueuePolicy, kRefuseNewest, kDropOldest);
VINV_ENUM_RANGE(CanErrorCause, kNoAcknowledge, kOtherBitrate);
VINV_ENUM_RANGE(CanWireData::Phase, kFree, kLone);
VINV_ENUM_RANGE(CanWireData::Outcome, kSuccess, kDestroyed);

void archive(Archive& a, CanFaultRule& rule) {
  VINV_MEMBERS(rule, fault, id, mask, extended, node, not_nodes, when, delay, times);
  VINV_FIELDS(a, CanFaultRule, fault, id, mask, extended, node, not_nodes, when, delay, times);
}

static void archive(Archive& a, CanFaultPlan& plan) {
  VINV_MEMBERS(plan, seed, rules);
  VINV_FIELDS(a, CanFaultPlan, seed, rules);
}

static void archive(Archive& a, CanVerdict& verdict) {
  VINV_MEMBERS(verdict, drop, bus_off, silence, twin, reorder, delay, corrupt, error_frames, copies, copies_after);
  VINV_FIELDS(a, CanVerdict, drop, bus_off, silence, twin, reorder, delay, corrupt, error_frames, copies, copies_after);
}

void archive(Archive& a, CanFaultJudge& judge) {
  VINV_MEMBERS(judge, plan, counts, random, injected);
  VINV_FIELDS(a, CanFaultJudge, plan, counts, random, injected);
  a.require(counts.size() == plan.rules.size(), "a fault plan has more or fewer counts than rules");
}

static void archive(Archive& a, CanNodeOptions& options) {
  VINV_MEMBERS(options, name, bitrate, listen_only, online, recovers, queue_frames, when_full);
  VINV_FIELDS(a, CanNodeOptions, name, bitrate, listen_only, online, recovers, queue_frames, when_full);
  a.require(bitrate > 0, "a CAN node has no bit rate");
}

static void archive(Archive& a, CanNodeData::Waiting& waiting) {
  VINV_MEMBERS(waiting, frame, ready_at, verdict);
  VINV_FIELDS(a, Waiting, frame, ready_at, verdict);
  a.require(is_well_formed(frame), "a CAN frame is none");
}

static void archive(Archive& a, CanNodeData& node) {
  VINV_MEMBERS(node, options, counters, reported, attached, online, ring, first, count, first_is_on_wire, not_before,
               joined_at, recovering, recovery_left, recovery_from, is_twin, held, sent, received, lost);
  VINV_FIELDS(a, CanNodeData, options, counters, reported, attached, online, ring, first, count, first_is_on_wire,
              not_before, joined_at, recovering, recovery_left, recovery_from, is_twin, held, sent, received, lost);
  a.require(first < ring.size() && count <= ring.size(), "the queue of a CAN node is longer than it can be");
  a.require(count > 0 || !first_is_on_wire, "a CAN node sends a frame that it has not");
}

static void archive(Archive& a, CanWireData& wire) {
  VINV_MEMBERS(wire, judge, injected_before, load, phase, sof_at, next_sof_at, recessive_since, disturb_start, on_wire,
               drop_on_wire, outcome, cause, ends_at, row_of_no_acknowledge, lone_period, lone_attempt, frames,
               error_frames, arbitrations_lost);
  VINV_FIELDS(a, CanWireData, judge, injected_before, load, phase, sof_at, next_sof_at, recessive_since, disturb_start,
              on_wire, drop_on_wire, outcome, cause, ends_at, row_of_no_acknowledge, lone_period, lone_attempt, frames,
              error_frames, arbitrations_lost);
  a.require(phase != CanWireData::Phase::kLone || lone_period > Duration{}, "attempts on a CAN bus take no time");
}

// Which nodes there are, in the order of attaching. Those of boards and masters are here before a load, in any order;
// twins are made and taken away by faults, which are part of the state.
void CanBus::Impl::archive_nodes(Archive& a) {
  std::vector<std::string> names;
  for (const NodePtr& n : nodes)
    if (!n->is_twin) names.push_back(n->options.name + "/" + std::to_string(n->ring.size()));
  std::sort(names.begin(), names.end());
  std::string all = options.name + ", " + std::to_string(options.bitrate) + " bit/s, with";
  for (const std::string& n : names) all += " " + n;
  a.must_match("CAN bus", all);

  const std::size_t count = a.count(nodes.size(), 65536);
  if (a.failed()) return;
  std::vector<NodePtr> here = nodes;
  std::erase_if(here, [](const NodePtr& n) { return n->is_twin; });
  std::vector<NodePtr> wanted;
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    bool twin = false;
    std::string name;
    if (!a.loads()) {
      twin = nodes[i]->is_twin;
      name = nodes[i]->options.name;
    }
    a.io(twin);
    a.io(name);
    if (!a.loads()) continue;
    if (twin) {
      wanted.push_back(std::make_shared<CanNodeState>());
      wanted.back()->is_twin = true;
      continue;
    }
    const auto it = std::find_if(here.begin(), here.end(), [&](const NodePtr& n) { return n->options.name == name; });
    a.require(it != here.end(), "a CAN node that there is not");
    if (a.failed()) return;
    wanted.push_back(*it);
    here.erase(it);
  }
  if (!a.loads()) return;
  a.require(here.empty(), "a CAN bus lacks a node");
  if (!a.failed()) nodes = std::move(wanted);
}

// Beside the data: transmitters and who of them is on the bus no longer, what follows from the nodes, events. Handlers,
// observers and what is set only while handlers run are no state.
void CanBus::Impl::archive_state(Archive& a) {
  VINV_CHECK(reporting == 0 && !closed);
  archive_nodes(a);
  if (a.failed()) return;
  a.io(static_cast<CanWireData&>(*this));
  a.io(states_changed);
  for (const NodePtr& n : nodes) {
    const std::string name = n->options.name;
    const std::size_t length = n->ring.size();
    const bool twin = n->is_twin;
    a.io(static_cast<CanNodeData&>(*n));
    a.require(n->is_twin == twin && n->attached && (twin || (n->options.name == name && n->ring.size() == length)),
              "a CAN node is another one");
    n->is_twin = twin;
    if (twin) continue;
    // What tells nodes apart stays, so that a refused load can be taken back.
    n->options.name = name;
    n->ring.resize(length);
  }
  const std::size_t senders = a.count(transmitters.size(), 65536);
  if (a.loads()) {
    transmitters.resize(senders);
    recovering = 0;
    for (const NodePtr& n : nodes) recovering += n->recovering ? 1 : 0;
  }
  for (NodePtr& t : transmitters) {
    const auto at = std::find(nodes.begin(), nodes.end(), t);
    auto index = static_cast<std::uint64_t>(at - nodes.begin());
    a.io(index);
    a.require(index <= nodes.size(), "a CAN node sends that there is not");
    if (a.failed()) return;
    if (index < nodes.size()) {
      t = nodes[index];
      continue;
    }
    // It has left.
    if (a.loads()) t = std::make_shared<CanNodeState>();
    a.io(static_cast<CanNodeData&>(*t));
  }
  const bool attempt = phase == Phase::kBusy && outcome != Outcome::kDestroyed;
  a.require(!(attempt || phase == Phase::kLone) || !transmitters.empty(), "a CAN frame has no sender");
  if (phase == Phase::kBusy || phase == Phase::kLone) {
    for (const NodePtr& t : transmitters) a.require(t->count > 0, "a CAN node sends a frame that it has not");
  }

  // As in schedule_arbitration(), schedule_end(), plan_recovery(), plan_bus_off() and hold().
  if (phase == Phase::kBusy) {
    scheduler.archive_event(a, wire_event, [this](Instant now) {
      wire_event = 0;
      finish(now);
    });
  } else {
    scheduler.archive_event(a, wire_event, [this](Instant) {
      wire_event = 0;
      arbitrate();
    });
  }
  scheduler.archive_event(a, recovery_event, [this](Instant now) {
    recovery_event = 0;
    check_recovery(now);
  });
  for (const NodePtr& node : nodes) {
    scheduler.archive_event(a, node->bus_off_event, [this, n = node.get()](Instant now) {
      n->bus_off_event = 0;
      force_bus_off(now, *n);
    });
    scheduler.archive_event(a, node->release_event, [this, n = node.get()](Instant now) {
      n->release_event = 0;
      release(now, *n);
      start_for(now, *n);
    });
  }
}

void CanBus::archive_state(Archive& a) { impl_->archive_state(a); }

}  // namespace vinv::transports
