#include "sim/transports/can/udp_multicast_port.hpp"

#include <array>
#include <asio/io_context.hpp>
#include <asio/ip/multicast.hpp>
#include <asio/ip/udp.hpp>
#include <utility>

#include "sim/transports/can/multicast_text.hpp"
#include "sim/transports/io_error.hpp"

namespace vinv::transports {

using asio::ip::udp;

struct UdpMulticastPort::Impl : RemotePortState {
  explicit Impl(EventLoop& l) : RemotePortState(l.scheduler()), loop(l), in(l.io()), out(l.io()) {}

  Result<void, std::string> open(const UdpMulticastOptions& options) {
    where = options.group + " port " + std::to_string(options.port);
    asio::error_code error;
    const auto group = asio::ip::make_address(options.group, error);
    if (error || !group.is_multicast()) return Unexpected(options.group + " is not a multicast address");
    const udp::endpoint to(group, options.port);
    // Two sockets: by what the second sends from, we know our own datagrams when they come back.
    in.open(to.protocol(), error);
    if (!error) in.set_option(udp::socket::reuse_address(true), error);
    // To the group and not to any address, which would bring us all groups of this machine on this port.
    if (!error) in.bind(to, error);
    if (!error) in.set_option(asio::ip::multicast::join_group(group), error);
    if (!error) in.non_blocking(true, error);
    if (!error) out.open(to.protocol(), error);
    if (!error) out.set_option(asio::ip::multicast::hops(options.hop_limit), error);
    if (!error) out.connect(to, error);
    if (!error) own = out.local_endpoint(error);
    if (!error) out.non_blocking(true, error);
    if (error) {
      return Unexpected("cannot use multicast on " + where + ": " + describe_errno(error.value()) +
                        " (multicast needs a route, for example by way of a default gateway)");
    }
    status.state = CanState::kErrorActive;
    receive();
    return {};
  }

  void receive() {
    in.async_receive_from(asio::buffer(datagram), from,
                          [weak = std::weak_ptr<Impl>(std::static_pointer_cast<Impl>(shared_from_this()))](
                              const asio::error_code& error, std::size_t size) {
                            const auto self = weak.lock();
                            if (!self || !self->in.is_open()) return;
                            if (!error) self->hear(size);
                            if (self->in.is_open()) self->receive();
                          });
  }

  void hear(std::size_t size) {
    if (from == own) return;
    const auto frame = parse_multicast_datagram(ByteView(datagram.data(), size));
    if (frame) received(loop.now(), *frame);
  }

  void shut() {
    handlers.reset();
    asio::error_code ignored;
    in.close(ignored);
    out.close(ignored);
  }

  EventLoop& loop;
  std::string where;
  udp::socket in;
  udp::socket out;
  udp::endpoint own;
  udp::endpoint from;
  std::array<std::uint8_t, 4096> datagram{};  // as much as python-can takes
};

UdpMulticastPort::UdpMulticastPort(std::shared_ptr<Impl> impl) : RemotePort(impl), impl_(std::move(impl)) {}
UdpMulticastPort::~UdpMulticastPort() { impl_->shut(); }

Result<std::unique_ptr<UdpMulticastPort>, std::string> UdpMulticastPort::open(EventLoop& loop,
                                                                              const UdpMulticastOptions& options) {
  auto impl = std::make_shared<Impl>(loop);
  if (const auto opened = impl->open(options); !opened) {
    impl->shut();
    return Unexpected(opened.error());
  }
  return std::unique_ptr<UdpMulticastPort>(new UdpMulticastPort(std::move(impl)));
}

bool UdpMulticastPort::hand_over(Instant now, const CanFrame& frame) {
  const Bytes bytes = multicast_datagram(frame, to_seconds(now));
  asio::error_code error;
  impl_->out.send(asio::buffer(bytes), 0, error);
  return !error;
}

void UdpMulticastPort::set_online(Instant now, bool online) {
  if (std::exchange(impl_->online, online) == online) return;
  impl_->enter(now, online ? CanState::kErrorActive : CanState::kOffline);
}

Result<void, std::string> UdpMulticastPort::set_bitrate(Instant, std::uint32_t) {
  return Unexpected(std::string("a multicast bus has no bit rate"));
}

std::string UdpMulticastPort::name() const { return "multicast " + impl_->where; }

}  // namespace vinv::transports
