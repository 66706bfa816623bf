// A connected stream socket (TCP or Unix) as a ByteStream, and the table of a listener's connections.
//
// A peer that ends its sending direction may still want its answers (`printf ... | socat - TCP:...`), which cannot be
// told from one that closed altogether: the stream sends on for kHalfCloseGrace and reports the end then, or as soon as
// the peer resets it or the listener needs its place.
#pragma once

#include <asio/generic/stream_protocol.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sim/transports/byte_stream.hpp"
#include "sim/transports/event_loop.hpp"

namespace vinv::transports {

inline constexpr Duration kHalfCloseGrace = std::chrono::milliseconds(500);
// Read at most this much of one stream before other sockets and events have their turn.
inline constexpr std::size_t kBytesPerWakeUp = 2048;

class SocketSession;

// The connections of one listener that take a place, oldest first.
class ConnectionTable {
 public:
  explicit ConnectionTable(std::size_t limit) : limit_(limit) {}
  // Makes room by ending a half-closed connection if need be; false if all places are in use.
  bool has_room();
  void add(const std::shared_ptr<SocketSession>& session);
  std::size_t size();

 private:
  void prune();
  std::size_t limit_;
  std::vector<std::weak_ptr<SocketSession>> sessions_;
};

// Takes a connected socket; table may be null. The stream starts to read when its handlers are set. A peer that leaves
// more than max_queued bytes unread is disconnected.
std::unique_ptr<ByteStream> make_socket_stream(EventLoop& loop, asio::generic::stream_protocol::socket socket,
                                               std::string name, ConnectionTable* table,
                                               std::size_t max_queued = ByteStream::kMaxQueuedBytes);

}  // namespace vinv::transports
