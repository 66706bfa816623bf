// What an adapter has to send on its three sockets, in order, in memory that it keeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "option_boards/ethernet_ip/encapsulation.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/ipv4.hpp"

namespace vinv::ethernet_ip {

enum class Channel : std::uint8_t { kTcp, kUdp, kIo };  // TCP 44818, UDP 44818, UDP 2222
VINV_ENUM_RANGE(Channel, kTcp, kIo);

// One of an adapter's TCP connections; never 0, not used again soon after it is closed.
using TcpId = std::uint32_t;

struct Transmit {
  Channel channel = Channel::kTcp;
  TcpId connection = 0;   // kTcp
  Ipv4Endpoint to;        // kUdp, kIo
  std::uint8_t dscp = 0;  // differentiated services code point; of a TCP connection always the same
  ByteView bytes;         // valid until the next call of the engine
};

class OutQueue {
 public:
  // The owner drains the queue after each handle_; what one call can ask for fits easily. Beyond it answers are lost.
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{256} * 1024;

  // Bytes appended to the result until end() are one transmission.
  Bytes& begin() { return bytes_; }
  void end(Channel channel, TcpId connection, const Ipv4Endpoint& to) {
    if (bytes_.size() > kMaxQueuedBytes) {
      bytes_.resize(end_);
      return;
    }
    parts_.push_back({channel, connection, to, end_, bytes_.size() - end_});
    end_ = bytes_.size();
  }
  // Where the transmission that began starts in begin()'s bytes.
  std::size_t start() const { return end_; }

  std::optional<Transmit> poll() {
    if (next_ == parts_.size()) {
      parts_.clear();
      bytes_.clear();
      next_ = end_ = 0;
      return std::nullopt;
    }
    const Part& part = parts_[next_++];
    return Transmit{part.channel, part.connection, part.to, kExplicitDscp,
                    ByteView(bytes_).subspan(part.at, part.length)};
  }
  void drop_connection(TcpId connection) {
    for (std::size_t i = next_; i < parts_.size(); ++i)
      if (parts_[i].channel == Channel::kTcp && parts_[i].connection == connection) parts_[i].length = 0;
  }

 private:
  struct Part {
    Channel channel = Channel::kTcp;
    TcpId connection = 0;
    Ipv4Endpoint to;
    std::size_t at = 0;
    std::size_t length = 0;
    VINV_ARCHIVE(Part, channel, connection, to, at, length);
  };
  Bytes bytes_;
  std::vector<Part> parts_;
  std::size_t next_ = 0;
  std::size_t end_ = 0;

  friend void archive(Archive& a, OutQueue& queue) {
    VINV_MEMBERS(queue, bytes, parts, next, end);
    VINV_FIELDS(a, OutQueue, bytes, parts, next, end);
    a.require(end == bytes.size() && next <= parts.size(), "a queue is not what it says");
    for (const Part& part : parts)
      a.require(part.at <= bytes.size() && part.length <= bytes.size() - part.at, "a transmission is not in its queue");
  }
};

}  // namespace vinv::ethernet_ip
