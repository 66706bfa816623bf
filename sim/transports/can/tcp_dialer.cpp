#include "sim/transports/can/tcp_dialer.hpp"

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <utility>

#include "sim/transports/io_error.hpp"
#include "sim/transports/socket_stream.hpp"

namespace vinv::transports {

using asio::ip::tcp;

struct TcpDialer::Impl : std::enable_shared_from_this<Impl> {
  Impl(EventLoop& l, tcp::endpoint to, std::string w, OnConnect handler)
      : loop(l), endpoint(std::move(to)), where(std::move(w)), on_connect(std::move(handler)), socket(l.io()) {}

  void connect() {
    timer = 0;
    socket = tcp::socket(loop.io());
    socket.async_connect(endpoint, [self = shared_from_this(), number = ++attempt](const asio::error_code& result) {
      if (self->closed || number != self->attempt) return;
      self->done(result.value());
    });
    timer = loop.scheduler().schedule(loop.now() + kConnectTimeout, kernel::Priority::kWire,
                                      [weak = weak_from_this()](Instant) {
                                        const auto self = weak.lock();
                                        if (!self) return;
                                        self->timer = 0;
                                        ++self->attempt;  // whatever the socket says now is not heard
                                        self->done(ETIMEDOUT);
                                      });
  }

  void done(int result) {
    if (timer != 0) loop.scheduler().cancel(std::exchange(timer, 0));
    if (result != 0) {
      error = "cannot connect to " + where + ": " + describe_errno(result);
      return again();
    }
    error.clear();
    asio::error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const auto protocol = endpoint.protocol();
    asio::generic::stream_protocol::socket generic(loop.io(), asio::generic::stream_protocol(protocol),
                                                   socket.release());
    on_connect(loop.now(), make_socket_stream(loop, std::move(generic), where, nullptr));
  }

  void again() {
    asio::error_code ignored;
    socket.close(ignored);
    if (closed || timer != 0) return;
    timer = loop.scheduler().schedule(loop.now() + kRetryInterval, kernel::Priority::kWire,
                                      [weak = weak_from_this()](Instant) {
                                        const auto self = weak.lock();
                                        if (self && !self->closed) self->connect();
                                      });
  }

  EventLoop& loop;
  tcp::endpoint endpoint;
  std::string where;
  OnConnect on_connect;
  tcp::socket socket;
  kernel::EventId timer = 0;  // for an attempt or for the pause between two
  std::uint64_t attempt = 0;
  std::string error;
  bool closed = false;
};

TcpDialer::TcpDialer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

TcpDialer::~TcpDialer() {
  impl_->closed = true;
  if (impl_->timer != 0) impl_->loop.scheduler().cancel(std::exchange(impl_->timer, 0));
  asio::error_code ignored;
  impl_->socket.close(ignored);
}

Result<std::unique_ptr<TcpDialer>, std::string> TcpDialer::open(EventLoop& loop, const std::string& host,
                                                                std::uint16_t port, OnConnect on_connect) {
  asio::error_code error;
  const auto address = asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
  if (error) return Unexpected("cannot connect to \"" + host + "\": not an IP address");
  const std::string shown = address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
  auto impl = std::make_shared<Impl>(loop, tcp::endpoint(address, port), shown + ":" + std::to_string(port),
                                     std::move(on_connect));
  impl->connect();
  return std::unique_ptr<TcpDialer>(new TcpDialer(std::move(impl)));
}

void TcpDialer::lost() { impl_->again(); }
const std::string& TcpDialer::error() const { return impl_->error; }

}  // namespace vinv::transports
