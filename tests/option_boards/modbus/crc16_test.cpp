// CRC of RTU frames. MODBUS over Serial Line V1.02, 6.2.2.
#include "option_boards/modbus/crc16.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>

#include "sim/base/random.hpp"
#include "tests/option_boards/support/hex.hpp"

namespace vinv::modbus {
namespace {

// Bit by bit, as 6.2.1 describes the procedure.
std::uint16_t crc16_by_bits(ByteView bytes) {
  std::uint16_t crc = 0xffff;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int i = 0; i < 8; ++i) {
      const bool carry = (crc & 1) != 0;
      crc = static_cast<std::uint16_t>(crc >> 1);
      if (carry) crc = static_cast<std::uint16_t>(crc ^ 0xa001);
    }
  }
  return crc;
}

TEST(Crc16, OfTheStandardsExampleFrameIsAsPrinted) {
  // Appendix B: 02 07 gives 1241H, sent 41 12.
  const Bytes bytes = test::from_hex("02 07");
  EXPECT_EQ(crc16(bytes), 0x1241);
}

TEST(Crc16, OfTheUsualCheckStringIsTheCatalogueValue) {
  constexpr std::string_view kText = "123456789";
  const Bytes bytes(kText.begin(), kText.end());
  EXPECT_EQ(crc16(bytes), 0x4b37);
}

TEST(Crc16, OfNothingIsTheInitialValue) { EXPECT_EQ(crc16({}), 0xffff); }

TEST(Crc16, TableAgreesWithTheBitProcedureOnRandomFrames) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    Bytes bytes(random.below(257));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    ASSERT_EQ(crc16(bytes), crc16_by_bits(bytes)) << test::to_hex(bytes);
  }
}

TEST(Crc16, OverAFrameWithItsOwnCrcIsZero) { EXPECT_EQ(crc16(test::frame("19 06 65 90 00 01")), 0); }

}  // namespace
}  // namespace vinv::modbus
