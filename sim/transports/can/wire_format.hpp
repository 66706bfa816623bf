// A CAN frame as bits on the wire: ISO 11898-1:2015, 10.4.2 (data frame), 10.4.3 (remote frame), 10.5 (bit stuffing),
// 10.4.2.6 (CRC). Classical frames only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/base/can_frame.hpp"
#include "sim/base/time.hpp"

namespace vinv::transports {

// The bit rates of CANopen devices (CiA 301, table 1, and 62.5k and 100k besides), in bit/s.
inline constexpr std::array<std::uint32_t, 8> kCanBitrates = {20'000,  50'000,  62'500,  100'000,
                                                              125'000, 250'000, 500'000, 1'000'000};
bool is_can_bitrate(std::uint32_t bitrate);
// Rounded to the nanosecond, which is exact for all of kCanBitrates.
constexpr Duration can_bit_time(std::uint32_t bitrate) { return Duration{(1'000'000'000 + bitrate / 2) / bitrate}; }

// Bits after the CRC sequence, which are not stuffed: CRC delimiter, ACK slot, ACK delimiter, end of frame.
inline constexpr unsigned kCanTrailerBits = 1 + 1 + 1 + 7;
inline constexpr unsigned kCanIntermissionBits = 3;

// CRC-15 of a sequence of bits (each 0 or 1), most significant first. Polynomial 0x4599, initial value 0.
std::uint16_t can_crc15(std::span<const std::uint8_t> bits);

// From start of frame to the last bit of the CRC sequence.
struct CanWireBits {
  static constexpr std::size_t kMaxBits = 118 + 29;  // extended frame with 8 bytes, stuffed at worst
  std::array<std::uint8_t, kMaxBits> bits{};         // stuffed; 0 is dominant
  unsigned count = 0;
  unsigned stuff_bits = 0;  // of count
  std::uint16_t crc = 0;

  std::span<const std::uint8_t> view() const { return {bits.data(), count}; }
  // From start of frame to the last bit of end of frame, without intermission.
  unsigned frame_bits() const { return count + kCanTrailerBits; }
};
// The frame is well formed: identifier within 11 or 29 bits, length at most 8.
CanWireBits can_wire_bits(const CanFrame& frame);
bool is_well_formed(const CanFrame& frame);

// The arbitration field as a number: of frames that start together the one with the lowest wins. Equal only if
// identifier, format and RTR are equal.
std::uint32_t can_arbitration_key(const CanFrame& frame);

}  // namespace vinv::transports
