// Faults on a CAN bus, by plan. The same plan and the same traffic give the same faults.
//
// A rule looks at each frame once, when its node hands it to its controller; retransmissions are not counted again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/can_frame.hpp"
#include "sim/base/random.hpp"
#include "sim/base/time.hpp"
#include "sim/transports/fault_trigger.hpp"

namespace vinv::transports {

enum class CanFault : std::uint8_t {
  kDrop,        // on the wire and acknowledged, but lost in every receiver, as by overrun
  kDelay,       // handed to the bus later by CanFaultRule::delay; what its node sends next waits behind it
  kDuplicate,   // a second time, CanFaultRule::delay after the first was handed over; later frames wait behind it
  kCorrupt,     // one bit between control field and CRC is inverted: nodes signal an error, the frame is sent again
  kErrorFrame,  // somebody signals an error right after the arbitration field: the frame is sent again
  kBusOff,      // its node goes bus off; the frame and what waits behind it are lost
  kReorder,     // behind the next frame of its node, but not later than CanFaultRule::delay
  kSilence,     // never gets to the wire; its node believes that it waits
  kTwin,        // a second node with the same address sends the same identifier at the same time, with other data
};

struct CanFaultRule {
  CanFault fault = CanFault::kDrop;
  // Which frames: identifiers equal to id in the bits of mask, of one format or both, of one node or any.
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  std::optional<bool> extended;
  std::string node;
  std::vector<std::string> not_nodes;  // nor of these
  FaultTrigger when;                   // of those frames
  Duration delay{};
  unsigned times = 1;  // kCorrupt, kErrorFrame: attempts to send it that fail
};

void archive(Archive& a, CanFaultRule& rule);

struct CanFaultPlan {
  std::uint64_t seed = 1;
  std::vector<CanFaultRule> rules;
};

// What the rules together do to one frame.
struct CanVerdict {
  bool drop = false;
  bool bus_off = false;
  bool silence = false;
  bool twin = false;
  std::optional<Duration> reorder;
  Duration delay{};
  unsigned corrupt = 0;       // attempts
  unsigned error_frames = 0;  // attempts, after those of corrupt
  unsigned copies = 0;
  Duration copies_after{};
};

class CanFaultJudge {
 public:
  explicit CanFaultJudge(CanFaultPlan plan)
      : plan_(std::move(plan)), counts_(plan_.rules.size()), random_(plan_.seed) {}

  CanVerdict judge(Instant now, const CanFrame& frame, std::string_view node);
  // Behind the rules there are.
  void add(CanFaultRule rule) {
    plan_.rules.push_back(std::move(rule));
    counts_.emplace_back();
  }
  // Chance begins anew; what the rules have counted stays.
  void reseed(std::uint64_t seed) {
    plan_.seed = seed;
    random_ = Random(seed);
  }
  // Which bit of kCorrupt, which byte of kTwin: 0 to bound - 1.
  std::uint64_t pick(std::uint64_t bound) { return random_.below(bound); }
  // Times a rule has acted.
  std::uint64_t injected() const { return injected_; }
  friend void archive(Archive& a, CanFaultJudge& judge);

 private:
  CanFaultPlan plan_;
  std::vector<FaultCount> counts_;  // by rule
  Random random_;
  std::uint64_t injected_ = 0;
};

}  // namespace vinv::transports
