#include "sim/transports/can/can_servers.hpp"

#include <map>
#include <utility>

#include "sim/transports/can/slcan_adapter.hpp"
#include "sim/transports/serial_pty.hpp"
#include "sim/transports/tcp_listener.hpp"

namespace vinv::transports {
namespace {

// The sessions of a listener by number. A session ends within its own handler and is safe against being destroyed
// there.
template <class Session>
struct Clients {
  template <class Make>
  void add(Make make) {
    const std::uint64_t number = ++last;
    sessions.emplace(number, make([this, number] { sessions.erase(number); }));
  }
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions;
  std::uint64_t last = 0;
};

TcpListenerOptions listener_options(const CanServerAddress& address) {
  TcpListenerOptions options;
  options.host = address.host;
  options.port = address.port;
  options.max_connections = kMaxCanClients;
  return options;
}

}  // namespace

struct SocketcandServer::Impl {
  SocketcandOptions options;
  Clients<SocketcandSession> clients;
  std::unique_ptr<TcpListener> listener;
};

SocketcandServer::SocketcandServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SocketcandServer::~SocketcandServer() = default;

Result<std::unique_ptr<SocketcandServer>, std::string> SocketcandServer::open(EventLoop& loop,
                                                                              const CanServerAddress& address,
                                                                              SocketcandOptions options) {
  auto impl = std::make_unique<Impl>();
  impl->options = std::move(options);
  auto listener = TcpListener::open(loop, listener_options(address),
                                    [&loop, raw = impl.get()](Instant now, std::unique_ptr<ByteStream> stream) {
                                      raw->clients.add([&](std::function<void()> on_end) {
                                        return std::make_unique<SocketcandSession>(
                                            loop.scheduler(), now, raw->options, std::move(stream), std::move(on_end));
                                      });
                                    });
  if (!listener) return Unexpected(listener.error());
  impl->listener = std::move(*listener);
  return std::unique_ptr<SocketcandServer>(new SocketcandServer(std::move(impl)));
}

std::string SocketcandServer::host() const { return impl_->listener->host(); }
std::uint16_t SocketcandServer::port() const { return impl_->listener->port(); }
std::size_t SocketcandServer::clients() const { return impl_->clients.sessions.size(); }

struct SlcanServer::Impl {
  Clients<SlcanAdapter> clients;
  std::unique_ptr<TcpListener> listener;
};

SlcanServer::SlcanServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SlcanServer::~SlcanServer() = default;

Result<std::unique_ptr<SlcanServer>, std::string> SlcanServer::open(EventLoop& loop, const CanServerAddress& address,
                                                                    CanBus& bus) {
  auto impl = std::make_unique<Impl>();
  auto listener = TcpListener::open(
      loop, listener_options(address), [&bus, raw = impl.get()](Instant, std::unique_ptr<ByteStream> stream) {
        raw->clients.add([&](std::function<void()> on_end) {
          return std::make_unique<SlcanAdapter>(bus, std::move(stream), std::move(on_end));
        });
      });
  if (!listener) return Unexpected(listener.error());
  impl->listener = std::move(*listener);
  return std::unique_ptr<SlcanServer>(new SlcanServer(std::move(impl)));
}

std::string SlcanServer::host() const { return impl_->listener->host(); }
std::uint16_t SlcanServer::port() const { return impl_->listener->port(); }
std::size_t SlcanServer::clients() const { return impl_->clients.sessions.size(); }

struct SlcanPty::Impl {
  std::string path;
  std::unique_ptr<SlcanAdapter> adapter;
};

SlcanPty::SlcanPty(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SlcanPty::~SlcanPty() = default;

Result<std::unique_ptr<SlcanPty>, std::string> SlcanPty::open(EventLoop& loop, const std::string& link, CanBus& bus) {
  SerialPtyOptions options;
  options.link = link;
  auto line = SerialPty::open(loop, options);
  if (!line) return Unexpected(line.error());
  auto impl = std::make_unique<Impl>();
  impl->path = (*line)->name();
  impl->adapter = std::make_unique<SlcanAdapter>(bus, std::move(*line), nullptr);
  return std::unique_ptr<SlcanPty>(new SlcanPty(std::move(impl)));
}

std::string SlcanPty::path() const { return impl_->path; }

}  // namespace vinv::transports
