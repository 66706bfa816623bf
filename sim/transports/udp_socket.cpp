#include "sim/transports/udp_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/unique_fd.hpp"

namespace vinv::transports {
namespace {

// Datagrams of one socket in one system call, before other sockets and events have their turn.
constexpr unsigned kBatch = 16;

sockaddr_in to_sockaddr(const Ipv4Endpoint& e) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(e.port);
  address.sin_addr.s_addr = htonl(e.address);
  return address;
}

Ipv4Endpoint to_endpoint(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

bool set_option(int fd, int level, int name, int value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

std::string text(const Ipv4Endpoint& e) { return ipv4_text(e.address) + ":" + std::to_string(e.port); }

}  // namespace

struct UdpSocket::Impl final : std::enable_shared_from_this<UdpSocket::Impl>, private ReadyHandler {
  explicit Impl(EventLoop& l) : loop(l) {}
  ~Impl() { close(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // 0, or errno.
  int open(const UdpSocketOptions& options) {
    UniqueFd opened(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const int fd = opened.get();
    if (fd < 0) return errno;
    interface_index = options.interface_index;
    if (options.shared && !set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1)) return errno;
    if (!set_option(fd, SOL_SOCKET, SO_BROADCAST, 1)) return errno;
    if (interface_index != 0 && !set_option(fd, IPPROTO_IP, IP_PKTINFO, 1)) return errno;
    const sockaddr_in address = to_sockaddr({options.address, options.port});
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return errno;
    if (!options.shared && options.address != 0) {
      // Multicast leaves by the interface that has this address, whatever the routes say.
      in_addr own{};
      own.s_addr = htonl(options.address);
      if (::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &own, sizeof own) != 0) return errno;
      if (!set_option(fd, IPPROTO_IP, IP_MULTICAST_TTL, options.multicast_ttl)) return errno;
    }
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return errno;
    local = to_endpoint(bound);
    socket = std::move(opened);
    prepare();
    return 0;
  }

  void prepare() {
    for (unsigned i = 0; i < kBatch; ++i) {
      pieces[i] = {buffers[i].data(), buffers[i].size()};
      msghdr& header = messages[i].msg_hdr;
      header.msg_name = &senders[i];
      header.msg_iov = &pieces[i];
      header.msg_iovlen = 1;
      if (interface_index != 0) header.msg_control = controls[i].bytes.data();
    }
  }

  void wait() { ready = loop.ready_set().add(socket.get(), EPOLLIN, *this); }

  void close() {
    if (ready != 0) loop.ready_set().remove(std::exchange(ready, 0), socket.get());
    socket.reset();
  }

  void on_ready(std::uint32_t /*events*/) override {
    const auto self = shared_from_this();
    receive();
  }

  void receive() {
    for (auto& m : messages) {
      m.msg_hdr.msg_namelen = sizeof(sockaddr_in);
      if (interface_index != 0) m.msg_hdr.msg_controllen = sizeof controls[0].bytes;
    }
    const int count = ::recvmmsg(socket.get(), messages.data(), kBatch, MSG_DONTWAIT, nullptr);
    const Instant now = loop.now();
    for (int i = 0; i < count && socket.is_open(); ++i) {
      auto& m = messages[static_cast<std::size_t>(i)];
      if ((m.msg_hdr.msg_flags & MSG_TRUNC) != 0 || !came_by_our_interface(m.msg_hdr)) continue;
      const auto keep = handler;
      if (keep && *keep)
        (*keep)(now, to_endpoint(senders[static_cast<std::size_t>(i)]),
                ByteView(buffers[static_cast<std::size_t>(i)]).first(m.msg_len));
    }
  }

  bool came_by_our_interface(msghdr& header) const {
    if (interface_index == 0) return true;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != IPPROTO_IP || c->cmsg_type != IP_PKTINFO) continue;
      in_pktinfo info{};
      std::memcpy(&info, CMSG_DATA(c), sizeof info);
      return static_cast<unsigned>(info.ipi_ifindex) == interface_index;
    }
    return false;
  }

  void send(const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp) {
    const int fd = socket.get();
    if (dscp != last_dscp) {  // senders hardly ever change it: cheaper than to say it with each packet
      last_dscp = dscp;
      set_option(fd, IPPROTO_IP, IP_TOS, dscp << 2);
    }
    const sockaddr_in address = to_sockaddr(to);
    // An error of an earlier datagram (nobody listens there) is reported here once and says nothing of this one.
    for (int tries = 0; tries < 2; ++tries) {
      const ssize_t sent = ::sendto(fd, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                                    reinterpret_cast<const sockaddr*>(&address), sizeof address);
      if (sent >= 0 || errno != ECONNREFUSED) return;
    }
  }

  bool change_membership(int option, std::uint32_t group) {
    ip_mreq request{};
    request.imr_multiaddr.s_addr = htonl(group);
    request.imr_interface.s_addr = htonl(member_by);
    return ::setsockopt(socket.get(), IPPROTO_IP, option, &request, sizeof request) == 0;
  }

  struct alignas(cmsghdr) Control {
    std::array<std::uint8_t, CMSG_SPACE(sizeof(in_pktinfo))> bytes{};
  };

  EventLoop& loop;
  UniqueFd socket;
  ReadySet::Id ready = 0;
  Ipv4Endpoint local;
  std::uint32_t member_by = 0;
  unsigned interface_index = 0;
  std::uint8_t last_dscp = 0;
  std::shared_ptr<OnDatagram> handler;
  std::array<std::array<std::uint8_t, kMaxDatagram>, kBatch> buffers{};
  std::array<Control, kBatch> controls{};
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> pieces{};
  std::array<sockaddr_in, kBatch> senders{};
};

UdpSocket::UdpSocket(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

UdpSocket::~UdpSocket() {
  impl_->handler.reset();
  impl_->close();
}

Result<std::unique_ptr<UdpSocket>, std::string> UdpSocket::open(EventLoop& loop, const UdpSocketOptions& options) {
  const std::string where = "cannot use UDP on " + text({options.address, options.port}) + ": ";
  if (options.address == 0 && !options.any_address)
    return Unexpected(where + "that is every address of this machine (give one of them, such as 127.0.0.2)");
  auto impl = std::make_shared<Impl>(loop);
  if (const int error = impl->open(options); error != 0) {
    std::string sentence = where + describe_errno(error);
    if (error == EADDRINUSE) sentence += " (another program uses it)";
    return Unexpected(sentence);
  }
  impl->member_by = is_multicast(options.address) || options.shared ? 0 : options.address;
  return std::unique_ptr<UdpSocket>(new UdpSocket(std::move(impl)));
}

void UdpSocket::set_handler(OnDatagram on_datagram) {
  impl_->handler = std::make_shared<OnDatagram>(std::move(on_datagram));
  if (impl_->ready == 0) impl_->wait();
}

void UdpSocket::send(Instant, const Ipv4Endpoint& to, ByteView bytes, std::uint8_t dscp) {
  impl_->send(to, bytes, dscp);
}

Result<void, std::string> UdpSocket::join(std::uint32_t group) {
  const std::uint32_t own = impl_->local.address;
  if (own == 0 || is_multicast(own)) {
    if (impl_->change_membership(IP_ADD_MEMBERSHIP, group)) return {};
    return Unexpected("cannot join " + ipv4_text(group) + " on " + text(impl_->local) + ": " + describe_errno(errno));
  }
  UdpSocketOptions options;
  options.address = group;
  options.port = impl_->local.port;
  options.shared = true;
  auto socket = open(impl_->loop, options);
  if (!socket) return Unexpected(socket.error());
  (*socket)->impl_->member_by = own;
  if (const auto joined = (*socket)->join(group); !joined) return joined;
  (*socket)->set_handler([to = std::weak_ptr(impl_)](Instant now, const Ipv4Endpoint& from, ByteView bytes) {
    const auto impl = to.lock();
    const auto keep = impl != nullptr ? impl->handler : nullptr;
    if (keep && *keep) (*keep)(now, from, bytes);
  });
  groups_[group] = std::move(*socket);
  return {};
}

void UdpSocket::leave(std::uint32_t group) {
  if (groups_.erase(group) == 0) impl_->change_membership(IP_DROP_MEMBERSHIP, group);
}

Ipv4Endpoint UdpSocket::local() const { return impl_->local; }

}  // namespace vinv::transports
