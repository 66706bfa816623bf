// A node on a bus behind an slcan adapter: a USB adapter's tty, or an slcan server on TCP. Adapters differ in whether
// and what they answer, so answers are not waited for: a frame counts as sent when the adapter has it, and a BEL is
// counted as a lost frame.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/can/remote_port.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class SlcanClient : public RemotePort {
 public:
  // How often the adapter's status flags (F) are asked for.
  static constexpr Duration kStatusInterval = std::chrono::seconds(1);

  // All refuse with a sentence; the loop or scheduler outlives the client. The rate is one that slcan_bitrate_command()
  // knows. A tty or server that vanishes is looked for and set up again.
  static Result<std::unique_ptr<SlcanClient>, std::string> open_tty(EventLoop& loop, const std::string& path,
                                                                    std::uint32_t baud, std::uint32_t bitrate);
  static Result<std::unique_ptr<SlcanClient>, std::string> open_tcp(EventLoop& loop, const std::string& host,
                                                                    std::uint16_t port, std::uint32_t bitrate);
  static Result<std::unique_ptr<SlcanClient>, std::string> open_stream(kernel::Scheduler& scheduler, Instant now,
                                                                       std::unique_ptr<ByteStream> stream,
                                                                       std::uint32_t bitrate);
  ~SlcanClient() override;

  // Closes and opens the adapter's channel.
  void set_online(Instant now, bool online) override;
  Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) override;
  std::string name() const override;

 private:
  struct Impl;
  explicit SlcanClient(std::shared_ptr<Impl> impl);
  bool hand_over(Instant now, const CanFrame& frame) override;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
