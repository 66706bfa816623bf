#include "option_boards/boards/oi_fr_e5nco/startup_settings.hpp"

#include <array>

namespace vinv::boards::oi_fr_e5nco {

SerialSetup parse_pr347(std::uint32_t raw) {
  constexpr std::array<std::uint32_t, 8> kBaudOfCode{9600, 1200, 2400, 4800, 9600, 19200, 38400, 9600};
  const bool parity_on = (raw >> 4 & 1u) != 0, even = (raw >> 3 & 1u) != 0;
  SerialSetup setup;
  setup.line.baud = kBaudOfCode[raw & 7u];
  setup.line.parity = !parity_on ? LineSettings::Parity::kNone
                      : even     ? LineSettings::Parity::kEven
                                 : LineSettings::Parity::kOdd;
  setup.answer_delay = std::chrono::milliseconds(raw >> 5 & 3u);
  setup.immediate_answer = (raw >> 7 & 1u) != 0;
  return setup;
}

unsigned bits_per_character(const LineSettings& line) { return line.parity == LineSettings::Parity::kNone ? 10 : 11; }

std::uint32_t can_bit_rate(std::uint32_t raw_pr346) {
  constexpr std::uint32_t kFactory = 125'000;
  constexpr std::array<std::uint32_t, 16> kRateOfCode{kFactory, 1'000'000, 500'000,  250'000,  125'000,  100'000,
                                                      62'500,   50'000,    20'000,   kFactory, kFactory, kFactory,
                                                      kFactory, kFactory,  kFactory, kFactory};
  return kRateOfCode[raw_pr346 & 0xf];
}

std::uint8_t node_address(std::uint32_t raw_pr345, AddressSwitches switches) {
  constexpr std::uint32_t kLastNode = 99;
  const std::uint32_t node = raw_pr345 >= 1 && raw_pr345 <= kLastNode ? raw_pr345 : switches.value();
  return static_cast<std::uint8_t>(node);
}

}  // namespace vinv::boards::oi_fr_e5nco
