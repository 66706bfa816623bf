// Error frames as Linux has them: an identifier of error classes and eight bytes of detail. linux/can/error.h.
#pragma once

#include <array>
#include <cstdint>

#include "sim/transports/can/can_bus.hpp"

namespace vinv::transports {

struct CanErrorFrame {
  static constexpr std::uint32_t kFlag = 0x20000000;  // CAN_ERR_FLAG, not in error_class
  std::uint32_t error_class = 0;                      // CAN_ERR_...
  std::array<std::uint8_t, 8> data{};
};

// What a driver tells when its controller enters this state.
CanErrorFrame error_frame_of(const CanStatus& status);
// What a driver with bus error reporting tells of a destroyed frame.
CanErrorFrame error_frame_of(CanErrorCause cause);

// What an error frame says of the controller; offline and counters 0 if it says nothing of them.
struct CanErrorNews {
  bool has_state = false;
  CanState state = CanState::kErrorActive;
  bool has_counters = false;
  CanErrorCounters counters;
};
CanErrorNews news_of(const CanErrorFrame& frame);

}  // namespace vinv::transports
