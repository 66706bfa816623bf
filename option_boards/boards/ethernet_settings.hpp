// What an option board on Ethernet is told of its surroundings, and what the ends of its cable are set to.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"

namespace vinv::boards {

// Addresses as numbers: 192.168.0.1 is 0xC0A80001; 0: not set.
struct IpConfiguration {
  std::uint32_t address = 0;
  std::uint32_t mask = 0;
  std::uint32_t gateway = 0;
  std::uint32_t name_server = 0;
  std::uint32_t name_server_2 = 0;
  std::string domain;
  friend bool operator==(const IpConfiguration&, const IpConfiguration&) = default;
  VINV_ARCHIVE(IpConfiguration, address, mask, gateway, name_server, name_server_2, domain);
};

// Speed and duplex of one end of a cable.
struct LineSetting {
  bool automatic = true;
  bool full_duplex = false;       // of a fixed setting
  std::uint16_t mbit_per_s = 10;  // of a fixed setting: 10 or 100
  friend constexpr bool operator==(const LineSetting&, const LineSetting&) = default;
  VINV_ARCHIVE(LineSetting, automatic, full_duplex, mbit_per_s);
};

// "auto", "10_half", "10_full", "100_half", "100_full".
std::string_view line_setting_word(const LineSetting& line);
std::optional<LineSetting> parse_line_setting(std::string_view word);
std::vector<std::string_view> line_setting_words();

// What the option keeps in its own memory over power-off.
struct Flash {
  bool dhcp = true;
  IpConfiguration ip;
  std::string host_name;
  LineSetting line;
  friend bool operator==(const Flash&, const Flash&) = default;
  VINV_ARCHIVE(Flash, dhcp, ip, host_name, line);
};

// Of the surroundings, whatever the board itself is set to.
struct EthernetSurroundings {
  std::array<std::uint8_t, 6> mac{};
  IpConfiguration lease;     // what a DHCP server gives
  LineSetting line_partner;  // the other end of the cable
  Flash flash;               // as the option comes
};

}  // namespace vinv::boards
