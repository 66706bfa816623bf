// Ports for datagrams. A rig sees a bound port and does not know what carries it: a socket of this machine or a network
// in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "sim/base/bytes.hpp"
#include "sim/base/ipv4.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

class UdpPort {
 public:
  using OnDatagram = std::function<void(Instant now, const Ipv4Endpoint& from, ByteView bytes)>;
  static constexpr std::size_t kMaxDatagram = 1472;  // that fits an Ethernet frame; a longer one is dropped

  virtual ~UdpPort() = default;
  virtual void set_handler(OnDatagram on_datagram) = 0;
  // Never blocks; what the network does not take is lost, as datagrams are. dscp: 0-63.
  virtual void send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp = 0) = 0;
  // Receives what is sent to a multicast group and this port's number. Refusal: a sentence.
  virtual Result<void, std::string> join(std::uint32_t group) = 0;
  virtual void leave(std::uint32_t group) = 0;
  virtual Ipv4Endpoint local() const = 0;
};

}  // namespace vinv::transports
