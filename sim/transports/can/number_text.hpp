// Numbers in the texts of CAN tools.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vinv::transports {

constexpr std::optional<std::uint32_t> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<std::uint32_t>(c - 'A' + 10);
  if (c >= 'a' && c <= 'f') return static_cast<std::uint32_t>(c - 'a' + 10);
  return std::nullopt;
}

// One to eight digits and nothing else.
constexpr std::optional<std::uint32_t> parse_hex(std::string_view text) {
  if (text.empty() || text.size() > 8) return std::nullopt;
  std::uint32_t value = 0;
  for (const char c : text) {
    const auto digit = hex_digit(c);
    if (!digit) return std::nullopt;
    value = value << 4 | *digit;
  }
  return value;
}

inline void append_hex(std::string& out, std::uint32_t value, int digits) {
  for (int i = digits; i-- > 0;) out += "0123456789ABCDEF"[value >> (4 * i) & 0xf];
}

// SECONDS.MICROSECONDS, the seconds with at least so many digits. The time is not before 1970.
inline void append_stamp(std::string& out, std::int64_t unix_us, int second_digits = 1) {
  char text[24];
  char* const end = text + sizeof text;
  char* at = end;
  auto rest = static_cast<std::uint64_t>(unix_us);
  for (int digits = 0; rest > 0 || digits < 6 + second_digits; ++digits, rest /= 10) {
    if (digits == 6) *--at = '.';
    *--at = static_cast<char>('0' + rest % 10);
  }
  out.append(at, end);
}

}  // namespace vinv::transports
