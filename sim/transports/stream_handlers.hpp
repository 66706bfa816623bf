// The handlers of a stream, safe against a handler that destroys its stream or sets other handlers while it runs.
#pragma once

#include <string>
#include <utility>

#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

class StreamHandlers {
 public:
  StreamHandlers() = default;
  ~StreamHandlers() { clear(); }
  StreamHandlers(const StreamHandlers&) = delete;
  StreamHandlers& operator=(const StreamHandlers&) = delete;

  void set(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed) {
    clear();
    handlers_ = new Handlers{std::move(on_bytes), std::move(on_closed)};
  }
  void clear() {
    if (handlers_ != nullptr) let_go(std::exchange(handlers_, nullptr));
  }
  bool are_set() const { return handlers_ != nullptr; }

  // Nothing of this object, nor of its owner, is touched after the handler: either may be gone.
  void bytes(Instant now, ByteView bytes, bool line_error) const {
    if (handlers_ == nullptr || !handlers_->on_bytes) return;
    const Hold hold(*handlers_);
    hold.handlers.on_bytes(now, bytes, line_error);
  }
  // At most once: forgets the handlers.
  void closed(Instant now, const std::string& reason) {
    if (handlers_ == nullptr) return;
    const Hold hold(*handlers_);
    clear();
    if (hold.handlers.on_closed) hold.handlers.on_closed(now, reason);
  }

 private:
  // Counted here and not by a shared_ptr, whose count is atomic, twice for each message: streams are of one thread.
  struct Handlers {
    ByteStream::OnBytes on_bytes;
    ByteStream::OnClosed on_closed;
    unsigned holders = 1;
  };
  static void let_go(Handlers* handlers) {
    if (--handlers->holders == 0) delete handlers;
  }
  struct Hold {
    explicit Hold(Handlers& held) : handlers(held) { ++handlers.holders; }
    ~Hold() { let_go(&handlers); }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
    Handlers& handlers;
  };
  Handlers* handlers_ = nullptr;
};

}  // namespace vinv::transports
