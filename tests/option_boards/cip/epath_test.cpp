// CIP Vol 1, appendix C-1. Paths of the FR-A7NE manual: 7.7.2 and 7.8.2; of DeviceNet: 62 34 37.
#include "option_boards/cip/epath.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/option_boards/support/hex.hpp"

namespace vinv::cip {
namespace {

using test::from_hex;
using test::to_hex;

Result<Segment, PathError> first_segment(const Bytes& path, PathForm form = PathForm::kPadded) {
  EpathReader reader(path, form);
  return reader.next();
}

template <class T>
T only(const Bytes& path, PathForm form = PathForm::kPadded) {
  EpathReader reader(path, form);
  const auto segment = reader.next();
  EXPECT_TRUE(segment.has_value()) << to_hex(path);
  if (!segment || !std::holds_alternative<T>(*segment)) {
    ADD_FAILURE() << "another segment: " << to_hex(path);
    return {};
  }
  EXPECT_TRUE(reader.at_end()) << to_hex(path);
  return std::get<T>(*segment);
}

std::string emitted(const Segment& segment, PathForm form = PathForm::kPadded) {
  Bytes out;
  append_segment(out, segment, form);
  return to_hex(out);
}

TEST(CipEpath, LogicalSegmentsHaveThreeWidths) {
  using enum LogicalType;
  using enum LogicalWidth;
  struct Row {
    const char* padded;
    const char* packed;
    LogicalSegment segment;
  };
  const std::vector<Row> rows{
      {"20 F5", "20 F5", {kClass, k8, 0xF5}},
      {"21 00 2A 01", "21 2A 01", {kClass, k16, 0x12A}},
      {"24 01", "24 01", {kInstance, k8, 1}},
      {"25 00 02 01", "25 02 01", {kInstance, k16, 0x102}},
      {"26 00 04 03 02 01", "26 04 03 02 01", {kInstance, k32, 0x01020304}},
      {"28 05", "28 05", {kMember, k8, 5}},
      {"29 00 05 00", "29 05 00", {kMember, k16, 5}},
      {"2A 00 05 00 01 00", "2A 05 00 01 00", {kMember, k32, 0x10005}},
      {"2C 47", "2C 47", {kConnectionPoint, k8, 71}},
      {"2D 00 B3 00", "2D B3 00", {kConnectionPoint, k16, 179}},
      {"2E 00 B3 00 00 00", "2E B3 00 00 00", {kConnectionPoint, k32, 179}},
      {"30 65", "30 65", {kAttribute, k8, 101}},
      {"31 00 00 02", "31 00 02", {kAttribute, k16, 512}},
      {"38 4B", "38 4B", {kService, k8, 0x4B}},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(only<LogicalSegment>(from_hex(row.padded)), row.segment) << row.padded;
    EXPECT_EQ(only<LogicalSegment>(from_hex(row.packed), PathForm::kPacked), row.segment) << row.packed;
    EXPECT_EQ(emitted(row.segment), row.padded);
    EXPECT_EQ(emitted(row.segment, PathForm::kPacked), row.packed);
  }
}

TEST(CipEpath, LogicalValuesTakeTheSmallestWidthThatFits) {
  Bytes out;
  append_logical(out, LogicalType::kInstance, 0xFF, PathForm::kPadded);
  append_logical(out, LogicalType::kInstance, 0x100, PathForm::kPadded);
  append_logical(out, LogicalType::kInstance, 0x10000, PathForm::kPadded);
  EXPECT_EQ(to_hex(out), "24 FF 25 00 00 01 26 00 00 00 01 00");
}

TEST(CipEpath, ElectronicKeyOfFormatFour) {
  const Bytes path = from_hex("34 04 A1 00 02 00 38 00 81 0A");
  const auto key = only<ElectronicKey>(path);
  EXPECT_EQ(key, (ElectronicKey{161, 2, 56, 1, true, 10}));
  EXPECT_EQ(emitted(key), to_hex(path));
  EXPECT_EQ(emitted(key, PathForm::kPacked), to_hex(path));
}

TEST(CipEpath, PortSegmentsWithAddressesOfAnyLength) {
  struct Row {
    const char* bytes;
    unsigned port;
    bool sized;
    const char* address;
  };
  for (const Row& row :
       {Row{"01 00", 1, false, "00"}, Row{"0E 3F", 14, false, "3F"}, Row{"0F 12 00 03 ", 18, false, "03"},
        Row{"11 01 07 00", 1, true, "07"},
        Row{"12 0D 31 39 32 2E 31 36 38 2E 31 2E 32 35 34 00", 2, true, "31 39 32 2E 31 36 38 2E 31 2E 32 35 34"},
        Row{"1F 02 00 01 AA BB", 256, true, "AA BB"}}) {
    const Bytes path = from_hex(row.bytes);
    const auto port = only<PortSegment>(path);
    EXPECT_EQ(port.port, row.port) << row.bytes;
    EXPECT_EQ(port.sized_address, row.sized) << row.bytes;
    EXPECT_EQ(to_hex(port.link_address), row.address);
    EXPECT_EQ(emitted(port), to_hex(path));
  }
  EXPECT_EQ(to_hex(only<PortSegment>(from_hex("11 01 07"), PathForm::kPacked).link_address), "07");
}

TEST(CipEpath, NetworkSegmentsCarryAByteOrWords) {
  const Bytes milliseconds = from_hex("43 0A");
  const auto inhibit = only<NetworkSegment>(milliseconds);
  EXPECT_EQ(inhibit.subtype, 3);
  EXPECT_EQ(to_hex(inhibit.data), "0A");
  EXPECT_EQ(emitted(inhibit), "43 0A");
  const Bytes words = from_hex("51 02 10 27 00 00");
  const auto microseconds = only<NetworkSegment>(words);
  EXPECT_EQ(microseconds.subtype, 0x11);
  EXPECT_EQ(to_hex(microseconds.data), "10 27 00 00");
  EXPECT_EQ(emitted(microseconds), "51 02 10 27 00 00");
}

TEST(CipEpath, SymbolsAndData) {
  EXPECT_EQ(only<SymbolicSegment>(from_hex("62 34 37"), PathForm::kPacked).name, "47");
  EXPECT_EQ(only<SymbolicSegment>(from_hex("62 34 37 00")).name, "47");
  EXPECT_EQ(emitted(SymbolicSegment{"47"}, PathForm::kPacked), "62 34 37");
  EXPECT_EQ(emitted(SymbolicSegment{"47"}), "62 34 37 00");
  EXPECT_EQ(only<AnsiSymbol>(from_hex("91 03 61 62 63 00")).name, "abc");
  EXPECT_EQ(emitted(AnsiSymbol{"abc"}), "91 03 61 62 63 00");
  EXPECT_EQ(to_hex(only<SimpleData>(from_hex("80 02 01 02 03 04")).words), "01 02 03 04");
  EXPECT_EQ(emitted(SimpleData{}), "80 00");
  for (const char* number : {"60 C6 FF 00", "60 C7 34 12", "60 C8 78 56 34 12"}) {
    EXPECT_EQ(emitted(only<NumericSymbol>(from_hex(number))), number);
  }
  EXPECT_EQ(only<NumericSymbol>(from_hex("60 C8 78 56 34 12")).value, 0x12345678u);
  for (const char* text : {"60 22 61 00 62 00", "60 41 61 62 63 00"}) {
    EXPECT_EQ(emitted(only<WideSymbol>(from_hex(text))), text);
  }
}

TEST(CipEpath, EachMalformedSegmentIsRefusedWhereItBegins) {
  using enum PathFault;
  struct Row {
    const char* bytes;
    PathFault fault;
  };
  for (const Row& row : {
           Row{"20", kTruncated},
           Row{"21 00 01", kTruncated},
           Row{"26 00 01 02 03", kTruncated},
           Row{"34 04 A1 00 02 00 38 00 81", kTruncated},
           Row{"01", kTruncated},
           Row{"12 0D 31", kTruncated},
           Row{"0F 12", kTruncated},
           Row{"11 01 07", kTruncated},
           Row{"43", kTruncated},
           Row{"51 02 10 27", kTruncated},
           Row{"62 34", kTruncated},
           Row{"62 34 37", kTruncated},
           Row{"60", kTruncated},
           Row{"60 C7 34", kTruncated},
           Row{"60 22 61", kTruncated},
           Row{"80 01 00", kTruncated},
           Row{"80", kTruncated},
           Row{"91", kTruncated},
           Row{"91 03 61 62 63", kTruncated},
           Row{"21 01 01 00", kBadPad},
           Row{"11 01 07 01", kBadPad},
           Row{"62 34 37 20", kBadPad},
           Row{"91 01 61 01", kBadPad},
           Row{"22 00 01 00 00 00", kReservedFormat},
           Row{"32 00 01 00 00 00", kReservedFormat},
           Row{"39 00 01 00", kReservedFormat},
           Row{"23 00", kReservedFormat},
           Row{"27 00 00 00", kReservedFormat},
           Row{"35 04 00 00", kUnknownSegment},
           Row{"3C 01 00 00", kUnknownSegment},
           Row{"40 00", kUnknownSegment},
           Row{"60 C5 00 00", kUnknownSegment},
           Row{"60 C9 00 00", kUnknownSegment},
           Row{"60 82 00 00", kUnknownSegment},
           Row{"81 00", kUnknownSegment},
           Row{"92 01 61 00", kUnknownSegment},
           Row{"A0 02 00 00", kUnknownSegment},
           Row{"C7 00", kUnknownSegment},
           Row{"FF FF", kUnknownSegment},
           Row{"34 05 A1 00 02 00 38 00 81 0A 01 00 00 00", kUnknownKey},
           Row{"00 01", kBadPort},
           Row{"0F 0E 00 01", kBadPort},
           Row{"1F 01 00 00 05 00", kBadPort},
           Row{"11 00", kEmpty},
           Row{"91 00", kEmpty},
           Row{"60 20", kEmpty},
           Row{"60 40", kEmpty},
       }) {
    const auto segment = first_segment(from_hex(row.bytes));
    ASSERT_FALSE(segment.has_value()) << row.bytes;
    EXPECT_EQ(segment.error(), (PathError{row.fault, 0})) << row.bytes;
    const Bytes after_class = from_hex(std::string("20 04 ") + row.bytes);
    EpathReader reader(after_class, PathForm::kPadded);
    ASSERT_TRUE(reader.next().has_value());
    EXPECT_EQ(reader.next().error(), (PathError{row.fault, 2})) << row.bytes;
    EXPECT_EQ(reader.offset(), 2u);
  }
}

TEST(CipObjectPath, TakesClassInstanceAttributeAndMemberInOrder) {
  struct Row {
    const char* bytes;
    ObjectPath path;
  };
  for (const Row& row : {Row{"20 01 24 01 30 07", {1, 1, 7, {}}}, Row{"20 F5 24 01", {0xF5, 1, {}, {}}},
                         Row{"20 01", {1, 0, {}, {}}}, Row{"20 04 2C 47 30 03", {4, 71, 3, {}}},
                         Row{"20 01 30 01", {1, 0, 1, {}}}, Row{"20 64 24 01 30 02 28 03", {0x64, 1, 2, 3}},
                         Row{"21 00 00 03 26 00 00 00 01 00", {0x300, 0x10000, {}, {}}}}) {
    const auto path = parse_object_path(from_hex(row.bytes), PathForm::kPadded);
    ASSERT_TRUE(path.has_value()) << row.bytes;
    EXPECT_EQ(*path, row.path) << row.bytes;
  }
}

TEST(CipObjectPath, RefusesWhatNamesNoObject) {
  for (const char* bytes :
       {"", "24 01", "30 01", "28 01", "20 01 20 01", "20 01 24 01 24 01", "20 01 24 01 2C 01", "20 01 30 01 24 01",
        "20 01 24 01 30 01 30 01", "20 01 28 01 28 01", "20 01 28 01 30 01", "20 01 24 01 38 0E", "01 00 20 01 24 01",
        "91 01 61 00", "62 34 37 00", "34 04 00 00 00 00 00 00 00 00 20 01 24 01", "20 01 24", "20 01 43 01"}) {
    const auto path = parse_object_path(from_hex(bytes), PathForm::kPadded);
    ASSERT_FALSE(path.has_value()) << bytes;
    EXPECT_EQ(path.error(), GeneralStatus::kPathSegmentError);
  }
}

}  // namespace
}  // namespace vinv::cip
