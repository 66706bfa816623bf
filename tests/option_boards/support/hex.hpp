// Bytes as spaced hex, the way manuals print frames.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "option_boards/modbus/crc16.hpp"
#include "sim/base/bytes.hpp"

namespace vinv::test {

// "19 06 5D C0"; anything that is not a hex digit separates.
inline Bytes from_hex(std::string_view text) {
  Bytes bytes;
  int digits = 0;
  unsigned value = 0;
  for (const char c : text) {
    const bool digit = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
    if (!digit) continue;
    value = value << 4 | static_cast<unsigned>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
    if (++digits % 2 == 0) {
      bytes.push_back(static_cast<std::uint8_t>(value));
      value = 0;
    }
  }
  return bytes;
}

inline std::string to_hex(ByteView bytes) {
  std::string text;
  char buffer[4];
  for (const std::uint8_t byte : bytes) {
    std::snprintf(buffer, sizeof buffer, "%02X", byte);
    if (!text.empty()) text += ' ';
    text += buffer;
  }
  return text;
}

inline Bytes with_crc(Bytes frame) {
  append_le16(frame, modbus::crc16(frame));
  return frame;
}
inline Bytes frame(std::string_view hex_without_crc) { return with_crc(from_hex(hex_without_crc)); }

// An MBAP header with the right length in front of a PDU.
inline Bytes adu(std::uint16_t transaction_id, std::uint8_t unit_id, std::string_view pdu_hex) {
  const Bytes pdu = from_hex(pdu_hex);
  Bytes out;
  append_be16(out, transaction_id);
  append_be16(out, 0);
  append_be16(out, static_cast<std::uint16_t>(pdu.size() + 1));
  out.push_back(unit_id);
  out.insert(out.end(), pdu.begin(), pdu.end());
  return out;
}

}  // namespace vinv::test
