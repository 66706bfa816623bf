// PDUs of functions 03 and 06 and exceptions. MODBUS Application Protocol V1.1b3: 6.3, 6.6, 7.
#include "option_boards/modbus/pdu.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::modbus {
namespace {

using test::from_hex;

TEST(Pdu, ReadRequestIsParsedAndEmittedAsPrinted) {
  // 6.3: read registers 108-110.
  const Bytes bytes = from_hex("03 00 6B 00 03");
  const auto request = parse_request(bytes);
  ASSERT_TRUE(request);
  EXPECT_EQ(std::get<ReadHoldingRegisters>(*request), (ReadHoldingRegisters{0x6b, 3}));
  EXPECT_EQ(emit(*request), bytes);
}

TEST(Pdu, WriteRequestIsParsedAndEmittedAsPrinted) {
  // 6.6: write register 2 to 00 03 hex.
  const Bytes bytes = from_hex("06 00 01 00 03");
  const auto request = parse_request(bytes);
  ASSERT_TRUE(request);
  EXPECT_EQ(std::get<WriteSingleRegister>(*request), (WriteSingleRegister{1, 3}));
  EXPECT_EQ(emit(*request), bytes);
}

TEST(Pdu, ReadAnswerCarriesTheByteCountAndHighBytesFirst) {
  const std::array<std::uint16_t, 3> values{0x022b, 0x0000, 0x0064};
  EXPECT_EQ(emit_read_answer(values), from_hex("03 06 02 2B 00 00 00 64"));  // 6.3
}

TEST(Pdu, LongestReadAnswerFitsAPdu) {
  const std::array<std::uint16_t, kMaxReadQuantity> values{};
  EXPECT_EQ(emit_read_answer(values).size(), 252u);
}

TEST(Pdu, ExceptionSetsTheHighestBitOfTheFunction) {
  EXPECT_EQ(emit_exception(0x03, Exception::kIllegalDataAddress), from_hex("83 02"));
  EXPECT_EQ(emit_exception(0x2b, Exception::kIllegalFunction), from_hex("AB 01"));
  EXPECT_EQ(emit_exception(0x86, Exception::kIllegalFunction), from_hex("86 01"));
}

TEST(Pdu, EveryOtherFunctionIsIllegal) {
  for (unsigned function = 0; function <= 0xff; ++function) {
    if (function == 0x03 || function == 0x06) continue;
    const Bytes pdu{static_cast<std::uint8_t>(function), 0, 0, 0, 1};
    const auto request = parse_request(pdu);
    ASSERT_FALSE(request) << function;
    EXPECT_EQ(request.error(), Exception::kIllegalFunction) << function;
  }
  EXPECT_EQ(parse_request({}).error(), Exception::kIllegalFunction);
}

TEST(Pdu, LengthThatDoesNotFitTheFunctionIsAnIllegalValue) {
  for (const char* hex : {"03", "03 4E 20 00", "03 4E 20 00 01 00", "06", "06 65 90 00", "06 65 90 00 01 00"}) {
    const auto request = parse_request(from_hex(hex));
    ASSERT_FALSE(request) << hex;
    EXPECT_EQ(request.error(), Exception::kIllegalDataValue) << hex;
  }
}

TEST(Pdu, QuantityIsOneToOneHundredTwentyFive) {
  EXPECT_EQ(parse_request(from_hex("03 4E 20 00 00")).error(), Exception::kIllegalDataValue);
  EXPECT_TRUE(parse_request(from_hex("03 4E 20 00 01")));
  EXPECT_TRUE(parse_request(from_hex("03 4E 20 00 7D")));
  EXPECT_EQ(parse_request(from_hex("03 4E 20 00 7E")).error(), Exception::kIllegalDataValue);
  EXPECT_EQ(parse_request(from_hex("03 4E 20 FF FF")).error(), Exception::kIllegalDataValue);
}

}  // namespace
}  // namespace vinv::modbus
