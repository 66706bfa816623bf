#include "option_boards/cip/data_types.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <utility>

#include "option_boards/cip/epath.hpp"
#include "sim/base/check.hpp"
#include "sim/base/table_text.hpp"

namespace vinv::cip {
namespace {

constexpr std::array<std::pair<std::string_view, DataType>, 19> kNames{{
    {"BOOL", DataType::kBool},
    {"SINT", DataType::kSint},
    {"INT", DataType::kInt},
    {"DINT", DataType::kDint},
    {"LINT", DataType::kLint},
    {"USINT", DataType::kUsint},
    {"UINT", DataType::kUint},
    {"UDINT", DataType::kUdint},
    {"ULINT", DataType::kUlint},
    {"REAL", DataType::kReal},
    {"LREAL", DataType::kLreal},
    {"STRING", DataType::kString},
    {"BYTE", DataType::kByte},
    {"WORD", DataType::kWord},
    {"DWORD", DataType::kDword},
    {"LWORD", DataType::kLword},
    {"SHORT_STRING", DataType::kShortString},
    {"EPATH", DataType::kEpath},
    {"PADDED_STRING", DataType::kPaddedString},
}};

bool is_signed(DataType type) {
  return type == DataType::kSint || type == DataType::kInt || type == DataType::kDint || type == DataType::kLint;
}

std::uint64_t read_raw(ByteView bytes, std::size_t size) {
  std::uint64_t raw = 0;
  for (std::size_t i = size; i-- > 0;) raw = raw << 8 | bytes[i];
  return raw;
}

void append_raw(Bytes& out, std::uint64_t raw, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) out.push_back(static_cast<std::uint8_t>(raw >> (8 * i)));
}

void append_text(Bytes& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

// Bytes of one value of the type at the front; empty if they are not all there.
std::optional<std::size_t> bytes_taken(DataType type, ByteView value) {
  const auto if_there = [&](std::size_t bytes) {
    return bytes <= value.size() ? std::optional<std::size_t>(bytes) : std::nullopt;
  };
  switch (type) {
    case DataType::kShortString: return value.empty() ? std::nullopt : if_there(1 + std::size_t{value[0]});
    case DataType::kString: return value.size() < 2 ? std::nullopt : if_there(2 + std::size_t{read_le16(value, 0)});
    case DataType::kPaddedString: {
      if (value.size() < 2) return std::nullopt;
      const std::size_t bare = 2 + std::size_t{read_le16(value, 0)};
      return if_there(bare + bare % 2);
    }
    case DataType::kEpath: return value.size();
    default: return if_there(size_of(type));
  }
}

bool readable_path(ByteView path) {
  EpathReader reader(path, PathForm::kPadded);
  while (!reader.at_end()) {
    if (!reader.next()) return false;
  }
  return true;
}

void append_hex(Bytes& out, std::string_view digits) {
  VINV_CHECK(digits.size() % 2 == 0);
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    out.push_back(number_of_field<std::uint8_t>(digits.substr(i, 2), 0, 16));
  }
}

void append_word(Bytes& out, DataType type, std::string_view word) {
  VINV_CHECK(!word.empty());
  if (type == DataType::kEpath) return append_hex(out, word);
  if (is_real(type)) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    VINV_CHECK(error == std::errc{} && end == word.data() + word.size());
    return append_real(out, type, value);
  }
  if (size_of(type) == 0) {
    VINV_CHECK(word.size() >= 2 && word.front() == '"' && word.back() == '"');
    word = word.substr(1, word.size() - 2);
    if (type == DataType::kShortString) return append_short_string(out, word);
    return type == DataType::kString ? append_string(out, word) : append_padded_string(out, word);
  }
  const auto value = number_of_field<std::int64_t>(word, 0);
  const IntegerRange range = range_of(type);
  VINV_CHECK(value >= range.min && value <= range.max);
  append_integer(out, type, value);
}

}  // namespace

std::size_t size_of(DataType type) {
  switch (type) {
    case DataType::kBool:
    case DataType::kSint:
    case DataType::kUsint:
    case DataType::kByte: return 1;
    case DataType::kInt:
    case DataType::kUint:
    case DataType::kWord: return 2;
    case DataType::kDint:
    case DataType::kUdint:
    case DataType::kDword:
    case DataType::kReal: return 4;
    case DataType::kLint:
    case DataType::kUlint:
    case DataType::kLword:
    case DataType::kLreal: return 8;
    default: return 0;
  }
}

bool is_integer(DataType type) { return size_of(type) != 0 && !is_real(type); }

std::optional<DataType> data_type_of(std::string_view name) {
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const auto& n) { return n.first == name; });
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

