#include "sim/rig/live_ethernet_ip.hpp"

#include <charconv>
#include <utility>

#include "sim/transports/udp_socket.hpp"

namespace vinv::rig {
namespace {

// Above the adapter's own limit: which connection has to go is its decision.
constexpr std::size_t kMaxConnections = ethernet_ip::EncapsulationLimits{}.tcp_connections + 16;

// "127.0.0.1:40312", as an accepted stream is named.
Ipv4Endpoint endpoint_of(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  Ipv4Endpoint endpoint;
  if (colon == std::string::npos) return endpoint;
  endpoint.address = parse_ipv4(std::string_view(name).substr(0, colon)).value_or(0);
  std::from_chars(name.data() + colon + 1, name.data() + name.size(), endpoint.port);
  return endpoint;
}

}  // namespace

Result<EthernetIpPort*, std::string> LiveEthernetIp::add(ethernet_ip::Adapter& adapter, const EthernetIpAddress& where,
                                                         std::string* notice) {
  transports::UdpSocketOptions options;
  options.address = where.address;
  options.port = where.port;
  auto udp = transports::UdpSocket::open(loop_, options);
  if (!udp) return Unexpected(udp.error());
  options.port = where.io_port;
  options.multicast_ttl = where.multicast_ttl;
  auto io = transports::UdpSocket::open(loop_, options);
  if (!io) return Unexpected(io.error());
  const std::uint16_t io_port = (*io)->local().port;
  Host host;
  host.port = std::make_unique<EthernetIpPort>(loop_.scheduler(), adapter, std::move(*udp), std::move(*io));
  EthernetIpPort& port = *host.port;
  auto listener = transports::TcpListener::open(loop_, {ipv4_text(where.address), where.port, kMaxConnections},
                                                [&port](Instant now, std::unique_ptr<transports::ByteStream> stream) {
                                                  const Ipv4Endpoint peer = endpoint_of(stream->name());
                                                  port.accept(now, std::move(stream), peer);
                                                });
  if (!listener) return Unexpected(listener.error());
  host.listener = std::move(*listener);
  adapter.start({where.address, where.netmask, io_port});
  const std::string deaf = listen_to_broadcasts(port, where);
  if (notice != nullptr) *notice = deaf;
  hosts_.push_back(std::move(host));
  return &port;
}

std::string LiveEthernetIp::listen_to_broadcasts(EthernetIpPort& port, const EthernetIpAddress& where) {
  const auto interface = transports::find_interface(where.address);
  if (!interface) return "broadcasts are not heard: " + interface.error();
  Segment& segment = segments_[{interface->index, where.port}];
  segment.ports.push_back(&port);
  if (segment.listener != nullptr) return {};
  auto listener = transports::BroadcastListener::open(
      loop_, *interface, where.port, [&segment](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
        for (EthernetIpPort* each : segment.ports) each->handle_broadcast(now, from, bytes);
      });
  if (!listener) return "broadcasts are not heard: " + listener.error();
  segment.listener = std::move(*listener);
  return {};
}

}  // namespace vinv::rig
