// CAN frames as text, the way candump writes them: "605#2B00400002000000", "185#R8" for a remote request of 8 bytes.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "sim/base/can_frame.hpp"
#include "sim/base/check.hpp"

namespace vinv::test {

// Blanks between the data bytes are allowed.
inline CanFrame can(std::string_view text) {
  const auto digit = [](char c) -> int {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  CanFrame frame;
  const std::size_t hash = text.find('#');
  VINV_CHECK(hash != std::string_view::npos);
  for (const char c : text.substr(0, hash)) frame.id = frame.id << 4 | static_cast<unsigned>(digit(c));
  frame.extended = hash == 8;
  std::string_view data = text.substr(hash + 1);
  if (data.starts_with('R')) {
    frame.remote = true;
    frame.length = static_cast<std::uint8_t>(data.size() > 1 ? digit(data[1]) : 0);
    return frame;
  }
  int high = -1;
  for (const char c : data) {
    const int value = digit(c);
    if (value < 0) continue;
    if (high < 0) {
      high = value;
    } else {
      VINV_CHECK(frame.length < 8);
      frame.data[frame.length++] = static_cast<std::uint8_t>(high << 4 | value);
      high = -1;
    }
  }
  return frame;
}

inline std::string text_of(const CanFrame& frame) {
  char buffer[16];
  std::snprintf(buffer, sizeof buffer, frame.extended ? "%08X#" : "%03X#", frame.id);
  std::string text = buffer;
  if (frame.remote) return text + "R" + std::to_string(frame.length);
  for (const std::uint8_t byte : frame.bytes()) {
    std::snprintf(buffer, sizeof buffer, "%02X", byte);
    text += buffer;
  }
  return text;
}

}  // namespace vinv::test
