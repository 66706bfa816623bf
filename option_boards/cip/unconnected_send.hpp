// Unconnected_Send, service 0x52 of the Connection Manager: a request with the route that it shall take.
// CIP Vol 1, 3-5.5.4.
#pragma once

#include <cstdint>

#include "option_boards/cip/message.hpp"
#include "option_boards/cip/status.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::cip {

inline constexpr std::uint8_t kUnconnectedSend = 0x52;

// Extended status words of kConnectionFailure that a router answers.
inline constexpr std::uint16_t kPortNotAvailable = 0x0311;
inline constexpr std::uint16_t kLinkAddressNotValid = 0x0312;
inline constexpr std::uint16_t kInvalidSegmentInPath = 0x0315;

struct UnconnectedSend {
  std::uint8_t priority_and_tick = 0;  // bits 3-0: a tick is 2^n ms
  std::uint8_t timeout_ticks = 0;
  ByteView message;     // the request inside
  ByteView route_path;  // padded; empty: the request is for this device

  // How long the request may be under way.
  Duration timeout() const {
    return std::chrono::milliseconds(std::int64_t{timeout_ticks} << (priority_and_tick & 0x0F));
  }
};

// The service data of a request. kNotEnoughData, kTooMuchData, kInvalidParameter for a pad that is not 0.
Result<UnconnectedSend, GeneralStatus> parse_unconnected_send(ByteView data);
void append_unconnected_send(Bytes& out, const UnconnectedSend& send);

// Where a device without further ports sends the request: nowhere but to itself. reply is the refusal if the path leads
// elsewhere: its first segment is no port (0x0315) or a port that the device does not have (0x0311); its data is the
// number of words of the path that remain (CIP Vol 1, 3-5.5.4: one byte and a pad).
bool route_ends_here(const UnconnectedSend& send, Reply& reply);

}  // namespace vinv::cip