IntegerRange range_of(DataType type) {
  if (type == DataType::kBool) return {0, 1};
  const auto bits = static_cast<unsigned>(8 * size_of(type));
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  if (is_signed(type)) {
    const std::int64_t max = kMost >> (64 - bits);
    return {-max - 1, max};
  }
  return {0, bits == 64 ? kMost : (std::int64_t{1} << bits) - 1};
}

std::int64_t read_integer(DataType type, ByteView bytes) {
  const std::size_t size = size_of(type);
  const std::uint64_t raw = read_raw(bytes, size);
  if (!is_signed(type)) return static_cast<std::int64_t>(raw);
  const auto unused = static_cast<unsigned>(64 - 8 * size);
  return static_cast<std::int64_t>(raw << unused) >> unused;
}

void append_integer(Bytes& out, DataType type, std::int64_t value) {
  append_raw(out, static_cast<std::uint64_t>(value), size_of(type));
}

double read_real(DataType type, ByteView bytes) {
  if (type == DataType::kReal) return static_cast<double>(std::bit_cast<float>(read_le32(bytes, 0)));
  return std::bit_cast<double>(read_raw(bytes, sizeof(double)));
}

void append_real(Bytes& out, DataType type, double value) {
  if (type == DataType::kReal) {
    append_raw(out, std::bit_cast<std::uint32_t>(static_cast<float>(value)), sizeof(float));
  } else {
    append_raw(out, std::bit_cast<std::uint64_t>(value), sizeof(double));
  }
}

void append_short_string(Bytes& out, std::string_view text) {
  text = text.substr(0, 0xFF);
  out.push_back(static_cast<std::uint8_t>(text.size()));
  append_text(out, text);
}

void append_string(Bytes& out, std::string_view text) {
  text = text.substr(0, 0xFFFF);
  append_le16(out, static_cast<std::uint16_t>(text.size()));
  append_text(out, text);
}

void append_padded_string(Bytes& out, std::string_view text) {
  append_string(out, text);
  if (text.size() % 2 != 0) out.push_back(0);
}

TypeSpec::TypeSpec(std::string_view text) {
  VINV_CHECK(parse(text).empty());
  // A path takes what remains.
  for (std::size_t i = 0; i + 1 < members_.size(); ++i) VINV_CHECK(members_[i].type != DataType::kEpath);
  if (members_.size() == 1 && members_[0].count == 1 && is_integer(members_[0].type)) integer_ = members_[0].type;
}

// What follows the type.
std::string_view TypeSpec::parse(std::string_view text) {
  constexpr std::string_view kArray = "ARRAY[", kStruct = "STRUCT{";
  if (text.starts_with(kArray)) {
    text.remove_prefix(kArray.size());
    const auto count = number_of_field<std::uint16_t>(take_until(text, ']'), 0);
    VINV_CHECK(count > 0 && text.starts_with(' '));
    const std::size_t first = members_.size();
    text = parse(text.substr(1));
    if (members_.size() == first + 1) {
      members_[first].count = static_cast<std::uint16_t>(members_[first].count * count);
      return text;
    }
    const std::vector<Member> element(members_.begin() + static_cast<std::ptrdiff_t>(first), members_.end());
    for (unsigned i = 1; i < count; ++i) members_.insert(members_.end(), element.begin(), element.end());
    return text;
  }
  if (text.starts_with(kStruct)) {
    text.remove_prefix(kStruct.size());
    text = parse(text);
    while (text.starts_with(';')) text = parse(text.substr(1));
    VINV_CHECK(text.starts_with('}'));
    return text.substr(1);
  }
  const std::size_t end = std::min(text.find_first_of(";}"), text.size());
  const auto type = data_type_of(text.substr(0, end));
  VINV_CHECK(type.has_value());
  members_.push_back({*type, 1});
  return text.substr(end);
}

GeneralStatus TypeSpec::check(ByteView value) const {
  for (const Member& member : members_) {
    if (member.type == DataType::kEpath) {
      return readable_path(value) ? GeneralStatus::kSuccess : GeneralStatus::kInvalidAttributeValue;
    }
    for (unsigned i = 0; i < member.count; ++i) {
      const auto taken = bytes_taken(member.type, value);
      if (!taken) return GeneralStatus::kNotEnoughData;
      value = value.subspan(*taken);
    }
  }
  return value.empty() ? GeneralStatus::kSuccess : GeneralStatus::kTooMuchData;
}

void TypeSpec::append_constant(Bytes& out, std::string_view words) const {
  for (const Member& member : members_) {
    for (unsigned i = 0; i < member.count; ++i) append_word(out, member.type, take_until(words, ' '));
  }
  VINV_CHECK(words.empty());
}

}  // namespace vinv::cip
