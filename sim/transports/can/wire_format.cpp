#include "sim/transports/can/wire_format.hpp"

#include <algorithm>

#include "sim/base/check.hpp"

namespace vinv::transports {
namespace {

constexpr unsigned kStuffAfter = 5;

// Unstuffed, 118 bits at most.
class BitWriter {
 public:
  void put(std::uint32_t value, unsigned width) {
    for (unsigned i = width; i-- > 0;) bits_[count_++] = static_cast<std::uint8_t>(value >> i & 1);
  }
  std::span<const std::uint8_t> view() const { return {bits_.data(), count_}; }

 private:
  std::array<std::uint8_t, 118> bits_{};
  std::size_t count_ = 0;
};

}  // namespace

bool is_can_bitrate(std::uint32_t bitrate) {
  return std::find(kCanBitrates.begin(), kCanBitrates.end(), bitrate) != kCanBitrates.end();
}

std::uint16_t can_crc15(std::span<const std::uint8_t> bits) {
  std::uint16_t crc = 0;
  for (const std::uint8_t bit : bits) {
    const bool invert = (bit ^ (crc >> 14 & 1)) != 0;
    crc = static_cast<std::uint16_t>(crc << 1 & 0x7fff);
    if (invert) crc ^= 0x4599;
  }
  return crc;
}

bool is_well_formed(const CanFrame& frame) {
  return frame.length <= 8 && frame.id <= (frame.extended ? 0x1fffffffu : 0x7ffu);
}

CanWireBits can_wire_bits(const CanFrame& frame) {
  VINV_CHECK(is_well_formed(frame));
  BitWriter plain;
  const std::uint32_t rtr = frame.remote ? 1 : 0;
  plain.put(0, 1);  // start of frame
  if (frame.extended) {
    plain.put(frame.id >> 18, 11);
    plain.put(0b11, 2);  // SRR, IDE
    plain.put(frame.id & 0x3ffff, 18);
    plain.put(rtr, 1);
    plain.put(0b00, 2);  // r1, r0
  } else {
    plain.put(frame.id, 11);
    plain.put(rtr, 1);
    plain.put(0b00, 2);  // IDE, r0
  }
  plain.put(frame.length, 4);
  for (const std::uint8_t byte : frame.bytes()) plain.put(byte, 8);

  CanWireBits out;
  out.crc = can_crc15(plain.view());
  plain.put(out.crc, 15);

  unsigned run = 0;
  std::uint8_t last = 1;
  for (const std::uint8_t bit : plain.view()) {
    run = bit == last ? run + 1 : 1;
    last = bit;
    out.bits[out.count++] = bit;
    if (run < kStuffAfter) continue;
    last = bit ^ 1u;
    run = 1;
    out.bits[out.count++] = last;
    ++out.stuff_bits;
  }
  return out;
}

std::uint32_t can_arbitration_key(const CanFrame& frame) {
  const std::uint32_t rtr = frame.remote ? 1 : 0;
  if (!frame.extended) return frame.id << 21 | rtr << 20;
  return (frame.id >> 18) << 21 | 0b11u << 19 | (frame.id & 0x3ffff) << 1 | rtr;
}

}  // namespace vinv::transports
