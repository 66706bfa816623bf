// A node on python-can's udp_multicast bus. It leaves this machine and needs a route for multicast, so only a plant
// file that asks for it gets it. There is no arbitration, confirmation or error signalling on this bus, and datagrams
// may be lost.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/can/remote_port.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

struct UdpMulticastOptions {
  std::string group = "ff15:7079:7468:6f6e:6465:6d6f:6d63:6173";  // python-can's default; or an IPv4 group
  std::uint16_t port = 43113;
  int hop_limit = 1;  // stays in the local network
};

class UdpMulticastPort : public RemotePort {
 public:
  // Refusal: a sentence. The loop outlives the port.
  static Result<std::unique_ptr<UdpMulticastPort>, std::string> open(EventLoop& loop,
                                                                     const UdpMulticastOptions& options);
  ~UdpMulticastPort() override;

  void set_online(Instant now, bool online) override;
  Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) override;
  std::string name() const override;

 private:
  struct Impl;
  explicit UdpMulticastPort(std::shared_ptr<Impl> impl);
  bool hand_over(Instant now, const CanFrame& frame) override;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
