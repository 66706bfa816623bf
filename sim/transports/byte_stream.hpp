// Ports for bytes. A rig sees a stream (one TCP connection, one serial line) and does not know what carries it;
// recorder and fault injector are streams around a stream; a scenario uses in-memory pairs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim/base/bytes.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

class ByteStream {
 public:
  // line_error: a parity, framing or speed error somewhere in these bytes (serial lines only).
  using OnBytes = std::function<void(Instant now, ByteView bytes, bool line_error)>;
  // The other end is gone, or was disconnected at a named limit. Called once; the stream sends nothing after it.
  using OnClosed = std::function<void(Instant now, const std::string& reason)>;

  virtual ~ByteStream() = default;
  virtual void set_handlers(OnBytes on_bytes, OnClosed on_closed) = 0;
  // Never blocks. What the peer does not take is queued up to kMaxQueuedBytes; beyond it the peer is disconnected.
  static constexpr std::size_t kMaxQueuedBytes = 64 * 1024;
  virtual void send(Instant now, ByteView bytes) = 0;
  virtual void close() = 0;
  // "127.0.0.1:40312", "/dev/pts/5".
  virtual std::string name() const = 0;
  // Of a line in memory that snapshots hold (memory_streams.hpp), also from what is around such a stream; 0: none.
  virtual std::uint32_t end_number() const { return 0; }
};

using OnAccept = std::function<void(Instant now, std::unique_ptr<ByteStream> stream)>;

}  // namespace vinv::transports
