// What a CanBus and its nodes know between two events, as plain data: can_bus_archive.cpp saves and loads it. Who
// listens (handlers, observers) is not part of it; events are archived beside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/can_frame.hpp"
#include "sim/base/time.hpp"
#include "sim/transports/can/bus_load.hpp"
#include "sim/transports/can/can_faults.hpp"
#include "sim/transports/can/can_port.hpp"
#include "sim/transports/can/error_counters.hpp"

namespace vinv::transports {

struct CanNodeOptions {
  std::string name;
  std::uint32_t bitrate = 0;  // 0: that of the bus
  bool listen_only = false;   // hears, but neither acknowledges nor signals errors nor sends
  bool online = true;
  bool recovers = true;                                  // from bus off by itself; else by CanNode::recover()
  std::size_t queue_frames = CanPort::kMaxQueuedFrames;  // 2 or more
  CanQueuePolicy when_full = CanQueuePolicy::kRefuseNewest;
};

enum class CanErrorCause : std::uint8_t {
  kNoAcknowledge,  // reported once for a row of attempts
  kCorrupted,      // by a fault plan
  kErrorFrame,     // by a fault plan or inject_error_frame()
  kCollision,      // two nodes sent different frames with one identifier
  kOtherBitrate,
};

struct CanNodeData {
  struct Waiting {
    CanFrame frame;
    Instant ready_at{};
    CanVerdict verdict;
  };

  CanNodeOptions options;  // bitrate and listen_only as they are now
  CanErrorCounters counters;
  CanState reported = CanState::kErrorActive;
  bool attached = true;
  bool online = true;
  std::vector<Waiting> ring;  // of fixed size
  std::size_t first = 0;
  std::size_t count = 0;
  bool first_is_on_wire = false;
  Instant not_before{};  // suspend transmission of a passive node
  Instant joined_at{};   // hears frames that start from then on
  bool recovering = false;
  int recovery_left = 0;        // sequences of recessive bits
  Instant recovery_from{};      // the sequences before it are counted
  bool is_twin = false;         // made by a fault plan, of the node that its name ends with
  std::optional<Waiting> held;  // by a fault plan, until the next frame is behind it or release_event comes
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;

  CanState state() const { return online ? counters.state() : CanState::kOffline; }
  CanStatus status() const { return {state(), counters, sent, received, lost}; }
  bool participates() const { return attached && online && !counters.is_bus_off(); }
  bool may_send() const { return participates() && !options.listen_only; }
  Waiting& head() { return ring[first]; }
  const Waiting& head() const { return ring[first]; }
  void push(const Waiting& waiting);
  void pop();
  // What is not on the wire; returns how many.
  std::size_t clear();
};

// The wire is free, or a start of frame is planned (or just happened, and arbitration is decided one bit later), or an
// attempt is under way whose end is known, or one passive node repeats an attempt that nobody acknowledges.
struct CanWireData {
  enum class Phase : std::uint8_t { kFree, kStarting, kBusy, kLone };
  enum class Outcome : std::uint8_t { kSuccess, kNoAcknowledge, kDestroyed };

  explicit CanWireData(Instant now) : load(now), next_sof_at(now), recessive_since(now) {}

  CanFaultJudge judge{CanFaultPlan{}};
  std::uint64_t injected_before = 0;  // by earlier plans
  CanLoadMeter load;

  Phase phase = Phase::kFree;
  Instant sof_at{};       // of the attempt that is planned or under way
  Instant next_sof_at{};  // not before
  Instant recessive_since{};
  bool disturb_start = false;

  // The attempt under way.
  CanFrame on_wire;
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
