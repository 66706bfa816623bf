// The control socket's protocol: JSON-RPC 2.0, one JSON text per line in both directions. Sans-I/O: bytes in, lines
// out. method is a command (commands.hpp); params {"drive": NAME, "value": VALUE} or {"drive": NAME, "words": [...]}.
//
// A client may send requests faster than they are executed, or a batch of them: the owner takes them one by one
// between the ticks of the plant, so that no client delays it by more than one request.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/rig/commands.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::rig {

class ControlSession {
 public:
  static constexpr std::size_t kMaxLineBytes = 64 * 1024;
  static constexpr std::size_t kMaxBatch = 256;  // requests in one JSON-RPC batch

  static constexpr std::size_t kMaxWaitingBytes = 1024 * 1024;  // of lines not executed yet

  explicit ControlSession(Plant& plant) : plant_(plant) {}
  // Takes bytes in; nothing is executed.
  void take_bytes(ByteView bytes);
  // Something waits to be executed or answered.
  bool has_work() const { return !lines_.empty() || batch_ || (broken_ && !farewell_.empty()); }
  // Executes the next request. What is to be sent then: whole lines, or nothing (a notification, a batch that goes on).
  std::string execute_next();
  // A limit was passed; what follows cannot be understood. Once there is no work the connection is to be closed.
  bool broken() const { return broken_; }

 private:
  struct Batch {
    Json requests;
    std::size_t next = 0;
    std::string answers;  // JSON texts, with commas between
  };

  void end_with(const std::string& message);
  std::string execute_line(const std::string& line);
  std::string execute_in_batch();
  // null for a notification.
  Json handle_request(const Json& request);

  Plant& plant_;
  std::string pending_;  // of the line that is not complete
  std::deque<std::string> lines_;
  std::size_t waiting_bytes_ = 0;  // in lines_
  std::optional<Batch> batch_;
  bool broken_ = false;
  std::string farewell_;  // the last line to a broken session
};

// Sessions over any byte streams, each with its own plant-wide rights.
class ControlServer {
 public:
  static constexpr std::size_t kMaxConnections = 128;

  explicit ControlServer(Plant& plant) : plant_(plant) {}
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;
  void accept(Instant now, std::unique_ptr<transports::ByteStream> stream);

 private:
  struct Connection {
    Connection(std::unique_ptr<transports::ByteStream> s, Plant& plant) : stream(std::move(s)), session(plant) {}
    std::unique_ptr<transports::ByteStream> stream;
    ControlSession session;
    bool closed = false;
    kernel::EventId next_request = 0;
  };
  void work(Instant now, Connection& connection);
  void retire(Connection& connection);

  Plant& plant_;
  std::vector<std::unique_ptr<Connection>> connections_;
};

}  // namespace vinv::rig
