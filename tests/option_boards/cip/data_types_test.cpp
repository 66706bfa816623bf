// CIP Vol 1, appendix C-5.
#include "option_boards/cip/data_types.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::cip {
namespace {

using test::from_hex;
using test::to_hex;

std::string constant(std::string_view type, std::string_view words) {
  Bytes out;
  TypeSpec(type).append_constant(out, words);
  return to_hex(out);
}

TEST(CipDataTypes, WholeNumbersHaveTheirSizesAndSigns) {
  struct Row {
    const char* name;
    std::size_t bytes;
    std::int64_t min, max;
  };
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  for (const Row& row :
       {Row{"BOOL", 1, 0, 1}, Row{"SINT", 1, -128, 127}, Row{"INT", 2, -32768, 32767},
        Row{"DINT", 4, -2147483648LL, 2147483647}, Row{"LINT", 8, -kMost - 1, kMost}, Row{"USINT", 1, 0, 255},
        Row{"UINT", 2, 0, 65535}, Row{"UDINT", 4, 0, 4294967295}, Row{"ULINT", 8, 0, kMost}, Row{"BYTE", 1, 0, 255},
        Row{"WORD", 2, 0, 65535}, Row{"DWORD", 4, 0, 4294967295}, Row{"LWORD", 8, 0, kMost}}) {
    const auto type = data_type_of(row.name);
    ASSERT_TRUE(type.has_value()) << row.name;
    EXPECT_TRUE(is_integer(*type));
    EXPECT_EQ(size_of(*type), row.bytes) << row.name;
    EXPECT_EQ(range_of(*type).min, row.min) << row.name;
    EXPECT_EQ(range_of(*type).max, row.max) << row.name;
    for (const std::int64_t value : {row.min, row.max, std::int64_t{0}, std::int64_t{1}}) {
      Bytes out;
      append_integer(out, *type, value);
      EXPECT_EQ(out.size(), row.bytes);
      EXPECT_EQ(read_integer(*type, out), value) << row.name;
    }
  }
  EXPECT_FALSE(data_type_of("UNIT").has_value());
}

TEST(CipDataTypes, RealsAreIeee754) {
  Bytes out;
  append_real(out, DataType::kReal, 1.5);
  append_real(out, DataType::kLreal, -2.0);
  EXPECT_EQ(to_hex(out), "00 00 C0 3F 00 00 00 00 00 00 00 C0");
  EXPECT_EQ(read_real(DataType::kReal, out), 1.5);
  EXPECT_EQ(read_real(DataType::kLreal, ByteView(out).subspan(4)), -2.0);
}

TEST(CipDataTypes, ConstantsAreWrittenMemberByMember) {
  // FR-A7NE manual, 7.1.2 attribute 7; 7.7.1 attribute 9; 7.7.2 attributes 3 and 4.
  EXPECT_EQ(constant("SHORT_STRING", "\"A700\""), "04 41 37 30 30");
  EXPECT_EQ(constant("ARRAY[3] STRUCT{UINT;UINT}", "0 0 0 0 4 2"), "00 00 00 00 00 00 00 00 04 00 02 00");
  EXPECT_EQ(constant("STRUCT{UINT;EPATH}", "2 20F52401"), "02 00 20 F5 24 01");
  EXPECT_EQ(constant("ARRAY[6] USINT", "0x02 0 1 2 3 255"), "02 00 01 02 03 FF");
  EXPECT_EQ(constant("STRUCT{USINT;USINT}", "1 10"), "01 0A");
  EXPECT_EQ(constant("INT", "-2"), "FE FF");
  EXPECT_EQ(constant("STRING", "\"abc\""), "03 00 61 62 63");
  EXPECT_EQ(constant("PADDED_STRING", "\"abc\""), "03 00 61 62 63 00");
  EXPECT_EQ(constant("PADDED_STRING", "\"\""), "00 00");
  EXPECT_EQ(constant("REAL", "1.5"), "00 00 C0 3F");
}

TEST(CipDataTypes, StructsNest) {
  const TypeSpec type("STRUCT{UDINT;ARRAY[2] STRUCT{USINT;ARRAY[2] UINT};STRUCT{SHORT_STRING;BOOL}}");
  Bytes out;
  type.append_constant(out, "1 2 3 4 5 6 7 \"x\" 1");
  EXPECT_EQ(to_hex(out), "01 00 00 00 02 03 00 04 00 05 06 00 07 00 01 78 01");
  EXPECT_EQ(type.check(out), GeneralStatus::kSuccess);
  EXPECT_FALSE(type.integer().has_value());
}

TEST(CipDataTypes, DataOfTheWrongLengthIsRefused) {
  using enum GeneralStatus;
  EXPECT_EQ(TypeSpec("UINT").check(from_hex("01")), kNotEnoughData);
  EXPECT_EQ(TypeSpec("UINT").check(from_hex("01 02")), kSuccess);
  EXPECT_EQ(TypeSpec("UINT").check(from_hex("01 02 03")), kTooMuchData);
  // Interface configuration: FR-A7NE manual, 7.8.2 attribute 5.
  const TypeSpec configuration("STRUCT{ARRAY[5] UDINT;PADDED_STRING}");
  const Bytes addresses(20, 1);
  const auto with = [&](const char* rest) {
    Bytes all = addresses;
    const Bytes tail = from_hex(rest);
    all.insert(all.end(), tail.begin(), tail.end());
    return configuration.check(all);
  };
  EXPECT_EQ(with(""), kNotEnoughData);
  EXPECT_EQ(with("00"), kNotEnoughData);
  EXPECT_EQ(with("00 00"), kSuccess);
  EXPECT_EQ(with("01 00 61"), kNotEnoughData);
  EXPECT_EQ(with("01 00 61 00"), kSuccess);
  EXPECT_EQ(with("01 00 61 00 00"), kTooMuchData);
  EXPECT_EQ(with("FF FF 61"), kNotEnoughData);
  EXPECT_EQ(TypeSpec("SHORT_STRING").check({}), kNotEnoughData);
  EXPECT_EQ(TypeSpec("SHORT_STRING").check(from_hex("01 61")), kSuccess);
  EXPECT_EQ(TypeSpec("EPATH").check(from_hex("20 01 24 01")), kSuccess);
  EXPECT_EQ(TypeSpec("EPATH").check(from_hex("20 01 24")), kInvalidAttributeValue);
}

}  // namespace
}  // namespace vinv::cip
