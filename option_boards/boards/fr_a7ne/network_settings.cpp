#include "option_boards/boards/fr_a7ne/network_settings.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "option_boards/cip/data_types.hpp"

namespace vinv::boards::fr_a7ne {
namespace {

using cip::GeneralStatus;

constexpr std::uint16_t kAutomatic = 1, kFullDuplex = 2;
constexpr std::uint16_t kSlow = 10, kFast = 100;
constexpr std::uint16_t kDefaultPr346 = 132;
constexpr std::uint16_t kKeyBits = 0xF000;
constexpr unsigned kOutputShift = 2, kInputShift = 7, kCodeMask = 0x1F;

struct AssemblyCode {
  std::uint8_t code, output, input;
};
constexpr std::array<AssemblyCode, 4> kAssemblies{{{0, 20, 70}, {1, 21, 71}, {6, 126, 176}, {7, 129, 179}}};
constexpr std::size_t kStandard = 1;

const AssemblyCode& assembly_of(unsigned code) {
  const auto found =
      std::find_if(kAssemblies.begin(), kAssemblies.end(), [&](const auto& a) { return a.code == code; });
  return found == kAssemblies.end() ? kAssemblies[kStandard] : *found;
}

std::uint16_t effective_pr346(std::uint16_t raw) { return (raw & kKeyBits) != 0 ? kDefaultPr346 : raw; }

std::optional<std::uint16_t> with_code(std::uint16_t pr346, unsigned shift, std::uint8_t AssemblyCode::*member,
                                       std::uint8_t instance) {
  for (const AssemblyCode& a : kAssemblies) {
    if (a.*member != instance) continue;
    const unsigned kept = effective_pr346(pr346) & ~(kCodeMask << shift);
    return static_cast<std::uint16_t>(kept | static_cast<unsigned>(a.code) << shift);
  }
  return std::nullopt;
}

// 7.8.2 *1.
bool usable(std::uint32_t address) {
  constexpr std::uint32_t kLoopback = 127, kFirstOfClassD = 224;
  const std::uint32_t first = address >> 24;
  return address == 0 || (first != 0 && first != kLoopback && first < kFirstOfClassD);
}
bool without_gaps(std::uint32_t mask) { return (~mask & (~mask + 1)) == 0; }

std::uint32_t four_octets(const std::uint8_t* octets) {
  return std::uint32_t{octets[0]} << 24 | std::uint32_t{octets[1]} << 16 | std::uint32_t{octets[2]} << 8 | octets[3];
}

// ComSet, bits 2-4 of Pr.540.
LineSetting line_of(std::uint16_t pr540) {
  const unsigned code = pr540 >> 2 & 7;
  if ((code & 4) == 0) return {};
  return {false, (code & 1) != 0, (code & 2) != 0 ? kFast : kSlow};
}

}  // namespace

LineState line_state(const LineSetting& own, const LineSetting& partner) {
  enum : std::uint8_t { kFailed = 1, kSpeedOnly = 2, kSucceeded = 3, kForced = 4 };
  if (own.automatic && partner.automatic) return {true, true, kFast, kSucceeded};
  if (own.automatic) {
    if (partner.full_duplex) return {false, false, kSlow, kFailed};
    return {true, false, partner.mbit_per_s, kSpeedOnly};
  }
  const bool agree = partner.automatic ? !own.full_duplex : own == partner;
  return {agree, own.full_duplex, own.mbit_per_s, kForced};
}

Result<LineSetting, GeneralStatus> parse_interface_control(ByteView bytes) {
  const std::uint16_t bits = read_le16(bytes, 0), speed = read_le16(bytes, 2);
  if ((bits & ~(kAutomatic | kFullDuplex)) != 0) return Unexpected(GeneralStatus::kInvalidAttributeValue);
  const bool full_duplex = (bits & kFullDuplex) != 0;
  if ((bits & kAutomatic) != 0) {
    if (full_duplex || speed != 0) return Unexpected(GeneralStatus::kObjectStateConflict);
    return LineSetting{};
  }
  if (speed != kSlow && speed != kFast) return Unexpected(GeneralStatus::kInvalidAttributeValue);
  return LineSetting{false, full_duplex, speed};
}

void append_interface_control(Bytes& out, const LineSetting& line) {
  append_le16(out, static_cast<std::uint16_t>(line.automatic ? kAutomatic : line.full_duplex ? kFullDuplex : 0));
  append_le16(out, line.automatic ? std::uint16_t{0} : line.mbit_per_s);
}

Result<IpConfiguration, GeneralStatus> parse_interface_configuration(ByteView bytes) {
  IpConfiguration ip;
  std::size_t at = 0;
  for (std::uint32_t* field : {&ip.address, &ip.mask, &ip.gateway, &ip.name_server, &ip.name_server_2}) {
    *field = read_le32(bytes, at);
    at += sizeof(std::uint32_t);
    if (field == &ip.mask ? !without_gaps(ip.mask) : !usable(*field)) {
      return Unexpected(GeneralStatus::kInvalidAttributeValue);
    }
  }
  const std::size_t length = read_le16(bytes, at);
  if (length > kMostNameCharacters) return Unexpected(GeneralStatus::kInvalidAttributeValue);
  const ByteView name = bytes.subspan(at + 2, length);
  ip.domain.assign(name.begin(), name.end());
  return ip;
}

void append_interface_configuration(Bytes& out, const IpConfiguration& ip) {
  for (const std::uint32_t field : {ip.address, ip.mask, ip.gateway, ip.name_server, ip.name_server_2}) {
    append_le32(out, field);
  }
  cip::append_padded_string(out, ip.domain);
}

NetworkSettings settings_at_start(const StartupParameters& parameters, const Flash& flash,
                                  const IpConfiguration& lease) {
  constexpr std::uint16_t kDhcpOff = 2;
  const std::uint16_t pr540 = effective_pr540(parameters.pr540);
  NetworkSettings settings;
  if (settings_from_parameters(pr540)) {
    settings.dhcp = (pr540 & kDhcpOff) == 0;
    const std::uint8_t* octets = parameters.pr434_to_445.data();
    settings.ip.address = four_octets(octets);
    settings.ip.mask = four_octets(octets + 4);
    settings.ip.gateway = four_octets(octets + 8);
    settings.line = line_of(pr540);
  } else {
    settings.dhcp = flash.dhcp;
    settings.ip = flash.ip;
    settings.line = flash.line;
  }
  if (settings.dhcp) settings.ip = lease;
  return settings;
}

AssemblyPair assemblies_of(std::uint16_t pr346) {
  const unsigned value = effective_pr346(pr346);
  return {assembly_of(value >> kOutputShift & kCodeMask).output, assembly_of(value >> kInputShift & kCodeMask).input};
}

std::optional<std::uint16_t> pr346_with_output(std::uint16_t pr346, std::uint8_t instance) {
  return with_code(pr346, kOutputShift, &AssemblyCode::output, instance);
}
std::optional<std::uint16_t> pr346_with_input(std::uint16_t pr346, std::uint8_t instance) {
  return with_code(pr346, kInputShift, &AssemblyCode::input, instance);
}

}  // namespace vinv::boards::fr_a7ne
