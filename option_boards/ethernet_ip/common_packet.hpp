// The common packet format: a count, then items of type, length and data. CIP Vol 2, 2-6.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/base/bytes.hpp"
#include "sim/base/ipv4.hpp"
#include "sim/base/result.hpp"

namespace vinv::ethernet_ip {

// Vol 2, table 2-6.3.
enum class ItemType : std::uint16_t {
  kNullAddress = 0x0000,
  kListIdentityResponse = 0x000c,
  kConnectedAddress = 0x00a1,
  kConnectedData = 0x00b1,
  kUnconnectedData = 0x00b2,
  kListServicesResponse = 0x0100,
  kSockaddrO2t = 0x8000,
  kSockaddrT2o = 0x8001,
  kSequencedAddress = 0x8002,
};

// Address, data, and a socket address for each direction.
inline constexpr std::size_t kMaxPacketItems = 4;
inline constexpr std::size_t kSockaddrLength = 16;

enum class PacketError : std::uint8_t {
  kTruncated,      // an item, or the count, is longer than what there is
  kTrailingBytes,  // more bytes than the items say
  kTooManyItems,
  kBadAddressItem,  // not first, of the wrong length, or none at all
  kBadDataItem,     // not second, or not the one that belongs to the address
  kBadSockaddr,     // wrong length or family, or twice the same direction
};

// A packet with an address, data, and what came along. Views into the bytes that were parsed.
struct CommonPacket {
  ItemType address = ItemType::kNullAddress;  // null, connected or sequenced
  std::uint32_t connection_id = 0;            // connected and sequenced
  std::uint32_t sequence = 0;                 // sequenced
  ByteView data;                              // of the data item
  std::optional<Ipv4Endpoint> o2t_sockaddr;   // family AF_INET
  std::optional<Ipv4Endpoint> t2o_sockaddr;
};

// The null address goes with unconnected data, the others with connected data. Further items that are not known are
// passed over.
Result<CommonPacket, PacketError> parse_common_packet(ByteView bytes);

// sockaddr_in as it travels: big-endian (2-6.3.3).
void append_sockaddr(Bytes& out, const Ipv4Endpoint& endpoint);
void append_item_header(Bytes& out, ItemType type, std::size_t length);

}  // namespace vinv::ethernet_ip
