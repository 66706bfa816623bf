// One EtherNet/IP adapter on its wires: TCP connections, the two UDP ports, its cable, its deadlines. Whatever carries
// them.
//
// While the cable is out, datagrams are lost; what TCP has to carry waits at both ends, as its repetitions do.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "option_boards/ethernet_ip/adapter.hpp"
#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/rig/wire_tap.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_streams.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::rig {

class EthernetIpPort {
 public:
  // Bytes that wait for the cable in each direction of a connection; more end it.
  static constexpr std::size_t kMaxHeldBytes = 64 * 1024;
  // More are closed at once: which one has to go is the adapter's decision, up to its own limit.
  static constexpr std::size_t kMaxConnections = ethernet_ip::EncapsulationLimits{}.tcp_connections + 16;

  // Something has gone in: the owner settles the device, and then calls handle_new_data() or poll().
  using OnTraffic = std::function<void(Instant now)>;

  // Scheduler and adapter outlive the port. Without UDP ports until connect().
  EthernetIpPort(kernel::Scheduler& scheduler, ethernet_ip::Adapter& adapter, OnTraffic on_traffic = {});
  ~EthernetIpPort();
  EthernetIpPort(const EthernetIpPort&) = delete;
  EthernetIpPort& operator=(const EthernetIpPort&) = delete;

  // Where datagrams go, bound to the adapter's address; take the place of those before. kOutside: sockets, which no
  // snapshot holds.
  enum class Carrier : std::uint8_t { kInside, kOutside };
  void connect(std::unique_ptr<transports::UdpPort> udp, std::unique_ptr<transports::UdpPort> io, Carrier carrier);
  // A connection to the adapter's TCP port from this peer.
  void accept(Instant now, std::unique_ptr<transports::ByteStream> stream, const Ipv4Endpoint& peer);
  // A broadcast to port 44818.
  void handle_broadcast(Instant now, const Ipv4Endpoint& from, ByteView bytes);

  // The device is there, with this address; its connections end if it was there before.
  void start(Instant now, const ethernet_ip::Adapter::Address& address);
  void stop(Instant now);
  void set_link(Instant now, bool up);
  // After each tick of the drive, and whatever else the device was told: sends what has become due.
  void handle_new_data(Instant now);
  void poll(Instant now);
  // True once after something has gone in or out, or a deadline has passed.
  bool take_activity() { return std::exchange(activity_, false); }

  std::size_t connections() const { return connections_.size(); }
  const ethernet_ip::Adapter& adapter() const { return adapter_; }
  bool has_link() const { return link_; }
  // Where faults of its TCP connections and of its datagrams go.
  WireTap& tcp_tap() { return tcp_tap_; }
  WireTap& udp_tap() { return udp_tap_; }
  void reseed(std::uint64_t seed) {
    tcp_tap_.reseed(seed);
    udp_tap_.reseed(seed);
  }

  // Clients or sockets outside the plant; a snapshot leaves them out.
  bool is_outside() const;
  // Before a load: the connections are forgotten without a word.
  void drop();
  // Snapshots: adapter included; after its device and the lines in memory of which the connections are. A load is for a
  // port without connections.
  void archive(Archive& a, transports::MemoryStreams& streams);

 private:
  struct Connection {
    ethernet_ip::TcpId id = 0;  // 0: the adapter has not heard of it yet
    Ipv4Endpoint peer;
    std::unique_ptr<transports::ByteStream> stream;
    Bytes to_adapter, to_peer;  // wait for the cable
    bool ended = false;         // by the peer, behind what waits
    bool closed = false;        // waits for being forgotten
  };

  Connection* find(ethernet_ip::TcpId id);
  void listen(Connection& connection);
  void receive(Instant now, Connection& connection, ByteView bytes);
  void send(Instant now, Connection& connection, ByteView bytes);
  void end(Instant now, Connection& connection);
  void open(Instant now, Connection& connection);
  void catch_up(Instant now);
  void retire(Connection& connection);
  void settle(Instant now);
  void arm();
  void on_deadline(Instant now);

  kernel::Scheduler& scheduler_;
  ethernet_ip::Adapter& adapter_;
  OnTraffic on_traffic_;
  std::unique_ptr<transports::FaultyUdp> udp_;
  std::unique_ptr<transports::FaultyUdp> io_;
  Carrier carrier_ = Carrier::kInside;
  std::vector<std::unique_ptr<Connection>> connections_;
  WireTap tcp_tap_;
  WireTap udp_tap_;
  bool link_ = true;
  bool activity_ = false;
  std::size_t last_found_ = 0;
  kernel::EventId event_ = 0;
  kernel::EventId sweep_ = 0;
  Instant armed_for_{};
};

}  // namespace vinv::rig
