// EtherNet/IP adapters on sockets of this machine: each on an address of its own with the standard ports, and one
// listener for broadcasts per interface, which answers for all adapters on it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/rig/ethernet_ip_port.hpp"
#include "sim/transports/broadcast_listener.hpp"
#include "sim/transports/tcp_listener.hpp"

namespace vinv::rig {

struct EthernetIpAddress {
  std::uint32_t address = 0x7f000002;
  std::uint32_t netmask = 0;  // 0: by the address's class
  std::uint16_t port = ethernet_ip::kEncapsulationPort;
  std::uint16_t io_port = ethernet_ip::kIoPort;
  int multicast_ttl = 1;
};

class LiveEthernetIp {
 public:
  // The loop outlives it.
  explicit LiveEthernetIp(transports::EventLoop& loop) : loop_(loop) {}

  // Opens the sockets and starts the adapter, which outlives this object. A broadcast listener that cannot be opened is
  // no refusal: the adapter is found by its address; notice has a sentence then. Refusal: a sentence.
  Result<EthernetIpPort*, std::string> add(ethernet_ip::Adapter& adapter, const EthernetIpAddress& where,
                                           std::string* notice = nullptr);

 private:
  struct Host {
    std::unique_ptr<EthernetIpPort> port;
    std::unique_ptr<transports::TcpListener> listener;
  };
  struct Segment {
    std::vector<EthernetIpPort*> ports;
    std::unique_ptr<transports::BroadcastListener> listener;
  };

  std::string listen_to_broadcasts(EthernetIpPort& port, const EthernetIpAddress& where);

  transports::EventLoop& loop_;
  std::vector<Host> hosts_;
  std::map<std::pair<unsigned, std::uint16_t>, Segment> segments_;  // by interface and port
};

}  // namespace vinv::rig
