#include "option_boards/ethernet_ip/common_packet.hpp"

#include <array>

namespace vinv::ethernet_ip {
namespace {

constexpr std::uint16_t kAfInet = 2;

struct Item {
  std::uint16_t type = 0;
  ByteView data;
};

std::optional<PacketError> take_address(CommonPacket& packet, const Item& item) {
  packet.address = static_cast<ItemType>(item.type);
  switch (packet.address) {
    case ItemType::kNullAddress: return item.data.empty() ? std::nullopt : std::optional(PacketError::kBadAddressItem);
    case ItemType::kConnectedAddress:
      if (item.data.size() != 4) return PacketError::kBadAddressItem;
      packet.connection_id = read_le32(item.data, 0);
      return std::nullopt;
    case ItemType::kSequencedAddress:
      if (item.data.size() != 8) return PacketError::kBadAddressItem;
      packet.connection_id = read_le32(item.data, 0);
      packet.sequence = read_le32(item.data, 4);
      return std::nullopt;
    default: return PacketError::kBadAddressItem;
  }
}

std::optional<PacketError> take_sockaddr(CommonPacket& packet, const Item& item) {
  auto& place =
      item.type == static_cast<std::uint16_t>(ItemType::kSockaddrO2t) ? packet.o2t_sockaddr : packet.t2o_sockaddr;
  if (place || item.data.size() != kSockaddrLength || read_be16(item.data, 0) != kAfInet)
    return PacketError::kBadSockaddr;
  place = Ipv4Endpoint{read_be32(item.data, 4), read_be16(item.data, 2)};
  return std::nullopt;
}

std::optional<PacketError> take_item(CommonPacket& packet, std::size_t index, const Item& item) {
  if (index == 0) return take_address(packet, item);
  if (index == 1) {
    const ItemType wanted =
        packet.address == ItemType::kNullAddress ? ItemType::kUnconnectedData : ItemType::kConnectedData;
    if (item.type != static_cast<std::uint16_t>(wanted)) return PacketError::kBadDataItem;
    packet.data = item.data;
    return std::nullopt;
  }
  switch (static_cast<ItemType>(item.type)) {
    case ItemType::kSockaddrO2t:
    case ItemType::kSockaddrT2o: return take_sockaddr(packet, item);
    // Unspecified: others pass over what they do not know, so that newer scanners find no fault with them.
    default: return std::nullopt;
  }
}

}  // namespace

Result<CommonPacket, PacketError> parse_common_packet(ByteView bytes) {
  if (bytes.size() < 2) return Unexpected(PacketError::kTruncated);
  const std::size_t count = read_le16(bytes, 0);
  bytes = bytes.subspan(2);
  if (count < 2) return Unexpected(count == 0 ? PacketError::kBadAddressItem : PacketError::kBadDataItem);
  if (count > kMaxPacketItems) return Unexpected(PacketError::kTooManyItems);
  CommonPacket packet;
  for (std::size_t i = 0; i < count; ++i) {
    if (bytes.size() < 4) return Unexpected(PacketError::kTruncated);
    const std::size_t length = read_le16(bytes, 2);
    if (bytes.size() - 4 < length) return Unexpected(PacketError::kTruncated);
    const Item item{read_le16(bytes, 0), bytes.subspan(4, length)};
    bytes = bytes.subspan(4 + length);
    if (const auto error = take_item(packet, i, item)) return Unexpected(*error);
  }
  if (!bytes.empty()) return Unexpected(PacketError::kTrailingBytes);
  return packet;
}

void append_sockaddr(Bytes& out, const Ipv4Endpoint& endpoint) {
  append_be16(out, kAfInet);
  append_be16(out, endpoint.port);
  append_be32(out, endpoint.address);
  out.insert(out.end(), 8, 0);
}

void append_item_header(Bytes& out, ItemType type, std::size_t length) {
  const auto type_word = static_cast<std::uint16_t>(type);
  const std::array<std::uint8_t, 4> bytes{static_cast<std::uint8_t>(type_word),
                                          static_cast<std::uint8_t>(type_word >> 8), static_cast<std::uint8_t>(length),
                                          static_cast<std::uint8_t>(length >> 8)};
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace vinv::ethernet_ip
