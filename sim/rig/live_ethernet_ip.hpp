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
#include "sim/transports/ip_recorder.hpp"
#include "sim/transports/tcp_listener.hpp"

namespace vinv::rig {

struct EthernetIpAddress {
  std::uint32_t address = 0x7f000002;
  std::uint16_t port = ethernet_ip::kEncapsulationPort;
  std::uint16_t io_port = ethernet_ip::kIoPort;
  int multicast_ttl = 1;
  bool any_address = false;  // sockets on 0.0.0.0, which leave no room for others on these ports
};

class LiveEthernetIp {
 public:
  // The loop outlives it, and so does the recorder of all traffic if there is one.
  explicit LiveEthernetIp(transports::EventLoop& loop, transports::IpRecorder* recorder = nullptr)
      : loop_(loop), recorder_(recorder) {}

  // Opens the sockets of the port, which outlives this object. A broadcast listener that cannot be opened is no
  // refusal: the adapter is found by its address; notice has a sentence then. Refusal: a sentence.
  Result<void, std::string> add(EthernetIpPort& port, const EthernetIpAddress& where, std::string* notice = nullptr);

 private:
  struct Segment {
    std::vector<EthernetIpPort*> ports;
    std::unique_ptr<transports::BroadcastListener> listener;
  };

  std::string listen_to_broadcasts(EthernetIpPort& port, const EthernetIpAddress& where);

  transports::EventLoop& loop_;
  transports::IpRecorder* recorder_;
  std::vector<std::unique_ptr<transports::TcpListener>> listeners_;
  std::map<std::pair<unsigned, std::uint16_t>, Segment> segments_;  // by interface and port
};

}  // namespace vinv::rig
