#include "sim/transports/serial_packets.hpp"

#include "sim/transports/byte_stream.hpp"

namespace vinv::transports {
namespace {

// Event types of the RTAC serial header, seen from our end. All its numbers are big endian.
constexpr std::uint8_t kDataTxStart = 1;
constexpr std::uint8_t kDataRxStart = 2;

}  // namespace

void SerialPackets::bytes(Instant now, PacketDirection direction, ByteView bytes) {
  if (!pending_.empty() && (direction != direction_ || now - last_ > kFrameGap)) flush();
  if (pending_.empty()) {
    direction_ = direction;
    first_ = now;
  }
  last_ = now;
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  if (pending_.size() >= ByteStream::kMaxQueuedBytes) flush();
}

void SerialPackets::flush() {
  if (pending_.empty()) return;
  packet_.clear();
  const auto us = static_cast<std::uint64_t>(to_ns(first_) / 1000);
  append_be32(packet_, static_cast<std::uint32_t>(us / 1'000'000));
  append_be32(packet_, static_cast<std::uint32_t>(us % 1'000'000));
  packet_.push_back(direction_ == PacketDirection::kInbound ? kDataRxStart : kDataTxStart);
  packet_.push_back(0);  // control lines: none
  append_be16(packet_, 0);
  packet_.insert(packet_.end(), pending_.begin(), pending_.end());
  emit_(first_, packet_, direction_);
  pending_.clear();
}

}  // namespace vinv::transports
