// A classical CAN frame as ISO 11898-1 has it; the way every layer of this project passes it on.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"

namespace vinv {

struct CanFrame {
  std::uint32_t id = 0;  // 11 bits, 29 if extended
  bool extended = false;
  bool remote = false;      // RTR: length is the requested one, there is no data
  std::uint8_t length = 0;  // 0-8
  std::array<std::uint8_t, 8> data{};

  static CanFrame standard(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    CanFrame f;
    f.id = id;
    f.length = static_cast<std::uint8_t>(std::min<std::size_t>(bytes.size(), 8));
    std::copy_n(bytes.begin(), f.length, f.data.begin());
    return f;
  }
  static CanFrame remote_request(std::uint32_t id, std::uint8_t length) {
    CanFrame f;
    f.id = id;
    f.remote = true;
    f.length = length;
    return f;
  }
  ByteView bytes() const { return {data.data(), remote ? std::size_t{0} : length}; }
  friend bool operator==(const CanFrame&, const CanFrame&) = default;
  friend void archive(Archive& a, CanFrame& frame) {
    VINV_MEMBERS(frame, id, extended, remote, length, data);
    VINV_FIELDS(a, CanFrame, id, extended, remote, length, data);
    a.require(length <= data.size(), "a CAN frame is longer than 8 bytes");
  }
};

}  // namespace vinv
