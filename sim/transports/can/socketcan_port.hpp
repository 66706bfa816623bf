// A CAN interface of the Linux kernel: real hardware or vcan. Remote frames and error frames pass; our own frames come
// back as confirmation (CAN_RAW_RECV_OWN_MSGS), and other sockets of this machine get them too. An interface that goes
// down or disappears is looked for every kLookInterval; the port is offline meanwhile.
#pragma once

#include <memory>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/can/can_port.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

class SocketCanPort : public CanPort {
 public:
  static constexpr Duration kLookInterval = std::chrono::milliseconds(200);
  // When the interface's transmit queue is full.
  static constexpr Duration kRetryInterval = std::chrono::milliseconds(1);

  // Refusal: a sentence with what to do, also where the kernel has no CAN. An interface that is down is no refusal.
  // The loop outlives the port.
  static Result<std::unique_ptr<SocketCanPort>, std::string> open(EventLoop& loop, const std::string& interface);
  ~SocketCanPort() override;
  SocketCanPort(const SocketCanPort&) = delete;
  SocketCanPort& operator=(const SocketCanPort&) = delete;

  void set_handlers(CanHandlers handlers) override;
  CanSend send(Instant now, const CanFrame& frame) override;
  std::size_t queue_room() const override;
  void clear_queue() override;
  // Off: the interface itself stays as it is.
  void set_online(Instant now, bool online) override;
  // Refused: the system's administration sets it (ip link set NAME type can bitrate N).
  Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) override;
  CanStatus status() const override;
  std::string name() const override;

 private:
  struct Impl;
  explicit SocketCanPort(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
