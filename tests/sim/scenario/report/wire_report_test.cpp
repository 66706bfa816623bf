#include "sim/scenario/report/wire_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "tests/sim/scenario/report/sample_run.hpp"

namespace vinv::scenario {
namespace {

struct Block {
  std::uint32_t type = 0;
  Bytes body;
};

std::vector<Block> blocks_of(const Bytes& file) {
  std::vector<Block> blocks;
  for (std::size_t at = 0; at + 12 <= file.size();) {
    const std::uint32_t length = read_le32(file, at + 4);
    if (length < 12 || at + length > file.size()) break;
    EXPECT_EQ(read_le32(file, at + length - 4), length);
    blocks.push_back({read_le32(file, at), Bytes(file.begin() + static_cast<long>(at) + 8,
                                                 file.begin() + static_cast<long>(at + length) - 4)});
    at += length;
  }
  return blocks;
}

struct Packet {
  std::uint32_t interface_id = 0;
  std::uint64_t ns = 0;
  Bytes data;
};

std::vector<Packet> packets_of(const Bytes& file) {
  std::vector<Packet> packets;
  for (const Block& b : blocks_of(file)) {
    if (b.type != 6) continue;
    Packet p;
    p.interface_id = read_le32(b.body, 0);
    p.ns = static_cast<std::uint64_t>(read_le32(b.body, 4)) << 32 | read_le32(b.body, 8);
    p.data.assign(b.body.begin() + 20, b.body.begin() + 20 + read_le32(b.body, 12));
    packets.push_back(p);
  }
  return packets;
}

Recording recording_of(std::vector<WireRecord> records) {
  Recording r;
  r.wire = std::move(records);
  return r;
}

TEST(WireReport, CandumpHasDataRemoteExtendedAndErrorFrames) {
  EXPECT_EQ(candump_log(recording_of(sample_wire())),
            "(0000000000.001000) line_can 605#4041600000000000\n"
            "(0000000000.002000) line_can 00000123#DEAD\n"
            "(0000000000.003000) line_can 705#R1\n"
            "(0000000000.004000) line_can 20000088#0000010A00000000\n");
}

TEST(WireReport, ARunWithoutWireMakesNoFiles) {
  EXPECT_TRUE(candump_log({}).empty());
  EXPECT_TRUE(wire_pcapng({}).empty());
}

TEST(WireReport, EachNetworkIsAnInterfaceOfItsLinkType) {
  std::vector<std::uint16_t> types;
  for (const Block& b : blocks_of(wire_pcapng(recording_of(sample_wire())))) {
    if (b.type == 1) types.push_back(read_le16(b.body, 0));
  }
  EXPECT_EQ(types, (std::vector<std::uint16_t>{227, 250, 1}));
}

TEST(WireReport, CanPacketsHaveTheIdentifierWithItsFlags) {
  const auto packets = packets_of(wire_pcapng(recording_of(sample_wire())));
  ASSERT_GE(packets.size(), 4U);
  EXPECT_EQ(packets[0].ns, 1'000'000U) << "simulated zero is 1970";
  EXPECT_EQ(packets[0].data, (Bytes{0, 0, 6, 5, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(packets[1].data, (Bytes{0x80, 0, 1, 0x23, 2, 0, 0, 0, 0xDE, 0xAD}));
  EXPECT_EQ(packets[2].data, (Bytes{0x40, 0, 7, 5, 1, 0, 0, 0}));
  EXPECT_EQ(packets[3].data, (Bytes{0x20, 0, 0, 0x88, 8, 0, 0, 0, 0, 0, 1, 10, 0, 0, 0, 0}));
}

TEST(WireReport, PacketsAreInTheOrderOfTime) {
  const auto packets = packets_of(wire_pcapng(recording_of(sample_wire())));
  EXPECT_TRUE(std::is_sorted(packets.begin(), packets.end(), [](const auto& a, const auto& b) { return a.ns < b.ns; }));
}

TEST(WireReport, SerialPacketsHaveDirectionAndBytes) {
  std::vector<Packet> serial;
  for (const Packet& p : packets_of(wire_pcapng(recording_of(sample_wire())))) {
    if (p.interface_id == 1) serial.push_back(p);
  }
  ASSERT_EQ(serial.size(), 2U);
  EXPECT_EQ(serial[0].data, (Bytes{0, 0, 0, 0, 0, 0, 0x13, 0x88, 2, 0, 0, 0, 5, 3, 0x5A, 0x3C, 0, 1, 0x57, 0x0A}));
  EXPECT_EQ(serial[1].data[8], 1) << "sent by the drive";
}

TEST(WireReport, TcpIsAWholeConnectionToThePortOfTheNetwork) {
  std::vector<Packet> tcp;
  for (const Packet& p : packets_of(wire_pcapng(recording_of(sample_wire())))) {
    if (p.interface_id == 2) tcp.push_back(p);
  }
  ASSERT_GE(tcp.size(), 8U) << "handshake, two segments with acknowledgements, end";
  EXPECT_EQ(read_be16(tcp[0].data, 14 + 20 + 2), 1502);
  EXPECT_EQ(tcp[0].data[14 + 20 + 13], 0x02) << "SYN";
  EXPECT_EQ(tcp.back().ns, 12'000'000U);
}

TEST(WireReport, TcpConnectionsOfOneNetworkAreConversationsOfTheirOwn) {
  // A query on each, then the answers; later a third connection.
  std::vector<WireRecord> wire;
  const auto add = [&](int ms, const char* sender, Bytes bytes, std::uint32_t connection) {
    wire.push_back({instant_from_ns(ms * 1'000'000), WireRecord::Kind::kTcp, "modbus_tcp", sender, 0, std::move(bytes),
                    connection});
  };
  add(1, "master", {1, 1, 1}, 4);
  add(2, "master", {2, 2}, 6);
  add(3, "b", {2, 2, 2, 2}, 6);
  add(4, "a", {1}, 4);
  add(9, "master", {3}, 8);
  struct Flow {
    std::optional<std::uint32_t> next_sequence;
    std::size_t bytes = 0;
    unsigned syns = 0;
    unsigned fins = 0;
  };
  std::map<std::pair<std::uint16_t, std::uint16_t>, Flow> flows;  // by the ports
  std::set<std::uint32_t> interfaces;
  for (const Packet& p : packets_of(wire_pcapng(recording_of(std::move(wire))))) {
    interfaces.insert(p.interface_id);
    const std::size_t tcp = 14 + 20;
    Flow& flow = flows[{read_be16(p.data, tcp), read_be16(p.data, tcp + 2)}];
    Flow& back = flows[{read_be16(p.data, tcp + 2), read_be16(p.data, tcp)}];
    const std::uint8_t flags = p.data[tcp + 13];
    const std::uint32_t sequence = read_be32(p.data, tcp + 4);
    const std::size_t payload = p.data.size() - tcp - 20;
    if (flow.next_sequence) {
      EXPECT_EQ(sequence, *flow.next_sequence);
    }
    if ((flags & 0x10) != 0) {
      EXPECT_EQ(read_be32(p.data, tcp + 8), back.next_sequence);
    }
    flow.syns += (flags & 2) != 0 ? 1 : 0;
    flow.fins += flags & 1;
    flow.bytes += payload;
    flow.next_sequence = sequence + static_cast<std::uint32_t>(payload) + ((flags & 3) != 0 ? 1 : 0);
  }
  EXPECT_EQ(interfaces.size(), 1u);
  std::vector<std::size_t> bytes;
  for (const auto& [ports, flow] : flows) {
    EXPECT_EQ(flow.syns, 1u);
    EXPECT_EQ(flow.fins, 1u);
    bytes.push_back(flow.bytes);
  }
  std::sort(bytes.begin(), bytes.end());
  EXPECT_EQ(bytes, (std::vector<std::size_t>{0, 1, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace vinv::scenario
