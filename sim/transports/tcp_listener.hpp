// Listens on one TCP address. Every connection becomes a ByteStream; beyond a limit the newcomer is refused and the
// oldest stay, so that a client that leaks connections cannot push out the one that works.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

struct TcpListenerOptions {
  static constexpr std::size_t kMaxConnections = 256;

  std::string host = "127.0.0.1";  // an IPv4 or IPv6 address, or localhost
  std::uint16_t port = 0;          // 0: a free one, see TcpListener::port()
  std::size_t max_connections = kMaxConnections;
  std::uint8_t dscp = 0;  // of what is sent over its connections, the handshake included (IPv4)
};

class TcpListener {
 public:
  // on_accept runs on the loop's thread. Refusal: a sentence that names the address and the reason. The loop outlives
  // the listener; accepted streams may outlive it.
  static Result<std::unique_ptr<TcpListener>, std::string> open(EventLoop& loop, const TcpListenerOptions& options,
                                                                OnAccept on_accept);
  ~TcpListener();
  TcpListener(const TcpListener&) = delete;
  TcpListener& operator=(const TcpListener&) = delete;

  std::string host() const;
  std::uint16_t port() const;  // the bound one
  std::size_t connections() const;
  std::uint64_t refused() const;  // newcomers at the limit

 private:
  struct Impl;
  explicit TcpListener(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
