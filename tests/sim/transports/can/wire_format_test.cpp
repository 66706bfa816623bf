#include "sim/transports/can/wire_format.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/base/random.hpp"

namespace vinv::transports {
namespace {

std::string text_of(std::span<const std::uint8_t> bits) {
  std::string out;
  for (const std::uint8_t b : bits) out += static_cast<char>('0' + b);
  return out;
}

CanFrame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f = CanFrame::standard(id, bytes);
  f.extended = true;
  return f;
}

// The check value of CRC-15/CAN in the catalogue of parametrised CRC algorithms: over the ASCII digits 1 to 9.
TEST(CanWireFormat, CrcHasTheCatalogueCheckValue) {
  std::vector<std::uint8_t> bits;
  for (char c = '1'; c <= '9'; ++c) {
    for (int i = 7; i >= 0; --i) bits.push_back(static_cast<std::uint8_t>(c >> i & 1));
  }
  EXPECT_EQ(can_crc15(bits), 0x059e);
}

TEST(CanWireFormat, ADataFrameHasItsBits) {
  const CanWireBits wire = can_wire_bits(CanFrame::standard(0x14, {0x01}));
  EXPECT_EQ(wire.crc, 0x7753);
  // 0 00000010100 0 0 0 0001 00000001 111011101010011; stuff bits after the first 00000, after the 00000 of RTR to DLC,
  // and in the data.
  EXPECT_EQ(text_of(wire.view()), "000001001010000010001000001001111011101010011");
  EXPECT_EQ(wire.stuff_bits, 3u);
}

// The remainder over message and CRC is zero, whatever the message.
TEST(CanWireFormat, CrcDividesTheWholeSequence) {
  for (const std::uint32_t id : {0x000u, 0x123u, 0x585u, 0x7ffu}) {
    const CanWireBits wire = can_wire_bits(CanFrame::standard(id, {0x4b, 0x41, 0x60, 0x00, 0x37, 0x02}));
    std::vector<std::uint8_t> plain;
    unsigned run = 0;
    std::uint8_t last = 2;
    bool stuff_next = false;
    for (const std::uint8_t b : wire.view()) {
      run = b == last ? run + 1 : 1;
      last = b;
      if (!stuff_next) plain.push_back(b);
      stuff_next = run == 5;
    }
    EXPECT_EQ(plain.size(), 34u + 48u);
    EXPECT_EQ(can_crc15(plain), 0);
  }
}

TEST(CanWireFormat, AFrameOfZerosIsStuffedAfterEveryFifthBit) {
  // 34 zeros, for the CRC of zeros is zero: a stuff bit after each 5.
  const CanWireBits wire = can_wire_bits(CanFrame::standard(0, {}));
  EXPECT_EQ(wire.crc, 0);
  EXPECT_EQ(text_of(wire.view()), "0000010000010000010000010000010000010000");
  EXPECT_EQ(wire.stuff_bits, 6u);
  EXPECT_EQ(wire.frame_bits(), 50u);
}

TEST(CanWireFormat, AStuffBitCountsForTheNextRun) {
  // 11111 0 1111 1...: ID 0x7ff begins SOF 0, then ones; the stuff bit 0 is followed by ones that are counted anew.
  const std::string bits = text_of(can_wire_bits(CanFrame::standard(0x7ff, {0xff})).view());
  EXPECT_EQ(bits.substr(0, 14), "01111101111101");
  // 0x078 begins 0 0000 1111 000: each stuff bit begins the next run, so there is one after every four bits.
  const std::string chain = text_of(can_wire_bits(CanFrame::standard(0x078, {})).view());
  EXPECT_EQ(chain.substr(0, 16), "0000011111000001");
}

TEST(CanWireFormat, RemoteFramesCarryTheirLengthAndNoData) {
  const CanWireBits wire = can_wire_bits(CanFrame::remote_request(0x705, 1));
  // 0 11100000101 1 0 0 0001: five zeros of the identifier are followed by a stuff bit.
  EXPECT_EQ(text_of(wire.view()).substr(0, 20), "01110000011011000001");
  EXPECT_EQ(wire.count - wire.stuff_bits, 34u);
}

TEST(CanWireFormat, ExtendedFramesHaveSubstituteAndExtensionBits) {
  const CanWireBits wire = can_wire_bits(extended(0x15555555, {}));
  // 0 10101010101 1 1 010101010101010101 0 0 0 0000
  EXPECT_EQ(text_of(wire.view()).substr(0, 32), "01010101010111010101010101010101");
  EXPECT_EQ(wire.count - wire.stuff_bits, 54u);
}

TEST(CanWireFormat, LengthsStayWithinTheKnownBounds) {
  Random random(7);
  unsigned most = 0;
  for (int i = 0; i < 20'000; ++i) {
    CanFrame f;
    f.extended = random.below(2) == 1;
    f.id = static_cast<std::uint32_t>(random.below(f.extended ? 0x20000000 : 0x800));
    f.length = static_cast<std::uint8_t>(random.below(9));
    f.remote = random.below(8) == 0;
    // Bytes of long runs are stuffed most.
    for (auto& b : f.data) b = static_cast<std::uint8_t>(random.below(3) == 0 ? random.next() : random.below(2) * 0xff);
    const CanWireBits wire = can_wire_bits(f);
    const unsigned plain = (f.extended ? 54u : 34u) + 8u * static_cast<unsigned>(f.bytes().size());
    ASSERT_EQ(wire.count, plain + wire.stuff_bits);
    ASSERT_LE(wire.stuff_bits, (plain - 1) / 4);
    unsigned run = 0;
    std::uint8_t last = 2;
    for (const std::uint8_t b : wire.view()) {
      run = b == last ? run + 1 : 1;
      last = b;
      ASSERT_LE(run, 5u);
    }
    most = std::max(most, wire.stuff_bits);
  }
  EXPECT_GT(most, 15u);
}

TEST(CanWireFormat, ArbitrationFollowsTheBitsOfTheField) {
  const CanFrame data = CanFrame::standard(0x123, {1});
  const CanFrame remote = CanFrame::remote_request(0x123, 0);
  const CanFrame ext = extended(0x123u << 18, {1});
  CanFrame ext_remote = ext;
  ext_remote.remote = true;
  const CanFrame higher_base = CanFrame::standard(0x124, {});
  // Standard data before standard remote before extended of the same base, and the base decides before all.
  const std::vector<CanFrame> order = {CanFrame::standard(0x122, {}),    data,       remote, ext, ext_remote,
                                       extended((0x123u << 18) + 1, {}), higher_base};
  for (std::size_t i = 1; i < order.size(); ++i) {
    EXPECT_LT(can_arbitration_key(order[i - 1]), can_arbitration_key(order[i])) << i;
  }
}

// The keys must order frames as a bit by bit comparison on the wire does.
TEST(CanWireFormat, KeysAgreeWithTheWire) {
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    CanFrame pair[2];
    const auto base = static_cast<std::uint32_t>(random.below(0x800));
    for (CanFrame& f : pair) {
      f.extended = random.below(2) == 1;
      f.remote = random.below(2) == 1;
      const auto near = static_cast<std::uint32_t>(base ^ (random.below(2) << random.below(11)));
      f.id = f.extended ? near << 18 | static_cast<std::uint32_t>(random.below(4)) : near;
    }
    if (can_arbitration_key(pair[0]) == can_arbitration_key(pair[1])) {
      EXPECT_EQ(pair[0], pair[1]);
      continue;
    }
    const std::string a = text_of(can_wire_bits(pair[0]).view());
    const std::string b = text_of(can_wire_bits(pair[1]).view());
    EXPECT_EQ(can_arbitration_key(pair[0]) < can_arbitration_key(pair[1]), a < b);
  }
}

TEST(CanWireFormat, BitTimesAreExact) {
  const std::vector<std::int64_t> expected_ns = {50'000, 20'000, 16'000, 10'000, 8'000, 4'000, 2'000, 1'000};
  for (std::size_t i = 0; i < kCanBitrates.size(); ++i) {
    EXPECT_EQ(can_bit_time(kCanBitrates[i]).count(), expected_ns[i]);
    EXPECT_TRUE(is_can_bitrate(kCanBitrates[i]));
  }
  EXPECT_FALSE(is_can_bitrate(83'333));
}

TEST(CanWireFormat, IllFormedFramesAreKnown) {
  EXPECT_TRUE(is_well_formed(CanFrame::standard(0x7ff, {1})));
  EXPECT_FALSE(is_well_formed(CanFrame::standard(0x800, {1})));
  EXPECT_TRUE(is_well_formed(extended(0x1fffffff, {})));
  EXPECT_FALSE(is_well_formed(extended(0x20000000, {})));
  EXPECT_FALSE(is_well_formed(CanFrame::remote_request(1, 9)));
}

}  // namespace
}  // namespace vinv::transports
