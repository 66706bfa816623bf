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

namespace vinv::transports {

enum class CanFault : std::uint8_t {
  kDrop,        // on the wire and acknowledged, but lost in every receiver, as by overrun
  kDelay,       // handed to the bus later by CanFaultRule::delay; what its node sends next waits behind it
  kDuplicate,   // a second time, CanFaultRule::delay after the first was handed over; later frames wait behind it
  kCorrupt,     // one bit between control field and CRC is inverted: nodes signal an error, the frame is sent again
  kErrorFrame,  // somebody signals an error right after the arbitration field: the frame is sent again
  kBusOff,      // its node goes bus off; the frame and what waits behind it are lost
};

struct CanFaultRule {
  CanFault fault = CanFault::kDrop;
  // Which frames: identifiers equal to id in the bits of mask, of one format or both, of one node or any.
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  std::optional<bool> extended;
  std::string node;
  // Which of these: the nth, counted from 1; 0: by probability, 0 to 1.
  std::uint64_t nth = 0;
  double probability = 0;
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
  Duration delay{};
  unsigned corrupt = 0;       // attempts
  unsigned error_frames = 0;  // attempts, after those of corrupt
  unsigned copies = 0;
  Duration copies_after{};
};

class CanFaultJudge {
 public:
  explicit CanFaultJudge(CanFaultPlan plan)
      : plan_(std::move(plan)), seen_(plan_.rules.size(), 0), random_(plan_.seed) {}

  CanVerdict judge(const CanFrame& frame, std::string_view node);
  // Which bit of kCorrupt, 0 to bound - 1.
  std::uint64_t pick(std::uint64_t bound) { return random_.below(bound); }
  // Times a rule has acted.
  std::uint64_t injected() const { return injected_; }
  friend void archive(Archive& a, CanFaultJudge& judge);

 private:
  CanFaultPlan plan_;
  std::vector<std::uint64_t> seen_;  // frames that each rule has looked at
  Random random_;
  std::uint64_t injected_ = 0;
};

}  // namespace vinv::transports
