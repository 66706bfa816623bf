// Data types as they travel: little endian. CIP Vol 1, appendix C-5 (numbers of the types: C-6.1).
//
// A type is written as in the manuals' tables: UINT, ARRAY[6] USINT, STRUCT{UINT;EPATH}, ARRAY[3] STRUCT{UINT;UINT}.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "option_boards/cip/status.hpp"
#include "sim/base/bytes.hpp"

namespace vinv::cip {

enum class DataType : std::uint8_t {
  kBool = 0xC1,
  kSint = 0xC2,
  kInt = 0xC3,
  kDint = 0xC4,
  kLint = 0xC5,
  kUsint = 0xC6,
  kUint = 0xC7,
  kUdint = 0xC8,
  kUlint = 0xC9,
  kReal = 0xCA,
  kLreal = 0xCB,
  kString = 0xD0,  // UINT length, characters
  kByte = 0xD1,
  kWord = 0xD2,
  kDword = 0xD3,
  kLword = 0xD4,
  kShortString = 0xDA,  // USINT length, characters
  kEpath = 0xDC,        // without a length of its own: what remains
  // STRING with a byte of 0 after an odd number of characters (TCP/IP object, attributes 5 and 6); in tables
  // PADDED_STRING. Not a number of the specification.
  kPaddedString = 0xFF,
};

// Bytes of a value; 0 for strings and paths.
std::size_t size_of(DataType type);
constexpr bool is_real(DataType type) { return type == DataType::kReal || type == DataType::kLreal; }
// A whole number, BOOL and bit strings included.
bool is_integer(DataType type);
// Empty: no such type.
std::optional<DataType> data_type_of(std::string_view name);

// The smallest and largest value; ULINT and LWORD as far as int64 goes.
struct IntegerRange {
  std::int64_t min = 0, max = 0;
};
IntegerRange range_of(DataType type);

// The caller has checked the size; type is a whole number. LWORD and ULINT wrap into the sign.
std::int64_t read_integer(DataType type, ByteView bytes);
void append_integer(Bytes& out, DataType type, std::int64_t value);
// REAL or LREAL.
double read_real(DataType type, ByteView bytes);
void append_real(Bytes& out, DataType type, double value);
// Longer texts are cut.
void append_short_string(Bytes& out, std::string_view text);
void append_string(Bytes& out, std::string_view text);
void append_padded_string(Bytes& out, std::string_view text);

// The type of an attribute: its members in order, arrays and structs taken apart.
class TypeSpec {
 public:
  struct Member {
    DataType type = DataType::kUint;
    std::uint16_t count = 1;
  };
  TypeSpec() = default;  // no data
  // Ends the process for a text that is no type: tables are part of the program.
  explicit TypeSpec(std::string_view text);

  // The type, if it is one whole number.
  std::optional<DataType> integer() const { return integer_; }
  const std::vector<Member>& members() const { return members_; }
  // kNotEnoughData, kTooMuchData or kSuccess. A path takes what remains; it is checked for being readable.
  GeneralStatus check(ByteView value) const;
  // A constant from a table: one word per value, separated by blanks: numbers (10, -1, 0x0F), "text" without blanks,
  // paths in hexadecimal digits. Ends the process if the words do not fit the type.
  void append_constant(Bytes& out, std::string_view words) const;

 private:
  std::string_view parse(std::string_view text);
  std::vector<Member> members_;
  std::optional<DataType> integer_;
};

}  // namespace vinv::cip
