// A datagram of python-can's udp_multicast bus: one message as a MessagePack map (msgpack specification, 2013) with
// eleven entries, named as the arguments of can.Message.
#pragma once

#include <optional>

#include "sim/base/bytes.hpp"
#include "sim/base/can_frame.hpp"

namespace vinv::transports {

Bytes multicast_datagram(const CanFrame& frame, double timestamp_s);
// Empty if it is none, or an FD or error frame. Entries may come in any order, unknown ones are skipped.
std::optional<CanFrame> parse_multicast_datagram(ByteView bytes);

}  // namespace vinv::transports
