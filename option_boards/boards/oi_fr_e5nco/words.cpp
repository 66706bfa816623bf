#include "option_boards/boards/oi_fr_e5nco/words.hpp"

#include <algorithm>
#include <array>

namespace vinv::boards::oi_fr_e5nco {
namespace {

struct CommandBit {
  unsigned bit;
  port::NetTerminal terminal;
};

constexpr std::array<CommandBit, 7> kCommandBits{{
    {0, port::NetTerminal::kStop},
    {1, port::NetTerminal::kStf},
    {2, port::NetTerminal::kStr},
    {3, port::NetTerminal::kRh},
    {4, port::NetTerminal::kRm},
    {5, port::NetTerminal::kRl},
    {10, port::NetTerminal::kMrs},
}};

constexpr port::ParameterId kPolesParameter{144, 0};
constexpr std::uint32_t kDefaultPoles = 4;

// 10 * poles / 4 of the formula, never 0.
std::uint32_t factor(std::uint32_t poles) { return std::max<std::uint32_t>(10 * poles / 4, 1); }

}  // namespace

port::NetTerminals terminals_of_command(std::uint16_t raw_command) {
  port::NetTerminals terminals;
  for (const auto& [bit, terminal] : kCommandBits) {
    if ((raw_command >> bit & 1u) != 0) terminals.set(terminal, true);
  }
  return terminals;
}

std::uint16_t raw_status(const port::Status& status) {
  const auto bit = [](bool on, unsigned n) { return on ? 1u << n : 0u; };
  return static_cast<std::uint16_t>(bit(status.running, 0) | bit(status.forward, 1) | bit(status.reverse, 2) |
                                    bit(status.up_to_frequency, 3) | bit(status.overload, 4) |
                                    bit(status.power_failure, 5) | bit(status.frequency_detected, 6) |
                                    bit(status.alarm, 7) | bit(status.ready, 15));
}

std::uint32_t poles_of(std::uint32_t raw_pr144) {
  constexpr std::uint32_t kDisplayOffset = 100, kMaxPr144 = 110;
  if (raw_pr144 == 0 || raw_pr144 > kMaxPr144) return kDefaultPoles;
  return raw_pr144 > kDisplayOffset ? raw_pr144 - kDisplayOffset : raw_pr144;
}

std::uint32_t poles_of(const port::DrivePort& drive) {
  return poles_of(drive.read_parameter(kPolesParameter).value_or(0u));
}

std::uint16_t raw_alarm_pair(const port::AlarmHistory& history, std::size_t pair) {
  return static_cast<std::uint16_t>(history.at(2 * pair) | history.at(2 * pair + 1) << 8);
}

std::uint32_t raw_frequency_of_rpm(std::uint32_t rpm, std::uint32_t poles) { return rpm * factor(poles) / 3; }

std::uint16_t rpm_of_raw_frequency(std::uint32_t raw_frequency, std::uint32_t poles) {
  return static_cast<std::uint16_t>(std::min(raw_frequency * 3 / factor(poles), kMaxWord));
}

std::uint16_t nearest_rpm_of_raw_frequency(std::uint32_t raw_frequency, std::uint32_t poles) {
  const std::uint64_t rounded = (std::uint64_t{raw_frequency} * 3 + factor(poles) / 2) / factor(poles);
  return static_cast<std::uint16_t>(std::min<std::uint64_t>(rounded, kMaxWord));
}

}  // namespace vinv::boards::oi_fr_e5nco
