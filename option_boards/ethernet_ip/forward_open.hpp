// Requests of the Connection Manager as they travel. CIP Vol 1, 3-5.5.2 (Forward_Open), 3-5.5.3 (Forward_Close),
// 3-5.6 (connection path).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "option_boards/cip/epath.hpp"
#include "option_boards/cip/status.hpp"
#include "option_boards/ethernet_ip/connection_status.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::ethernet_ip {

enum class ConnectionType : std::uint8_t { kNull = 0, kMulticast = 1, kPointToPoint = 2, kReserved = 3 };
VINV_ENUM_RANGE(ConnectionType, kNull, kReserved);
enum class Priority : std::uint8_t { kLow = 0, kHigh = 1, kScheduled = 2, kUrgent = 3 };
VINV_ENUM_RANGE(Priority, kLow, kUrgent);
enum class Trigger : std::uint8_t { kCyclic = 0, kChangeOfState = 1, kApplication = 2 };
VINV_ENUM_RANGE(Trigger, kCyclic, kApplication);

// One direction's network connection parameters: a word, or a double word in Large_Forward_Open.
struct NetworkParameters {
  std::uint16_t size = 0;  // bytes, with sequence count and run/idle header; the largest if variable
  bool variable = false;
  Priority priority = Priority::kLow;
  ConnectionType type = ConnectionType::kNull;
  bool redundant_owner = false;
  VINV_ARCHIVE(NetworkParameters, size, variable, priority, type, redundant_owner);
};
NetworkParameters network_parameters(std::uint16_t word);
NetworkParameters large_network_parameters(std::uint32_t word);

// What names a connection (3-5.5.2): a close or a further open that has the same three means this connection.
struct ConnectionTriad {
  std::uint16_t serial = 0;
  std::uint16_t vendor_id = 0;  // of the originator, as is the next
  std::uint32_t originator_serial = 0;
  friend constexpr bool operator==(const ConnectionTriad&, const ConnectionTriad&) = default;
  VINV_ARCHIVE(ConnectionTriad, serial, vendor_id, originator_serial);
};

struct ForwardOpen {
  std::uint32_t o2t_id = 0;  // the originator's proposals
  std::uint32_t t2o_id = 0;
  ConnectionTriad triad;
  std::uint8_t timeout_multiplier = 0;  // raw: times out after 4 << multiplier intervals
  Duration o2t_rpi{};                   // whole microseconds
  NetworkParameters o2t;
  Duration t2o_rpi{};
  NetworkParameters t2o;
  std::uint8_t transport = 0;  // raw: direction, trigger, class
  ByteView path;

  bool is_server() const { return (transport & 0x80) != 0; }
  std::uint8_t trigger() const { return transport >> 4 & 7; }
  std::uint8_t transport_class() const { return transport & 0x0f; }
  bool is_null() const { return o2t.type == ConnectionType::kNull && t2o.type == ConnectionType::kNull; }
};

// kNotEnoughData or kTooMuchData, by the path's size.
Result<ForwardOpen, cip::GeneralStatus> parse_forward_open(ByteView data, bool large);

struct ForwardClose {
  ConnectionTriad triad;
  ByteView path;
};
Result<ForwardClose, cip::GeneralStatus> parse_forward_close(ByteView data);

// What a connection path says. Views into the path.
struct ConnectionPath {
  static constexpr std::size_t kMaxPoints = 3;

  std::optional<cip::ElectronicKey> key;
  std::optional<Duration> inhibit_time;  // production inhibit time segment
  std::optional<std::uint16_t> class_id;
  // Instances and connection points in their order: configuration, consumed, produced, or the last two.
  std::array<std::uint32_t, kMaxPoints> points{};
  std::size_t point_count = 0;
  ByteView configuration;  // of the data segment
};
Result<ConnectionPath, ConnectionStatus> parse_connection_path(ByteView path);

}  // namespace vinv::ethernet_ip
