// Takes a fuzzer's bytes apart: small numbers and chunks; zeros when they are used up.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sim/base/bytes.hpp"

namespace vinv::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}
  bool empty() const { return rest_.empty(); }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_[0];
    rest_ = rest_.subspan(1);
    return value;
  }
  std::uint16_t word() {
    const auto high = byte();
    return static_cast<std::uint16_t>(high << 8 | byte());
  }
  // At most size bytes; fewer at the end.
  Bytes chunk(std::size_t size) {
    const ByteView taken = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return {taken.begin(), taken.end()};
  }

 private:
  ByteView rest_;
};

}  // namespace vinv::fuzz
