// Where a device's multicast goes. CIP Vol 2, 3-5.3: 32 groups for each host number, from 239.192.1.0 on.
#pragma once

#include <cstdint>

namespace vinv::ethernet_ip {

inline constexpr std::uint32_t kMulticastGroups = 32;  // of one device

constexpr std::uint32_t first_multicast_address(std::uint32_t address, std::uint32_t netmask) {
  constexpr std::uint32_t kBase = 0xefc00100;  // 239.192.1.0
  constexpr std::uint32_t kHostMask = 0x3ff;   // hosts that are told apart
  const std::uint32_t host = address & ~netmask;
  return kBase + ((host - 1) & kHostMask) * kMulticastGroups;
}

// The mask of an address without one: by its class (3-5.3).
constexpr std::uint32_t mask_by_class(std::uint32_t address) {
  if (address >> 31 == 0) return 0xff000000;
  if (address >> 30 == 2) return 0xffff0000;
  return 0xffffff00;
}

}  // namespace vinv::ethernet_ip
