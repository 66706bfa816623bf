// An IPv4 address with a port, in host byte order, as engines and transports both name the ends of a conversation.
#pragma once

#include <charconv>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim/base/archive.hpp"

namespace vinv {

struct Ipv4Endpoint {
  std::uint32_t address = 0;  // 127.0.0.1 is 0x7F000001
  std::uint16_t port = 0;
  friend constexpr auto operator<=>(const Ipv4Endpoint&, const Ipv4Endpoint&) = default;
  VINV_ARCHIVE(Ipv4Endpoint, address, port);
};

constexpr std::uint32_t ipv4(unsigned a, unsigned b, unsigned c, unsigned d) { return a << 24 | b << 16 | c << 8 | d; }
// 224.0.0.0/4.
constexpr bool is_multicast(std::uint32_t address) { return address >> 28 == 0xe; }

inline std::string ipv4_text(std::uint32_t address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8)
    text += std::to_string(address >> shift & 0xff) + (shift == 0 ? "" : ".");
  return text;
}

// Four decimal numbers of 0 to 255 with points between them; nothing else.
inline std::optional<std::uint32_t> parse_ipv4(std::string_view text) {
  std::uint32_t address = 0;
  for (int part = 0; part < 4; ++part) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const auto digits = static_cast<std::size_t>(end - text.data());
    if (error != std::errc() || value > 255 || digits > 3) return std::nullopt;
    address = address << 8 | value;
    text.remove_prefix(digits);
    if (part == 3) break;
    if (!text.starts_with('.')) return std::nullopt;
    text.remove_prefix(1);
  }
  if (!text.empty()) return std::nullopt;
  return address;
}

}  // namespace vinv
