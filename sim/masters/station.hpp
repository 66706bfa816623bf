// A master on a wire in virtual time: a protocol client, its wire and its alarm clock on a scheduler. It carries out
// the words of a drive engineer, one order at a time, sends and hears raw frames, and tells what passes on its wire.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/masters/profile.hpp"
#include "sim/masters/word_runner.hpp"

namespace vinv::masters {

// A frame of the master's own wire. Serial line: the bytes of a frame; TCP: what came in one piece, an ADU; CAN: the
// identifier with the flags of SocketCAN (bit 31 extended, bit 30 remote) in four bytes, the highest first, then the
// data; a remote frame has as many zeros as it asks for bytes.
struct WireFrame {
  Instant at;
  bool sent = false;  // by this master
  Bytes bytes;
  std::uint32_t connection = 0;  // tells the TCP connections of a plant apart
};

class Station {
 public:
  static constexpr std::size_t kMaxFrames = 4096;  // that nobody takes; then the oldest are lost

  explicit Station(kernel::Scheduler& scheduler) : scheduler_(scheduler) {}
  virtual ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  // An order under way is replaced without an outcome. The profile is for the board at the order's node.
  void begin(Instant now, const BoardProfile& profile, const Order& order);
  // The outcome of what was begun, once.
  std::optional<Outcome> poll() { return runner().poll(); }

  // A frame as it is. False if it is none: a CAN frame of the wrong length; or there is no connection.
  virtual bool send_frame(Instant now, ByteView frame) = 0;
  // What arrived since the last call, oldest first.
  std::vector<Bytes> take_frames();

  // Master silence, as of a PLC in stop: nothing goes out, and what comes is not heard, though the wire sees it.
  void set_silent(Instant now, bool silent);
  bool silent() const { return silent_; }

  // Snapshots (docs/decisions/0005-snapshots.md), not from within a handler: after the scheduler and what carries the
  // wire. A load is for a station made alike, before the plant was loaded; on_wire() stays.
  virtual void archive(Archive& a);

  void on_wire(std::function<void(const WireFrame&)> handler) { on_wire_ = std::move(handler); }
  kernel::Scheduler& scheduler() { return scheduler_; }

 protected:
  virtual WordRunner& runner() = 0;
  // Sends what is due, takes results, advances the runner; empty: nothing is due any more.
  virtual std::optional<Instant> work(Instant now) = 0;
  // After anything that happened.
  void settle(Instant now);
  void log(Instant now, bool sent, Bytes bytes, std::uint32_t connection = 0);

 private:
  void wake(Instant now);

  kernel::Scheduler& scheduler_;
  kernel::EventId wake_event_ = 0;
  std::optional<Instant> wake_at_;
  bool settling_ = false;
  bool silent_ = false;
  std::vector<Bytes> frames_;
  std::function<void(const WireFrame&)> on_wire_;
};

}  // namespace vinv::masters
