// What is broadcast on one interface to a port: one for all the addresses of the interface that programs here serve,
// because a socket that is bound to one address hears no broadcasts.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim/transports/event_loop.hpp"
#include "sim/transports/udp_socket.hpp"

namespace vinv::transports {

struct NetworkInterface {
  std::string name;
  unsigned index = 0;
  std::uint32_t address = 0;
  std::uint32_t netmask = 0;
  bool is_loopback = false;
  std::uint32_t broadcast() const { return address | ~netmask; }
};
// The interface whose network an address of this machine lies in; 127.0.0.0/8 is one network. Refusal: a sentence.
Result<NetworkInterface, std::string> find_interface(std::uint32_t address);

class BroadcastListener {
 public:
  // to: the broadcast address, and the port.
  using OnDatagram = std::function<void(Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes)>;

  // Hears the interface's own broadcast address and, except on the loopback, 255.255.255.255 as far as it comes in
  // there. Other programs may do the same. The loop outlives the listener.
  static Result<std::unique_ptr<BroadcastListener>, std::string> open(EventLoop& loop, const NetworkInterface& where,
                                                                      std::uint16_t port, OnDatagram on_datagram);

 private:
  BroadcastListener() = default;
  std::unique_ptr<UdpSocket> directed_;
  std::unique_ptr<UdpSocket> limited_;  // nullptr on the loopback
};

}  // namespace vinv::transports
