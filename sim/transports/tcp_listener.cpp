#include "sim/transports/tcp_listener.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <asio/detail/socket_option.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <utility>

#include "sim/transports/accept_loop.hpp"
#include "sim/transports/io_error.hpp"
#include "sim/transports/socket_stream.hpp"

namespace vinv::transports {
namespace {

using asio::ip::tcp;

// With the queue of the stream this is all that waits for a peer that does not read.
constexpr int kSendBufferBytes = 64 * 1024;
// A peer that vanished without a word is found after 60 + 5 x 10 s and gives its place free.
constexpr int kKeepAliveIdleSeconds = 60;
constexpr int kKeepAliveIntervalSeconds = 10;
constexpr int kKeepAliveProbes = 5;

using KeepAliveIdle = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPIDLE>;
using KeepAliveInterval = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPINTVL>;
using TypeOfService = asio::detail::socket_option::integer<IPPROTO_IP, IP_TOS>;
using KeepAliveProbes = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPCNT>;

std::string text(const asio::ip::address& address, std::uint16_t port) {
  return (address.is_v6() ? "[" + address.to_string() + "]" : address.to_string()) + ":" + std::to_string(port);
}

std::string refusal(const std::string& where, int error) {
  std::string sentence = "cannot listen on " + where + ": " + describe_errno(error);
  if (error == EADDRINUSE) sentence += " (another program listens there; choose another port, or 0 for a free one)";
  if (error == EACCES) sentence += " (ports below 1024 need root or CAP_NET_BIND_SERVICE; choose a higher one)";
  return sentence;
}

// An answer is complete in one write: waiting for more to put into the segment only delays it.
void set_options(tcp::socket& socket) {
  asio::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  socket.set_option(KeepAliveIdle(kKeepAliveIdleSeconds), ignored);
  socket.set_option(KeepAliveInterval(kKeepAliveIntervalSeconds), ignored);
  socket.set_option(KeepAliveProbes(kKeepAliveProbes), ignored);
}

}  // namespace

struct TcpListener::Impl : AcceptLoop<Impl, tcp> {
  Impl(EventLoop& l, std::size_t limit, OnAccept handler)
      : AcceptLoop(l), table(limit), on_accept(std::move(handler)) {}

  void take(tcp::socket socket) {
    asio::error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return;  // gone already
    if (!table.has_room()) {
      ++refused;
      return;
    }
    set_options(socket);
    const auto handler = on_accept;  // kept, should the handler destroy the listener
    handler(loop.now(), make_socket_stream(loop, std::move(socket), text(peer.address(), peer.port()), &table));
  }

  tcp::endpoint bound;
  ConnectionTable table;
  std::uint64_t refused = 0;
  OnAccept on_accept;
};

TcpListener::TcpListener(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

TcpListener::~TcpListener() {
  asio::error_code ignored;
  impl_->acceptor.close(ignored);
}

Result<std::unique_ptr<TcpListener>, std::string> TcpListener::open(EventLoop& loop, const TcpListenerOptions& options,
                                                                    OnAccept on_accept) {
  asio::error_code error;
  const asio::ip::address address =
      asio::ip::make_address(options.host == "localhost" ? "127.0.0.1" : options.host, error);
  if (error) {
    return Unexpected("cannot listen on \"" + options.host +
                      "\": not an IP address (give one of this machine's, such as 127.0.0.1 or ::1)");
  }
  const std::string where = text(address, options.port);
  auto impl = std::make_shared<Impl>(loop, options.max_connections, std::move(on_accept));
  const tcp::endpoint endpoint(address, options.port);
  impl->acceptor.open(endpoint.protocol(), error);
  if (error) return Unexpected(refusal(where, error.value()));
  // A restart must not wait for connections of the last run that are in TIME_WAIT.
  impl->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  // Accepted sockets have it from here.
  if (!error && options.dscp != 0) impl->acceptor.set_option(TypeOfService(options.dscp << 2), error);
  if (!error) impl->acceptor.bind(endpoint, error);
  if (!error) impl->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) impl->bound = impl->acceptor.local_endpoint(error);
  if (error) return Unexpected(refusal(where, error.value()));
  impl->accept();
  return std::unique_ptr<TcpListener>(new TcpListener(std::move(impl)));
}

std::string TcpListener::host() const { return impl_->bound.address().to_string(); }
std::uint16_t TcpListener::port() const { return impl_->bound.port(); }
std::size_t TcpListener::connections() const { return impl_->table.size(); }
std::uint64_t TcpListener::refused() const { return impl_->refused; }

}  // namespace vinv::transports
