// A node's view of a CAN bus: its controller and driver. The bus behind it may be ours (CanBus), a kernel interface
// (SocketCanPort) or somebody else's, reached over TCP or a serial adapter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "sim/base/can_frame.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"
#include "sim/transports/can/error_counters.hpp"

namespace vinv::transports {

// What became of a frame that was given to send().
enum class CanSend : std::uint8_t {
  kQueued,
  kDroppedOldest,  // queued, and the frame that waited longest was thrown away for it (CanQueuePolicy::kDropOldest)
  kRefusedFull,    // the queue holds its limit
  kRefusedState,   // bus off, offline or listen-only
};

enum class CanQueuePolicy : std::uint8_t { kRefuseNewest, kDropOldest };

struct CanStatus {
  CanState state = CanState::kErrorActive;
  CanErrorCounters counters;  // zero where the bus does not tell
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;  // frames refused, thrown away or flushed before they were sent
};

struct CanHandlers {
  // A frame of another node, at the end of its last bit.
  std::function<void(Instant now, const CanFrame& frame)> on_frame;
  // Our frame has been sent; the loopback of a driver. There may be room in the queue again.
  std::function<void(Instant now, const CanFrame& frame)> on_sent;
  std::function<void(Instant now, const CanStatus& status)> on_state;
};

class CanPort {
 public:
  // Frames that wait in one port, unless its options say less or more.
  static constexpr std::size_t kMaxQueuedFrames = 64;

  virtual ~CanPort() = default;
  // Handlers may send, set other handlers or destroy ports, this one too.
  virtual void set_handlers(CanHandlers handlers) = 0;
  // Never blocks and calls no handler. Frames of one port are sent in the order of their sending. The frame is well
  // formed.
  virtual CanSend send(Instant now, const CanFrame& frame) = 0;
  // Frames that send() takes now.
  virtual std::size_t queue_room() const = 0;
  // Throws away what waits; a frame that is on the wire already is completed.
  virtual void clear_queue() = 0;
  // Off: hears, acknowledges and sends nothing, as without power. On again: the counters start from zero. This and
  // set_bitrate() tell on_state before they return.
  virtual void set_online(Instant now, bool online) = 0;
  // The reason if the bus has its bit rate from elsewhere.
  virtual Result<void, std::string> set_bitrate(Instant now, std::uint32_t bitrate) = 0;
  virtual CanStatus status() const = 0;
  virtual std::string name() const = 0;
};

}  // namespace vinv::transports
