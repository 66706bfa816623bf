// The handlers of a stream, safe against a handler that destroys its stream or sets other handlers while it runs.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

class StreamHandlers {
 public:
  void set(ByteStream::OnBytes on_bytes, ByteStream::OnClosed on_closed) {
    handlers_ = std::make_shared<const Handlers>(Handlers{std::move(on_bytes), std::move(on_closed)});
  }
  void clear() { handlers_.reset(); }
  bool are_set() const { return handlers_ != nullptr; }

  void bytes(Instant now, ByteView bytes, bool line_error) const {
    const auto keep = handlers_;
    if (keep && keep->on_bytes) keep->on_bytes(now, bytes, line_error);
  }
  // At most once: forgets the handlers.
  void closed(Instant now, const std::string& reason) {
    const auto keep = std::exchange(handlers_, nullptr);
    if (keep && keep->on_closed) keep->on_closed(now, reason);
  }

 private:
  struct Handlers {
    ByteStream::OnBytes on_bytes;
    ByteStream::OnClosed on_closed;
  };
  std::shared_ptr<const Handlers> handlers_;
};

}  // namespace vinv::transports
