// A node on a bus that a socketcand server serves: ours of another process, or the linux-can project's. What the server
// does not tell stays unknown: a frame counts as sent when the server has it, and bit rate and counters are its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/can/remote_port.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class SocketcandClient : public RemotePort {
 public:
  // Connects, and again whenever the connection is lost; offline meanwhile. Refusal: a sentence. The loop outlives it.
  static Result<std::unique_ptr<SocketcandClient>, std::string> open(EventLoop& loop, const std::string& host,
                                                                     std::uint16_t port, const std::string& bus);
  // On a stream that is there already; offline for good when it ends. The scheduler outlives it.
  SocketcandClient(kernel::Scheduler& scheduler, const std::string& bus, std::unique_ptr<ByteStream> stream);
  ~SocketcandClient() override;

  void set_online(Instant now, bool online) override;
  Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) override;
  std::string name() const override;
  // What the server complained of last, or why there is no connection; empty if nothing.
  std::string error() const;

 private:
  struct Impl;
  explicit SocketcandClient(std::shared_ptr<Impl> impl);
  bool hand_over(Instant now, const CanFrame& frame) override;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
