// What the board takes from parameters and switches when it starts. OI-FR-E5NCO manual: 2.3 switches, 5.1 Pr.345 and
// Pr.346, 8.3 Pr.347, 8.4 node.
#pragma once

#include <cstdint>

#include "option_boards/boards/option_board.hpp"
#include "sim/base/archive.hpp"
#include "sim/base/time.hpp"

namespace vinv::boards::oi_fr_e5nco {

// Pr.347, all 256 values. Bit 7 immediate answer; 6-5 delay in ms; 4 parity on; 3 even; 2-0 baud code 1-6.
// Unspecified: baud codes 0 and 7, and bits above 7: 9600 baud, ignored.
struct SerialSetup {
  LineSettings line;
  Duration answer_delay{};
  bool immediate_answer = false;
  friend constexpr bool operator==(const SerialSetup&, const SerialSetup&) = default;
  VINV_ARCHIVE(SerialSetup, line, answer_delay, immediate_answer);
};
SerialSetup parse_pr347(std::uint32_t raw);
// Start, 8 data, parity if any, 1 stop bit.
unsigned bits_per_character(const LineSettings& line);

// Pr.346: the low nibble is the code of 5.1, bits above do not count. Bit/s.
// Unspecified: codes 0 and 9-15: 125 kbit/s, the factory value.
std::uint32_t can_bit_rate(std::uint32_t raw_pr346);

// Two decimal rotary switches: SW1 tens, SW2 units.
struct AddressSwitches {
  std::uint8_t sw1 = 0;
  std::uint8_t sw2 = 0;
  unsigned value() const { return 10u * sw1 + sw2; }
  VINV_ARCHIVE(AddressSwitches, sw1, sw2);
};

// The node address, 1-99; 0 if there is none (switches at 00), and then the board stays silent.
// Pr.345: 1-99 is the node, 100 takes the switches. Unspecified: 0 and 101-255 take the switches too.
std::uint8_t node_address(std::uint32_t raw_pr345, AddressSwitches switches);

}  // namespace vinv::boards::oi_fr_e5nco
