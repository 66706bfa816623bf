// Explicit messages of an EtherNet/IP scanner: what is asked, what comes of it, and the wishes of a Forward_Open. CIP
// Vol 1, 2-4 (message router), 3-5.5 (Connection Manager).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::masters {

struct CipAsk {
  std::uint8_t service = 0x0e;
  Bytes path;  // padded EPATH, whole words
  Bytes data;
  bool connected = false;  // over the class 3 connection, which is opened when there is none
  VINV_ARCHIVE(CipAsk, service, path, data, connected);
};
inline constexpr std::uint8_t kGetAttributeSingle = 0x0e, kSetAttributeSingle = 0x10;
// Logical segments of 8 or 16 bit; without attribute if it is 0.
Bytes object_path(std::uint16_t class_id, std::uint16_t instance, std::uint16_t attribute);

struct CipFailure {
  enum class Kind : std::uint8_t { kStatus, kTimeout, kNotConnected, kEncapsulation };
  friend VINV_ENUM_RANGE(Kind, kStatus, kEncapsulation);
  Kind kind = Kind::kNotConnected;
  std::uint8_t general = 0;             // kStatus
  std::vector<std::uint16_t> extended;  // kStatus
  std::uint32_t encapsulation = 0;      // kEncapsulation
  friend bool operator==(const CipFailure&, const CipFailure&) = default;
  VINV_ARCHIVE(CipFailure, kind, general, extended, encapsulation);
};
// "general status 01, extended status 0106 (ownership conflict)", "no answer".
std::string text_of(const CipFailure& failure);

// The data of the answer.
using CipAnswer = Result<Bytes, CipFailure>;
using CipAskId = std::uint32_t;
struct CipResult {
  CipAskId id = 0;
  CipAnswer answer = Unexpected(CipFailure{});
  VINV_ARCHIVE(CipResult, id, answer);
};

// An I/O connection of class 1 (or 0) as its scanner wants it.
struct IoWish {
  std::uint32_t output_point = 21;  // what the device consumes; a heartbeat point if it takes no data
  std::uint32_t input_point = 71;   // what it produces
  std::uint16_t output_size = 4;    // bytes of data, without sequence count and header
  std::uint16_t input_size = 4;
  bool run_idle_header = true;  // O->T; without it an empty packet means idle
  Duration output_rpi = std::chrono::milliseconds(10);
  Duration input_rpi = std::chrono::milliseconds(10);
  std::uint8_t timeout_multiplier = 0;  // raw: times out after 4 << multiplier intervals
  bool multicast = false;               // T->O
  std::uint8_t trigger = 0;             // 0 cyclic, 1 change of state, 2 application
  std::uint8_t transport_class = 1;     // 0 or 1
  Bytes key;                            // electronic key segment; empty: none
  bool large = false;                   // Large_Forward_Open
  friend bool operator==(const IoWish&, const IoWish&) = default;
  VINV_ARCHIVE(IoWish, output_point, input_point, output_size, input_size, run_idle_header, output_rpi, input_rpi,
               timeout_multiplier, multicast, trigger, transport_class, key, large);
};

}  // namespace vinv::masters
