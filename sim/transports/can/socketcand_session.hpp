// One client of a socketcand server: a node on a bus, for the text that comes over a stream. Also in virtual time.
//
// States and answers are those of the linux-can/socketcand server: < hi > on connecting; < open NAME > and then the
// modes, each answered < ok >; frames are sent to the client in raw mode. < send > and < sendrtr > work in bcm mode
// too; the cyclic jobs, filters, statistics and ISO-TP of that server are answered as unknown commands.
//
// Deviation, for python-can 4.1: it reads an < ok > literally, so frames wait after one until the client says something
// or kAfterOk has passed; and when a read ends within a message it loses the first character of that message, so each
// frame is preceded by a blank.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/socketcand_text.hpp"

namespace vinv::transports {

// What a client names in < open >, and the bus behind it.
struct SocketcandBus {
  std::string name;
  CanBus* bus = nullptr;
};

struct SocketcandOptions {
  // The only bus of a server is opened by any name: a master's configuration says vcan0 or can0 and seldom more.
  std::vector<SocketcandBus> buses;
  // What simulated zero is in the time stamps, in nanoseconds since 1970.
  std::int64_t start_unix_ns = 0;
};

class SocketcandSession {
 public:
  // Frames of a client that wait for the bus; beyond it they are refused with an error message.
  static constexpr std::size_t kMaxQueuedFrames = 512;
  static constexpr std::size_t kMaxBusNameBytes = 15;  // of a network interface
  static constexpr Duration kAfterOk = std::chrono::milliseconds(20);

  // Scheduler, options and buses outlive the session. on_end is called once, from within the stream's handlers, when
  // the session has nothing more to do; it may destroy the session.
  SocketcandSession(kernel::Scheduler& scheduler, Instant now, const SocketcandOptions& options,
                    std::unique_ptr<ByteStream> stream, std::function<void()> on_end);
  ~SocketcandSession();
  SocketcandSession(const SocketcandSession&) = delete;
  SocketcandSession& operator=(const SocketcandSession&) = delete;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
