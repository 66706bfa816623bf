// Where the option's address and line settings come from: flash memory, parameters, DHCP. FR-A7NE
// manual, 4.2, 7.8, 7.9.
//
// They act from power-on or reset. No DHCP exchange takes place: the lease is part of the configuration. Unspecified:
// what the flash holds at first; here DHCP, automatic negotiation, no address.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "option_boards/boards/ethernet_settings.hpp"
#include "option_boards/cip/status.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"

namespace vinv::boards::fr_a7ne {

// What the two ends of a cable come to (4.2.5): a fixed full duplex end does not go with an automatic one.
struct LineState {
  bool link = false;
  bool full_duplex = false;
  std::uint16_t mbit_per_s = 10;
  std::uint8_t negotiation = 0;  // attribute 2 of the Ethernet Link object, bits 2-4
  friend constexpr bool operator==(const LineState&, const LineState&) = default;
};
LineState line_state(const LineSetting& own, const LineSetting& partner);

// Interface Control (0xF6, attribute 6): control bits and speed. 0x09: what the interface does not have; 0x0C: speed or
// duplex together with automatic negotiation.
Result<LineSetting, cip::GeneralStatus> parse_interface_control(ByteView bytes);
void append_interface_control(Bytes& out, const LineSetting& line);

// Interface Configuration (0xF5, attribute 5), of the right length. 0x09: an address that is not of class A, B or C or
// is loopback, a mask with gaps, a domain of more than 48 characters.
Result<IpConfiguration, cip::GeneralStatus> parse_interface_configuration(ByteView bytes);
void append_interface_configuration(Bytes& out, const IpConfiguration& ip);

inline constexpr std::size_t kMostNameCharacters = 48;

// What is read at power-on.
struct StartupParameters {
  std::uint16_t pr346 = 132;
  std::uint16_t pr540 = 0;
  std::array<std::uint8_t, 12> pr434_to_445{};
  friend bool operator==(const StartupParameters&, const StartupParameters&) = default;
  VINV_ARCHIVE(StartupParameters, pr346, pr540, pr434_to_445);
};

// Pr.540 with its key: 0 unless bits 12-15 are 0 (4.2.5).
constexpr std::uint16_t effective_pr540(std::uint16_t raw) { return (raw & 0xF000) != 0 ? 0 : raw; }
constexpr bool settings_from_parameters(std::uint16_t pr540) { return (effective_pr540(pr540) & 1) != 0; }
constexpr bool keeps_connections_over_reset(std::uint16_t pr540) { return (effective_pr540(pr540) & 0x0800) != 0; }

// What acts until the next start.
struct NetworkSettings {
  bool dhcp = false;
  IpConfiguration ip;
  LineSetting line;
  VINV_ARCHIVE(NetworkSettings, dhcp, ip, line);
};
NetworkSettings settings_at_start(const StartupParameters& parameters, const Flash& flash,
                                  const IpConfiguration& lease);

// Instances of class 0x04 by Pr.346 (4.2.1): bits 2-6 output, 7-11 input; the default if bits 12-15 are not 0.
struct AssemblyPair {
  std::uint8_t output = 21;
  std::uint8_t input = 71;
  friend constexpr bool operator==(const AssemblyPair&, const AssemblyPair&) = default;
  VINV_ARCHIVE(AssemblyPair, output, input);
};
AssemblyPair assemblies_of(std::uint16_t pr346);
// Pr.346 with another output or input; empty: the board does not have this instance.
std::optional<std::uint16_t> pr346_with_output(std::uint16_t pr346, std::uint8_t instance);
std::optional<std::uint16_t> pr346_with_input(std::uint16_t pr346, std::uint8_t instance);

}  // namespace vinv::boards::fr_a7ne
