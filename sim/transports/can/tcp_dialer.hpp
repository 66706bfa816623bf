// Keeps one TCP connection to a server: connects, and connects again kRetryInterval after it was lost or refused.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class TcpDialer {
 public:
  static constexpr Duration kRetryInterval = std::chrono::seconds(1);
  static constexpr Duration kConnectTimeout = std::chrono::seconds(5);

  // A new connection. Its owner calls lost() when it has ended.
  using OnConnect = std::function<void(Instant now, std::unique_ptr<ByteStream> stream)>;
  // Refusal: host is no IP address. Connecting begins in the loop. The loop outlives the dialer.
  static Result<std::unique_ptr<TcpDialer>, std::string> open(EventLoop& loop, const std::string& host,
                                                              std::uint16_t port, OnConnect on_connect);
  ~TcpDialer();
  TcpDialer(const TcpDialer&) = delete;
  TcpDialer& operator=(const TcpDialer&) = delete;

  void lost();
  // Why the last attempt failed; empty after a success.
  const std::string& error() const;

 private:
  struct Impl;
  explicit TcpDialer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
