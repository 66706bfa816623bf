#include "sim/transports/pcapng.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/transports/tcp_conversation.hpp"

namespace vinv::transports {
namespace {

// draft-ietf-opsawg-pcapng-02, section 4.
TEST(Pcapng, BlocksAreAsTheDocumentDrawsThem) {
  PcapngEncoder encoder(1'000'000'000);
  Bytes out;
  encoder.begin_section(out, "abc");
  EXPECT_EQ(out, (Bytes{0x0a, 0x0d, 0x0d, 0x0a, 40,   0,    0,    0,    0x4d, 0x3c, 0x2b, 0x1a, 1,  0, 0, 0,  //
                        0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,                                       //
                        4,    0,    3,    0,    'a',  'b',  'c',  0,    0,    0,    0,    0,    40, 0, 0, 0}));
  out.clear();
  EXPECT_EQ(encoder.add_interface(out, LinkType::kEthernet, "tcp0"), 0u);
  EXPECT_EQ(out, (Bytes{1, 0, 0, 0, 40,  0,   0,   0,   1, 0, 0, 0, 0, 0, 4, 0,  //
                        2, 0, 4, 0, 't', 'c', 'p', '0', 9, 0, 1, 0, 9, 0, 0, 0, 0, 0, 0, 0, 40, 0, 0, 0}));
  out.clear();
  EXPECT_EQ(encoder.add_interface(out, LinkType::kRtacSerial, "x"), 1u);
  out.clear();
  encoder.packet(out, 1, instant_from_ns(5'000'000'001), Bytes{7, 8, 9}, PacketDirection::kOutbound);
  // 6000000001 ns = 0x1'65a0bc01
  EXPECT_EQ(out, (Bytes{6, 0, 0, 0, 48, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0x01, 0xbc, 0xa0, 0x65, 3,  0, 0, 0,
                        3, 0, 0, 0, 7,  8, 9, 0, 2, 0, 4, 0, 2, 0, 0, 0, 0,    0,    0,    0,    48, 0, 0, 0}));
}

TEST(TcpConversation, ReadsTheAddressesOfStreams) {
  const auto v4 = parse_ip_endpoint("127.0.0.1:40312");
  ASSERT_TRUE(v4);
  EXPECT_FALSE(v4->is_v6);
  EXPECT_EQ(v4->port, 40312);
  EXPECT_EQ(v4->address[0], 127);
  EXPECT_EQ(v4->address[3], 1);
  const auto v6 = parse_ip_endpoint("[fe80::1%eth0]:502");
  ASSERT_TRUE(v6);
  EXPECT_TRUE(v6->is_v6);
  EXPECT_EQ(v6->address[0], 0xfe);
  EXPECT_EQ(v6->address[15], 1);
  for (const char* bad : {"", "/dev/pts/5", "127.0.0.1", "127.0.0.1:", "127.0.0.1:70000", "127.0.0.1:5x", "::1:5"}) {
    EXPECT_FALSE(parse_ip_endpoint(bad)) << bad;
  }
}

TEST(TcpConversation, SequenceNumbersCountDataSynAndFin) {
  struct Segment {
    TcpSide from;
    std::uint32_t sequence;
    std::uint32_t acknowledged;
    std::uint8_t flags;
    std::size_t payload;
  };
  std::vector<Segment> segments;
  TcpConversation tcp(*parse_ip_endpoint("10.0.0.1:1000"), *parse_ip_endpoint("10.0.0.2:502"), 0,
                      [&](TcpSide from, ByteView f) {
                        segments.push_back({from, read_be32(f, 38), read_be32(f, 42), f[47], f.size() - 54});
                      });
  tcp.open();
  tcp.data(TcpSide::kClient, Bytes(2000));
  tcp.data(TcpSide::kServer, Bytes(5));
  tcp.close(TcpSide::kServer);
  const std::uint32_t c = 0x10000000;
  const std::uint32_t s = 0x80000000;
  const Segment expected[] = {
      {TcpSide::kClient, c, 0, 0x02, 0},
      {TcpSide::kServer, s, c + 1, 0x12, 0},
      {TcpSide::kClient, c + 1, s + 1, 0x10, 0},
      {TcpSide::kClient, c + 1, s + 1, 0x10, 1440},
      {TcpSide::kClient, c + 1441, s + 1, 0x18, 560},
      {TcpSide::kServer, s + 1, c + 2001, 0x10, 0},
      {TcpSide::kServer, s + 1, c + 2001, 0x18, 5},
      {TcpSide::kClient, c + 2001, s + 6, 0x10, 0},
      {TcpSide::kServer, s + 6, c + 2001, 0x11, 0},
      {TcpSide::kClient, c + 2001, s + 7, 0x11, 0},
      {TcpSide::kServer, s + 7, c + 2002, 0x10, 0},
  };
  ASSERT_EQ(segments.size(), std::size(expected));
  for (std::size_t i = 0; i < segments.size(); ++i) {
    EXPECT_EQ(segments[i].from, expected[i].from) << i;
    EXPECT_EQ(segments[i].sequence, expected[i].sequence) << i;
    EXPECT_EQ(segments[i].acknowledged, expected[i].acknowledged) << i;
    EXPECT_EQ(segments[i].flags, expected[i].flags) << i;
    EXPECT_EQ(segments[i].payload, expected[i].payload) << i;
  }
}

}  // namespace
}  // namespace vinv::transports
