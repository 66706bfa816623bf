// A UDP socket of this machine as a port. Takes several waiting datagrams in one system call.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "sim/transports/event_loop.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::transports {

struct UdpSocketOptions {
  std::uint32_t address = 0x7f000001;  // one of this machine's; 0 (any) only with any_address
  std::uint16_t port = 0;              // 0: a free one
  bool any_address = false;
  // Others may bind the same address and port: for broadcast and multicast addresses, where all of them receive.
  bool shared = false;
  int multicast_ttl = 1;  // stays in the local network
  // Only what comes in by this interface (if_nametoindex); 0: by any.
  unsigned interface_index = 0;
};

class UdpSocket : public UdpPort {
 public:
  // Refusal: a sentence that names the address and the reason. The loop outlives the socket.
  static Result<std::unique_ptr<UdpSocket>, std::string> open(EventLoop& loop, const UdpSocketOptions& options);
  ~UdpSocket() override;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  void set_handler(OnDatagram on_datagram) override;
  void send(Instant now, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp = 0) override;
  Result<void, std::string> join(std::uint32_t group) override;
  void leave(std::uint32_t group) override;
  Ipv4Endpoint local() const override;

 private:
  struct Impl;
  explicit UdpSocket(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
  // A socket that is bound to a host's address gets nothing of a group: one more for each.
  std::map<std::uint32_t, std::unique_ptr<UdpSocket>> groups_;
};

}  // namespace vinv::transports
