// The Ethernet frame of a UDP datagram over IPv4, for recordings. RFC 768, RFC 791, RFC 1071; multicast addresses of
// Ethernet: RFC 1112, 6.4.
#pragma once

#include <cstdint>

#include "sim/base/bytes.hpp"
#include "sim/base/ipv4.hpp"

namespace vinv::transports {

struct UdpFrameOptions {
  std::uint16_t ip_id = 0;
  std::uint8_t dscp = 0;
};

// Replaces what is in out. payload: at most UdpPort::kMaxDatagram bytes.
void make_udp_frame(Bytes& out, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView payload,
                    const UdpFrameOptions& options);

}  // namespace vinv::transports
