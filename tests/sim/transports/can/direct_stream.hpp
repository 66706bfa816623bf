// A stream whose far end is the test itself: what the session sends is kept up to a fixed length, so that nothing here
// allocates.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {

struct DirectEnd {
  ByteStream::OnBytes on_bytes;
  std::array<char, 256> last{};
  std::size_t size = 0;

  void say(Instant now, std::string_view text) {
    on_bytes(now, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, false);
  }
  std::string_view heard() const { return {last.data(), size}; }
};

class DirectStream : public ByteStream {
 public:
  explicit DirectStream(DirectEnd& end) : end_(end) {}
  void set_handlers(OnBytes on_bytes, OnClosed) override { end_.on_bytes = std::move(on_bytes); }
  void send(Instant, ByteView bytes) override {
    end_.size = std::min(bytes.size(), end_.last.size());
    std::copy_n(bytes.begin(), end_.size, end_.last.begin());
  }
  void close() override {}
  std::string name() const override { return "test"; }

 private:
  DirectEnd& end_;
};

}  // namespace vinv::transports
