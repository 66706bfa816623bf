// Packets of one serial line, for captures of link type RTAC serial (250), which carries direction and time. A line has
// no packets of its own: bytes of one direction that follow within kFrameGap are one packet. Sans-I/O.
#pragma once

#include <chrono>
#include <functional>
#include <utility>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/transports/pcapng.hpp"

namespace vinv::transports {

class SerialPackets {
 public:
  // Masters send a frame in one piece and wait tens of milliseconds before the next.
  static constexpr Duration kFrameGap = std::chrono::milliseconds(5);
  // at: of the packet's first byte. packet: header and bytes.
  using Emit = std::function<void(Instant at, ByteView packet, PacketDirection direction)>;

  explicit SerialPackets(Emit emit) : emit_(std::move(emit)) {}
  // direction: kInbound to us, kOutbound from us.
  void bytes(Instant now, PacketDirection direction, ByteView bytes);
  // The packet that is not complete yet, if there is one.
  void flush();

 private:
  Emit emit_;
  PacketDirection direction_ = PacketDirection::kInbound;
  Instant first_{};
  Instant last_{};
  Bytes pending_;
  Bytes packet_;
};

}  // namespace vinv::transports
