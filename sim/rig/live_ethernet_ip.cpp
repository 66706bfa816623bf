#include "sim/rig/live_ethernet_ip.hpp"

#include <charconv>
#include <utility>

#include "sim/transports/udp_socket.hpp"

namespace vinv::rig {
namespace {

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

Result<void, std::string> LiveEthernetIp::add(EthernetIpPort& port, const EthernetIpAddress& where,
                                              std::string* notice) {
  const std::uint32_t bound = where.any_address ? 0 : where.address;
  transports::UdpSocketOptions options;
  options.address = bound;
  options.any_address = where.any_address;
  options.port = where.port;
  auto udp = transports::UdpSocket::open(loop_, options);
  if (!udp) return Unexpected(udp.error());
  options.port = where.io_port;
  options.multicast_ttl = where.multicast_ttl;
  auto io = transports::UdpSocket::open(loop_, options);
  if (!io) return Unexpected(io.error());
  auto listener = transports::TcpListener::open(
      loop_, {ipv4_text(bound), where.port, EthernetIpPort::kMaxConnections, ethernet_ip::kExplicitDscp},
      [this, &port, where](Instant now, std::unique_ptr<transports::ByteStream> stream) {
        const Ipv4Endpoint peer = endpoint_of(stream->name());
        if (recorder_ != nullptr)
          stream =
              recorder_->wrap(now, std::move(stream), ipv4_text(where.address), where.port, ethernet_ip::kExplicitDscp);
        port.accept(now, std::move(stream), peer);
      });
  if (!listener) return Unexpected(listener.error());
  listeners_.push_back(std::move(*listener));
  std::unique_ptr<transports::UdpPort> list_port = std::move(*udp), io_port = std::move(*io);
  if (recorder_ != nullptr) {
    list_port = recorder_->wrap(std::move(list_port));
    io_port = recorder_->wrap(std::move(io_port));
  }
  port.connect(std::move(list_port), std::move(io_port), EthernetIpPort::Carrier::kOutside);
  const std::string deaf = where.any_address ? std::string() : listen_to_broadcasts(port, where);
  if (notice != nullptr) *notice = deaf;
  return {};
}

std::string LiveEthernetIp::listen_to_broadcasts(EthernetIpPort& port, const EthernetIpAddress& where) {
  const auto interface = transports::find_interface(where.address);
  if (!interface) return "broadcasts are not heard: " + interface.error();
  Segment& segment = segments_[{interface->index, where.port}];
  segment.ports.push_back(&port);
  if (segment.listener != nullptr) return {};
  auto listener = transports::BroadcastListener::open(
      loop_, *interface, where.port,
      [this, &segment](Instant now, const Ipv4Endpoint& from, const Ipv4Endpoint& to, ByteView bytes) {
        if (recorder_ != nullptr) recorder_->received(now, from, to, bytes);
        for (EthernetIpPort* each : segment.ports) each->handle_broadcast(now, from, bytes);
      });
  if (!listener) return "broadcasts are not heard: " + listener.error();
  segment.listener = std::move(*listener);
  return {};
}

}  // namespace vinv::rig
