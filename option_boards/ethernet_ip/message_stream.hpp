// Encapsulation messages out of the bytes of one TCP connection. Copies nothing when a message comes whole.
#pragma once

#include <cstddef>
#include <optional>

#include "option_boards/ethernet_ip/encapsulation.hpp"
#include "sim/base/time.hpp"

namespace vinv::ethernet_ip {

// A message that has begun must be complete this long afterwards; otherwise the connection is closed.
inline constexpr Duration kPartialMessageTimeout = std::chrono::seconds(10);

struct EncapsulationMessage {
  EncapsulationHeader header;
  ByteView data;
  bool oversized = false;  // more than kMaxEncapsulatedData was announced: data is empty, the bytes are skipped
};

class MessageStream {
 public:
  // Takes bytes from the front until there is a message; empty: all are used up. The message's data lives as long as
  // the bytes do and until the next call.
  std::optional<EncapsulationMessage> take(Instant now, ByteView& bytes);
  // Restarts with each message that begins; empty between messages.
  std::optional<Instant> deadline() const { return deadline_; }

 private:
  Bytes partial_;
  std::size_t done_ = 0;  // bytes of partial_ that were given out and go with the next call
  std::size_t skip_ = 0;  // of an oversized message, still to come
  std::optional<Instant> deadline_;

  friend void archive(Archive& a, MessageStream& stream) {
    VINV_MEMBERS(stream, partial, done, skip, deadline);
    VINV_FIELDS(a, MessageStream, partial, done, skip, deadline);
    a.require(partial.size() <= kEncapsulationHeader + kMaxEncapsulatedData && (done == 0 || done == partial.size()),
              "a message is longer than it may be");
  }
};

}  // namespace vinv::ethernet_ip
