// Parameters of one PDO: COB-ID, transmission type, times, mapping. CiA DS-301 v4.0, 9.2.1, 9.5.4, 9.6.3.
// Objects 1400H, 1600H, 1800H, 1A00H and following.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "option_boards/canopen/abort_code.hpp"
#include "option_boards/canopen/nmt.hpp"
#include "option_boards/canopen/object_table.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::canopen {

inline constexpr std::size_t kMaxMapped = 8;  // objects of whole bytes
inline constexpr unsigned kMaxPdoLength = 8;  // bytes
inline constexpr std::uint32_t kCobIdInvalid = 1u << 31;
inline constexpr std::uint32_t kCobIdNoRtr = 1u << 30;
inline constexpr std::uint32_t kCobIdMask = 0x7ff;

enum class PdoDirection : std::uint8_t { kReceive, kTransmit };

// Transmission types.
inline constexpr std::uint8_t kAcyclicSynchronous = 0;
inline constexpr std::uint8_t kLastCyclicSynchronous = 240;
inline constexpr std::uint8_t kSynchronousRtrOnly = 252;
inline constexpr std::uint8_t kAsynchronousRtrOnly = 253;
inline constexpr std::uint8_t kAsynchronousManufacturer = 254;
constexpr bool is_synchronous(std::uint8_t type) { return type <= kLastCyclicSynchronous; }
constexpr bool is_event_driven(std::uint8_t type) { return type >= kAsynchronousManufacturer; }
// Types 241-251 are reserved; an RPDO cannot be RTR-only.
constexpr bool is_transmission_type(PdoDirection direction, std::uint8_t type) {
  if (is_synchronous(type) || is_event_driven(type)) return true;
  return direction == PdoDirection::kTransmit && (type == kSynchronousRtrOnly || type == kAsynchronousRtrOnly);
}

struct MappedObject {
  std::uint16_t row = 0;  // position in the table
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t size = 0;  // bytes
  friend constexpr bool operator==(const MappedObject&, const MappedObject&) = default;
  VINV_ARCHIVE(MappedObject, row, index, sub, size);
};

struct PdoSettings {
  std::uint32_t cob_id = kCobIdInvalid;  // with bits 31 (not valid) and 30 (no RTR)
  std::uint8_t transmission_type = 255;
  std::uint16_t inhibit_time = 0;  // 100 us
  std::uint8_t reserved = 0;       // sub-index 4
  std::uint16_t event_timer = 0;   // ms
  std::uint8_t mapped = 0;
  std::array<std::uint32_t, kMaxMapped> mapping{};  // index, sub-index, bits

  // Of the mapped objects, once the mapping is valid.
  std::array<MappedObject, kMaxMapped> objects{};
  std::uint8_t length = 0;

  bool valid() const { return (cob_id & kCobIdInvalid) == 0; }
  bool active() const { return valid() && mapped > 0; }
  bool has_id(std::uint32_t id) const { return active() && (cob_id & kCobIdMask) == id; }
  Duration inhibit() const { return std::chrono::microseconds(100) * inhibit_time; }
  Duration event_interval() const { return std::chrono::milliseconds(event_timer); }
  VINV_ARCHIVE(PdoSettings, cob_id, transmission_type, inhibit_time, reserved, event_timer, mapped, mapping, objects,
               length);
};

// What a COB-ID entry may hold: an 11-bit identifier that is free for it, and of the bits above only allowed_flags.
constexpr bool is_cob_id(std::uint32_t value, std::uint32_t allowed_flags) {
  if ((value & ~(kCobIdMask | allowed_flags)) != 0) return false;
  return (value & kCobIdInvalid) != 0 || !is_restricted(value & kCobIdMask);
}

// The object that a mapping entry names, if it may be mapped in this direction.
Result<MappedObject, AbortCode> resolve_mapping(const ObjectTable& table, PdoDirection direction, std::uint32_t entry);

}  // namespace vinv::canopen
