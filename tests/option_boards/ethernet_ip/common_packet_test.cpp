// The common packet format. CIP Vol 2, 2-6.
#include "option_boards/ethernet_ip/common_packet.hpp"

#include <gtest/gtest.h>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::ethernet_ip {
namespace {

using test::from_hex;
using test::to_hex;

TEST(CommonPacketTest, UnconnectedMessageHasNullAddressAndData) {
  const auto bytes = from_hex("02 00  00 00 00 00  B2 00 03 00 0E 00 01");
  const auto packet = parse_common_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->address, ItemType::kNullAddress);
  EXPECT_EQ(to_hex(packet->data), "0E 00 01");
  EXPECT_FALSE(packet->t2o_sockaddr);
}

TEST(CommonPacketTest, SequencedAddressHasIdentifierAndSequence) {
  const auto bytes = from_hex("02 00  02 80 08 00 44 33 22 11 05 00 00 00  B1 00 02 00 01 00");
  const auto packet = parse_common_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->connection_id, 0x11223344u);
  EXPECT_EQ(packet->sequence, 5u);
  EXPECT_EQ(to_hex(packet->data), "01 00");
}

TEST(CommonPacketTest, SocketAddressesAreBigEndian) {
  const auto bytes = from_hex(
      "04 00  00 00 00 00  B2 00 00 00  00 80 10 00 00 02 08 AE 7F 00 00 05 00 00 00 00 00 00 00 00"
      "  01 80 10 00 00 02 13 88 EF C0 01 80 00 00 00 00 00 00 00 00");
  const auto packet = parse_common_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->o2t_sockaddr, (Ipv4Endpoint{ipv4(127, 0, 0, 5), 2222}));
  EXPECT_EQ(packet->t2o_sockaddr, (Ipv4Endpoint{ipv4(239, 192, 1, 128), 5000}));
  Bytes out;
  append_sockaddr(out, *packet->o2t_sockaddr);
  EXPECT_EQ(to_hex(out), "00 02 08 AE 7F 00 00 05 00 00 00 00 00 00 00 00");
}

TEST(CommonPacketTest, UnknownFurtherItemsArePassedOver) {
  const auto bytes = from_hex(
      "04 00  00 00 00 00  B2 00 01 00 0E  34 12 03 00 01 02 03"
      "  01 80 10 00 00 02 13 88 EF C0 01 80 00 00 00 00 00 00 00 00");
  const auto packet = parse_common_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(to_hex(packet->data), "0E");
  EXPECT_EQ(packet->t2o_sockaddr, (Ipv4Endpoint{ipv4(239, 192, 1, 128), 5000}));
}

struct Malformed {
  const char* name;
  const char* hex;
  PacketError error;
};

class MalformedPacketTest : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedPacketTest, IsRefused) {
  const auto packet = parse_common_packet(from_hex(GetParam().hex));
  ASSERT_FALSE(packet);
  EXPECT_EQ(packet.error(), GetParam().error);
}

constexpr Malformed kMalformed[] = {
    {"Empty", "", PacketError::kTruncated},
    {"NoItems", "00 00", PacketError::kBadAddressItem},
    {"AddressOnly", "01 00 00 00 00 00", PacketError::kBadDataItem},
    {"FiveItems", "05 00 00 00 00 00", PacketError::kTooManyItems},
    {"ItemHeaderCut", "02 00 00 00 00", PacketError::kTruncated},
    {"ItemLongerThanPacket", "02 00 00 00 00 00 B2 00 03 00 01 02", PacketError::kTruncated},
    {"BytesAfterLastItem", "02 00 00 00 00 00 B2 00 01 00 01 02", PacketError::kTrailingBytes},
    {"NullAddressWithData", "02 00 00 00 01 00 01 B2 00 00 00", PacketError::kBadAddressItem},
    {"ConnectedAddressTooShort", "02 00 A1 00 02 00 01 02 B1 00 00 00", PacketError::kBadAddressItem},
    {"SequencedAddressTooShort", "02 00 02 80 04 00 01 02 03 04 B1 00 00 00", PacketError::kBadAddressItem},
    {"SequencedAddressTooLong", "02 00 02 80 09 00 01 02 03 04 05 06 07 08 09 B1 00 00 00",
     PacketError::kBadAddressItem},
    {"DataBeforeAddress", "02 00 B2 00 00 00 00 00 00 00", PacketError::kBadAddressItem},
    {"ConnectedDataWithNullAddress", "02 00 00 00 00 00 B1 00 00 00", PacketError::kBadDataItem},
    {"UnconnectedDataWithConnectedAddress", "02 00 A1 00 04 00 01 02 03 04 B2 00 00 00", PacketError::kBadDataItem},
    {"SockaddrTooShort", "03 00 00 00 00 00 B2 00 00 00 01 80 04 00 00 02 08 AE", PacketError::kBadSockaddr},
    {"SockaddrOfAnotherFamily",
     "03 00 00 00 00 00 B2 00 00 00 01 80 10 00 00 0A 08 AE 00 00 00 00 00 00 00 00 00 00 00 00",
     PacketError::kBadSockaddr},
    {"SameDirectionTwice",
     "04 00 00 00 00 00 B2 00 00 00 01 80 10 00 00 02 08 AE 00 00 00 00 00 00 00 00 00 00 00 00"
     "01 80 10 00 00 02 08 AE 00 00 00 00 00 00 00 00 00 00 00 00",
     PacketError::kBadSockaddr},
    {"UnknownItemLongerThanPacket", "03 00 00 00 00 00 B2 00 00 00 34 12 02 00 00", PacketError::kTruncated},
    {"UnknownItemFirst", "02 00 34 12 00 00 B2 00 00 00", PacketError::kBadAddressItem},
    {"UnknownItemForData", "02 00 00 00 00 00 34 12 00 00", PacketError::kBadDataItem},
};
INSTANTIATE_TEST_SUITE_P(All, MalformedPacketTest, ::testing::ValuesIn(kMalformed),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace vinv::ethernet_ip
