// Integers as they travel: reads and writes of fixed-width words in either byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vinv {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

// The caller has checked that at + 2 (or + 4) bytes are there.
constexpr std::uint16_t read_be16(ByteView b, std::size_t at) {
  return static_cast<std::uint16_t>(b[at] << 8 | b[at + 1]);
}
constexpr std::uint16_t read_le16(ByteView b, std::size_t at) {
  return static_cast<std::uint16_t>(b[at + 1] << 8 | b[at]);
}
constexpr std::uint32_t read_be32(ByteView b, std::size_t at) {
  return static_cast<std::uint32_t>(read_be16(b, at)) << 16 | read_be16(b, at + 2);
}
constexpr std::uint32_t read_le32(ByteView b, std::size_t at) {
  return static_cast<std::uint32_t>(read_le16(b, at + 2)) << 16 | read_le16(b, at);
}

inline void append_be16(Bytes& out, std::uint16_t v) {
  out.push_back(static_cast<std::uint8_t>(v >> 8));
  out.push_back(static_cast<std::uint8_t>(v));
}
inline void append_le16(Bytes& out, std::uint16_t v) {
  out.push_back(static_cast<std::uint8_t>(v));
  out.push_back(static_cast<std::uint8_t>(v >> 8));
}
inline void append_be32(Bytes& out, std::uint32_t v) {
  append_be16(out, static_cast<std::uint16_t>(v >> 16));
  append_be16(out, static_cast<std::uint16_t>(v));
}
inline void append_le32(Bytes& out, std::uint32_t v) {
  append_le16(out, static_cast<std::uint16_t>(v));
  append_le16(out, static_cast<std::uint16_t>(v >> 16));
}

}  // namespace vinv
