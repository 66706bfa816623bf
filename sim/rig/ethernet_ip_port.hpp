// One EtherNet/IP adapter on its wires: TCP connections, the two UDP ports, its deadlines. Whatever carries them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "option_boards/ethernet_ip/adapter.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::rig {

class EthernetIpPort {
 public:
  // Scheduler and adapter outlive the port. udp and io are bound to the adapter's address.
  EthernetIpPort(kernel::Scheduler& scheduler, ethernet_ip::Adapter& adapter, std::unique_ptr<transports::UdpPort> udp,
                 std::unique_ptr<transports::UdpPort> io);
  ~EthernetIpPort();
  EthernetIpPort(const EthernetIpPort&) = delete;
  EthernetIpPort& operator=(const EthernetIpPort&) = delete;

  // A connection to the adapter's TCP port from this peer.
  void accept(Instant now, std::unique_ptr<transports::ByteStream> stream, const Ipv4Endpoint& peer);
  // A broadcast to port 44818.
  void handle_broadcast(Instant now, const Ipv4Endpoint& from, ByteView bytes);
  // After each tick of the drive, and whatever else the device was told: sends what has become due.
  void handle_new_data(Instant now);
  void poll(Instant now);

  std::size_t connections() const { return connections_.size(); }
  const ethernet_ip::Adapter& adapter() const { return adapter_; }

 private:
  struct Connection {
    ethernet_ip::TcpId id = 0;
    std::unique_ptr<transports::ByteStream> stream;
    bool closed = false;
  };

  Connection* find(ethernet_ip::TcpId id);
  void retire(Connection& connection);
  void arm();
  void on_deadline(Instant now);

  kernel::Scheduler& scheduler_;
  ethernet_ip::Adapter& adapter_;
  std::unique_ptr<transports::UdpPort> udp_;
  std::unique_ptr<transports::UdpPort> io_;
  std::vector<std::unique_ptr<Connection>> connections_;
  std::size_t last_found_ = 0;
  kernel::EventId event_ = 0;
  kernel::EventId sweep_ = 0;
  Instant armed_for_{};
};

}  // namespace vinv::rig
