#include "sim/transports/broadcast_listener.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <cerrno>
#include <utility>

#include "sim/transports/io_error.hpp"

namespace vinv::transports {
namespace {

constexpr std::uint32_t kLimitedBroadcast = 0xffffffff;

UdpPort::OnDatagram told_to(const UdpSocket& socket, const BroadcastListener::OnDatagram& on_datagram) {
  return [to = socket.local(), on_datagram](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    on_datagram(now, from, to, bytes);
  };
}

std::uint32_t address_in(const sockaddr* address) {
  return ntohl(reinterpret_cast<const sockaddr_in*>(address)->sin_addr.s_addr);
}

}  // namespace

Result<NetworkInterface, std::string> find_interface(std::uint32_t address) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return Unexpected("the interfaces cannot be listed: " + describe_errno(errno));
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, ::freeifaddrs);
  for (const ifaddrs* i = list; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_netmask == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    const std::uint32_t mask = address_in(i->ifa_netmask);
    if (((address_in(i->ifa_addr) ^ address) & mask) != 0) continue;
    return NetworkInterface{i->ifa_name, ::if_nametoindex(i->ifa_name), address_in(i->ifa_addr), mask,
                            (i->ifa_flags & IFF_LOOPBACK) != 0};
  }
  return Unexpected("no interface of this machine has " + ipv4_text(address) + " in its network");
}

Result<std::unique_ptr<BroadcastListener>, std::string> BroadcastListener::open(EventLoop& loop,
                                                                                const NetworkInterface& where,
                                                                                std::uint16_t port,
                                                                                OnDatagram on_datagram) {
  std::unique_ptr<BroadcastListener> listener(new BroadcastListener);
  UdpSocketOptions options;
  options.port = port;
  options.shared = true;
  options.address = where.broadcast();
  auto directed = UdpSocket::open(loop, options);
  if (!directed) return Unexpected(directed.error());
  listener->directed_ = std::move(*directed);
  listener->directed_->set_handler(told_to(*listener->directed_, on_datagram));
  if (where.is_loopback) return listener;
  options.address = kLimitedBroadcast;
  options.interface_index = where.index;
  auto limited = UdpSocket::open(loop, options);
  if (!limited) return Unexpected(limited.error());
  listener->limited_ = std::move(*limited);
  listener->limited_->set_handler(told_to(*listener->limited_, on_datagram));
  return listener;
}

}  // namespace vinv::transports
