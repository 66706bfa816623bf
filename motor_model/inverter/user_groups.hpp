// User groups of parameters that the panel may be limited to (E500: Pr.160, 173-176).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "sim/base/archive.hpp"

namespace vinv::inverter {

struct UserGroup {
  static constexpr std::size_t kCapacity = 16;  // typical for the family
  std::array<std::uint16_t, kCapacity> numbers{};
  std::uint8_t count = 0;

  bool contains(std::uint16_t number) const {
    return std::find(numbers.begin(), numbers.begin() + count, number) != numbers.begin() + count;
  }
  // False if full; a number that is in already stays once.
  bool add(std::uint16_t number) {
    if (contains(number)) return true;
    if (count == kCapacity) return false;
    numbers[count++] = number;
    return true;
  }
  void remove(std::uint16_t number) {
    auto* const last = numbers.begin() + count;
    auto* const kept = std::remove(numbers.begin(), last, number);
    count = static_cast<std::uint8_t>(kept - numbers.begin());
    std::fill(kept, last, std::uint16_t{0});
  }
  void clear() { *this = UserGroup{}; }
  friend bool operator==(const UserGroup&, const UserGroup&) = default;
  VINV_ARCHIVE(UserGroup, numbers, count);
};

}  // namespace vinv::inverter
