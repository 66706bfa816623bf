// The control socket's protocol: JSON-RPC 2.0, one JSON text per line in both directions. Sans-I/O: bytes in, lines
// out. method is a command (commands.hpp); params {"drive": NAME, "value": VALUE} or {"drive": NAME, "words": [...]}.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/rig/commands.hpp"
#include "sim/transports/byte_stream.hpp"

namespace vinv::rig {

class ControlSession {
 public:
  static constexpr std::size_t kMaxLineBytes = 64 * 1024;
  static constexpr std::size_t kMaxBatch = 256;  // requests in one JSON-RPC batch

  explicit ControlSession(Plant& plant) : plant_(plant) {}
  // Answers to whole lines in these bytes, each with its newline; empty for notifications.
  std::string handle_bytes(ByteView bytes);
  // A line was longer than allowed; what follows cannot be understood and the connection is to be closed.
  bool broken() const { return broken_; }

 private:
  std::string handle_line(const std::string& line);
  // null for a notification.
  Json handle_request(const Json& request);

  Plant& plant_;
  std::string pending_;
  bool broken_ = false;
};

// Sessions over any byte streams, each with its own plant-wide rights.
class ControlServer {
 public:
  static constexpr std::size_t kMaxConnections = 64;

  explicit ControlServer(Plant& plant) : plant_(plant) {}
  void accept(Instant now, std::unique_ptr<transports::ByteStream> stream);

 private:
  struct Connection {
    Connection(std::unique_ptr<transports::ByteStream> s, Plant& plant) : stream(std::move(s)), session(plant) {}
    std::unique_ptr<transports::ByteStream> stream;
    ControlSession session;
    bool closed = false;
  };
  void retire(Connection& connection);

  Plant& plant_;
  std::vector<std::unique_ptr<Connection>> connections_;
};

}  // namespace vinv::rig
