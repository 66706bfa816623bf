// What the Connection Manager keeps of a connection, and of a stream of packets that it sends. CIP Vol 1, 3-4; Vol 2,
// 3-4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "option_boards/cip/io_points.hpp"
#include "option_boards/ethernet_ip/forward_open.hpp"
#include "option_boards/ethernet_ip/out_queue.hpp"

namespace vinv::cip {
VINV_ENUM_RANGE(IoRole, kExclusiveOwner, kListenOnly);
VINV_ENUM_RANGE(RunMode, kRun, kIdle);
}  // namespace vinv::cip

namespace vinv::ethernet_ip {

enum class TransportClass : std::uint8_t { kClass0 = 0, kClass1 = 1, kClass3 = 3 };
VINV_ENUM_RANGE(TransportClass, kClass0, kClass3);

// What stands before the data of an I/O packet (Vol 1, 3-6.1). Without a header an empty packet means idle; a heartbeat
// is a packet of a point that has no data.
enum class RealTimeFormat : std::uint8_t { kModeless, kHeader32 };
VINV_ENUM_RANGE(RealTimeFormat, kModeless, kHeader32);

struct ConnectionOptions {
  std::size_t io_connections = 16;
  std::size_t explicit_connections = 16;
  // A drive has one run command: one more owner is kOwnershipConflict, whichever points it names.
  std::size_t exclusive_owners = 1;
  Duration shortest_rpi = std::chrono::milliseconds(1);  // of I/O; explicit connections have no least interval
  Duration longest_rpi = std::chrono::seconds(3200);
  // Formats that each direction may have.
  bool o2t_header = true, o2t_modeless = true;
  bool t2o_header = true, t2o_modeless = true;
  std::uint16_t largest_explicit = 4002;
  // Differentiated services code points of I/O packets by Priority (Vol 2, 5-6.4.2); all 0 for a device without QoS
  // object.
  std::array<std::uint8_t, 4> dscp = {31, 43, 47, 55};
};

inline constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

struct Connection {
  bool open = false;
  ConnectionTriad triad;
  TransportClass transport = TransportClass::kClass1;
  Trigger trigger = Trigger::kCyclic;
  cip::IoRole role = cip::IoRole::kExclusiveOwner;  // classes 0 and 1
  std::uint32_t configuration_point = 0, consumed_point = 0, produced_point = 0;
  Bytes configuration;  // as its originator gave it
  std::uint32_t o2t_id = 0, t2o_id = 0;
  std::uint32_t originator = 0;  // IPv4 address
  TcpId tcp = 0;                 // over which it was opened; class 3 lives and dies with it
  NetworkParameters o2t, t2o;
  RealTimeFormat o2t_format = RealTimeFormat::kModeless;
  Duration o2t_rpi{}, t2o_rpi{}, t2o_api{};
  std::uint8_t timeout_multiplier = 0;
  Instant expires_at{};  // restarts from each packet of the originator that counts

  // classes 0 and 1: from the originator
  std::size_t consumed_size = 0;
  bool synchronized = false;        // a packet has come
  std::uint32_t last_sequence = 0;  // of the sequenced address
  std::uint16_t last_count = 0;     // class 1, in front of the data
  cip::RunMode mode = cip::RunMode::kIdle;
  std::size_t producer = kNone;

  // class 3
  std::optional<std::uint16_t> last_request;  // sequence count
  Bytes last_reply;                           // message; empty while it is awaited

  VINV_ARCHIVE(Connection, open, triad, transport, trigger, role, configuration_point, consumed_point, produced_point,
               configuration, o2t_id, t2o_id, originator, tcp, o2t, t2o, o2t_format, o2t_rpi, t2o_rpi, t2o_api,
               timeout_multiplier, expires_at, consumed_size, synchronized, last_sequence, last_count, mode, producer,
               last_request, last_reply);
};

// Packets of one point to one destination; several connections share one if it is multicast.
struct Producer {
  std::size_t users = 0;  // 0: free
  std::uint32_t connection_id = 0;
  Ipv4Endpoint to;
  bool multicast = false;
  std::uint32_t point = 0;
  std::size_t data_size = 0;
  NetworkParameters parameters;
  RealTimeFormat format = RealTimeFormat::kModeless;
  TransportClass transport = TransportClass::kClass1;
  Trigger trigger = Trigger::kCyclic;
  Duration api{};
  Duration inhibit_time{};
  // Cyclic: the previous one plus the interval. Other triggers: restarts from each packet.
  Instant next_at{};
  bool fresh = false;         // other triggers: there is something new, to be sent when the inhibit time is over
  Instant inhibited_until{};  // from each packet
  std::uint32_t version = 0;  // of the data that was sent or is to be sent
  std::uint32_t sequence = 0;
  std::uint16_t count = 0;

  VINV_ARCHIVE(Producer, users, connection_id, to, multicast, point, data_size, parameters, format, transport, trigger,
               api, inhibit_time, next_at, fresh, inhibited_until, version, sequence, count);
};

}  // namespace vinv::ethernet_ip
